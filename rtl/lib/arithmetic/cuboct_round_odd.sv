// SPDX-License-Identifier: MIT
// a / 2^Shift, rounded to nearest, halves away from zero: (a + 2^(Shift-1) - (a < 0)) >>> Shift. Odd in a.
// Combinational. The carry out of the bits that go is found from them alone, so that the only adder is as wide as the
// result: with a = h 2^Shift + l it is 1 where l >= 2^(Shift-1) + (a < 0).
module cuboct_round_odd #(
  parameter int InBits  = 8,  // width of a_i, >= 1
  parameter int Shift   = 1,  // >= 0; 0 passes a_i
  parameter int OutBits = 8   // width of y_o; the result is sign-extended or wrapped to it
) (
  input  logic signed [InBits-1:0]  a_i,  // any value
  output logic signed [OutBits-1:0] y_o   // the rounded value modulo 2^OutBits
);
  if (Shift == 0) begin : gen_pass
    cuboct_resize #(.InBits(InBits), .OutBits(OutBits)) u_resize (.a_i, .y_o);
  end else begin : gen_round
    localparam int FullBits = (InBits > Shift) ? InBits : Shift + 1;
    localparam int HighBits = FullBits - Shift + 1;  // a carry may lengthen it

    logic signed [FullBits-1:0] full;
    logic                       half, rest, carry;
    logic signed [HighBits-1:0] rounded;
    assign half = full[Shift-1];
    if (InBits == FullBits) begin : gen_same
      assign full = a_i;
    end else begin : gen_extend
      assign full = {{(FullBits - InBits) {a_i[InBits-1]}}, a_i};
    end
    if (Shift > 1) begin : gen_rest
      assign rest = (full[Shift-2:0] != '0);
    end else begin : gen_no_rest
      assign rest = 1'b0;
    end
    assign carry   = half && (!full[FullBits-1] || rest);
    assign rounded = $signed({full[FullBits-1], full[FullBits-1:Shift]}) + $signed({{(HighBits - 1) {1'b0}}, carry});
    cuboct_resize #(.InBits(HighBits), .OutBits(OutBits)) u_resize (.a_i(rounded), .y_o);
  end
endmodule
