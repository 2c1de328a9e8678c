// SPDX-License-Identifier: MIT
// The input, Depth cycles later. No reset: what travels beside it says whether it counts.
module cuboct_delay #(
  parameter int Bits  = 8,  // >= 1
  parameter int Depth = 1   // cycles, >= 0
) (
  input  logic            clk_i,
  input  logic [Bits-1:0] d_i,  // in cycle t
  output logic [Bits-1:0] q_o   // in cycle t + Depth
);
  if (Depth == 0) begin : gen_wire
    logic unused_clk;
    assign unused_clk = clk_i;
    assign q_o = d_i;
  end else if (Depth == 1) begin : gen_one
    always_ff @(posedge clk_i) q_o <= d_i;
  end else begin : gen_more
    logic [Depth*Bits-1:0] stages_q;  // the newest lowest
    always_ff @(posedge clk_i) stages_q <= {stages_q[(Depth-1)*Bits-1:0], d_i};
    assign q_o = stages_q[Depth*Bits-1 -: Bits];
  end
endmodule
