#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# guide.sh ROOT DIRECTORY_OF_CUBOCT CACHE [unchecked]: runs the sh blocks of docs/user/board.md, in turn and in one shell, and
# finds each line of its plain blocks in what they printed. unchecked: emits without the minute of synthesis that tells whether
# the board has room.
set -euo pipefail
root=$1 programs=$2 page=$1/docs/user/board.md
export XDG_CACHE_HOME=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
ln -s "$root/scenes" "$work/scenes"
cd "$work"
PATH=$programs:$PATH
awk '/^```sh$/ {inside = 1; next} /^```/ {inside = 0} inside' "$page" > blocks.sh
[ "${4-}" != unchecked ] || sed -i '/^cuboct emit .* --board /s/$/ --unchecked/' blocks.sh
bash -euo pipefail blocks.sh > printed 2>&1 </dev/null || { cat printed; exit 1; }
lines=0
while IFS= read -r expected; do
  lines=$((lines + 1))
  grep -qxF -- "$expected" printed || { echo "not printed: $expected"; cat printed; exit 1; }
done < <(awk '/^```text$/ {inside = 1; next} /^```/ {inside = 0} inside' "$page")
[ "$(wc -l < blocks.sh)" -ge 4 ] && [ "$lines" -ge 2 ] || { echo "only $lines lines to find"; exit 1; }
echo "ran $(wc -l < blocks.sh) lines, found $lines"
