#!/usr/bin/env bash
# rooms.sh DIRECTORY: prints every include that a room may not make (docs/architecture.md), and
# fails where there is one.
cd -- "$1" || exit 2

# room | what its files may include, as a regular expression over the path
rules=(
  'queues|queues/'
  'renderer|renderer/|queues/work_queue\.hpp$'
  'stress|stress/|queues/'
  'bench|bench/|stress/|renderer/|queues/'
  'tests|.*'
)

failed=0
for rule in "${rules[@]}"; do
  room=${rule%%|*} allowed=${rule#*|}
  [[ -d $room ]] || continue
  while IFS=: read -r file line include; do
    [[ $include =~ \"(.*)\" ]] || continue
    path=${BASH_REMATCH[1]}
    # Without a directory: a file generated for this room alone; in templates: filled in by CMake.
    [[ $path != */* || $path == @* ]] && continue
    if [[ ! $path =~ ^($allowed) ]]; then
      echo "$file:$line: $room/ may not include \"$path\""
      failed=1
    fi
  done < <(grep -rnE '^ *# *include *"' --include='*.[hc]pp' --include='*.in' "$room")
done
exit "$failed"
