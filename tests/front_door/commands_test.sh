#!/usr/bin/env bash
# Commands, options and what reaches the tool behind them.
source "$(dirname -- "$0")/sandbox.sh"

help_names_every_command() {
  local command
  for command in help --help -h; do
    irt "$command"
    expect_code 0
    local known
    for known in compare render list doctor bench new watch test lint help; do
      grep -qE "^  $known " "$work/out" || fail "$command does not name $known"
    done
  done
  irt help test
  expect_code 0
  expect_in out --sanitizer
}

unknown_command_names_the_nearest() {
  irt rendr --scene x
  expect_code 2
  expect_in err "'rendr' is not a command; the nearest is 'render'"
  irt tset
  expect_code 2
  expect_in err "the nearest is 'test'"
  irt bench tarcer
  expect_code 2
  expect_in err "the nearest is 'bench tracer'"
  irt bench
  expect_code 2
  expect_in err "as 'irt bench tracer'"
  irt help dcotor
  expect_code 2
  expect_in err "the nearest is 'doctor'"
  [[ ! -e $project/build ]] || fail "something was built"
}

unknown_option_of_test_is_refused() {
  irt test --fast
  expect_code 2
  expect_in err --fast
  irt test --sanitizer msan
  expect_code 2
  expect_in err 'known are asan and tsan'
  irt lint spelling
  expect_code 2
  expect_in err 'known are format and tidy'
}

arguments_and_directory_reach_the_tool() {
  mkdir "$work/else where"
  cd "$work/else where" || exit 1
  irt render 'two words' '' '*' --out 'a"b' "it's"
  expect_code 0
  printf '%s\n' "in <$work/else where>" '<render>' '<two words>' '<>' '<*>' '<--out>' '<a"b>' \
    "<it's>" >"$work/expected"
  diff "$work/expected" "$work/out" || fail "arguments changed"
  [[ -z $(ls -A) ]] || fail "something was left in the caller's directory"

  ln -s "$project/irt" "$work/linked"
  "$work/linked" list >"$work/out" 2>"$work/err" || fail "not to be called through a link"
  expect_in out '<list>'
}

options_without_a_command_compare() {
  irt
  expect_in out '<compare>'
  irt --out 'my results'
  expect_code 0
  tail -n 3 "$work/out" | diff - <(printf '<%s>\n' compare --out 'my results') || fail "not passed on"
}

changed_source_is_rebuilt() {
  irt list
  expect_not_in out changed
  sed -i 's/in </changed </' "$project/bench/main.cpp"
  irt list
  expect_in out changed
}

queues_are_built_when_asked_for() {
  local module="$project/build/release/queues/modules/lock.so"
  cat >>"$project/CMakeLists.txt" <<'P'
add_library(lock MODULE EXCLUDE_FROM_ALL lock.cpp)
set_target_properties(lock PROPERTIES PREFIX ""
  LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/queues/modules)
P
  echo 'extern int lock;' >"$project/lock.cpp"
  sed -i 's/^  char here/  std::printf("front door <%s>\\n", getenv("IRT_FRONT_DOOR"));\n&/; 1i #include <cstdlib>' \
    "$project/bench/main.cpp"
  irt list
  expect_code 0
  expect_in out " release $project/irt>"
  [[ ! -e $module ]] || fail "nobody asked for it"
  irt modules release "$module"
  expect_code 0
  [[ -f $module ]] || fail "it was not built"
  echo 'error here' >>"$project/lock.cpp"
  irt modules release "$module"
  expect_code 1
  expect_in err 'lock.cpp:2:1: error'
}

new_starts_a_queue_and_overwrites_nothing() {
  cp -r "$top/queues" "$project/queues"
  cd "$work" || exit 1
  irt new my-queue 'my folder'
  expect_code 0
  [[ -f 'my folder/my_queue.hpp' && -f 'my folder/CMakeLists.txt' ]] || fail "files are missing"
  expect_in out "--plugin $work/my\\ folder/build/my-queue.so --queue my-queue"
  irt new my-queue 'my folder'
  expect_code 2
  expect_in err "'my folder' is there already"
  irt new MyQueue
  expect_code 2
  expect_in err "'MyQueue' is not a name"
  irt new
  expect_code 2
}

watch_wants_one_header() {
  irt watch
  expect_code 2
  expect_in err 'is not the header of a queue'
  irt watch lfree
  expect_code 2
  expect_in err "'lfree' is not the header of a queue"
  irt watch a.hpp b.hpp
  expect_code 2
  expect_in err 'one header at a time'
  irt watch no/such.hpp
  expect_code 2
  expect_in err 'there is no file no/such.hpp'
  irt help watch
  expect_code 0
  [[ ! -e $project/build ]] || fail "something was built"
}

# write_queue FILE CLASS... : a header with these class templates.
write_queue() {
  local file=$1 class
  shift
  mkdir -p -- "$(dirname -- "$file")"
  {
    echo 'struct Claims {};'
    echo 'namespace mine {'
    for class; do
      printf 'template <class T>\nclass %s {\n  static constexpr Claims claims{};\n};\n' "$class"
    done
    echo '}  // namespace mine'
  } >"$file"
}

