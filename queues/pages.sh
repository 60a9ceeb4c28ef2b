#!/usr/bin/env bash
# Writes the pages of docs/queues: one for each header of a queue, from its comment and its claims,
# and the list of all queues. Nothing in them is written by hand.
#
#   queues/pages.sh [DIRECTORY]      # default: docs/queues
set -euo pipefail

here=$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")
pages=${1:-$here/../docs/queues}
mkdir -p -- "$pages"
rm -f -- "$pages"/*.md

# name header class, a line for each queue, in the order of `irt list`
queues() {
  tr '\n' ' ' <"$here/CMakeLists.txt" | grep -o 'irt_add_queue([^)]*)' |
    sed 's/irt_add_queue(//; s/irt:://; s/)//' | awk '{ print $1, $2, $3 }'
}

# The comment above `#pragma once`, as Markdown.
comment() {
  sed -n '/^\/\/\//!q; s,^/// \{0\,1\},,p' "$1" |
    sed -E 's/(^|[.)] )(When to use|When not|Ordering|Ordering, progress|Ordering, progress, memory, bounds|Progress|Memory|How it works|What differs from [^:,]*(, and why)?|Not done):/\1**\2**:/g'
}

# What is said of `class` in `header`: the text of its `summary`, the source of its `claims`.
summary_of() {
  awk -v class="$2" '
    $0 ~ "^class " class "( |$)" { inside = 1 }
    inside && /summary =/ { found = 1 }
    inside && found { text = text $0 }
    inside && found && /;/ { exit }
    END { gsub(/^[^"]*"|"[^"]*$/, "", text); gsub(/" *"/, "", text); print text }' "$1"
}
claims_of() {
  awk -v class="$2" '
    $0 ~ "^class " class "( |$)" { inside = 1 }
    inside && /Claims claims/ { found = 1 }
    inside && found { print }
    inside && found && /;/ { exit }' "$1" | sed 's/^  //'
}

page_of() {
  local page=${1##*/}
  page=${page%.hpp}
  echo "${page//_/-}.md"
}

list=$pages/README.md
{
  echo '# The queues, and where each is explained'
  echo
  echo 'Each page is the comment of its header; `queues/pages.sh` writes them all.'
  echo
  echo '| queue | what it is |'
  echo '|---|---|'
} >"$list"

while read -r name header class; do
  page=$(page_of "$header")
  echo "| [\`$name\`]($page) | $(summary_of "$here/$header" "$class" | sed 's/|/\\|/g') |" >>"$list"
  [[ -e $pages/$page ]] && continue
  {
    echo "# $(queues | awk -v header="$header" '$2 == header { printf "%s`%s`", separator, $1; separator = ", " }')"
    echo
    comment "$here/$header"
    echo
    echo '## What it claims'
    echo
    queues | while read -r other its_header its_class; do
      [[ $its_header == "$header" ]] || continue
      echo "\`$other\`: $(summary_of "$here/$header" "$its_class")."
      echo
      claims=$(claims_of "$here/$header" "$its_class")
      if [[ -n $claims ]]; then
        printf '```cpp\n%s\n```\n\n' "$claims"
      else
        printf 'It claims what the queue inside does.\n\n'
      fi
    done
    echo "Source: [\`queues/$header\`](../../queues/$header). What the claims mean, and who tests them:"
    echo "[claims](../claims.md)."
  } >"$pages/$page"
done < <(queues)
