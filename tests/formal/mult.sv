// SPDX-License-Identifier: MIT
// cuboct_mult of one cycle or two: the product of every pair of operands, signed, is there Cycles cycles after en_i and
// stays, whatever the operands become, until that of the next pair.
module mult_formal #(
  parameter int ABits  = 3,
  parameter int BBits  = 4,
  parameter int Cycles = 2   // 1 or 2
) (
  input logic                    clk_i,
  input logic                    en_i,
  input logic signed [ABits-1:0] a_i,
  input logic signed [BBits-1:0] b_i
);
  localparam int Bits = ABits + BBits;

  logic signed [Bits-1:0] product;
  cuboct_mult #(.ABits(ABits), .BBits(BBits), .Cycles(Cycles)) u_dut (
    .clk_i, .rst_ni(1'b1), .en_i, .a_i, .b_i, .p_o(product)
  );

  logic                   some_q = 1'b0, due_q = 1'b0;  // a pair came; its product is due
  logic                   en_q = 1'b0, again_q = 1'b0;
  logic signed [Bits-1:0] first_q, expected_q;
  always_ff @(posedge clk_i) begin
    some_q  <= some_q || en_i;
    en_q    <= en_i;
    again_q <= en_i && en_q;
    if (en_i) first_q <= a_i * b_i;
    if (Cycles == 1) begin
      due_q <= some_q || en_i;
      if (en_i) expected_q <= a_i * b_i;
    end else begin
      due_q <= some_q;
      if (en_q) expected_q <= first_q;
    end
  end
  always_ff @(posedge clk_i) begin
    if (due_q) a_product: assert (product == expected_q);
    c_least: cover (due_q && product == {2'b01, {(Bits - 2) {1'b0}}});
    c_kept:  cover (due_q && !en_q && !en_i && product == '1);
    c_again: cover (due_q && again_q && product != '0);
  end
endmodule