# A source among the arguments of check is a program; what belongs to it is for the compiler, and what
# follows -- its own.
program_is_told_from_options() {
  local room
  room=$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")/../../bench/front_door
  source "$room/outside.sh"
  source "$room/programs.sh"
  install_development() { :; }
  build_program() {
    built=("$@")
    program_module=/build/program.so
  }
  cd "$work" || exit 1
  touch main.cpp more.c
  replace_program release --seconds 3 main.cpp more.c --include . --flag=-DX --json out.json -- 4 a.cpp
  diff <(printf '<%s>\n' "${replaced[@]}") \
    <(printf '<%s>\n' --seconds 3 --json out.json --program main.cpp --module /build/program.so -- 4 a.cpp) ||
    fail 'passed on otherwise'
  diff <(printf '<%s>\n' "${built[@]}") \
    <(printf '<%s>\n' release main.cpp "$work"$'\n' '' "$work/main.cpp"$'\n'"$work/more.c"$'\n' \
      -DX$'\n') ||
    fail 'built otherwise'
  [[ $IRT_PROGRAM_GIVEN == 'main.cpp more.c --include=. --flag=-DX' ]] ||
    fail "told as $IRT_PROGRAM_GIVEN"
  replace_program release --queue lfree
  [[ "${replaced[*]}" == '--queue lfree' ]] || fail 'a queue became a program'
}

outside_queue_is_built_and_passed_on() {
  cd "$work" || exit 1
  write_queue 'my queues/spin_ring.hpp' SpinRing
  irt render --queue "lfree,my queues/spin_ring.hpp" --frames 3
  expect_code 0
  local plugin
  plugin=$(sed -n 's/^<\(.*spin-ring.so\)>$/\1/p' "$work/out")
  [[ -f $plugin ]] || fail "there is no plug-in"
  tail -n 7 "$work/out" |
    diff - <(printf '<%s>\n' render --queue lfree,spin-ring --frames 3 --plugin "$plugin") ||
    fail "passed on otherwise"

  # What only looks like a header is left alone.
  irt render --out results.hpp
  expect_code 0
  expect_not_in out --plugin
  irt render -q 'my queues/spin_ring.hpp:mine::SpinRing'
  expect_code 0
  expect_in out '<spin-ring>'

  # What was saved is compiled again.
  echo 'error here' >>'my queues/spin_ring.hpp'
  irt render --queue='my queues/spin_ring.hpp'
  expect_code 2
  expect_in err 'spin_ring.hpp:8:1: error'
  expect_not_in out '<render>'
  irt render --queue 'no/such.hpp'
  expect_code 2
  expect_in err 'there is no file no/such.hpp'
}

outside_queue_brings_what_it_needs() {
  cd "$work" || exit 1
  write_queue needy.hpp Needy
  sed -i '1i #include "helper.h"' needy.hpp
  irt render --queue needy.hpp
  expect_code 2
  expect_in err 'helper.h'
  mkdir 'with space'
  echo 'extern "C" int help();' >'with space/helper.h'
  echo 'int help() { return 1; }' >'with space/helper.c'
  irt render --include 'with space' --source 'with space/helper.c' --queue needy.hpp
  expect_code 0
  expect_in out '<needy>'
  expect_not_in out '<--include>'
  nm -D "$(sed -n 's/^<\(.*needy.so\)>$/\1/p' "$work/out")" | grep -q ' T help' ||
    fail "the source is not in the plug-in"

  write_queue flagged.hpp Flagged
  printf '#if !defined(FIRST) || FIRST(1, 0) != 1\n#error no flag\n#endif\n' >>flagged.hpp
  irt render --queue flagged.hpp
  expect_code 2
  irt render --flag='-DFIRST(a,b)=a' --queue flagged.hpp
  expect_code 0
}

outside_queue_may_be_a_line_or_an_alias() {
  cd "$work" || exit 1
  printf 'struct Claims {};\ntemplate <class T> class Declared;\n%s\n%s\n%s\n%s\n' \
    'template <class T> class Line {' '  template <class U> struct Member {};' \
    '  static constexpr Claims claims{}; };' \
    'template <class T> using Alias = Line<T>;' >line.hpp
  irt render --queue line.hpp
  expect_code 0
  expect_in out '<line>'
  irt render --queue line.hpp:Missing
  expect_code 2
  expect_in err 'there are Line Alias'
}

outside_queue_of_several_is_named() {
  cd "$work" || exit 1
  write_queue two.hpp First Second
  irt render --queue two.hpp
  expect_code 2
  expect_in err 'two.hpp:mine::First two.hpp:mine::Second'
  irt render --queue two.hpp:Second
  expect_code 0
  expect_in out '<two-second>'
  irt render --queue two.hpp:Third
  expect_code 2
  expect_in err 'no class template Third'
  irt doctor --queue two.hpp:Second
  expect_code 2
  expect_in err 'doctor: takes no queue'
}

second_start_configures_nothing() {
  irt list
  [[ -f $project/build/logs/configure-release.log ]] || fail "the first start did not configure"
  rm -f "$project/build/logs/configure-release.log"
  irt list
  expect_code 0
  [[ ! -e $project/build/logs/configure-release.log ]] || fail "the second start configured"
  [[ ! -s $work/err ]] || fail "the second start talked"
  touch "$project/moved"
  mv "$project" "$work/new place"
  project="$work/new place"
  irt list
  expect_code 0
  expect_in out '<list>'
}

run_case "$@"
