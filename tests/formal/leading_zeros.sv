// SPDX-License-Identifier: MIT
// cuboct_leading_zeros against its meaning, for every input: the bit below so many zeros is set, and those are
// zeros. Combinational: one cycle is all of it.
module leading_zeros_formal #(
  parameter int  CountBits = 3,
  localparam int Bits      = 1 << CountBits
) (
  input logic            clk_i,
  input logic [Bits-1:0] a_i
);
  logic [CountBits-1:0] zeros;
  cuboct_leading_zeros #(.CountBits(CountBits)) u_dut (.a_i(a_i), .zeros_o(zeros));

  // The leading one at the top; what stands above it is lost.
  logic [Bits-1:0] raised;
  assign raised = a_i << zeros;

  always_ff @(posedge clk_i) begin
    a_none: assert (a_i != '0 || zeros == '1);
    a_leading: assert (a_i == '0 || raised[Bits-1]);
    a_above: assert ((raised >> zeros) == a_i);
    c_last: cover (zeros == '1 && a_i != '0);
  end
endmodule
