# Programs: `irt check test.cpp`. Each is a small CMake project below build/outside, as queues are
# that are headers (outside.sh).

program_pattern='\.(c|cc|cpp|cxx|C)$'

# replace_program PRESET ARGUMENTS... : builds the program that the sources among the arguments make;
# leaves the arguments in `replaced`, with its module in their place. What follows `--` is the
# program's own.
replace_program() {
  local preset=$1
  shift
  replaced=("$@")
  local includes='' links='' sources='' flags='' option value given='' first=''
  local -a rest=()
  while (($#)); do
    option=${1%%=*} value=''
    case $option in
      --) break ;;
      --include | --link | --source | --flag)
        if [[ $1 == *=* ]]; then value=${1#*=}; else value=${2:-} && shift; fi
        note_need "$option" "$value"
        given+=" $option=$(printf %q "$value")"
        ;;
      *)
        # A source; not the value of the option before.
        if [[ $1 =~ $program_pattern ]] && [[ ${rest[*]: -1} != --* || ${rest[*]: -1} == *=* ]]; then
          [[ -f $1 ]] || usage_error "check $1: there is no such file"
          note_need --source "$1"
          given+=" $(printf %q "$1")"
          first=${first:-$1}
        else
          rest+=("$1")
        fi
        ;;
    esac
    shift
  done
  [[ $first ]] || return 0
  install_development
  build_program "$preset" "$first" "$includes" "$links" "$sources" "$flags"
  replaced=("${rest[@]}" --program "${first##*/}" --module "$program_module" "$@")
  export IRT_PROGRAM_GIVEN=${given# }
}

# build_program PRESET NAME INCLUDES LINKS SOURCES FLAGS : sets program_module.
build_program() {
  local preset=$1 given=$2 includes=$3 links=$4 sources=$5 flags=$6
  local name key folder project all_flags log
  name=$(sed -E 's/[^A-Za-z0-9]+/-/g' <<<"${given##*/}")
  key=$(printf '%s\n' "$@" | cksum | cut -d' ' -f1)
  folder=$here/build/outside/$name-$key
  program_module=$folder/build/program.so
  all_flags=$(sed -n 's/^CMAKE_CXX_FLAGS:[A-Z]*=//p' "$here/build/$preset/CMakeCache.txt")
  mkdir -p -- "$folder"
  exec {outside_lock}>"$folder/lock"
  flock "$outside_lock"
  project=$(
    cat <<P
cmake_minimum_required(VERSION 3.25)
project(program LANGUAGES C CXX)
find_package(irt REQUIRED)
set(CMAKE_CXX_STANDARD 20)
add_library(needs INTERFACE)
target_include_directories(needs INTERFACE$(quoted_list "$includes"))
target_link_libraries(needs INTERFACE$(quoted_list "$links"))
target_compile_options(needs INTERFACE$(quoted_list "$flags"))
irt_virtual_module(program SOURCES$(quoted_list "$sources") LINK needs OPTIONS -O2)
add_custom_target(everything ALL DEPENDS program)
P
  )
  log=$logs/outside-$name.log
  if [[ ! -f $folder/build/build.ninja || $project != "$(cat "$folder/CMakeLists.txt" 2>/dev/null)" ]]; then
    printf '%s\n' "$project" >"$folder/CMakeLists.txt"
    if ! run_step "Configuring $name" "$log" cmake -G Ninja -S "$folder" -B "$folder/build" \
      -D CMAKE_CXX_FLAGS="$all_flags" -D CMAKE_C_FLAGS="$all_flags" \
      -D CMAKE_PREFIX_PATH="$development"; then
      say "irt: check $given cannot be configured"
      first_error "$log"
      say "irt: the whole log is in $log"
      exit 2
    fi
  fi
  if ! run_step "Building $name" "$log" ninja -C "$folder/build" -j "$(build_jobs)" everything; then
    say "irt: $given does not compile:"
    first_error "$log"
    say "irt: the whole log is in $log"
    exit 2
  fi
  exec {outside_lock}>&-
}
