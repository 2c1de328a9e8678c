#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The whole flow for an iCE40UP5K on the pipe of a narrow machine; a wider one is refused; an interrupt leaves
# nothing.
# usage: ice40.sh CUBOCT SOURCES WORK
set -euo pipefail
cuboct=$1 here=$2 work=$3
rm -rf "$work"
mkdir -p "$work"
cd "$work"
export XDG_CACHE_HOME=$work/cache
fail() { echo "$1"; exit 1; }

"$cuboct" emit "$here/sheet.toml" --arch "$here/narrow.toml" --out narrow --vector-steps 1
"$cuboct" synth narrow --target up5k --unit pipe --quiet > printed 2> said || { cat said; exit 1; }
[ ! -s said ] || fail "not quiet: $(cat said)"
results=narrow/synth/up5k/pipe
[ "$(ls narrow/synth/up5k)" = pipe ] || fail "more than the results: $(ls narrow/synth/up5k)"
diff <(sed '$d' printed) $results/table.txt || fail "what is printed is not what is stored"
[ "$(stat -c %s $results/unit.bin)" = 104090 ] || fail "the bitstream is not as long as that of an UP5K"
python3 - $results/report.json <<'PYTHON'
import json, os, sys
r = json.load(open(sys.argv[1]))
def sums(block):
    parts = [sums(b) for b in block.get("blocks", [])]
    uses = block["uses"]
    assert all(sum(p[k] for p in parts) <= uses[k] for k in uses), block["module"]
    return uses
uses = sums(r["block"])
# Two squares, the table's slope, two products of the strength: one multiplier each.
assert uses["DSP"] == 5, uses
axes = [b for b in r["block"]["blocks"] if b["module"] == "cuboct_axis_mults"][0]
mult = [b for b in axes["blocks"] if b["module"] == "cuboct_mult"][0]
assert mult["instances"] == 4 and mult["uses"]["DSP"] == 4, mult
assert uses["BRAM"] >= 1 and uses["LUT"] > 100 and uses["FF"] > 100, uses
# The harness is flip-flops, and one LUT for three outputs.
assert r["used"]["FF"] == uses["FF"] + r["harness_flip_flops"], r["used"]
assert uses["FF"] <= r["logic_cells"] <= uses["LUT"] + uses["FF"] + 200, r["logic_cells"]
# Two tools that know the device's delays.
fmax = r["fmax_mhz"]
assert 25 < fmax < 120 and abs(r["icetime_mhz"] / fmax - 1) < 0.2, (fmax, r["icetime_mhz"])
# What was estimated before placing.
assert abs(r["estimate"]["error"]) < 0.25, r["estimate"]
assert abs(r["estimate"]["mhz"] / fmax - 1 - r["estimate"]["error"]) < 1e-6
assert r["critical_path"] and "steps_per_second" not in r
assert r["files"] == sorted(os.listdir(os.path.dirname(sys.argv[1]))), r["files"]
PYTHON

# Products of 18 bits take four multipliers each.
sed 's/^position_frac = .*/position_frac = 20/; s/^difference_frac = .*/difference_frac = 17/;
     s/^velocity_bits = .*/velocity_bits = 23/; s/^sum_bits = .*/sum_bits = 23/' \
  "$here/narrow.toml" > wide.toml
"$cuboct" emit "$here/sheet.toml" --arch wide.toml --out wide --vector-steps 1
code=0
"$cuboct" synth wide --target up5k --unit pipe > printed 2> said || code=$?
[ $code = 2 ] && [ ! -s printed ] || fail "not refused: $code"
grep -qE '^pipe does not fit up5k: LUT [0-9]+/5280, FF [0-9]+/5280, DSP (9|1[0-9])/8, BRAM [0-9]+/30$' said ||
  fail "refused in other words: $(cat said)"
grep -qx '  hint: ecp5-25 has room for what it takes here' said || fail "no device named: $(cat said)"
grep -q '^Fmax  *not known: not placed$' wide/synth/up5k/pipe/table.txt || fail "what it takes was not stored"

# An interrupt while yosys works.
"$cuboct" synth wide --target hx8k > printed 2> said &
child=$!
until ls wide/synth/hx8k/*/yosys.log > found 2>&1; do
  kill -0 $child 2> gone || fail "it ended before yosys began: $(cat said printed)"
  sleep 0.1
done
kill -INT $child
code=0
wait $child || code=$?
[ $code = 1 ] || fail "an interrupt: exit $code"
grep -qx 'interrupted; nothing was written' said || fail "an interrupt: $(cat said)"
[ -z "$(ls wide/synth/hx8k)" ] || fail "an interrupt leaves $(ls wide/synth/hx8k)"
