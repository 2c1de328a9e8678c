// SPDX-License-Identifier: MIT
// Whether one of two conditions holds, each of which has a part that comes late in the cycle. Tools that map logic to
// lookup tables take what an adder gives to be there when the cycle begins; kept as a module of its own, this is last.
(* keep_hierarchy *)
module cuboct_either (
  input  logic a_early_i,  // the first condition, but for
  input  logic a_late_i,   // its late part
  input  logic b_early_i,  // the second one, but for
  input  logic b_late_i,   // its late part
  output logic or_o        // one of them holds
);
  assign or_o = (a_early_i && a_late_i) || (b_early_i && b_late_i);
endmodule
