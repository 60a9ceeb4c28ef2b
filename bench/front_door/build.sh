# Configures and builds, each preset of CMakePresets.json in a directory of its own.

# As many compilers as there are processors, and no more than memory holds at 1.5 GB each.
build_jobs() {
  local processors kilobytes
  processors=$(nproc)
  kilobytes=$(awk '/^MemAvailable:/ { print $2 }' /proc/meminfo)
  local fitting=$((kilobytes / 1500000))
  local jobs=$((processors < fitting ? processors : fitting))
  echo $((jobs > 1 ? jobs : 1))
}

# What a configuration rests on beside the CMake files, which ninja watches itself.
configuration_stamp() {
  printf '%s\n' "$here"
  cksum "$here/CMakePresets.json"
  dpkg-query -W -f '${Package} ${Version}\n' "${!package_purpose[@]}" 2>/dev/null
}

# Configures a preset where its stamp says that something changed.
configure() {
  local preset=$1 build=$here/build/$1 log=$logs/configure-$1.log stamp
  stamp=$(configuration_stamp)
  if [[ -f $build/build.ninja && $(cat "$build/irt-stamp" 2>/dev/null) == "$stamp" ]]; then
    return 0
  fi
  if ! run_step 'Configuring' "$log" cmake -S "$here" --preset "$preset" --fresh; then
    say "irt: the build could not be configured"
    show_failure "$log"
    exit 1
  fi
  printf '%s\n' "$stamp" >"$build/irt-stamp"
}

ninja_options=()

# build_modules PRESET FILE... : brings modules of the tree's queues up to date, for a tool that was
# just built.
build_modules() {
  (($# > 1)) || usage_error "modules: takes a preset and files; tools call it"
  local preset=$1 log=$logs/build-$1-modules.log
  shift
  exec {build_lock}>"$here/build/lock-$preset"
  flock "$build_lock"
  if ! NINJA_STATUS='[%f/%t] ' run_step 'Building queues' "$log" \
    ninja -C "$here/build/$preset" -j "$(build_jobs)" "${@#"$here/build/$preset/"}"; then
    say "irt: a queue could not be built"
    show_failure "$log"
    exit 1
  fi
}

# prepare_build PRESET PACKAGES... : from whatever state to a configured build, which this irt alone
# uses until it closes build_lock.
prepare_build() {
  local preset=$1
  shift
  mkdir -p -- "$logs"
  exec {build_lock}>"$here/build/lock-$preset"
  if ! flock -n "$build_lock"; then
    say "irt: waiting for another irt that builds here"
    flock "$build_lock"
  fi
  ensure_packages "$@"
  configure "$preset"
}

# build_target PRESET "TARGET..." PACKAGES... : from whatever state to up-to-date targets.
build_target() {
  local preset=$1 target=$2
  shift 2
  prepare_build "$preset" "$@"
  local log=$logs/build-$preset-${target// /-}.log
  if ! NINJA_STATUS='[%f/%t] ' run_step "Building ${target%% *}" "$log" \
    ninja -C "$here/build/$preset" -j "$(build_jobs)" "${ninja_options[@]}" $target; then
    say "irt: $target could not be built"
    show_failure "$log"
    exit 1
  fi
  exec {build_lock}>&-
}
