#!/usr/bin/env bash
# irt::explore() in a test framework that is headers only, and that is explored along with the test:
# framework_test.sh BUILD COMPILER WORK doctest|catch2|boost
set -euo pipefail
build=$1 compiler=$2 work=$3 framework=$4
here=$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")

fail() {
  echo "$1"
  exit 1
}

declare -A header=([doctest]=doctest/doctest.h [catch2]=catch2/catch.hpp
  [boost]=boost/test/included/unit_test.hpp)
if ! echo "#include <${header[$framework]}>" | "$compiler" -x c++ -fsyntax-only - 2>/dev/null; then
  echo "skipped: no $framework here"
  exit 77
fi

rm -rf "$work"
mkdir -p "$work/project"
cp "$here"/frameworks/* "$work/project"
cmake --install "$build" --component plugin --prefix "$work/irt" >"$work/install.log"
cmake -G Ninja -S "$work/project" -B "$work/build" -D CMAKE_CXX_COMPILER="$compiler" \
  -D CMAKE_PREFIX_PATH="$work/irt" -D FRAMEWORK="$framework" >"$work/configure.log"
ninja -C "$work/build" >"$work/build.log" || fail "$(tail "$work/build.log")"

told=$work/assertions.log
run() { # run FRAMEWORK'S-OPTION...
  "$work/irt"/lib*/irt/irt-check --tests "$work/build/assertions.so" -- "$@" >"$told" 2>&1
}
declare -A only=([doctest]=--test-case= [catch2]='' [boost]=--run_test=)
run "${only[$framework]}right*" || fail "right tests do not pass: $(cat "$told")"
run && fail 'wrong tests pass'
for wrong in 'where it must hold' 'and goes on' 'again where another one has failed'; do
  name="wrong $wrong"
  [[ $framework != boost ]] || name=${name// /_}
  run "${only[$framework]}$name" && fail "wrong $wrong: passes"
  grep -Eq 'an assertion of the test has failed|an exception left a thread: .*(TestFailureException|execution_aborted)' \
    "$told" || fail "wrong $wrong: something else is told: $(cat "$told")"
  grep -q 'Numbers are lines of additions.hpp' "$told" || fail "lines of others: $(cat "$told")"
done
