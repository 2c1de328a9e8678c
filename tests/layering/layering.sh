#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The edges between directories: model <- hw <- {rtl, emu}, {model, hw} <- gpu_ref, {model, hw, emu/lattice} <- study,
# everything <- {cli, tests};
# engines (emu/<engine>, gpu_ref) never include one another, but for the bench that systemc and verilated share, and
# systemc's words and collector, which are board's too.
# usage: layering.sh ROOT; prints each forbidden include and fails if there is one.
set -euo pipefail
cd "$1"

allowed() {  # directory of the includer, included path
  case "$1:$2" in
    model*:model/*) ;;
    hw*:model/*|hw*:hw/*) ;;
    rtl*:model/*|rtl*:hw/*|rtl*:rtl/*) ;;
    emu/lattice*:model/*|emu/lattice*:hw/*|emu/lattice*:emu/lattice/*) ;;
    emu/board*:model/*|emu/board*:hw/*|emu/board*:emu/board/*|emu/board*:emu/systemc/*) ;;
    emu/systemc*:model/*|emu/systemc*:hw/*|emu/systemc*:emu/systemc/*) ;;
    emu/verilated*:model/*|emu/verilated*:hw/*|emu/verilated*:emu/verilated/*|emu/verilated*:emu/systemc/*) ;;
    study*:model/*|study*:hw/*|study*:emu/lattice/*|study*:study/*) ;;
    gpu_ref*:model/*|gpu_ref*:hw/*|gpu_ref*:gpu_ref/*) ;;
    cli*:*|tests*:*) ;;
    *) return 1 ;;
  esac
}

edges=0 bad=0
while IFS=: read -r file line text; do
  included=$(sed -E 's/.*#include "([^"]+)".*/\1/' <<<"$text")
  case "$included" in */*) ;; *) continue ;; esac   # generated or local to a tool
  edges=$((edges + 1))
  if ! allowed "$(dirname "$file")" "$included"; then
    echo "$file:$line: $(dirname "$file") must not include $included"
    bad=1
  fi
done < <(grep -rnE --include='*.h' --include='*.cpp' --include='*.cu' '^#include "' model hw rtl emu study gpu_ref cli tests 2>/dev/null)
[ "$edges" -gt 20 ] || { echo "only $edges includes found: the check sees nothing"; exit 1; }
[ "$bad" = 0 ] && echo "$edges includes follow the layering"
exit "$bad"
