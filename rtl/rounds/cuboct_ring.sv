// SPDX-License-Identifier: MIT
// The input, Depth cycles later, in a small memory that is written around: for words that wait long.
module cuboct_ring #(
  parameter int Bits  = 8,  // >= 1
  parameter int Depth = 3   // cycles, >= 2
) (
  input  logic            clk_i,
  input  logic            rst_ni,
  input  logic [Bits-1:0] d_i,  // in cycle t
  output logic [Bits-1:0] q_o   // in cycle t + Depth
);
  localparam int PlaceBits = (Depth > 2) ? $clog2(Depth) : 1;
  localparam int Behind    = Depth - 1;
  (* no_rw_check *) logic [Bits-1:0] mem_q [0:(1<<PlaceBits)-1];
  logic [PlaceBits-1:0] place_q, read_place;
  assign read_place = place_q - Behind[PlaceBits-1:0];
  always_ff @(posedge clk_i) begin
    if (!rst_ni) place_q <= '0;
    else place_q <= place_q + 1'b1;
  end
  always_ff @(posedge clk_i) mem_q[place_q] <= d_i;
  always_ff @(posedge clk_i) q_o <= mem_q[read_place];
endmodule
