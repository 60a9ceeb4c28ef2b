# Runs a long command quietly: a progress bar on a terminal, now and then a line elsewhere, all of
# its output in a log. Everything said here goes to stderr; stdout belongs to the tools.

say() { printf '%s\n' "$*" >&2; }

duration() {
  local seconds=$1
  if ((seconds < 60)); then
    printf '%d s' "$seconds"
  else
    printf '%d min %02d s' $((seconds / 60)) $((seconds % 60))
  fi
}

# How far the step is, read off one line of output: of ninja, ctest or apt (whose Status-Fd counts
# to 100 twice, for download and for installation). Sets step_done and step_total.
note_progress() {
  if [[ $1 =~ ^\[([0-9]+)/([0-9]+)\] || $1 =~ ^\ *([0-9]+)/([0-9]+)\ Test ]]; then
    step_done=${BASH_REMATCH[1]} step_total=${BASH_REMATCH[2]}
  elif [[ $1 =~ ^(dl|pm)status:[^:]*:([0-9]+) ]]; then
    step_done=${BASH_REMATCH[2]} step_total=200
    [[ ${BASH_REMATCH[1]} == pm ]] && ((step_done += 100))
  fi
  return 0
}

# "12 s, about 40 s left", from the share that is done.
describe_time() {
  local elapsed=$1
  duration "$elapsed"
  if ((step_done > 0 && step_done < step_total && elapsed >= 3)); then
    printf ', about %s left' "$(duration $((elapsed * (step_total - step_done) / step_done)))"
  fi
}

draw_bar() {
  local title=$1 elapsed=$2 width=30 bar
  if ((step_total > 0)); then
    printf -v bar '%*s' $((step_done * width / step_total)) ''
    bar=${bar// /#}
  else
    printf -v bar '%*s<=>' $((elapsed % (width - 2))) '' # on its way, nobody knows how far
  fi
  printf '\r\e[K%s [%-*s] %s' "$title" "$width" "$bar" "$(describe_time "$elapsed")" >&2
}

print_plain() {
  local title=$1 elapsed=$2 share=''
  ((step_total > 0)) && share=" $((100 * step_done / step_total)) %,"
  say "$title:$share $(describe_time "$elapsed")"
}

# The part of a log that a reader wants: from the first thing that names itself an error.
show_failure() {
  local log=$1 first
  first=$(grep -n -m1 -E '^(FAILED:|CMake Error|E: |ninja: error)' "$log" | cut -d: -f1)
  if [[ -n $first ]]; then
    tail -n "+$first" "$log" | head -n 40 >&2
  else
    tail -n 25 "$log" >&2
  fi
  say "irt: the whole log is in $log"
}

# Ends the running step with all its children, then the front door.
stop_step() {
  local code=$1
  trap - INT TERM HUP
  if [[ -n ${step_child:-} ]]; then
    $step_prefix kill -TERM -- "-$step_child" 2>/dev/null
    wait "$step_child" 2>/dev/null
  fi
  [[ -t 2 ]] && printf '\r\e[K' >&2
  say "irt: interrupted"
  exit "$code"
}

# run_step TITLE LOG COMMAND... : the command's exit code. A command under sudo is also stopped
# under sudo: set step_prefix.
run_step() {
  local title=$1 log=$2 started=$SECONDS polls=0 last=0 line='' part='' code=0 lines idle
  shift 2
  step_done=0 step_total=0 step_prefix=${step_prefix:-}
  mkdir -p -- "${log%/*}"
  : >"$log"
  # A process group of its own, so that stopping the step reaches every compiler it started.
  set -m
  "$@" </dev/null >>"$log" 2>&1 &
  step_child=$!
  set +m
  trap 'stop_step 130' INT
  trap 'stop_step 143' TERM
  trap 'stop_step 129' HUP

  exec {lines}<"$log" {idle}<> <(:)
  while kill -0 "$step_child" 2>/dev/null; do
    read -r -t "0.$((polls++ < 15 ? 02 : 20))" -u "$idle"
    while IFS= read -r line <&"$lines" || { part+=$line && false; }; do
      note_progress "$part$line"
      part=''
    done
    local elapsed=$((SECONDS - started))
    if [[ -t 2 ]]; then
      ((elapsed >= 1)) && draw_bar "$title" "$elapsed"
    elif ((elapsed - last >= 10 + last / 5)); then
      print_plain "$title" "$elapsed"
      last=$elapsed
    fi
  done
  wait "$step_child" || code=$?
  step_child=''
  trap - INT TERM HUP
  exec {lines}<&- {idle}<&-

  [[ -t 2 ]] && printf '\r\e[K' >&2
  if ((code == 0 && SECONDS - started >= 2)); then
    say "$title: done in $(duration $((SECONDS - started)))"
  fi
  return "$code"
}
