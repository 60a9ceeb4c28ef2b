# A copy of the front door before a project of one source file, in a directory whose name has a
# space, on a machine whose dpkg-query, apt-get and sudo are made up. Sourced by the test scripts,
# which end with `run_case "$@"`.

set -u
top=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.." && pwd)

fail() {
  printf 'FAILED: %s\n' "$*" >&2
  printf -- '--- %s\n' "$work"/out "$work"/err >&2
  cat -- "$work"/out "$work"/err >&2
  exit 1
}

expect_code() { [[ $code -eq $1 ]] || fail "exit code $code, expected $1"; }
expect_in() { grep -qF -- "$2" "$work/$1" || fail "'$2' is not in std$1"; }
expect_not_in() { ! grep -qF -- "$2" "$work/$1" || fail "'$2' is in std$1"; }

# A program of the made-up machine, its text on stdin.
fake() {
  cat - >"$machine/$1"
  chmod 755 "$machine/$1"
}

make_sandbox() {
  work=$(mktemp -d)
  trap 'rm -rf -- "$work"' EXIT
  project="$work/a project"
  machine="$work/machine"
  mkdir -p "$project/bench" "$machine"
  touch "$work/out" "$work/err" "$work/apt-calls" "$work/missing"
  cp -r "$top/irt" "$top/CMakePresets.json" "$project/"
  cp -r "$top/bench/front_door" "$project/bench/"
  cat >"$project/CMakeLists.txt" <<'P'
cmake_minimum_required(VERSION 3.25)
project(sandbox LANGUAGES CXX)
add_subdirectory(bench)
add_custom_target(irt-development)
install(FILES irt-config.cmake DESTINATION share/cmake/irt COMPONENT plugin)
P
  # A plug-in of it is whatever compiles.
  cat >"$project/irt-config.cmake" <<'P'
function(irt_add_plugin name header class)
  cmake_parse_arguments(PARSE_ARGV 3 ARG "" "" "LINK;SOURCES")
  set(source ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp)
  file(WRITE ${source} "#include \"${header}\"\ntemplate class ${class}<int>;\n")
  add_library(${name} MODULE ${source} ${ARG_SOURCES})
  set_target_properties(${name} PROPERTIES PREFIX "")
  target_link_libraries(${name} PRIVATE ${ARG_LINK})
endfunction()
P
  cat >"$project/bench/CMakeLists.txt" <<'P'
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/frames)
add_executable(irt-frames main.cpp)
P
  cat >"$project/bench/main.cpp" <<'P'
#include <unistd.h>
#include <cstdio>
int main(int argc, char** argv) {
  char here[4096];
  std::printf("in <%s>\n", getcwd(here, sizeof here));
  for (int i = 1; i < argc; ++i) std::printf("<%s>\n", argv[i]);
}
P
  # Everything is installed but what the file `missing` names; an installation empties it.
  fake dpkg-query <<P
#!/bin/bash
for package in "\${@:4}"; do
  grep -qxF -- "\$package" '$work/missing' || echo "ii  \$package 1.0"
done
P
  fake apt-cache <<'P'
#!/bin/bash
for package in "${@:4}"; do echo "Package: $package"; done
P
  fake apt-get <<P
#!/bin/bash
echo "\$*" >>'$work/apt-calls'
[[ " \$* " != *' install '* ]] || : >'$work/missing'
P
  fake sudo <<'P'
#!/bin/bash
[[ $1 == -n ]] && shift
exec "$@"
P
  chmod -R a+rwX "$work"
}

# Runs the sandbox's front door; what it says lands in the files out and err, its exit code in code.
irt() {
  code=0
  PATH=$machine:$PATH "$project/irt" "$@" >"$work/out" 2>"$work/err" </dev/null || code=$?
}

run_case() {
  make_sandbox
  "$1"
}
