// SPDX-License-Identifier: MIT
// The or of three words of which two come late in the cycle, from block memories. Tools that map logic to lookup tables
// take what a memory answers to be there when the cycle begins, as a register is, and put what is late in their count
// behind it; kept as a module of its own, the or is the last.
(* keep_hierarchy *)
module cuboct_late #(
  parameter int Bits = 66  // of a word
) (
  input  logic [Bits-1:0] early_i,  // a word
  input  logic [Bits-1:0] late_i,   // from a memory
  input  logic [Bits-1:0] other_i,  // from another memory
  output logic [Bits-1:0] or_o      // of all
);
  assign or_o = early_i | late_i | other_i;
endmodule
