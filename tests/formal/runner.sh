#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# What tests/formal/prove says of proofs that do not hold, prove nothing, or are written wrongly.
# usage: runner.sh PYTHON PROVE
set -uo pipefail
python=$1 prove=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

cat > counter.sv <<'EOF'
module counter_formal (input logic clk_i, input logic push_i);
  logic running_q = 1'b0;
  always_ff @(posedge clk_i) running_q <= 1'b1;
  logic full, empty;
  logic data;
  always_comb if (push_i) assume (running_q && !full);
  cuboct_fifo #(.Bits(1), .Depth(3)) u_dut (.clk_i, .rst_ni(running_q), .push_i, .data_i(1'b0), .full_o(full),
    .pop_i(1'b0), .data_o(data), .empty_o(empty));
  always_ff @(posedge clk_i) if (running_q) begin
    a_true:  assert (!(full && empty));
    `BODY
    c_full:  cover (full);
    `COVER
  end
endmodule
EOF
table() {  # METHOD DEPTH BODY COVER MUTANT_FIND [MUTANT_REPLACE]: writes the table and the harness
  { echo "\`define BODY $3"; echo "\`define COVER $4"; cat counter.sv; } > harness.sv
  local replace=${6-"assign empty_o = 1'b1;"}
  cat > table.toml <<EOF
[[proof]]
name = "counter"
proves = "a test"
file = "harness.sv"
top = "counter_formal"
lib = ["cuboct_fifo"]
method = "$1"
depth = $2
cover = 8
mutants = [["always", "cuboct_fifo", "a_true", 8, "$5", "$replace"]]
EOF
}
bad=0
expect() {  # STATUS TEXT ARGUMENTS...: the run ends with STATUS and says TEXT
  local status=$1 text=$2
  shift 2
  out=$(PATH=${path:-$PATH} "$python" "$prove" --table table.toml --out out "$@" 2>&1)
  local got=$?
  if [ $got -ne "$status" ] || ! grep -qE -- "$text" <<<"$out"; then
    echo "$*: status $got, not $status, or it does not say '$text':"; echo "$out"; bad=1
  fi
}
find="assign empty_o = empty_q;"

table induction 1 "" "" "$find"
expect 0 '^ok    counter +induction 1, 1 covers' counter
expect 0 '^ok    counter/always +refuted by a_true in cycle 4' counter/always
expect 0 '^ok    counter/always' counter/always --traces
[ -s out/counter_always/bmc.vcd ] || { echo "no trace"; bad=1; }
expect 2 "^prove: no proof 'conter'; --list shows them\$" conter

# A property that does not hold, by each method; one that holds but is not inductive; a cover that is never reached.
for method in induction pdr bmc; do
  table $method 6 "a_false: assert (!full);" "" "$find"
  expect 1 '^FAIL  counter +broken: a_false, see .*/out/counter/bmc.vcd' counter --no-mutants
  [ -s out/counter/bmc.vcd ] || { echo "no trace of the $method"; bad=1; }
done
table induction 1 "a_late: assert (u_q != 2'd3);" "" "$find"
sed -i 's/  logic full, empty;/  logic full, empty; logic [1:0] u_q; always_ff @(posedge clk_i) u_q <= !running_q ? 2'"'"'d0 : (u_q == 2'"'"'d1) ? 2'"'"'d0 : u_q + 2'"'"'d1;/' harness.sv
expect 1 '^FAIL  counter +not inductive at k=1: a_late, see .*/step.vcd' counter --no-mutants
for method in induction pdr bmc; do
  table $method 1 "" "c_never: cover (full && empty);" "$find"
  expect 1 '^FAIL  counter +1 of 2 covers not reached in 8 cycles' counter --no-mutants
done
table combinational 1 "" "" "$find"
expect 1 '^FAIL  counter +not combinational: there are registers' counter --no-mutants

# A mutant that changes nothing that matters, and one whose place is not there.
table pdr 1 "" "" "$find" "assign empty_o = !(count_q != '0);"
expect 1 '^FAIL  counter/always +not seen in 8 cycles' counter
table pdr 1 "" "" "no such line"
expect 1 "^FAIL  counter/always +cuboct_fifo.sv holds 'no such line' 0 times, not once" counter/always
expect 1 "^counter/always: cuboct_fifo.sv holds 'no such line' 0 times, not once" --check
table pdr 1 "" "" "$find"
expect 0 '^1 mutants stand in the library$' --check

# Tables that are wrong.
sed -i '/^mutants/d' table.toml
expect 2 "^prove: table.toml: proof 'counter' has no mutant: a proof that cannot fail proves nothing\$" counter
table guess 1 "" "" "$find"
expect 2 "^prove: table.toml: proof 'counter': method 'guess' is none of induction, pdr, bmc, combinational\$" counter
table pdr 1 "" "" "$find"
sed -i 's/^depth = 1/dept = 1/' table.toml
expect 2 "^prove: table.toml: proof 'counter': unknown key 'dept'\$" counter

table pdr 1 "" "" "$find"
sed -i 's/, 8, /, /' table.toml
expect 2 "^prove: table.toml: proof 'counter': a mutant is \\[name, module, property, cycles, text, other text\\]\$" counter

# A tool that is missing.
table pdr 1 "" "" "$find"
mkdir bin
for program in yosys yosys-smtbmc yosys-abc; do ln -s "$(command -v $program)" bin/; done
python=$("$python" -c 'import sys; print(sys.executable)')
path=$work/bin expect 2 "^prove: no program 'z3': install the Debian package z3\$" counter
exit $bad
