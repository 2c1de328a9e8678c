// SPDX-License-Identifier: MIT
// Keeps the least fault of a step, by (code, id, number); number is signed, code 0 is none.
module cuboct_least_fault #(
  parameter int Sources = 1,  // that may speak in one cycle, >= 1
  parameter int IdBits  = 8,  // of an id, >= 1
  parameter int NumberBits = 64,  // that hold every number, <= 64
  parameter int Late    = 0,  // 1: what speaks is compared a cycle later, and the outputs count it already
  parameter int Direct  = 0   // 1: the outputs count what speaks in this cycle, even one with clear_i
) (
  input  logic                      clk_i,
  input  logic                      rst_ni,
  input  logic                      clear_i,   // not in a cycle with a fault, unless Direct
  input  logic [Sources-1:0]        valid_i,   // per source: a fault
  input  logic [Sources*4-1:0]      code_i,    // 1 to 15
  input  logic [Sources*IdBits-1:0] id_i,      // of the particle
  input  logic [Sources*64-1:0]     number_i,  // signed
  output logic                      valid_o,   // there was one since clear_i
  output logic [3:0]                code_o,    // of the least; 0 where there is none
  output logic [IdBits-1:0]         id_o,      // 0 where there is none
  output logic signed [63:0]        number_o   // 0 where there is none
);
  localparam int KeyBits = 4 + IdBits + NumberBits;

  logic [Sources-1:0]        valid;
  logic [Sources*4-1:0]      code;
  logic [Sources*IdBits-1:0] id;
  logic [Sources*64-1:0]     number_in;
  if (Late != 0) begin : gen_late
    logic [Sources-1:0]        valid_in_q;
    logic [Sources*4-1:0]      code_q;
    logic [Sources*IdBits-1:0] id_q;
    logic [Sources*64-1:0]     number_q;
    always_ff @(posedge clk_i) begin
      if (!rst_ni) valid_in_q <= '0;
      else valid_in_q <= valid_i;
    end
    always_ff @(posedge clk_i) begin
      code_q   <= code_i;
      id_q     <= id_i;
      number_q <= number_i;
    end
    assign valid     = valid_in_q;
    assign code      = code_q;
    assign id        = id_q;
    assign number_in = number_q;
  end else begin : gen_now
    assign valid     = valid_i;
    assign code      = code_i;
    assign id        = id_i;
    assign number_in = number_i;
  end

  // With its sign inverted, number orders as an unsigned value.
  logic                seen, valid_d, valid_q;
  logic [KeyBits-1:0]  key_d, key_q;
  logic [KeyBits-1:0]  key;
  integer              s;
  always_comb begin
    seen  = valid_q;
    key_d = key_q;
    key   = key_q;
    for (s = 0; s < Sources; s = s + 1) begin
      if (valid[s]) begin
        key = {code[s*4 +: 4], id[s*IdBits +: IdBits], !number_in[s*64+63],
               number_in[s*64 +: NumberBits-1]};
        if (!seen || key < key_d) key_d = key;
        seen = 1'b1;
      end
    end
    valid_d = seen && !clear_i;
  end

  always_ff @(posedge clk_i) begin
    if (!rst_ni) valid_q <= 1'b0;
    else valid_q <= valid_d;
  end
  always_ff @(posedge clk_i) begin
    if (valid != '0) key_q <= key_d;
  end

  logic [KeyBits-1:0] least;
  assign valid_o = (Late != 0 || Direct != 0) ? seen : valid_q;
  assign least   = (Late != 0 || Direct != 0) ? key_d : key_q;
  assign code_o  = valid_o ? least[NumberBits+IdBits +: 4] : 4'd0;
  assign id_o    = valid_o ? least[NumberBits +: IdBits] : '0;
  logic signed [NumberBits-1:0] number;
  assign number = valid_o ? $signed({!least[NumberBits-1], least[NumberBits-2:0]}) : '0;
  cuboct_resize #(.InBits(NumberBits), .OutBits(64)) u_number (.a_i(number), .y_o(number_o));
  logic unused_numbers;
  assign unused_numbers = ^number_in;
endmodule
