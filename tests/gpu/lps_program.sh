#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# `cuboct-gpu lps` on a plate that cracks: beside the reference, along the run, and where it refuses. Skipped without a device.
# usage: lps_program.sh cuboct-gpu ROOT
set -euo pipefail
program=$1
cd "$2"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
fail() {
  echo "$1"
  cat "$scratch/out" "$scratch/err"
  exit 1
}
code=0
"$program" lps tests/gpu/lps/cracked_glass.toml --repeats 1 --no-energy --rows 4 --compare 20 --points "$scratch/points" \
  >"$scratch/out" 2>"$scratch/err" || code=$?
if grep -q '^no GPU: ' "$scratch/err"; then
  echo "skipped: $(cat "$scratch/err")"
  exit 77
fi
[ "$code" = 0 ] || fail "exit code $code"

value() { sed -n "s/^lps\.$1 \([^ ]*\) .*/\1/p" "$scratch/out"; }
below() { awk -v value="$(value "$1")" -v most="$2" 'BEGIN { exit !(value != "" && value + 0 < most) }' || fail "$1 is not below $2"; }
# As in tests/gpu/lps_tests.cpp; a device contracts products and sums, which makes no more roundings.
for field in displacement velocity; do below "double.${field}_error" 1e-10; done
below double.dilatation_error 1e-9
below double.damage_error 1e-6
below float.displacement_error 1e-5
below float.velocity_error 1e-3
for precision in float double; do
  [ "$(grep -c "^lps.$precision.crack " "$scratch/out")" = 4 ] || fail "not four looks at the crack"
  points=$(grep "^lps.$precision.crack " "$scratch/out" | tail -1 | sed 's/.* s \([0-9]*\) points.*/\1/')
  [ "$points" -gt 50 ] || fail "$points damaged points at the end"
  [ "$(wc -l <"$scratch/points.$precision.tsv")" -gt "$points" ] || fail "fewer lines than damaged points"
  awk -v rate="$(value "$precision.bond_updates_per_second")" 'BEGIN { exit !(rate > 1e5) }' || fail "no rate"
done

refuses() {  # text, arguments
  local text=$1 code=0
  shift
  "$program" lps "$@" >"$scratch/out" 2>"$scratch/err" || code=$?
  [ "$code" = 2 ] || fail "exit code $code and not 2"
  grep -qF -- "$text" "$scratch/err" || fail "not refused by '$text'"
}
refuses 'scenes/coupon.toml: its rule has pairs alone' scenes/coupon.toml
refuses 'scenes/none.toml' scenes/none.toml
refuses '--device: there is no CUDA device 99' tests/gpu/lps/cracked_glass.toml --device 99
refuses '--precision' tests/gpu/lps/cracked_glass.toml --precision half
echo "floats and doubles beside the reference, cracks in both, four refusals"
