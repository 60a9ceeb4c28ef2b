#!/usr/bin/env bash
# What is shown while something runs, and what happens when it fails or is interrupted.
source "$(dirname -- "$0")/sandbox.sh"

# A build of four steps that take a second each.
slow_ninja() {
  irt list # CMake itself asks ninja this and that
  expect_code 0
  fake ninja <<'P'
#!/bin/bash
for i in 1 2 3 4; do
  sleep 1
  echo "[$i/4] step $i"
done
P
}

reads_ninja_ctest_and_apt() {
  source "$project/bench/front_door/progress.sh"
  local -a lines=('[3/12] Building CXX object' ' 7/90 Test  #7: a.b ...   Passed    0.01 sec'
    'dlstatus:4:50.1234:Retrieving file' 'pmstatus:libpng-dev:25.0000:Unpacking'
    'a line that says 3/4 of nothing')
  local -a expected=(3/12 7/90 50/200 125/200 125/200)
  local i
  for i in "${!lines[@]}"; do
    note_progress "${lines[i]}"
    [[ $step_done/$step_total == "${expected[i]}" ]] || fail "${lines[i]}: $step_done/$step_total"
  done
}

terminal_gets_a_bar() {
  slow_ninja
  PATH=$machine:$PATH script -qefc "'$project/irt' list" /dev/null </dev/null >"$work/out" 2>&1
  grep -qE 'Building irt-frames \[#######+ +\] [2-4] s' "$work/out" || fail "no bar that grows"
  grep -qE 'Building irt-frames: done in [4-9] s' "$work/out" || fail "no closing line"
}

log_gets_plain_lines() {
  slow_ninja
  sed -i 's/sleep 1/sleep 3/' "$machine/ninja"
  irt list
  grep -qE 'Building irt-frames: [0-9]+ %, 1[01] s, about [0-9]+ s left' "$work/err" ||
    fail "no line after ten seconds"
  ! grep -q $'[\r\e]' "$work/err" || fail "control characters outside a terminal"
}

failure_shows_the_error_and_the_log() {
  echo 'int main() { return missing_name; }' >"$project/bench/main.cpp"
  irt list
  expect_code 1
  expect_in err missing_name
  expect_in err "the whole log is in $project/build/logs/build-release-irt-frames.log"
  grep -q missing_name "$project/build/logs/build-release-irt-frames.log" || fail "not in the log"

  echo 'no_such_function()' >>"$project/CMakeLists.txt"
  rm "$project/build/release/irt-stamp"
  irt list
  expect_code 1
  expect_in err no_such_function
}

interrupt_stops_the_children() {
  irt list
  expect_code 0
  fake ninja <<P
#!/bin/bash
sleep 300 &
echo \$! >'$work/child'
wait
P
  local signal expected
  for signal in INT:130 TERM:143; do
    expected=${signal#*:}
    rm -f "$work/child"
    set -m # else a background job ignores SIGINT
    PATH=$machine:$PATH "$project/irt" list >"$work/out" 2>"$work/err" </dev/null &
    local door=$!
    set +m
    local patience=200
    until [[ -s $work/child ]] || ((patience-- == 0)); do sleep 0.1; done
    kill "-${signal%:*}" "$door"
    code=0
    wait "$door" || code=$?
    expect_code "$expected"
    patience=50
    while kill -0 "$(cat "$work/child")" 2>/dev/null; do
      ((patience-- > 0)) || fail "the compiler outlived the front door"
      sleep 0.1
    done
  done
}

run_case "$@"
