#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# ECP5: yosys, then a placer that is not in Debian, here a stand-in that leaves a report; then a report made
# elsewhere.
# usage: ecp5.sh CUBOCT SOURCES WORK
set -euo pipefail
cuboct=$1 here=$2 work=$3
rm -rf "$work"
mkdir -p "$work/bin"
cd "$work"
export XDG_CACHE_HOME=$work/cache
fail() { echo "$1"; exit 1; }

cat > bin/nextpnr-ecp5 <<'FAKE'
#!/bin/sh
[ "$1" = --version ] && { echo '"nextpnr-ecp5" -- stand-in' >&2; exit 0; }
echo "$@" > arguments
test -s netlist.json || exit 3
echo '{"fmax": {"$glbnet$clk_i": {"achieved": 123.5, "constraint": 150.0}}, "utilization": {}}' > timing.json
echo bits > unit.config
FAKE
cat > bin/ecppack <<'FAKE'
#!/bin/sh
cp unit.config unit.bit
FAKE
chmod +x bin/*
"$cuboct" emit "$here/sheet.toml" --arch "$here/narrow.toml" --out narrow --vector-steps 1
PATH=$work/bin:$PATH "$cuboct" synth narrow --target ecp5-25 --unit pipe --seed 7 --json > printed
results=narrow/synth/ecp5-25/pipe
cmp printed $results/report.json
for file in netlist.json netlist.v place.sh timing.json unit.bit yosys.log; do
  [ -s $results/$file ] || fail "no $file"
done
kept=$(ls cache/cuboct/synth | wc -l)
[ "$kept" = 4 ] || fail "of elaboration, synthesis, estimate and placement $kept are kept"
for argument in --25k '--package CABGA381' '--seed 7' '--top cuboct_harness' '--freq 150'; do
  grep -qF -- "$argument" $results/arguments || fail "nextpnr-ecp5 was not asked for $argument"
done
python3 - $results/report.json <<'PYTHON'
import json, sys
r = json.load(open(sys.argv[1]))
assert r["fmax_mhz"] == 123.5 and r["fmax_from"] == "nextpnr-ecp5, seed 7", r
assert r["tools"][1] == '"nextpnr-ecp5" -- stand-in', r["tools"]
assert r["block"]["uses"]["DSP"] == 5, r["block"]
assert r["fit"] == {"units": 4, "limit": "DSP"}, r["fit"]  # 75 % of 28 are 21
assert 3 < r["depth"] < 100, r["depth"]
# Register, multiplier, register: no pipe of products is faster.
e = r["estimate"]
assert 40 < e["mhz"] < 1000 / (0.525 + 4.041), e
assert abs(e["error"] - (e["mhz"] / 123.5 - 1)) < 1e-6 and 0 < e["wires_ns"] < e["ns"], e
assert e["path"][0].endswith("_Q") or "DP16KD" in e["path"][0], e["path"]
used = r["used"]
def report(ffs):
    clocks = {"fast": {"achieved": 140.25, "constraint": 150}, "slow": {"achieved": 133.5, "constraint": 150}}
    return {"fmax": clocks,
            "utilization": {k: {"used": n, "available": 999999} for k, n in
                            {"TRELLIS_FF": ffs, "MULT18X18D": used["DSP"], "DP16KD": used["BRAM"]}.items()}}
json.dump(report(used["FF"]), open("same.json", "w"))
json.dump(report(used["FF"] + 1), open("other.json", "w"))
json.dump({"ffs": used["FF"]}, open("ffs.json", "w"))
PYTHON
ffs=$(tr -dc 0-9 < ffs.json)
code=0
"$cuboct" synth narrow --target ecp5-25 --unit pipe --timing other.json > printed 2> said || code=$?
[ $code = 2 ] || fail "another netlist's report was taken"
diff said - <<SAID
other.json: is of another netlist: $((ffs + 1)) TRELLIS_FF there, $ffs here
  hint: place the netlist.json that is here
SAID
"$cuboct" synth narrow --target ecp5-25 --unit pipe --timing same.json > printed
grep -qx 'Fmax                   133.50 MHz (nextpnr-ecp5, elsewhere)' printed || fail "$(cat printed)"
grep -q '"achieved": 133.5' $results/timing.json || fail "the report was not kept"
