// SPDX-License-Identifier: MIT
// A register of cuboct_spread or cuboct_gather. It stays a module of its own in a netlist: tools merge registers with
// the same input, and then one register would drive what several are for.
(* keep_hierarchy *)
module cuboct_stage #(
  parameter int Flags = 1,  // bits with a reset, >= 1
  parameter int Bits  = 8   // bits without, >= 1
) (
  input  logic             clk_i,
  input  logic             rst_ni,
  input  logic [Flags-1:0] flags_i,  // of cycle t
  input  logic [Bits-1:0]  data_i,   // of cycle t
  output logic [Flags-1:0] flags_o,  // in cycle t + 1; zeros after a reset
  output logic [Bits-1:0]  data_o    // in cycle t + 1
);
  always_ff @(posedge clk_i) begin
    if (!rst_ni) flags_o <= '0;
    else flags_o <= flags_i;
  end
  always_ff @(posedge clk_i) data_o <= data_i;
endmodule
