#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Makes the tables synth-nodes-TARGET of docs/measured/synth.md anew: what a node of five scenes takes on a target. Some
# ten minutes. usage: docs/synth_table.sh BUILD_DIRECTORY [TARGET...]
set -euo pipefail
cuboct=$1/cuboct
shift
targets=("$@")
[ $# -gt 0 ] || targets=(ecp5-85 xc7)
docs=$(dirname "${BASH_SOURCE[0]}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for target in "${targets[@]}"; do
  for scene in coupon undamped_block lj_block sheet two_types; do
    [ -d "$work/$scene" ] || "$cuboct" emit "$docs/../scenes/$scene.toml" --out "$work/$scene" > "$work/emit.log"
    "$cuboct" synth "$work/$scene" --target "$target" --no-place --json > "$work/$scene.json"
  done
  python3 - "$work" "$target" > "$work/table" <<'PYTHON'
import json, sys
work, target = sys.argv[1:]
reports = {scene: json.load(open(f"{work}/{scene}.json")) for scene in "coupon undamped_block lj_block sheet two_types".split()}
estimated = any("estimate" in r for r in reports.values())
print(f"node of, on {target}", "nodes", "cycles per step", "LUT", "FF", "DSP", "BRAM", "fit", "longest path, cells",
      *(["clock, estimated, MHz"] if estimated else []), sep="\t")
for scene, r in reports.items():
    uses = r["block"]["uses"]
    fit = f'{r["fit"]["units"]}, by {r["fit"]["limit"]}' if "fit" in r else "-"
    print(scene, r["nodes"], f'{r["cycles_per_step"]["counted"]["mean"]:.0f}', *(uses[k] for k in ("LUT", "FF", "DSP", "BRAM")), fit, r.get("depth", "-"),
          *([f'{r["estimate"]["mhz"]:.0f}' if "estimate" in r else "-"] if estimated else []), sep="\t")
PYTHON
  { printf '# commit: %s\n' "$(git -C "$docs" rev-parse --short=7 HEAD)"
    printf '# machine: any machine: %s\n' "$(yosys -V | cut -d' ' -f1,2)"
    printf '# command: docs/synth_table.sh build %s\n' "$target"
    cat "$work/table"; } > "$docs/measured/data/synth-nodes-$target.tsv"
done
"$docs/tables"
