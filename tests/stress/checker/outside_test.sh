#!/usr/bin/env bash
# irt_add_check() and irt::explore() from outside of the tree: outside_test.sh BUILD COMPILER WORK
set -euo pipefail
build=$1 compiler=$2 work=$3
here=$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")

fail() {
  echo "$1"
  exit 1
}

rm -rf "$work"
mkdir -p "$work/project"
cp "$here"/outside/* "$here/../../../docs/programs/philosophers.cpp" "$work/project"
cmake --install "$build" --component plugin --prefix "$work/irt" >"$work/install.log"
cmake -G Ninja -S "$work/project" -B "$work/build" -D CMAKE_CXX_COMPILER="$compiler" \
  -D CMAKE_PREFIX_PATH="$work/irt" >"$work/configure.log"
ninja -C "$work/build" >"$work/build.log" || fail "$(tail "$work/build.log")"

run() { ctest --test-dir "$work/build" --output-on-failure -R "^$1\$" >"$work/$1.log" 2>&1; }
run philosophers || fail "the right program does not pass: $(cat "$work/philosophers.log")"
run hungry_philosophers && fail 'the wrong program passes'
grep -q 'deadlock: ' "$work/hungry_philosophers.log" || fail 'the deadlock is not told'
run lock_tests && fail 'the wrong tests pass'
told=$work/lock_tests.log
for right in Excludes FindsItsVariablesAsTheyWere; do
  grep -q "OK \] Right.$right" "$told" || fail "Right.$right does not pass: $(cat "$told")"
done
for wrong in UnlocksTooWeakly ExpectsWhatMayBeLater ExploresNothing; do
  grep -q "FAILED  \] Wrong.$wrong" "$told" || fail "Wrong.$wrong passes"
done
grep -q 'data race: ' "$told" || fail 'the race is not told'
grep -q 'Only machines with weaker orders than x86' "$told" || fail 'x86 is not spoken of'
grep -q 'an assertion of the test has failed' "$told" || fail 'the assertion is not seen'
grep -q 'there was nothing to explore' "$told" || fail 'nothing is not told from something'

run late_tests && fail 'assertions that nobody sees pass'
grep -q 'include GoogleTest before irt/explore.hpp' "$work/late_tests.log" ||
  fail "something else is told: $(cat "$work/late_tests.log")"

# What a report says to do shows the same again.
schedule=$(sed -n "s/.*IRT_REPLAY='\([^']*\)'.*/\1/p" "$told" | head -n 1)
IRT_REPLAY=$schedule "$work/irt"/lib*/irt/irt-check --tests "$work/build/lock_tests.so" -- \
  --gtest_filter=Wrong.UnlocksTooWeakly >"$work/replay.log" && fail 'the replay passes'
grep -q 'data race: ' "$work/replay.log" || fail "the replay finds something else: $(cat "$work/replay.log")"
