#!/bin/sh
# SPDX-License-Identifier: MIT
# lint_kinds.sh EMIT_CASE DIR: lints the project of each kind of node, and tells of all that are not clean. Some cases do not
# have some kinds: no more than a quarter may be refused.
set -eu
emit=$1 dir=$2
clean=0 refused=0 bad=0
for name in $("$emit" --kinds); do
  rm -rf "$dir"
  if ! "$emit" "$name" "$dir" 1 2>"$dir.refusal"; then
    refused=$((refused + 1))
    continue
  fi
  if make -s -C "$dir/bench" lint >"$dir.log" 2>&1; then
    clean=$((clean + 1))
  else
    bad=$((bad + 1))
    echo "$name:"
    grep -E '^%' "$dir.log" | sort | uniq -c
  fi
done
echo "$clean clean, $bad not, $refused refused"
[ $bad -eq 0 ] && [ $clean -ge 100 ] && [ $((3 * refused)) -le $clean ]
