# `irt test` and `irt lint`.

help_test() {
  cat <<'H'
Usage: irt test [--full] [--sanitizer asan|tsan] [-- CTEST-OPTIONS...]

Builds and runs the tests of the project.
  --full             also the long ones: fuzzers, soaks; every queue as its concrete type
  --sanitizer asan   everything under AddressSanitizer and UndefinedBehaviorSanitizer
  --sanitizer tsan   everything under ThreadSanitizer
  -- -R REGEX        hands what follows to ctest, here: only tests whose names match
H
}

run_tests() {
  local preset=release selection=(-LE '^full$') packages=("${packages_test[@]}") seconds=120
  local targets=irt-tests
  while (($#)); do
    case $1 in
      --full)
        selection=() packages=("${packages_full[@]}") seconds=900
        targets='irt-tests irt-queue-modules'
        ;;
      --sanitizer)
        case ${2:-} in
          asan | tsan) preset=$2 ;;
          *) usage_error "--sanitizer ${2:-(nothing)}: not a sanitizer; known are asan and tsan" ;;
        esac
        shift
        ;;
      -h | --help) help_test && exit 0 ;;
      --) shift && break ;;
      *) usage_error "test: unknown option $1; see 'irt help test'" ;;
    esac
    shift
  done
  [[ $preset == release ]] || ((seconds *= 5))

  build_target "$preset" "$targets" "${packages[@]}"

  # One more than there are processors, for some tests only wait.
  local run=(ctest --test-dir "$here/build/$preset" --output-on-failure --no-tests=error
    --parallel "$(($(nproc) + 1))" --timeout "$seconds" "${selection[@]}" "$@")
  # ThreadSanitizer of GCC 12 cannot map its shadow where addresses are randomised over more bits.
  if [[ $preset == tsan ]] && setarch -R true 2>/dev/null; then run=(setarch -R "${run[@]}"); fi
  local log=$logs/test-$preset.log code=0
  run_step 'Testing' "$log" "${run[@]}" || code=$?
  if ((code)); then
    grep -E -A 40 '\*\*\*(Failed|Exception|Timeout|Not Run)' "$log" | head -n 150 >&2
    say "irt: tests failed; the whole log is in $log"
  fi
  if grep -q 'tests passed' "$log"; then
    sed -n '/% tests passed/,$p' "$log"
  else
    tail -n 5 "$log" >&2
  fi
  return "$code"
}

help_lint() {
  cat <<'H'
Usage: irt lint [format|tidy]

Checks the source: its formatting (clang-format 14), and with clang-tidy while everything is
compiled with clang++. Without a word, both.
H
}

own_sources() {
  find "$here" -path "$here/build*" -prune -o -path "$here/.git" -prune -o \
    -type f \( -name '*.hpp' -o -name '*.cpp' \) -print0
}

lint() {
  local what=${1:-both}
  case $what in
    -h | --help) help_lint && return 0 ;;
    format | tidy | both) ;;
    *) usage_error "lint: $what is unknown; known are format and tidy" ;;
  esac
  if [[ $what != tidy ]]; then
    ensure_packages "${packages_format[@]}"
    if ! own_sources | xargs -0 clang-format --dry-run --Werror >&2; then
      say "irt: formatting differs; 'clang-format -i FILE' mends it"
      return 1
    fi
    say "Formatting: clean"
  fi
  if [[ $what != format ]]; then
    # Other rules are for ninja no reason to look at a file again.
    [[ $here/.clang-tidy -nt $here/build/tidy/build.ninja ]] && rm -rf -- "$here/build/tidy"
    ninja_options=(-k 0) # everything there is to mend in one go
    build_target tidy 'all irt-tests' "${packages_tidy[@]}"
    say "clang-tidy: clean"
  fi
}
