# Queues that are headers outside the tree: `--queue FOLDER/my_queue.hpp` or `my_queue.hpp:Class`.
#
# Each is a small CMake project below build/outside, whose plug-in ninja keeps up to date: a second
# call compiles what was saved in between, and nothing else.

# The header of a queue: anything.hpp, and after a colon the class template in it.
outside_pattern='^(.+\.(hpp|hh|hxx|h))(:[A-Za-z_][A-Za-z0-9_:]*)?$'

# class_templates HEADER : the class templates of one type in it that are no members of others, a line
# each: "class NAME", and "claims NAME" for those that make claims themselves.
class_templates() {
  awk '
    function within_a_class(  d, namespaces) {
      for (d in spaces) if (d <= depth) ++namespaces
      return depth > namespaces
    }
    { line = $0; sub(/\/\/.*/, "", line) }
    match(line, /^[ \t]*(inline[ \t]+)?namespace[ \t]+[A-Za-z_0-9:]+/) {
      name = substr(line, RSTART, RLENGTH); sub(/.*namespace[ \t]+/, "", name)
      spaces[depth + 1] = name
    }
    line ~ /template[ \t]*</ {
      is_template = line ~ /template[ \t]*<[ \t]*(class|typename)[ \t]+[A-Za-z_0-9]+[ \t]*(=[^,>]*)?>/
      if (!is_template) candidate = ""
    }
    { rest = line; sub(/^[ \t]*template[ \t]*<[^<>]*>/, "", rest) }
    # Not a mere declaration; an alias is as good.
    is_template && !within_a_class() && (rest !~ /;[ \t]*$/ || rest ~ /[{=]/) &&
      match(rest, /^[ \t]*(class|struct|using)[ \t]+[A-Za-z_][A-Za-z0-9_]*/) {
      found = substr(rest, RSTART, RLENGTH); sub(/[ \t]*(class|struct|using)[ \t]+/, "", found)
      candidate = ""
      for (d = 1; d <= depth; ++d) if (d in spaces) candidate = candidate spaces[d] "::"
      candidate = candidate found
      is_template = 0
      print "class", candidate
    }
    line ~ /[^A-Za-z_]Claims[ \t]+claims/ && candidate != "" && !(candidate in printed) {
      printed[candidate] = 1; print "claims", candidate
    }
    {
      for (i = 1; i <= length(line); ++i) {
        c = substr(line, i, 1)
        if (c == "{") ++depth
        if (c == "}") delete spaces[depth--]
      }
    }' "$1"
}

# outside_name HEADER CLASS SEVERAL : what the queue is called, after its file, and its class where
# the file has several; never as one of the tree.
outside_name() {
  local name=${1##*/}
  name=${name%.*}
  [[ -n $3 ]] && name+=-${2##*::}
  name=$(sed -E 's/([a-z0-9])([A-Z])/\1-\2/g; s/([A-Z])([A-Z][a-z])/\1-\2/g; s/[^A-Za-z0-9]+/-/g; s/^[^A-Za-z]+//; s/-+$//' \
    <<<"$name" | tr '[:upper:]' '[:lower:]')
  [[ -n $name ]] || name=queue
  grep -qs "^irt_add_queue($name " "$here/queues/CMakeLists.txt" && name+=-outside
  echo "$name"
}

# The first error of a compiler's log, with what belongs to it. Where the contract is not kept: what
# of it.
first_error() {
  local log=$1 first
  if grep -q 'failed: this class template is no work queue' "$log"; then
    say '  what a queue must have, and this one has not or of another type (docs/add-a-queue.md):'
    sed -n -E "s/.*(the required expression|nested requirement) ‘(.*)’ is.*/    \2/p;
      s/.*note: ‘(.*)’ does not satisfy.*/    \1/p" "$log" | sort -u >&2
    return
  fi
  first=$(grep -n -m1 -E '(error|Error):|CMake Error' "$log" | cut -d: -f1)
  tail -n "+${first:-1}" "$log" | awk 'NR > 1 && /(error|warning):|^\[|^ninja:/ { exit } { print }' |
    head -n 12 >&2
}

# note_need OPTION VALUE : what a header needs beside itself, into includes, links, sources and flags
# of the caller, a line each. The option is one of --include, --link, --source and --flag; a flag may
# have commas, of the others they separate several.
note_need() {
  local value=$2
  if [[ -e $value && $1 != --flag ]]; then
    value=$(realpath -- "$value")
  elif [[ $1 != --flag ]]; then
    value=${value//,/$'\n'}
  fi
  case $1 in
    --include) includes+=$value$'\n' ;;
    --link) links+=$value$'\n' ;;
    --source) sources+=$value$'\n' ;;
    --flag) flags+=$value$'\n' ;;
  esac
}

