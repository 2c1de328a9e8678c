// SPDX-License-Identifier: MIT
// cuboct_mult with more than one cycle: the product of every pair of operands, signed, is there Cycles cycles after
// en_i and stays up to the next en_i. Between the two it holds the product by those bits of b that were added up.
module serial_mult_formal #(
  parameter int ABits  = 3,
  parameter int BBits  = 4,
  parameter int Cycles = 5
) (
  input logic                    clk_i,
  input logic                    en_i,
  input logic signed [ABits-1:0] a_i,
  input logic signed [BBits-1:0] b_i
);
  localparam int CountBits = $clog2(BBits + 1);
  localparam int Bits      = ABits + BBits;

  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;

  logic signed [Bits-1:0] product;
  cuboct_mult #(.ABits(ABits), .BBits(BBits), .Cycles(Cycles)) u_dut (
    .clk_i, .rst_ni(running_q), .en_i, .a_i, .b_i, .p_o(product)
  );

  // Operands as they were with en_i; a_i stays for Cycles cycles, in which no other en_i comes.
  logic                    some_q;
  logic [4:0]              age_q;  // cycles since en_i, as far as it counts
  logic signed [ABits-1:0] a_q;
  logic signed [BBits-1:0] b_q;
  always_comb begin
    if (en_i) assume (running_q && (!some_q || age_q >= Cycles[4:0]));
    if (some_q && age_q < Cycles[4:0]) assume (a_i == a_q);
  end
  always_ff @(posedge clk_i) begin
    if (!running_q) some_q <= 1'b0;
    else if (en_i) some_q <= 1'b1;
    if (en_i) begin
      a_q   <= a_i;
      b_q   <= b_i;
      age_q <= 5'd1;
    end else if (age_q != Cycles[4:0]) begin
      age_q <= age_q + 1'b1;
    end
  end

  // Helper: after n bits, 0 to BBits, the register's upper ABits + n bits are a times the lower n bits of b (all of
  // them: signed), its lower ones are what is left of b.
  (* keep *) logic [CountBits-1:0] tap_left;
  logic [4:0]                      bits;
  logic signed [Bits-1:0]          part;
  logic [BBits-1:0]                low;
  assign bits = BBits[4:0] - {{(5 - CountBits) {1'b0}}, tap_left};
  assign low  = b_q & ~({BBits {1'b1}} << bits);
  assign part = (bits == BBits[4:0]) ? a_q * b_q
              : $signed({{BBits {a_q[ABits-1]}}, a_q}) * $signed({{ABits {1'b0}}, low});
  always_ff @(posedge clk_i) begin
    if (running_q && some_q) begin
      a_product: assert (age_q != Cycles[4:0] || product == a_q * b_q);
      i_age:     assert (age_q != '0 && age_q <= Cycles[4:0]);
      i_left:    assert (tap_left == ((age_q > BBits[4:0]) ? '0 : BBits[CountBits-1:0] + 1'b1 - age_q[CountBits-1:0]));
      i_part:    assert ((product >>> tap_left) == part
                         && (product & ~({Bits {1'b1}} << tap_left)) == ({{ABits {1'b0}}, b_q} >> bits
                                                                        & ~({Bits {1'b1}} << tap_left)));
      c_least: cover (age_q == Cycles[4:0] && a_q == {1'b1, {(ABits - 1) {1'b0}}}
                      && b_q == {1'b1, {(BBits - 1) {1'b0}}});
      c_again: cover (age_q == Cycles[4:0] && en_i && product != '0 && a_i != a_q);
    end
  end
endmodule
