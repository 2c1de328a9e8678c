// SPDX-License-Identifier: MIT
// cuboct_round_odd against its meaning, for every input: |a| / 2^Shift rounded to nearest, halves up, with
// a's sign; so it is odd. Combinational: one cycle is all of it.
module round_odd_formal #(
  parameter int InBits  = 8,
  parameter int Shift   = 3,
  parameter int OutBits = 8
) (
  input logic              clk_i,
  input logic [InBits-1:0] a_i
);
  localparam int Bits = InBits + Shift + OutBits + 2;

  logic [OutBits-1:0] y, y_minus;
  cuboct_round_odd #(.InBits(InBits), .Shift(Shift), .OutBits(OutBits)) u_dut (.a_i(a_i), .y_o(y));
  logic [InBits-1:0] minus;
  assign minus = -a_i;
  cuboct_round_odd #(.InBits(InBits), .Shift(Shift), .OutBits(OutBits)) u_minus (.a_i(minus), .y_o(y_minus));

  logic [Bits-1:0] wide, size, quotient, rest, rounded, result;
  assign wide     = {{(Bits - InBits) {a_i[InBits-1]}}, a_i};
  assign size     = a_i[InBits-1] ? -wide : wide;
  assign quotient = size >> Shift;
  assign rest     = size - (quotient << Shift);
  // The rest is at least half of 2^Shift; with Shift 0 there is none.
  assign rounded  = ((rest << 1) >= ({{(Bits - 1) {1'b0}}, 1'b1} << Shift)) ? quotient + 1'b1 : quotient;
  assign result   = a_i[InBits-1] ? -rounded : rounded;

  always_ff @(posedge clk_i) begin
    a_value: assert (y == result[OutBits-1:0]);
    // -2^(InBits-1) has no negative.
    if (minus != a_i || a_i == '0) a_odd: assert (y_minus == -y);
    c_half: cover (a_i[InBits-1] && (Shift == 0 || Shift >= InBits
                   || (rest << 1) == ({{(Bits - 1) {1'b0}}, 1'b1} << Shift)));
  end
endmodule
