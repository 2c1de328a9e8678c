#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Lines of hand-written SystemVerilog have at most 120 columns; rtl/example is written by the generator.
# usage: columns.sh ROOT; prints each longer line and fails if there is one.
set -euo pipefail
cd "$1"
find rtl/lib rtl/lattice rtl/pipeline rtl/rounds rtl/board rtl/bus tests/formal \( -name '*.sv' -o -name '*.svh' \) -print0 | sort -z | xargs -0 awk '
  length > 120 { printf "%s:%d: %d columns, more than 120\n", FILENAME, FNR, length; bad = 1 }
  END {
    if (NR < 1000) { printf "only %d lines found: the check sees nothing\n", NR; bad = 1 }
    if (!bad) printf "%d lines, none too long\n", NR
    exit bad
  }'
