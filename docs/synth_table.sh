#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Makes tables of docs/measured anew: synth-nodes-TARGET, what a node of five scenes takes on a target; with "small" in place
# of a target rtl-small-fpgas, a node on two small FPGAs as placed with three seeds; with "ecp5-placed" synth-ecp5-placed,
# the estimate beside nodes that were placed; with "boards" board-examples, what the examples of boards take; with "solids"
# halo-clock, machines for solids and their steps per second; with "rules" synth-rules, nodes of rules of text. Some fifty
# minutes.
# usage: docs/synth_table.sh BUILD_DIRECTORY [TARGET...]
set -euo pipefail
build=$1 cuboct=$1/cuboct
shift
targets=("$@")
[ $# -gt 0 ] || targets=(ecp5-85 xc7 small ecp5-placed boards solids rules)
docs=$(dirname "${BASH_SOURCE[0]}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
yosys=$(yosys -V | cut -d' ' -f1,2)

origin() {  # TARGET MACHINE
  printf '# commit: %s\n# machine: any machine: %s\n# command: docs/synth_table.sh build %s\n' \
    "$(git -C "$docs" rev-parse --short=7 HEAD)" "$2" "$1"
}
# Of the RTL that figures are of, but for its comments.
digest() { cat "$1"/rtl/*.sv | grep -v '^ *//' | sha256sum | cut -c1-8; }
emit() {  # NAME SCENE ARGUMENTS...
  [ -d "$work/$1" ] || "$cuboct" emit "$docs/../scenes/$2.toml" "${@:3}" --out "$work/$1" > "$work/emit.log"
}

nodes() {  # TARGET
  local scene scenes=(coupon undamped_block lj_block sheet two_types)
  for scene in "${scenes[@]}"; do
    emit "$scene" "$scene"
    "$cuboct" synth "$work/$scene" --target "$1" --no-place --json > "$work/$scene.json"
    digest "$work/$scene" > "$work/$scene.digest"
  done
  python3 - "$work" "$1" "${scenes[@]}" <<'PYTHON'
import json, sys
work, target, *scenes = sys.argv[1:]
reports = {scene: json.load(open(f"{work}/{scene}.json")) for scene in scenes}
estimated = any("estimate" in r for r in reports.values())
print(f"node of, on {target}", "nodes", "cycles per step", "LUT", "FF", "DSP", "BRAM", "fit", "longest path, cells",
      *(["clock, estimated, MHz"] if estimated else []), "RTL", sep="\t")
for scene, r in reports.items():
    uses = r["block"]["uses"]
    fit = f'{r["fit"]["units"]}, by {r["fit"]["limit"]}' if "fit" in r else "-"
    print(scene, r["nodes"], f'{r["cycles_per_step"]["counted"]["mean"]:.0f}', *(uses[k] for k in ("LUT", "FF", "DSP", "BRAM")),
          fit, r.get("depth", "-"), *([f'{r["estimate"]["mhz"]:.0f}' if "estimate" in r else "-"] if estimated else []),
          open(f"{work}/{scene}.digest").read().strip(), sep="\t")
PYTHON
}

small() {
  local device arch seed
  printf '%s\t' 'full node of the coupon' 'logic cells' 'of these the harness' EBR DSP 'clock, MHz: seeds 1, 2, 3' \
    'estimated' 'cycles per step' 'steps per second, seed 1'
  printf 'RTL\n'
  for device in up5k:ice40 hx8k:ice40_serial; do
    arch=${device#*:} device=${device%:*}
    emit "$arch" coupon --arch "$docs/../scenes/archs/$arch.toml"
    for seed in 1 2 3; do
      "$cuboct" synth "$work/$arch" --target "$device" --unit node --seed $seed --json > "$work/$arch.$seed.json"
    done
    python3 - "$work" "$arch" "$(digest "$work/$arch")" <<'PYTHON'
import json, sys
work, arch, digest = sys.argv[1:]
reports = [json.load(open(f"{work}/{arch}.{seed}.json")) for seed in (1, 2, 3)]
r = reports[0]
uses, holds, harness = r["block"]["uses"], r["holds"], r["harness_flip_flops"]
of = lambda k: f"{uses[k]} of {holds[k]}" if holds[k] else "-"
print(f"{r['target'].upper()}, `{arch}.toml`", f"{r['logic_cells'] + harness} of {holds['LUT']}", harness, of("BRAM"), of("DSP"),
      ", ".join(f"{x['fmax_mhz']:.1f}" for x in reports), f"{r['estimate']['mhz']:.1f}",
      f"{r['cycles_per_step']['counted']['mean']:.0f}", f"{r['steps_per_second']:.0f}", digest, sep="\t")
PYTHON
  done
}

boards() {
  local example scene board arch target clock
  printf '%s\t' 'scene of scenes/boards, arch' nodes LUT FF DSP BRAM 'logic cells' 'clock, MHz' "board's clock" \
    'cycles per step'
  printf 'RTL\n'
  for example in grips:icebreaker:icebreaker:up5k:12 grips:ulx3s:board:ecp5-85:25 heat:icebreaker:icebreaker_heat:up5k:12; do
    IFS=: read -r scene board arch target clock <<< "$example"
    emit "$arch" "boards/$scene" --arch "$docs/../scenes/archs/$arch.toml" --board "$board"
    "$cuboct" synth "$work/$arch" --target "$target" --unit board --json > "$work/$arch.json"
    python3 - "$work/$arch.json" "\`$scene\`, \`archs/$arch.toml\`, $target" "$clock" "$(digest "$work/$arch")" <<'PYTHON'
import json, sys
r, name, clock, digest = json.load(open(sys.argv[1])), *sys.argv[2:]
uses, holds = r["used"], r["holds"]
print(name, r["nodes"], *(f"{uses[k]} of {holds[k]}" for k in ("LUT", "FF", "DSP", "BRAM")), r.get("logic_cells", "-"),
      f"{r['fmax_mhz']:.1f}, placed" if "fmax_mhz" in r else f"{r['estimate']['mhz']:.1f}, estimated", clock,
      f"{r['cycles_per_step']['counted']['mean']:.0f}", digest, sep="\t")
PYTHON
  done
}

# The default machine, the one for solids, and that one with twice the pipes.
solids() {
  local scene machine
  sed 's/^force_pipes = 2$/force_pipes = 4/' "$docs/../scenes/archs/solid.toml" > "$work/four_pipes.toml"
  cp "$docs"/../scenes/archs/{default,solid}.toml "$work"
  printf '%s\t' 'node of' machine 'cycles per step' LUT FF DSP BRAM 'clock, estimated, MHz' 'million steps/s' 'steps/s per LUT'
  printf 'the longest path ends in\n'
  for scene in undamped_block coupon; do
    for machine in default solid four_pipes; do
      emit "$scene.$machine" "$scene" --arch "$work/$machine.toml"
      "$cuboct" synth "$work/$scene.$machine" --target ecp5-85 --no-place --json > "$work/$scene.$machine.json"
      python3 - "$work/$scene.$machine.json" "$scene" "$machine" <<'PYTHON'
import json, sys
r, scene, machine = json.load(open(sys.argv[1])), *sys.argv[2:]
uses, mhz, end = r["block"]["uses"], r["estimate"]["mhz"], r["estimate"]["ends"][0]
cycles = r["cycles_per_step"]["counted"]["mean"]
steps = mhz * 1e6 / cycles
named = {"four_pipes": "`solid.toml`, four pipes"}.get(machine, f"`{machine}.toml`")
print(scene, named, f"{cycles:.1f}", *(f"{uses[k]:,}" for k in ("LUT", "FF", "DSP", "BRAM")),
      f"{mhz:.1f}", f"{steps / 1e6:.2f}", f"{steps / uses['LUT']:.0f}", f'`{end["to"]}`', sep="\t")
PYTHON
    done
  done
}

# Nodes of rules of text, whether they fit or not; the energy of a particle-step by the band of a technology.
rules() {
  local scene
  printf '%s\t' 'node of' rounds 'cycles per step' LUT FF DSP BRAM 'clock, estimated, MHz' 'steps/s' \
    'nJ per particle-step, cmos45' 'cmos7'
  printf 'RTL\n'
  # Of glass a quarter of the plate: more nodes than can be observed at once are not emitted.
  cp -r "$docs/../scenes/rules" "$work/rules"
  sed -i 's/^max = "\[40, /max = "[10, /' "$work/rules/glass.toml"
  for scene in heat copper glass langevin; do
    "$cuboct" emit "$work/rules/$scene.toml" --out "$work/$scene" > "$work/emit.log"
    "$cuboct" synth "$work/$scene" --target ecp5-85 --no-place > "$work/synth.log" 2>&1 || [ $? = 2 ]
    "$cuboct" energy "$work/rules/$scene.toml" --steps 5 --json > "$work/$scene.energy"
    python3 - "$work" "$scene" "$(digest "$work/$scene")" <<'PYTHON'
import json, sys
work, scene, digest = sys.argv[1:]
read = lambda path: json.load(open(f"{work}/{path}"))
r, project, machine = read(f"{scene}/synth/ecp5-85/node/report.json"), read(f"{scene}/project.json"), read(f"{scene}.energy")["machines"][0]
uses, cycles = r["block"]["uses"], r["cycles_per_step"]["counted"]["mean"]
mhz = r["estimate"]["mhz"] if "estimate" in r else None
energy = [[joules * 1e9 for joules in t["joules_per_particle_step"]] for t in machine["technologies"]]
print(scene, project["rule"]["rounds"], f"{cycles:.0f}", *(f"{uses[k]:,}" for k in ("LUT", "FF", "DSP", "BRAM")),
      f"{mhz:.0f}" if mhz else "-", f"{mhz * 1e6 / cycles:,.0f}" if mhz else "-",
      *(f"{low:.3g} to {high:.3g}" for low, high in energy), digest, sep="\t")
PYTHON
  done
}

# What the calibration's own test prints.
placed() {
  printf '%s\t' 'node of, on LFE5U-25F' 'placed, MHz, by seeds' 'estimated before these were known' 'estimated' error \
    'without this node'
  printf 'error\n'
  "$build/synth_tests" --gtest_filter=Calibration.LeavingANodeOut | sed -n 's/^row\t//p'
}

for target in "${targets[@]}"; do
  case $target in
    small) table=rtl-small-fpgas tools="$yosys, nextpnr-ice40 $(dpkg-query -W -f '${Version}' nextpnr-ice40)" rows=small ;;
    solids) table=halo-clock tools=$yosys rows=solids ;;
    boards) table=board-examples tools="$yosys, nextpnr-ice40 $(dpkg-query -W -f '${Version}' nextpnr-ice40)" rows=boards ;;
    rules) table=synth-rules tools=$yosys rows=rules ;;
    ecp5-placed) table=synth-ecp5-placed tools="placed by nextpnr-ecp5 0.8, netlists by $yosys" rows=placed ;;
    *) table=synth-nodes-$target tools=$yosys rows=nodes ;;
  esac
  { origin "$target" "$tools" && "$rows" "$target"; } > "$work/table"
  cp "$work/table" "$docs/measured/data/$table.tsv"
done
"$docs/tables"
