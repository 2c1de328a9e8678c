#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# What tests/blocks/pages says of a page that is not what the RTL is: a copy of two modules and their pages, broken in one
# place at a time.
# usage: runner.sh PYTHON SOURCE_DIRECTORY
set -uo pipefail
python=$1 source=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
page=docs/reference/blocks/fifo.md
failed=0

fresh() {  # the copy as it should be, with its pages written
  rm -rf "$work/tree"
  mkdir -p "$work/tree/rtl/lib/memories" "$work/tree/docs/reference/blocks"
  cp "$source/rtl/lib/memories/cuboct_fifo.sv" "$work/tree/rtl/lib/memories"
  cp "$source/docs/reference/blocks/README.md" "$source/$page" "$work/tree/docs/reference/blocks"
  (cd "$work/tree" && "$python" "$source/tests/blocks/pages" --root . > log 2>&1) || { cat "$work/tree/log"; exit 1; }
}
expect() {  # CHECK STATUS TEXT...: what the check ends with, and lines that it prints
  local check=$1 status=$2 found
  shift 2
  (cd "$work/tree" && "$python" "$source/tests/blocks/pages" --root . --check "$check" > log 2>&1)
  found=$?
  if [ $found != "$status" ]; then
    echo "status $found, not $status, for: $*"
    cat "$work/tree/log"
    failed=1
  fi
  for text in "$@"; do
    grep -qF -- "$text" "$work/tree/log" || { echo "not said: $text"; cat "$work/tree/log"; failed=1; }
  done
}
edit() {  # FILE SED: the file must change
  cp "$work/tree/$1" "$work/before"
  sed -i "$2" "$work/tree/$1"
  if cmp -s "$work/before" "$work/tree/$1"; then
    echo "$1 does not have what '$2' changes"
    failed=1
  fi
}

fresh
expect ports 0 "2 pages: "
expect cycles 0 "none differs"

edit rtl/lib/memories/cuboct_fifo.sv 's/pop_i/take_i/g'
expect ports 1 "$page: cuboct_fifo: 'take_i' is missing on the page" \
  "$page: cuboct_fifo: 'pop_i' is on the page, but not in the module" "to write the pages anew: tests/blocks/pages"
expect cycles 2 "'pop_i' is no input of cuboct_fifo"

fresh
edit rtl/lib/memories/cuboct_fifo.sv 's/output logic            full_o,/output logic [1:0]      full_o,/'
expect ports 1 "$page: cuboct_fifo: 'full_o' is on the page"

fresh
edit rtl/lib/memories/cuboct_fifo.sv 's/parameter int Depth = 16 /parameter int Depth = 32 /'
expect ports 1 "$page: cuboct_fifo: 'Depth' is on the page"

fresh
edit $page "/^| \`empty_o\` | out/d"
expect ports 1 "$page: cuboct_fifo: 'empty_o' is missing on the page"

fresh
edit rtl/lib/memories/cuboct_fifo.sv 's|// with push_i||'
expect ports 2 "rtl/lib/memories/cuboct_fifo.sv: cuboct_fifo: 'data_i' has no comment at its line"

fresh
edit rtl/lib/memories/cuboct_fifo.sv 's|// with push_i$|&\n                           // goes on|'
expect ports 1 "| with push_i goes on |"

fresh
sed 's/cuboct_fifo/cuboct_other/' "$work/tree/rtl/lib/memories/cuboct_fifo.sv" > "$work/tree/rtl/lib/memories/cuboct_other.sv"
expect ports 2 "module cuboct_other is on no page of docs/reference/blocks"

fresh
edit rtl/lib/memories/cuboct_fifo.sv 's/assign full_o  = full_q/assign full_o  = full_d/'
expect cycles 1 "cuboct_fifo: the page shows" "to write the pages anew: tests/blocks/pages"
expect ports 0

fresh
edit $page 's/^    3 |      \.     00     \. |      1/    3 |      .     00     . |      ./'
expect cycles 1 "cuboct_fifo: the page shows"

fresh
edit $page 's/^cycle | push_i/cycle | shove_i/'
expect cycles 2 "'shove_i' is no input of cuboct_fifo"

[ $failed = 0 ] && echo "each break was told"
exit $failed
