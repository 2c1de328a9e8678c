#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# What the command says of faults on links, word for word.
# usage: command.sh ROOT DIRECTORY_OF_CUBOCT
set -euo pipefail
root=$1 cuboct=$2/cuboct
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
scene=$root/scenes/lj_block.toml
for check in retry detect; do printf 'name = "%s"\n[link]\ncheck = "%s"\n' $check $check >$check.toml; done

# expect CODE TEXT COMMAND...: its exit code, and all that it prints on standard output.
expect() {
  local code=$1 text=$2 got=0 printed
  shift 2
  printed=$("$@" 2>errors) || got=$?
  [ $got -eq "$code" ] || { echo "exit code $got, expected $code: $*"; cat errors; exit 1; }
  [ "$printed" = "$text" ] || { printf 'expected:\n%s\nprinted:\n%s\nof %s\n' "$text" "$printed" "$*"; exit 1; }
}
says() { [ "$(cat errors)" = "$1" ] || { printf 'expected:\n%s\non standard error:\n' "$1"; cat errors; exit 1; }; }

expect 0 'matched 1280 updates over 5 steps in 2 engines
systemc: 300 faults injected (52 flipped, 45 dropped, 50 repeated, 153 in acknowledgements), 300 detected, 300 healed' \
  "$cuboct" crosscheck "$scene" --arch retry.toml --steps 5 --engines golden,systemc --inject-faults 300
expect 0 'matched 1280 updates over 5 steps in 3 engines
matched 1080 phase times' \
  "$cuboct" crosscheck "$scene" --arch retry.toml --steps 5 --engines golden,systemc,lattice
expect 1 'systemc: 1 faults injected (0 flipped, 0 dropped, 0 repeated, 1 in acknowledgements), 1 detected, 0 healed
systemc stopped after 1 matched steps: step 1, node of cell 26 at (2, 2, 2), link +z: wrong check of a beat' \
  "$cuboct" crosscheck "$scene" --arch detect.toml --steps 5 --engines golden,systemc --inject-faults 1
# Without a check the comparison finds what went wrong.
if "$cuboct" crosscheck "$scene" --steps 5 --engines golden,systemc --inject-faults 20 --fault-seed 1 >out 2>errors; then
  echo "twenty faults on unchecked links were not seen"; exit 1
fi
grep -q '^mismatch: ' out || { cat out errors; exit 1; }

"$cuboct" run "$scene" --arch retry.toml --engine systemc --steps 5 --inject-faults 0.01 --json >summary.json
for name in injected detected healed; do
  grep -qE "\"faults_$name\": \{?.*[1-9]" summary.json || { echo "no faults_$name"; cat summary.json; exit 1; }
done

expect 2 '' "$cuboct" run "$scene" --engine lattice --inject-faults 2
says '--inject-faults needs an engine that has links
  hint: systemc or rtl'
expect 2 '' "$cuboct" run "$scene" --engine systemc --inject-faults all
says "'all' faults cannot be injected
  hint: give a share of all beats, as 0.001, or their number in the run, as 10000"