# quoted_list LINES : "a" "b", for CMake.
quoted_list() {
  local element
  while read -r element; do
    [[ -z $element ]] || printf ' "%s"' "$(sed 's/[\\"]/\\&/g' <<<"$element")"
  done <<<"$1"
}

# Builds what plug-ins are compiled against and installs it beside the build.
install_development() {
  build_target release irt-development "${packages_tools[@]}"
  development=$here/build/development
  cmake --install "$here/build/release" --component plugin --prefix "$development" \
    >"$logs/install-development.log"
}

# modules_of TOOL : what of a queue it opens, by the ends of the files (queues/modules.hpp); fails
# where it takes no queue.
modules_of() {
  case $1 in
    check) echo virtual.so ;;
    simulate) echo so virtual.so ;;
    'bench contention') echo so contention.so counted.so ;;
    'bench counted') echo so counted.so ;;
    'bench micro') echo so micro.so ;;
    watch) echo so contention.so virtual.so ;;
    compare | render | list | collide | overhead | stress | 'bench instructions') echo so ;;
    *) return 1 ;;
  esac
}

# build_outside PRESET TOOL HEADER[:CLASS] INCLUDES LINKS SOURCES FLAGS : builds of the
# plug-in what the tool opens; sets outside_plugin and outside_queue.
build_outside() {
  local preset=$1 tool=$2 given=$3 includes=$4 links=$5 sources=$6 flags=$7
  [[ $given =~ $outside_pattern ]]
  local header=${BASH_REMATCH[1]} class=${BASH_REMATCH[3]#:}
  [[ -f $header ]] || usage_error "--queue $given: there is no file $header"
  header=$(realpath -- "$header")
  local -a all classes
  local known found
  mapfile -t all < <(class_templates "$header" | sed -n 's/^class //p')
  mapfile -t classes < <(class_templates "$header" | sed -n 's/^claims //p')
  if [[ -z $class ]]; then
    ((${#classes[@]} > 0)) || usage_error "--queue $given: no class template of one type in it has \`claims\`; docs/add-a-queue.md says what a queue must have, 'irt new' writes one, and $given:CLASS names one that inherits its claims"
    ((${#classes[@]} == 1)) || usage_error "--queue $given: it has several queues; say which:$(printf " $given:%s" "${classes[@]}")"
    class=${classes[0]}
  else
    for known in "${all[@]}"; do  # without its namespaces it is found, too
      if [[ $known == "$class" || $known == *"::$class" ]]; then found=$known; fi
    done
    [[ ${found:-} ]] || usage_error "--queue $given: no class template $class of one type in it; there are${all[*]:+ ${all[*]}}"
    class=$found
  fi
  outside_queue=$(outside_name "$header" "$class" "$([[ ${#all[@]} == 1 || ${classes[*]} == "$class" ]] || echo several)")
  local key folder all_flags
  key=$(printf '%s\n' "$preset" "$header" "$class" "$includes" "$links" "$sources" "$flags" | cksum | cut -d' ' -f1)
  folder=$here/build/outside/$outside_queue-$key
  outside_plugin=$folder/build/$outside_queue.so
  all_flags=$(sed -n 's/^CMAKE_CXX_FLAGS:[A-Z]*=//p' "$here/build/$preset/CMakeCache.txt")
  mkdir -p -- "$folder"
  exec {outside_lock}>"$folder/lock"
  flock "$outside_lock"
  local project
  project=$(
    cat <<P
cmake_minimum_required(VERSION 3.25)
project(outside LANGUAGES C CXX)
find_package(irt REQUIRED)
add_library(outside INTERFACE)
target_include_directories(outside INTERFACE "$(dirname -- "$header")"$(quoted_list "$includes"))
target_link_libraries(outside INTERFACE$(quoted_list "$links"))
target_compile_options(outside INTERFACE$(quoted_list "$flags"))
irt_add_plugin($outside_queue "$header" $class LINK outside SOURCES$(quoted_list "$sources"))
P
  )
  local log=$logs/outside-$outside_queue.log
  if [[ ! -f $folder/build/build.ninja || $project != "$(cat "$folder/CMakeLists.txt" 2>/dev/null)" ]]; then
    printf '%s\n' "$project" >"$folder/CMakeLists.txt"
    if ! run_step "Configuring $outside_queue" "$log" cmake -G Ninja -S "$folder" -B "$folder/build" \
      -D CMAKE_BUILD_TYPE=Release -D CMAKE_CXX_FLAGS="$all_flags" -D CMAKE_C_FLAGS="$all_flags" \
      -D CMAKE_PREFIX_PATH="$development"; then
      say "irt: --queue $given cannot be configured"
      first_error "$log"
      say "irt: the whole log is in $log"
      exit 2
    fi
  fi
  local -a modules=()
  local end
  for end in $(modules_of "$tool"); do
    # Without virtual cores, or under a sanitizer, there is less.
    ninja -C "$folder/build" -t query "$outside_queue.$end" &>/dev/null &&
      modules+=("$outside_queue.$end")
  done
  if ! run_step "Building $outside_queue" "$log" ninja -C "$folder/build" -j "$(build_jobs)" \
    "${modules[@]}"; then
    say "irt: --queue $given does not compile as a queue:"
    first_error "$log"
    say "irt: the whole log is in $log"
    exit 2
  fi
  exec {outside_lock}>&-
}

# has_outside_queue ARGUMENTS... : whether a header is among the queues.
has_outside_queue() {
  local argument previous='' element
  for argument; do
    [[ $argument == --queue*=* ]] && previous=--queue
    case $previous in
      -q | --queue | --queues)
        while read -r -d, element; do
          [[ $element =~ $outside_pattern ]] && return 0
        done <<<"${argument#--queue*=},"
        ;;
    esac
    previous=$argument
  done
  return 1
}

# replace_outside_queues PRESET TOOL ARGUMENTS... : builds the headers among the queues; leaves the
# arguments in `replaced`, with plug-ins in their place.
replace_outside_queues() {
  local preset=$1 tool=$2 argument
  shift 2
  replaced=("$@")
  has_outside_queue "$@" || return 0
  local includes='' links='' sources='' flags='' queues='' previous='' option value element
  local given_options=''
  local -a rest=() plugins=() lists=()
  while (($#)); do
    option=${1%%=*} value=''
    case $option in
      --include | --link | --source | --flag | -q | --queue | --queues)
        if [[ $1 == *=* ]]; then value=${1#*=}; else value=${2:-} && shift; fi
        shift
        ;;
    esac
    case $option in
      --include | --link | --source | --flag)
        note_need "$option" "$value"
        given_options+=" $option=$(printf %q "$value")"
        ;;
      -q | --queue | --queues) lists+=("$value") rest+=("$option" "$((${#lists[@]} - 1))@") ;;
      *) rest+=("$1") && shift ;;
    esac
  done
  install_development
  local i given=''
  for i in "${!lists[@]}"; do
    queues=''
    while read -r -d, element; do
      if [[ $element =~ $outside_pattern ]]; then
        build_outside "$preset" "$tool" "$element" "$includes" "$links" "$sources" "$flags"
        plugins+=(--plugin "$outside_plugin")
        given+="$outside_queue --queue $(printf %q "$element")$given_options"$'\n'
        element=$outside_queue
      fi
      queues+=,$element
    done <<<"${lists[i]},"
    lists[i]=${queues#,}
  done
  replaced=()
  for argument in "${rest[@]}"; do
    if [[ $previous == -q || $previous == --queue* ]] && [[ $argument == *@ ]]; then argument=${lists[${argument%@}]}; fi
    replaced+=("$argument")
    previous=$argument
  done
  replaced+=("${plugins[@]}")
  export IRT_QUEUES_GIVEN=$given  # for commands that tools tell: stress/running/queue_options.hpp
}
