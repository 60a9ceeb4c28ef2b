# Which Debian packages a command needs and why, and their installation.

# Plug-ins are of one version of GCC.
gcc_version=$(g++ -dumpversion 2>/dev/null)
gcc_plugin=gcc-${gcc_version%%.*}-plugin-dev
[[ -n $gcc_version ]] || gcc_plugin=gcc-12-plugin-dev

declare -A package_purpose=(
  [g++]='compiles the project'
  [cmake]='configures the build'
  [ninja-build]='runs the build'
  [libcli11-dev]='command lines of the tools'
  [libfmt-dev]='formatted output'
  [nlohmann-json3-dev]='results as JSON'
  [libhwloc-dev]='what the processor looks like; pinning of threads'
  [libtbb-dev]='oneTBB, whose queue is compared'
  [libboost-dev]='Boost.Lockfree, whose queue is compared'
  [libpng-dev]='writes the frames'
  [libtinyobjloader-dev]='reads OBJ scenes'
  [libhwy-dev]='SIMD that suits the processor it runs on'
  [libgtest-dev]='GoogleTest, for the tests'
  [doctest-dev]='doctest, in which irt::explore is tested'
  [catch2]='Catch2, in which irt::explore is tested'
  [libboost-context-dev]='fibers: the virtual cores of irt check and irt simulate'
  [$gcc_plugin]='irt check sees what GCC alone does not announce'
  [gnuplot-nox]='draws the plots of irt report --plots'
  [chromium]='a browser, in which the page of irt report is tested'
  [libembree-dev]='Embree, which irt bench tracer compares with'
  [libcds-dev]='libcds, whose queues are compared'
  [libboost-thread-dev]='what the flat combining of libcds needs'
  [libconcurrentqueue-dev]='moodycamel::ConcurrentQueue, whose queue is compared'
  [libatomic-queue-dev]='atomic_queue, whose rings are compared'
  [liburcu-dev]='userspace RCU, whose queues are compared'
  [libck-dev]='Concurrency Kit, whose queues are compared'
  [libreaderwriterqueue-dev]='moodycamel::ReaderWriterQueue, which is compared'
  [libpfm4-dev]='names of hardware events, for irt bench contention'
  [libbenchmark-dev]='Google Benchmark, which irt bench micro rests on'
  [valgrind]='counts instructions and cache misses for irt bench instructions'
  [clang]='compiles with a second compiler; fuzzers'
  [libclang-rt-dev]='libFuzzer, for the fuzzers'
  [clang-format]='checks the formatting'
  [clang-tidy]='checks the source for known mistakes'
)
packages_tools=(g++ cmake ninja-build libcli11-dev libfmt-dev nlohmann-json3-dev libhwloc-dev
  libtbb-dev libboost-dev libpng-dev libtinyobjloader-dev libhwy-dev
  libboost-context-dev)
packages_test=("${packages_tools[@]}" libgtest-dev "$gcc_plugin")
# Other people's queues, docs/comparators.md. The first start does without.
packages_comparators=(libcds-dev libboost-thread-dev libconcurrentqueue-dev libatomic-queue-dev
  liburcu-dev libck-dev libreaderwriterqueue-dev)
packages_full=("${packages_test[@]}" clang libclang-rt-dev "${packages_comparators[@]}"
  libbenchmark-dev libpfm4-dev catch2 doctest-dev valgrind gnuplot-nox chromium)
# What a target does without where it cannot be installed.
declare -A optional_packages=([irt-check]=$gcc_plugin [irt-simulate]=$gcc_plugin
  [irt-counted]=$gcc_plugin [irt-tracer-bench]=libembree-dev [irt-report]=gnuplot-nox
  [irt-contention]=libpfm4-dev
  [irt-micro]="libbenchmark-dev ${packages_comparators[*]}"
  [irt-instructions]="valgrind ${packages_comparators[*]}")
packages_format=(clang-format)
packages_tidy=("${packages_full[@]}" clang-tidy)

# Prints those of the named packages that are not installed, one a line.
missing_packages() {
  local -A installed=()
  local state package
  while read -r state package _; do
    [[ $state == ?i ]] && installed[$package]=1
  done < <(dpkg-query -W -f '${db:Status-Abbrev} ${Package}\n' "$@" 2>/dev/null)
  for package; do
    [[ -n ${installed[$package]:-} ]] || printf '%s\n' "$package"
  done
}

list_purposes() {
  local package
  for package; do
    printf '  %-22s %s\n' "$package" "${package_purpose[$package]}" >&2
  done
}

# apt_step TITLE LOG ARGUMENTS... : apt-get as root, without questions, as a step with progress.
apt_step() {
  local title=$1 log=$2
  shift 2
  run_step "$title" "$log" $step_prefix env DEBIAN_FRONTEND=noninteractive \
    apt-get -y -o APT::Status-Fd=1 -o Dpkg::Use-Pty=0 -o DPkg::Lock::Timeout=300 "$@"
}

# Installs what is missing of the named packages.
ensure_packages() {
  if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    ensure_tools_elsewhere "$@"
    return
  fi
  local -a missing
  mapfile -t missing < <(missing_packages "$@")
  ((${#missing[@]})) || return 0

  say "irt needs these Debian packages, which are not installed:"
  list_purposes "${missing[@]}"
  step_prefix=''
  if ((EUID != 0)); then
    # The password, if any, is asked for here, where the terminal is still the user's.
    if ! { sudo -n true || { [[ -t 0 ]] && sudo -v; }; } 2>/dev/null; then
      say "irt: installing them needs root, and sudo is not available to this user. As root, run"
      say "  apt-get install --no-install-recommends ${missing[*]}"
      exit 1
    fi
    step_prefix='sudo -n'
  fi

  local log=$logs/install.log known
  known=$(apt-cache show --no-all-versions -- "${missing[@]}" 2>/dev/null | grep -c '^Package:')
  if ((known < ${#missing[@]})); then
    apt_step 'Reading the package lists' "$logs/update.log" update ||
      say "irt: the package lists could not be renewed (see $logs/update.log); trying all the same"
  fi
  if ! apt_step 'Installing packages' "$log" install --no-install-recommends "${missing[@]}"; then
    # Most often the lists are older than the archive.
    if ! { apt_step 'Reading the package lists' "$logs/update.log" update &&
      apt_step 'Installing packages' "$log" install --no-install-recommends "${missing[@]}"; }; then
      say "irt: the packages could not be installed"
      show_failure "$log"
      exit 1
    fi
  fi
  step_prefix=''
}

# try_packages PACKAGES... : as ensure_packages, but goes on without them.
try_packages() {
  local package
  mkdir -p -- "$logs"
  for package; do
    (ensure_packages "$package") || say "irt: going on without $package"
  done
}

# On another system the user installs; all that can be checked is the tools.
ensure_tools_elsewhere() {
  local tool
  for tool in g++ cmake ninja; do
    command -v "$tool" >/dev/null && continue
    say "irt: $tool is not installed, and this system has no apt-get to install it with."
    say "What is needed, by the names of the Debian packages:"
    list_purposes "$@"
    exit 1
  done
}
