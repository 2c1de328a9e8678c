// SPDX-License-Identifier: MIT
// Signed product with an output register. A module of its own, kept in the hierarchy: synthesis tools that fold the
// adder behind a product into a DSP block get it wrong otherwise. Latency 1 cycle.
(* keep_hierarchy *)
module cuboct_mult #(
  parameter int ABits = 18,  // >= 1
  parameter int BBits = 18   // >= 1
) (
  input  logic                          clk_i,
  input  logic                          en_i,  // p_o keeps its value in a cycle without
  input  logic signed [ABits-1:0]       a_i,
  input  logic signed [BBits-1:0]       b_i,
  output logic signed [ABits+BBits-1:0] p_o
);
  logic signed [ABits+BBits-1:0] p_d, p_q;
  assign p_d = a_i * b_i;
  always_ff @(posedge clk_i) begin
    if (en_i) p_q <= p_d;
  end
  assign p_o = p_q;
endmodule
