// SPDX-License-Identifier: MIT
// cuboct_axis_mults: every axis' product is there after en_i, Axes cycles later where one multiplier serves them in
// turn, else Product cycles later, and stays up to the next en_i.
module axis_mults_formal #(
  parameter int Axes    = 3,
  parameter int Shared  = 1,
  parameter int Held    = 0,
  parameter int Product = 1,
  parameter int ABits   = 2,
  parameter int BBits   = 2
) (
  input logic                  clk_i,
  input logic                  en_i,
  input logic [Axes*ABits-1:0] a_i,
  input logic [Axes*BBits-1:0] b_i
);
  localparam int Bits   = ABits + BBits;
  localparam int Cycles = (Shared != 0) ? Axes : Product;

  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;

  logic [Axes*Bits-1:0] products;
  cuboct_axis_mults #(
    .Axes(Axes), .Shared(Shared), .ABits(ABits), .BBits(BBits), .Product(Product), .Held(Held)
  ) u_dut (.clk_i, .rst_ni(running_q), .en_i, .a_i, .b_i, .p_o(products));

  // The operands, which stay for as long as the block asks for.
  logic                  some_q, busy;
  logic [3:0]            age_q;  // cycles since en_i, as far as it counts
  logic [Axes*ABits-1:0] a_q;
  logic [Axes*BBits-1:0] b_q;
  assign busy = some_q && age_q < Cycles[3:0];
  always_comb begin
    if (en_i) assume (running_q && !busy);
    if (busy && (Held != 0 || Product > 1)) assume (a_i == a_q);
    if (busy && Held != 0) assume (b_i == b_q);
  end
  always_ff @(posedge clk_i) begin
    if (!running_q) some_q <= 1'b0;
    else if (en_i) some_q <= 1'b1;
    if (en_i) begin
      a_q   <= a_i;
      b_q   <= b_i;
      age_q <= 4'd1;
    end else if (age_q != Cycles[3:0]) begin
      age_q <= age_q + 1'b1;
    end
  end

  logic [Axes-1:0] right;
  for (genvar k = 0; k < Axes; k++) begin : gen_axis
    logic signed [ABits-1:0] one;
    logic signed [BBits-1:0] other;
    logic signed [Bits-1:0]  product;
    assign one      = a_q[k*ABits +: ABits];
    assign other    = b_q[k*BBits +: BBits];
    assign product  = one * other;
    assign right[k] = (products[k*Bits +: Bits] == product);
  end
  always_ff @(posedge clk_i) begin
    if (running_q && some_q) begin
      a_product: assert (busy || right == '1);
      c_again:   cover (!busy && en_i && a_i != a_q && products != '0);
      c_stays:   cover (!busy && !en_i && a_i != a_q && products[Bits-1:0] != products[Bits +: Bits]);
    end
  end
endmodule
