#!/usr/bin/env bash
# Packages: what is installed, when, and what is said about it.
source "$(dirname -- "$0")/sandbox.sh"

complete_machine_installs_nothing() {
  irt list
  expect_code 0
  [[ ! -s $work/apt-calls ]] || fail "apt-get was called: $(cat "$work/apt-calls")"
}

says_what_it_installs_and_why() {
  printf '%s\n' libpng-dev libhwloc-dev >"$work/missing"
  irt list
  expect_code 0
  expect_in out '<list>'
  grep -qE '^  libpng-dev +writes the frames' "$work/err" || fail "no purpose of libpng-dev"
  expect_in err libhwloc-dev
  expect_not_in err cmake
  [[ $(wc -l <"$work/apt-calls") -eq 1 ]] || fail "more than one call of apt-get"
  grep -q 'install --no-install-recommends libhwloc-dev libpng-dev$' "$work/apt-calls" ||
    fail "asked for $(cat "$work/apt-calls")"
}

without_rights_it_says_what_to_do() {
  echo libpng-dev >"$work/missing"
  fake sudo <<<$'#!/bin/bash\nexit 1'
  local command=("$project/irt" list)
  if ((EUID == 0)); then
    command=(setpriv --reuid=65534 --regid=65534 --clear-groups "${command[@]}")
  fi
  code=0
  PATH=$machine:$PATH "${command[@]}" >"$work/out" 2>"$work/err" </dev/null || code=$?
  expect_code 1
  expect_in err 'apt-get install --no-install-recommends libpng-dev'
  [[ ! -s $work/apt-calls ]] || fail "apt-get was called without rights"
}

old_package_lists_are_renewed() {
  echo libpng-dev >"$work/missing"
  fake apt-get <<P
#!/bin/bash
echo "\$*" >>'$work/apt-calls'
case " \$* " in
  *' update '*) touch '$work/renewed' ;;
  *) [[ -e '$work/renewed' ]] && : >'$work/missing' || { echo 'E: 404 Not Found'; exit 100; } ;;
esac
P
  irt list
  expect_code 0
  [[ $(wc -l <"$work/apt-calls") -eq 3 ]] || fail "not install, update, install"

  echo libpng-dev >"$work/missing"
  fake apt-get <<<$'#!/bin/bash\necho "E: no such thing"; exit 100'
  irt list
  expect_code 1
  expect_in err 'E: no such thing'
  expect_in err install.log
}

other_system_without_the_tools() {
  # A PATH of just what the front door itself calls.
  local tool
  rm "$machine"/*
  for tool in bash dirname readlink flock mkdir cat cksum; do
    ln -s "$(command -v "$tool")" "$machine/$tool"
  done
  code=0
  PATH=$machine bash "$project/irt" list >"$work/out" 2>"$work/err" </dev/null || code=$?
  expect_code 1
  expect_in err 'g++ is not installed'
  expect_in err libtinyobjloader-dev
}

run_case "$@"
