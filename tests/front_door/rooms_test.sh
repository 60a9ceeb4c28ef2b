#!/usr/bin/env bash
# Arrows between rooms run downwards only.
source "$(dirname -- "$0")/sandbox.sh"

check() {
  code=0
  bash "$top/tests/front_door/rooms.sh" "$1" >"$work/out" 2>"$work/err" || code=$?
}

rooms_include_downwards() {
  check "$top"
  expect_code 0
}

upward_include_is_found() {
  mkdir -p "$work/tree/queues/blocking" "$work/tree/bench"
  echo '#include "queues/work_queue.hpp"' >"$work/tree/queues/blocking/good.hpp"
  echo '#include "queues/registry.hpp"' >"$work/tree/bench/good.cpp"
  check "$work/tree"
  expect_code 0
  echo '#include "renderer/tracing/rays.hpp"' >"$work/tree/queues/blocking/bad.hpp"
  check "$work/tree"
  expect_code 1
  expect_in out 'queues/blocking/bad.hpp:1: queues/ may not include "renderer/tracing/rays.hpp"'
}

foreign_room_is_found() {
  mkdir -p "$work/tree/renderer" "$work/tree/stress"
  echo '#include "queues/work_queue.hpp"' >"$work/tree/renderer/good.hpp"
  check "$work/tree"
  expect_code 0
  echo '#include "queues/registry.hpp"' >"$work/tree/renderer/bad.hpp"
  echo '#include "renderer/scene/scene.hpp"' >"$work/tree/stress/bad.cpp"
  check "$work/tree"
  expect_code 1
  [[ $(wc -l <"$work/out") -eq 2 ]] || fail "not both found"
}

upward_include_within_a_room_is_found() {
  local many_core=$work/tree/bench/many_core
  mkdir -p "$many_core/coherence" "$many_core/machine"
  echo '#include "bench/many_core/coherence/directory.hpp"' >"$many_core/machine/good.hpp"
  echo '#include "bench/results/record.hpp"' >"$many_core/coherence/good.hpp"
  echo '#include "bench/many_core/machine/machine.hpp"' >"$many_core/main.cpp"
  check "$work/tree"
  expect_code 0
  echo '#include "bench/many_core/machine/thread.hpp"' >"$many_core/coherence/bad.hpp"
  check "$work/tree"
  expect_code 1
  expect_in out 'bench/many_core/coherence/ may not include "bench/many_core/machine/thread.hpp"'
}

files_beside_the_rooms_are_below_them() {
  mkdir -p "$work/tree/renderer/scene" "$work/tree/renderer/bvh"
  echo '#include "renderer/spin_wait.hpp"' >"$work/tree/renderer/scene/good.hpp"
  echo '#include "renderer/scene/scene.hpp"' >"$work/tree/renderer/bvh/good.hpp"
  check "$work/tree"
  expect_code 0
  echo '#include "renderer/bvh/wald.hpp"' >"$work/tree/renderer/scene/bad.hpp"
  check "$work/tree"
  expect_code 1
  expect_in out 'renderer/scene/ may not include "renderer/bvh/wald.hpp"'
}

room_that_is_not_drawn_is_found() {
  mkdir -p "$work/tree/renderer/attic"
  check "$work/tree"
  expect_code 0
  touch "$work/tree/renderer/attic/box.hpp"
  check "$work/tree"
  expect_code 1
  expect_in out 'renderer/attic is missing in docs/architecture.md'
}

run_case "$@"
