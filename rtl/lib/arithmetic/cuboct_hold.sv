// SPDX-License-Identifier: MIT
// What belongs to a pair, Depth cycles later, where pairs come at least Interval cycles after one another and the input
// stays for Interval cycles: a register per Interval then does what a chain of Depth would. Registers load with pairs
// alone, so that their clock can rest between.
module cuboct_hold #(
  parameter int Bits     = 8,  // >= 1
  parameter int Depth    = 1,  // cycles, >= 0
  parameter int Interval = 1   // cycles, >= 1
) (
  input  logic            clk_i,
  input  logic [Depth:0]  valid_i,  // [k]: the pair whose input came k cycles ago is there
  input  logic [Bits-1:0] d_i,      // of the pair with valid_i[0]
  // Of that pair in a cycle with valid_i[Depth]; where registers hold it, N of them, from valid_i[N Interval] on until
  // the next pair's.
  output logic [Bits-1:0] q_o
);
  localparam int Registers = Depth / Interval;
  logic unused_valid;
  assign unused_valid = ^valid_i;
  if (Registers == 0) begin : gen_wire
    logic unused_clk;
    assign unused_clk = clk_i;
    assign q_o = d_i;
  end else begin : gen_hold
    logic [(Registers+1)*Bits-1:0] stages;
    assign stages[Bits-1:0] = d_i;
    for (genvar r = 0; r < Registers; r++) begin : gen_register
      logic [Bits-1:0] held_q;
      always_ff @(posedge clk_i) begin
        if (valid_i[(r+1)*Interval-1]) held_q <= stages[r*Bits +: Bits];
      end
      assign stages[(r+1)*Bits +: Bits] = held_q;
    end
    assign q_o = stages[Registers*Bits +: Bits];
  end
endmodule
