// SPDX-License-Identifier: MIT
// Sign extension, or the low bits: two's complement at another width. Wires only.
module cuboct_resize #(
  parameter int InBits  = 8,  // >= 1
  parameter int OutBits = 8   // >= 1
) (
  input  logic signed [InBits-1:0]  a_i,  // any value
  output logic signed [OutBits-1:0] y_o   // a_i modulo 2^OutBits
);
  if (OutBits > InBits) begin : gen_extend
    assign y_o = {{(OutBits - InBits) {a_i[InBits-1]}}, a_i};
  end else if (OutBits == InBits) begin : gen_same
    assign y_o = a_i;
  end else begin : gen_wrap
    logic unused_high;
    assign y_o = a_i[OutBits-1:0];
    assign unused_high = ^a_i[InBits-1:OutBits];
  end
endmodule
