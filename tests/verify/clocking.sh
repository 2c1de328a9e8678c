#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The statements of docs/reference/rtl.md on clock, reset and crossings, of emitted designs; and that each of them, broken in
# a design of a few lines, is found.
# usage: clocking.sh CLOCKING PROGRAM SOURCE SMALL_CASE WORK defects|axi4lite|wishbone|board|CASE
set -euo pipefail
clocking=$1 program=$2 source=$3 small=$4 work=$5 what=$6
rm -rf "$work"
mkdir -p "$work"
cd "$work"
emit() { "$program" emit "$source/scenes/boards/grips.toml" --arch "$source/scenes/archs/board.toml" "$@" --out p > emit.log; }
holds() {  # RESETS_AT_LEAST ARGUMENTS...
  local least=$1
  shift
  (cd p && "$clocking" "$@") | tee out.txt
  [ "$(grep -o '[0-9]* of them' out.txt | cut -d' ' -f1)" -ge "$least" ] || { echo "fewer than $least bits are reset"; exit 1; }
}
case $what in
  axi4lite|wishbone)
    emit --bus "$what"
    # The host's RESET resets the lattice besides.
    holds 500 "cuboct_$what" --reset rst_ni --reset u_machine.lattice_rst_n $(cat p/bus/files.f) ;;
  board)
    emit --board ulx3s
    holds 500 cuboct_board --reset rst_ni --reset u_machine.lattice_rst_n --asynchronous rx_i $(cat p/board/files.f)
    holds 0 cuboct_board_top --reset NONE --asynchronous reset_i $(cat p/board/files.f) ;;
  defects)
    good='module t (input logic clk_i, rst_ni, a_i, input logic [1:0] d_i, output logic q_o, output logic [1:0] e_o);
  logic [1:0] s_q;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) s_q <= 2'"'b00"'; else s_q <= {s_q[0], a_i};
  end
  always_ff @(posedge clk_i) e_o <= d_i;
  assign q_o = s_q[1];
endmodule'
    echo "$good" > t.sv
    "$clocking" t --asynchronous a_i t.sv | tee out.txt
    grep -q '^t: 4 bits of registers, 2 of them reset; as stated$' out.txt
    found() {  # TEXT FROM TO: with TO in place of FROM the design is refused with TEXT
      local text=$1 from=$2 to=$3
      echo "${good/"$from"/"$to"}" > t.sv
      cmp -s t.sv <(echo "$good") && { echo "'$from' is not there"; exit 1; }
      if "$clocking" t --asynchronous a_i t.sv > out.txt 2>&1 || ! grep -qF -- "$text" out.txt; then
        echo "'$to' was not found:"; cat out.txt; exit 1
      fi
    }
    found 'set or reset by more than a clock' '@(posedge clk_i) begin' '@(posedge clk_i or negedge rst_ni) begin'
    found 'a latch' 'always_ff @(posedge clk_i) e_o <= d_i;' 'always_latch if (a_i) e_o <= d_i;'
    found 'at the falling edge' 'always_ff @(posedge clk_i) e_o' 'always_ff @(negedge clk_i) e_o'
    found 'its clock is another one' 'always_ff @(posedge clk_i) e_o' 'always_ff @(posedge a_i) e_o'
    found 'the clock is its B' 'assign q_o = s_q[1];' 'assign q_o = s_q[1] && clk_i;'
    found 'the reset is its B' 'assign q_o = s_q[1];' 'assign q_o = s_q[1] && rst_ni;'
    found 'what is no constant' "s_q <= 2'b00" 's_q <= d_i'
    found 'before it has passed two registers' 'assign q_o = s_q[1];' 'assign q_o = s_q[0];'
    found 'before it has passed two registers' 'assign q_o = s_q[1];' 'assign q_o = a_i;'
    echo "nine defects found" ;;
  *)
    "$small" "$what" p
    holds 100 cuboct_lattice $(cat p/files.f) ;;
esac
