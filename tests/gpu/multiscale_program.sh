#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# `cuboct multiscale --gpu` beside `cuboct multiscale`: results, a run that is cut and goes on with the other engine, a comparison,
# and what is refused. Skipped without a device.
# usage: multiscale_program.sh cuboct cuboct-gpu
set -euo pipefail
scratch=$(mktemp -d "$(dirname "$1")/multiscale-XXXXXX")
trap 'rm -rf "$scratch"' EXIT
# Side by side under the names that a user has them by, wherever this build has them.
ln "$1" "$scratch/cuboct"
ln "$(dirname "$1")/cuboct-study" "$scratch"
ln "$2" "$scratch/cuboct-gpu"
cd "$scratch"
fail() {
  echo "$1"
  cat out err
  exit 1
}
material='[material]
potential = "si_multiscale"
edge = "5.43 angstrom"
mass = "28.0855 u"
cells = 1
'
grains='[grains]
cubes = 1
'
printf '%s' "$material" '[mesh]
cubes = [2, 2, 2]
size = "[1, 1, 1] um"
repeats = "x"
' "$grains" '[stretch]
axis = "x"
strains = [0.001, 0.002, 0.003]
' >bar.toml
printf '%s' "$material" '[mesh]
cubes = [12, 1, 1]
size = "[12, 1, 1] um"
[samples]
strain_tolerance = 2e-5
[wave]
along = "x"
peak = "10 MPa"
pulse = "0.3 ns"
' >rod.toml
cp bar.toml compare.toml
printf '[compare]\nrefine = [1, 2]\n' >>compare.toml

code=0
./cuboct multiscale bar.toml --gpu --out gpu.bar --json >out 2>err || code=$?
if grep -q 'no GPU: ' err; then
  echo "skipped: $(cat err)"
  exit 77
fi
[ "$code" = 0 ] || fail "exit code $code"
./cuboct multiscale rod.toml --gpu --out gpu.rod --json >out 2>err || fail "the rod failed"
./cuboct multiscale compare.toml --gpu --out gpu.compare --json >out 2>err || fail "the comparison failed"
for study in bar rod; do ./cuboct multiscale $study.toml --out cpu.$study >out 2>err; done
./cuboct multiscale compare.toml --out cpu.compare >out 2>err

# Samples are at rest to 1e-6 eV/angstrom of the 1e-2 that a strain of 1e-3 puts on their atoms: stresses are good to 1e-4 where the
# engines' steps part, and to roundings where they do not. Relaxations and evaluations are those of the same steps.
python3 - <<'END'
import json
def of(path):
    return {key: entry["value"] for key, entry in json.load(open(path + "/summary.json")).items()}
def near(name, a, b, part):
    assert abs(a - b) <= part * abs(b), (name, a, b)
for study, names in ("bar", ("modulus", "Poisson_ratio")), ("rod", ("wave_speed",)):
    gpu, cpu = of("gpu." + study), of("cpu." + study)
    for name in names:
        near(name, gpu[name], cpu[name], 1e-6)
    assert gpu["stress_updates"] == cpu["stress_updates"]
    near("relaxations", gpu["relaxations"], cpu["relaxations"], 1e-3)
    near("atom steps", gpu["atom_steps"], cpu["atom_steps"], 1e-2)
for a, b in zip(of("gpu.compare")["points"], of("cpu.compare")["points"], strict=True):
    near("compare", a["modulus"], b["modulus"], 1e-6)
END
[ -s gpu.rod/front.tsv ] || fail "no front"

# A run that is cut leaves its progress, and goes on with either engine (sample_relaxer_tests.cpp has the other way). The moment to cut
# is between the start of the program and the end of the run, wherever these are here.
sed 's/\[12, 1, 1\]/[200, 1, 1]/; s/12, 1, 1/200, 1, 1/; s/cells = 1/cells = 2/' rod.toml >long.toml
for delay in 0.1 0.15 0.22 0.33 0.5 0.75 1.1 1.7 2.5 4 6; do
  rm -rf cut
  ./cuboct multiscale long.toml --gpu --out cut >out 2>err &
  pid=$!
  sleep $delay
  kill -TERM $pid 2>/dev/null || true
  code=0
  wait $pid || code=$?
  [ "$code" != 0 ] && [ -e cut/progress ] && break
done
[ "$code" = 1 ] || fail "a cut run's exit code is $code"
grep -q '^interrupted; the same command goes on where it was' err || fail "a cut run does not say so"
[ -e cut/progress ] || fail "nothing was left to go on from"
[ ! -e cut/progress.error ] || fail "a file is left"
./cuboct multiscale long.toml --out cut >out 2>err || fail "the rest failed"
./cuboct multiscale long.toml --out whole >out 2>err
python3 - <<'END'
import json
cut, whole = (json.load(open(path + "/summary.json"))["wave_speed"]["value"] for path in ("cut", "whole"))
assert abs(cut / whole - 1) < 1e-6, (cut, whole)
END

refuses() {  # exit code, text, arguments
  local expected=$1 text=$2 code=0
  shift 2
  ./cuboct multiscale "$@" >out 2>err || code=$?
  [ "$code" = "$expected" ] || fail "exit code $code and not $expected"
  grep -qF -- "$text" err || fail "not refused by '$text'"
}
sed 's/potential = .*/springs = { C11 = "165 GPa", C12 = "63 GPa", C44 = "78 GPa" }/' bar.toml >springs.toml
refuses 2 'springs.toml: --gpu: samples on a GPU are of Tersoff' springs.toml --gpu
sed 's/peak = .*/peak = "500 GPa"/' rod.toml >torn.toml
refuses 1 'element ' torn.toml --gpu --out torn
echo '# another' >>bar.toml
refuses 2 'is the progress of another study' bar.toml --gpu --out gpu.bar
rm cuboct-gpu
refuses 2 '--gpu: there is no program cuboct-gpu beside this one' bar.toml --gpu --out none
echo "two studies and a comparison beside the host's, a run that was cut and changed its engine, four refusals"
