// SPDX-License-Identifier: MIT
// The input, Depth cycles later. No reset: what travels beside it says whether it counts.
module cuboct_delay #(
  parameter int Bits  = 8,  // >= 1
  parameter int Depth = 1   // cycles, >= 0
) (
  input  logic            clk_i,
  input  logic [Bits-1:0] d_i,
  output logic [Bits-1:0] q_o
);
  if (Depth == 0) begin : gen_wire
    logic unused_clk;
    assign unused_clk = clk_i;
    assign q_o = d_i;
  end else begin : gen_stages
    logic [Bits-1:0] stage_q [0:Depth-1];
    for (genvar s = 0; s < Depth; s++) begin : gen_stage
      if (s == 0) begin : gen_first
        always_ff @(posedge clk_i) stage_q[s] <= d_i;
      end else begin : gen_next
        always_ff @(posedge clk_i) stage_q[s] <= stage_q[s-1];
      end
    end
    assign q_o = stage_q[Depth-1];
  end
endmodule
