# `irt watch`: every instrument on a queue, for a few seconds each time it is saved.

help_watch() {
  cat <<'H'
Usage: irt watch HEADER[:CLASS] [--against QUEUE] [--once] [--include DIR] [--link LIB] [--source FILE]
                 [--flag FLAG]

Whenever the header, or what it includes, was saved: compiles it, explores its small shapes (4 s), runs
it on real threads under the oracles (2 s), and times it against itself as it was before the first
save, or against QUEUE. One screen: green, or what broke. A pass says only that so short a look found
nothing; 'irt check' and 'irt stress' look longer. Ends with Ctrl-C; with --once after one round, with
exit code 1 where something broke and 2 where it does not compile.
H
}

# A line of the screen: its state, what was looked at, what came of it.
watch_line() {
  local colour=''
  if [[ -t 1 ]]; then case $1 in ok) colour=$'\e[32m' ;; BROKEN) colour=$'\e[1;31m' ;; esac; fi
  printf '%s%-7s%s %-12s %s\n' "$colour" "$1" "${colour:+$'\e[0m'}" "$2" "$3"
}

# watch_round PLUGIN QUEUE FOLDER BASELINE... : 0 if nothing broke. The last argument is the
# name of what it is timed against, those before it are for the tool.
watch_round() {
  local plugin=$1 queue=$2 out=$3 code=0 broken=0 report
  shift 3
  local baseline=${*: -1} release=$here/build/release

  report=$("$release/stress/checker/irt-check" --plugin "$plugin" --queue "$queue" --seconds 4 2>&1) ||
    code=$?
  if ((code == 0)); then
    watch_line ok check "$(tail -n 1 <<<"$report" | sed -E 's/^[^:]*: //; s/ Not searched whole.*//')"
  else
    broken=1
    watch_line BROKEN check "$(tail -n 1 <<<"$report" | sed -E 's/^[^:]*: //; s/ Not searched whole.*//')"
    sed -n '/^[a-z].*: .* at /,$p' <<<"$report" | head -n 40
  fi

  code=0
  report=$("$release/stress/threads/irt-stress" --plugin "$plugin" --queue "$queue" --seconds 2 2>&1) ||
    code=$?
  if ((code == 0)); then
    watch_line ok stress 'no claim broke on real threads in 2 s'
  else
    broken=1
    watch_line BROKEN stress ''
    sed -n '/^FINDING/,/^ok/p' <<<"$report" | grep -v '^ok' | head -n 16
  fi
  if ((broken)); then
    watch_line - speed 'not timed, for it is broken'
    return 1
  fi

  local figures=$out/contention.json
  if "$release/bench/contention/irt-contention" contention --plugin "$plugin" "${@:1:$#-1}" \
    --queue "$baseline,$queue" --threads 1,2 --repetitions 5 --seconds 0.05 --warmup 0.1 \
    --out "$out" >"$out/contention.log" 2>&1; then
    "$release/bench/contention/irt-contention" compare "$figures" --queues "$baseline" "$queue" 2>&1 |
      grep -E 'faster|slower|difference' | tr -s ' ' | while read -r report; do watch_line time speed "$report"; done
  else
    watch_line time speed "not measured: $(tail -n 1 "$out/contention.log")"
  fi
}

watch_queue() {
  local header='' against='' once='' includes='' links='' sources='' flags=''
  while (($#)); do
    case $1 in
      -h | --help) help_watch && return 0 ;;
      --once) once=yes ;;
      --against) against=${2:-} && shift ;;
      --include | --link | --source | --flag) note_need "$1" "${2:-}" && shift ;;
      -*) usage_error "watch: unknown option $1; see 'irt help watch'" ;;
      *)
        [[ -z $header ]] || usage_error "watch: one header at a time; '$header' and '$1' were given"
        header=$1
        ;;
    esac
    shift
  done
  [[ $header =~ $outside_pattern ]] ||
    usage_error "watch: '${header:-(nothing)}' is not the header of a queue, as my_queue.hpp or my_queue.hpp:Class"
  local file=${BASH_REMATCH[1]} class=${BASH_REMATCH[3]}
  [[ -f $file ]] || usage_error "watch: there is no file $file"
  build_target release 'irt-check irt-stress irt-contention' "${packages_tools[@]}"
  [[ $against =~ $outside_pattern ]] && usage_error "watch: --against takes a queue of the tree, and not '$against'"
  install_development

  # As it was at first, under another name: what it is timed against.
  local out before queue plugin code baseline=("$against")
  out=$here/build/outside/watch-$(realpath -- "$file" | cksum | cut -d' ' -f1)
  mkdir -p -- "$out"
  if [[ -z $against ]]; then
    before=$out/$(basename -- "${file%.*}")_before.${file##*.}
    rm -f -- "$out/before"
    cp -- "$file" "$before"
    (build_outside release watch "$before$class" "$includes$(realpath -- "$(dirname -- "$file")")" "$links" \
      "$sources" "$flags" && printf '%s\n' "$outside_plugin" "$outside_queue" >"$out/before") 2>/dev/null
    mapfile -t baseline < <(cat "$out/before" 2>/dev/null)
    if ((${#baseline[@]} == 2)); then
      baseline=(--plugin "${baseline[@]}")
    else
      baseline=(lfree)  # there is no running version yet
    fi
  fi
  if ((${#baseline[@]} == 1)); then
    local modules=$here/build/release/queues/modules/$baseline
    grep -qx "$baseline.contention.so" "${modules%/*}/list.txt" ||
      usage_error "watch: --against $baseline: there is no such queue; 'irt list' shows them"
    (build_modules release "$modules.so" "$modules.contention.so") || exit 1
  fi

  while true; do
    [[ -t 1 ]] && printf '\e[H\e[2J'
    code=0
    if (build_outside release watch "$header" "$includes" "$links" "$sources" "$flags" &&
      printf '%s\n' "$outside_plugin" "$outside_queue" >"$out/now"); then
      { read -r plugin && read -r queue; } <"$out/now"
      echo "$queue, saved at $(date -r "$file" +%T)"
      watch_line ok compiles ''
      watch_round "$plugin" "$queue" "$out" "${baseline[@]}" || code=1
    else
      code=2
    fi
    [[ -n $once ]] && return "$code"
    local folder=${plugin:+$(dirname -- "$plugin")}
    local saved
    saved=$(stat -c %Y.%s -- "$file")
    until [[ $(stat -c %Y.%s -- "$file" 2>/dev/null) != "$saved" ]] ||
      { ((code != 2)) && ! ninja -C "$folder" -n 2>/dev/null | grep -q 'no work to do'; }; do
      sleep 0.5
    done
  done
}
