// SPDX-License-Identifier: MIT
// Keeps the least fault of a step, by (code, id, number); number is signed, code 0 is none.
module cuboct_least_fault #(
  parameter int Sources = 1,  // that may speak in one cycle, >= 1
  parameter int IdBits  = 8,
  parameter int NumberBits = 64  // that hold every number, <= 64
) (
  input  logic                      clk_i,
  input  logic                      rst_ni,
  input  logic                      clear_i,   // never in a cycle with a fault
  input  logic [Sources-1:0]        valid_i,
  input  logic [Sources*4-1:0]      code_i,
  input  logic [Sources*IdBits-1:0] id_i,
  input  logic [Sources*64-1:0]     number_i,
  output logic                      valid_o,
  output logic [3:0]                code_o,
  output logic [IdBits-1:0]         id_o,
  output logic signed [63:0]        number_o
);
  localparam int KeyBits = 4 + IdBits + NumberBits;

  // With its sign inverted, number orders as an unsigned value.
  logic                valid_d, valid_q;
  logic [KeyBits-1:0]  key_d, key_q;
  logic [KeyBits-1:0]  key;
  integer              s;
  always_comb begin
    valid_d = valid_q;
    key_d   = key_q;
    key     = key_q;
    for (s = 0; s < Sources; s = s + 1) begin
      if (valid_i[s]) begin
        key = {code_i[s*4 +: 4], id_i[s*IdBits +: IdBits], !number_i[s*64+63],
               number_i[s*64 +: NumberBits-1]};
        if (!valid_d || key < key_d) key_d = key;
        valid_d = 1'b1;
      end
    end
    if (clear_i) valid_d = 1'b0;
  end

  always_ff @(posedge clk_i) begin
    if (!rst_ni) valid_q <= 1'b0;
    else valid_q <= valid_d;
  end
  always_ff @(posedge clk_i) begin
    if (valid_i != '0) key_q <= key_d;
  end

  assign valid_o  = valid_q;
  assign code_o   = valid_q ? key_q[NumberBits+IdBits +: 4] : 4'd0;
  assign id_o     = valid_q ? key_q[NumberBits +: IdBits] : '0;
  logic signed [NumberBits-1:0] number;
  assign number = valid_q ? $signed({!key_q[NumberBits-1], key_q[NumberBits-2:0]}) : '0;
  cuboct_resize #(.InBits(NumberBits), .OutBits(64)) u_number (.a_i(number), .y_o(number_o));
  logic unused_numbers;
  assign unused_numbers = ^number_i;
endmodule
