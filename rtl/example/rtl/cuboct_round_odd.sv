// SPDX-License-Identifier: MIT
// a / 2^Shift, rounded to nearest, halves away from zero: (a + 2^(Shift-1) - (a < 0)) >>> Shift. Odd in a. Combinational.
module cuboct_round_odd #(
  parameter int InBits  = 8,  // width of a_i, >= 1
  parameter int Shift   = 1,  // >= 0; 0 passes a_i
  parameter int OutBits = 8   // width of y_o; the result is sign-extended or wrapped to it
) (
  input  logic signed [InBits-1:0]  a_i,
  output logic signed [OutBits-1:0] y_o
);
  // One bit for the carry of the half and one so that the half itself stays positive.
  localparam int FullBits = ((InBits > Shift) ? InBits : Shift) + 2;

  logic signed [FullBits-1:0] full;
  if (Shift == 0) begin : gen_pass
    assign full = {{(FullBits - InBits) {a_i[InBits-1]}}, a_i};
  end else begin : gen_round
    localparam logic signed [FullBits-1:0] Half = {{(FullBits - 1) {1'b0}}, 1'b1} << (Shift - 1);
    logic signed [FullBits-1:0] biased;
    assign biased = $signed({{(FullBits - InBits) {a_i[InBits-1]}}, a_i}) + Half
                  + $signed({FullBits{a_i[InBits-1]}});
    assign full = biased >>> Shift;
  end

  cuboct_resize #(.InBits(FullBits), .OutBits(OutBits)) u_resize (.a_i(full), .y_o(y_o));
endmodule
