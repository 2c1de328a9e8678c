#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The netlist of a node, with the models of its cells, in the bench of the project: yosys may misbuild silently.
# Then with multipliers that take one operand for unsigned, which the bench has to see: not each of them ever
# gets a negative one.
# usage: gates.sh CUBOCT SOURCES WORK
set -euo pipefail
cuboct=$1 here=$2 work=$3
rm -rf "$work"
mkdir -p "$work"
cd "$work"
export XDG_CACHE_HOME=$work/cache

"$cuboct" emit "$here/sheet.toml" --arch "$here/narrow.toml" --out narrow --vector-steps 2
"$cuboct" synth narrow --target up5k --no-place > printed
grep -q '^node  *1 ' printed
cp narrow/bench/*.hex .
# The unit without its harness.
sed '/^module cuboct_harness/,/^endmodule/d' narrow/synth/up5k/node/netlist.v > netlist.v
grep -q '^module cuboct_node(' netlist.v
models=$(dirname "$(command -v yosys)")/../share/yosys/ice40/cells_sim.v
simulate() {
  iverilog -g2012 -DNO_ICE40_DEFAULT_ASSIGNMENTS -o bench.vvp -s cuboct_bench narrow/rtl/cuboct_pkg.sv \
    narrow/rtl/cuboct_{stage,spread,gather,watch,tree,lattice}.sv "$1" "$models" narrow/bench/cuboct_bench.sv \
    2> log || { cat log; exit 1; }
  vvp -n bench.vvp
}
simulate netlist.v | tee simulated
grep -q '^PASS [1-9][0-9]* comparisons, 2 steps, 4 nodes' simulated

sed "s/\.A_SIGNED(32'd1)/.A_SIGNED(32'd0)/" netlist.v > broken.v
cmp -s netlist.v broken.v && { echo "nothing was broken"; exit 1; }
simulate broken.v > simulated || true
grep -q '^FAIL step [0-9]* node [0-9]' simulated || { echo "a broken netlist passes"; cat simulated; exit 1; }
