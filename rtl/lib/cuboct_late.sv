// SPDX-License-Identifier: MIT
// The or of two words of which one comes late in the cycle, from a block memory. Tools that map logic to lookup tables
// take what a memory answers to be there when the cycle begins, as a register is, and put what is late in their count
// behind it; kept as a module of its own, the or is the last.
(* keep_hierarchy *)
module cuboct_late #(
  parameter int Bits = 66  // of a word
) (
  input  logic [Bits-1:0] early_i,  // a word
  input  logic [Bits-1:0] late_i,   // that from a memory
  output logic [Bits-1:0] or_o      // of both
);
  assign or_o = early_i | late_i;
endmodule
