#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# projects.sh CUBOCT ROOT DIR: the emitted projects of both boards, with velocities that a host may set and without: no
# lint, no inferred latch, the same bytes twice, and the bench of the lattice passes.
set -euo pipefail
cuboct=$1 root=$2 dir=$3
rm -rf "$dir"
mkdir -p "$dir"
check() {  # NAME ARGUMENTS...
  local project=$dir/$1
  shift
  "$cuboct" emit "$root/scenes/boards/grips.toml" --arch "$arch" --out "$project" --vector-steps 2 "$@" >/dev/null
  "$cuboct" emit "$root/scenes/boards/grips.toml" --arch "$arch" --out "$dir/again" --vector-steps 2 "$@" >/dev/null
  diff -r "$project" "$dir/again"
  (cd "$project" && verilator --lint-only -Wall --top-module cuboct_board_top -f board/files.f)
  (cd "$project" && yosys -q -p "read_verilog -sv $(tr '\n' ' ' < board/files.f); hierarchy -check -top cuboct_board_top; proc; check -assert" > yosys.log)
  ! grep -i latch "$project/yosys.log"
  # The README's instantiation is one.
  awk '/^```systemverilog$/ {inside = 1; next} /^```/ {inside = 0} inside' "$project/README.md" > "$project/my_design.sv"
  (cd "$project" && verilator --lint-only -Wall --top-module my_design $(cat files.f) my_design.sv)
  rm "$project/my_design.sv"
  local port
  for port in $(sed -nE 's/^  (in|out)put +logic +([a-z0-9_]+).*/\2/p' "$project/board/cuboct_board_top.sv"); do
    grep -q "[ \"]$port[ \"]" "$project"/board/pins.* || { echo "no pin for $port"; exit 1; }
  done
}
arch=$root/scenes/archs/board.toml
check icebreaker --board icebreaker --unchecked
check ulx3s --board ulx3s --baud 3000000 --unchecked
check fixed --board ulx3s --fixed-velocities --unchecked
! grep -rq velocity_i "$dir/fixed/rtl/cuboct_lattice.sv"
arch=$root/tests/board/one_node.toml
check brick --board ulx3s --unchecked
make -s -C "$dir/icebreaker/bench" icarus 2>&1 | grep '^PASS [1-9][0-9]* comparisons'
