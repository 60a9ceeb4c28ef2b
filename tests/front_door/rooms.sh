#!/usr/bin/env bash
# rooms.sh DIRECTORY: prints every include that a room may not make, and fails where there is one. The
# rooms are those that docs/architecture.md draws.
drawing=$(dirname -- "$(readlink -f -- "$0")")/../../docs/architecture.md
cd -- "$1" || exit 2

# room | what its files may include, as a regular expression over the path
rules=(
  'queues|queues/'
  'renderer|renderer/|queues/(work_queue|split_mix)\.hpp$'
  'stress|stress/|queues/'
  'bench|bench/|stress/|renderer/|queues/'
  'tests|.*'
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

# floor HOUSE ROOM: the next floor of a house includes itself, those below and what no room holds.
declare -A below
floor() {
  below[$1]+=${below[$1]:+|}$2
  check "$1/$2" "$1/((${below[$1]})/|[^/]+$)" "$1/"
}

# The houses stand under a heading each, their rooms in a table.
house=
while IFS= read -r line; do
  case $line in
    '#'*) [[ $line =~ ^\#+\ \`(.+)/\`$ ]] && house=${BASH_REMATCH[1]} || house= ;;
    '| `'*) [[ $house && $line =~ ^\|\ \`([a-z_]+)/\` ]] && floor "$house" "${BASH_REMATCH[1]}" ;;
  esac
done <"$drawing"

for house in "${!below[@]}"; do
  for room in "$house"/*/; do
    room=${room%/}
    [[ ${room##*/} =~ ^(${below[$house]})$ ]] && continue
    compgen -G "$room/*.[hc]pp" >/dev/null || continue
    echo "$room is missing in docs/architecture.md, where the rooms of $house/ are drawn"
    failed=1
  done
done
exit "$failed"
