#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The GPU engine's kernels under compute-sanitizer: short runs of each kind, each under each tool. Skipped without a device.
# usage: device.sh cuboct-gpu ROOT [TOOL...]; TOOL is memcheck, racecheck, initcheck or synccheck
set -euo pipefail
program=$1
cd "$2"
shift 2
tools=("$@")
[ ${#tools[@]} -gt 0 ] || tools=(memcheck racecheck synccheck)  # initcheck reports padding of structures that are copied whole
skip() {
  echo "skipped: $1"
  exit 77
}
sanitizer=$(PATH=$PATH:/usr/local/cuda/bin command -v compute-sanitizer) || skip "no compute-sanitizer"
"$program" --list >/dev/null 2>&1 || skip "no GPU"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# What runs: lists of pairs kept and made anew, blocks that stay and a launch each, slabs of one device, rules of text, the solid
# of peridynamics, several runs at once.
cases=("pair $PWD/scenes/lj_block.toml --out $scratch/trace.h5 --steps 30"
  "pair_float $PWD/scenes/lj_block.toml --out $scratch/trace.h5 --steps 30 --precision float"
  "damped $PWD/scenes/coupon.toml --out $scratch/trace.h5 --steps 30"
  "damped_double $PWD/scenes/coupon.toml --out $scratch/trace.h5 --steps 30 --precision double"
  "slabs $PWD/scenes/bench/block_32k.toml --out $scratch/trace.h5 --steps 6 --devices 0,0"
  "slabs_float $PWD/scenes/bench/block_32k.toml --out $scratch/trace.h5 --steps 6 --devices 0,0 --precision float"
  "copper $PWD/scenes/rules/copper.toml --out $scratch/trace.h5 --steps 6"
  "copper_float $PWD/scenes/rules/copper.toml --out $scratch/trace.h5 --steps 6 --precision float"
  "glass $PWD/scenes/rules/glass.toml --out $scratch/trace.h5 --steps 6"
  "heat_slabs $PWD/scenes/rules/heat.toml --out $scratch/trace.h5 --steps 6 --devices 0,0"
  "langevin_double $PWD/scenes/rules/langevin.toml --out $scratch/trace.h5 --steps 6 --precision double"
  "lps lps $PWD/tests/gpu/lps/cracked_glass.toml --repeats 1 --no-energy --rows 2"
  "many many --at-once 4")
printf '["scenes/coupon.toml", "--steps", "20", "--out", "%s"]\n' "$scratch"/{1,2,3,4}.h5 >"$scratch/many"
failed=0
for tool in "${tools[@]}"; do
  for case in "${cases[@]}"; do
    read -r name words <<<"$case"
    begin=$SECONDS code=0
    # shellcheck disable=SC2086
    timeout 300 "$sanitizer" --tool "$tool" --error-exitcode 9 --print-limit 3 "$program" $words <"$scratch/many" >"$scratch/said" 2>&1 || code=$?
    if [ "$code" = 0 ] && grep -q "ERROR SUMMARY: 0 errors\|RACECHECK SUMMARY: 0 hazards" "$scratch/said"; then
      echo "$tool $name: clean, $((SECONDS - begin)) s"
    elif grep -q "Device not supported" "$scratch/said"; then
      skip "compute-sanitizer does not support this device"
    else
      failed=1
      echo "$tool $name: exit code $code"
      tail -40 "$scratch/said"
    fi
  done
done
exit $failed
