#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The table of docs/reference/synth.md: what a node of five scenes takes on two targets. Some ten minutes.
# usage: docs/synth_table.sh BUILD_DIRECTORY [TARGET...]
set -euo pipefail
cuboct=$1/cuboct
shift
targets=("$@")
[ $# -gt 0 ] || targets=(ecp5-85 xc7)
root=$(dirname "${BASH_SOURCE[0]}")/..
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for target in "${targets[@]}"; do
  columns='nodes | cycles per step | LUT | FF | DSP | BRAM | fit | longest path, cells | clock, estimated, MHz'
  printf '| node of, on %s | %s |\n' "$target" "$columns"
  printf '|---|---|---|---|---|---|---|---|---|---|\n'
  for scene in coupon undamped_block lj_block sheet two_types; do
    [ -d "$work/$scene" ] || "$cuboct" emit "$root/scenes/$scene.toml" --out "$work/$scene" > "$work/emit.log"
    "$cuboct" synth "$work/$scene" --target "$target" --no-place --json > "$work/report.json"
    python3 - "$work/report.json" "$scene" <<'PYTHON'
import json, sys
r = json.load(open(sys.argv[1]))
uses = r["block"]["uses"]
fit = f'{r["fit"]["units"]}, by {r["fit"]["limit"]}' if "fit" in r else "-"
counts = [uses[k] for k in ("LUT", "FF", "DSP", "BRAM")]
row = [sys.argv[2], r["nodes"], r["cycles_per_step"], *counts, fit, r.get("depth", "-"),
       f'{r["estimate"]["mhz"]:.0f}' if "estimate" in r else "-"]
print("| " + " | ".join(str(cell) for cell in row) + " |")
PYTHON
  done
done
