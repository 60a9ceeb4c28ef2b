#!/usr/bin/env bash
# rooms.sh DIRECTORY: prints every include that a room may not make (docs/architecture.md), and
# fails where there is one.
cd -- "$1" || exit 2

# room | what its files may include, as a regular expression over the path
rules=(
  'queues|queues/'
  'renderer|renderer/|queues/(work_queue|split_mix)\.hpp$'
  'stress|stress/|queues/'
  'bench|bench/|stress/|renderer/|queues/'
  'tests|.*'
)

# room | its rooms from the ground floor up: of the room's files each may include those of its own
# floor and below
floors=(
  'bench/many_core|profiles calibration coherence machine workloads sweeps renderer'
)

failed=0

# check ROOM ALLOWED PREFIX: of the includes in ROOM that begin with PREFIX.
check() {
  local file line include path
  [[ -d $1 ]] || return
  while IFS=: read -r file line include; do
    [[ $include =~ \"(.*)\" ]] || continue
    path=${BASH_REMATCH[1]}
    # Without a directory: a file generated for this room alone; in templates: filled in by CMake.
    [[ $path != */* || $path == @* ]] && continue
    if [[ ! $path =~ ^($2) ]]; then
      echo "$file:$line: $1/ may not include \"$path\""
      failed=1
    fi
  done < <(grep -rnE "^ *# *include *\"$3" --include='*.[hc]pp' --include='*.in' "$1")
}

for rule in "${rules[@]}"; do check "${rule%%|*}" "${rule#*|}" ''; done
for house in "${floors[@]}"; do
  room=${house%%|*} below=
  for floor in ${house#*|}; do
    below+=${below:+|}$floor
    check "$room/$floor" "$room/($below)/" "$room/"
  done
done
exit "$failed"
