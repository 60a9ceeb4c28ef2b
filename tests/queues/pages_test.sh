#!/usr/bin/env bash
# The pages of docs/queues are those that queues/pages.sh makes of the headers.
#
#   pages_test.sh TREE WORK
set -euo pipefail
tree=$1 work=$2

rm -rf -- "$work"
"$tree/queues/pages.sh" "$work"
if ! diff -r "$tree/docs/queues" "$work"; then
  echo "docs/queues is not what the headers say; run queues/pages.sh and commit what it writes" >&2
  exit 1
fi
# Each has what a reader looks for.
for page in "$work"/*.md; do
  [[ ${page##*/} == README.md ]] && continue
  for words in '**When to use**' '## What it claims'; do
    grep -qF -- "$words" "$page" || {
      echo "${page##*/} lacks: $words" >&2
      exit 1
    }
  done
done
