// SPDX-License-Identifier: MIT
// Keeps the least fault of a step, by (code, id, number); number is signed, code 0 is none. What pipes and update say
// is compared a cycle later. Migration speaks in the step's last cycle too, so what it says is shown at once: its codes
// are above theirs and never fall within a step, so that its id alone is compared, and that with faults of the same
// code.
module cuboct_least_fault #(
  parameter int Sources    = 1,  // pipes, that may speak in one cycle; the update in place of the first; >= 1
  parameter int IdBits     = 8,  // of an id, >= 1
  parameter int NumberBits = 64  // that hold every number, <= 64
) (
  input  logic                      clk_i,
  input  logic                      rst_ni,
  input  logic                      clear_i,       // the step's last cycle: no source spoke in it or in the one before
  input  logic [Sources-1:0]        valid_i,       // per source: a fault
  input  logic [Sources*4-1:0]      code_i,        // 1 to 5
  input  logic [Sources*IdBits-1:0] id_i,          // of the particle
  input  logic [Sources*64-1:0]     number_i,      // signed
  input  logic                      move_valid_i,  // a fault of migration
  input  logic [3:0]                move_code_i,   // 6 to 11, none below an earlier one of the step
  input  logic [IdBits-1:0]         move_id_i,     // of the particle
  input  logic [63:0]               move_number_i, // one for each code, >= 0
  output logic                      valid_o,       // with clear_i: there was one in the step
  output logic [3:0]                code_o,        // of the least; 0 where there is none
  output logic [IdBits-1:0]         id_o,          // 0 where there is none
  output logic signed [63:0]        number_o       // 0 where there is none
);
  localparam int KeyBits = 4 + IdBits + NumberBits;

  logic [Sources-1:0]        late_valid_q;
  logic [Sources*4-1:0]      code_q;
  logic [Sources*IdBits-1:0] id_q;
  logic [Sources*64-1:0]     number_q;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) late_valid_q <= '0;
    else late_valid_q <= valid_i;
  end
  always_ff @(posedge clk_i) begin
    code_q   <= code_i;
    id_q     <= id_i;
    number_q <= number_i;
  end

  // Bit by bit: tools that build it from a carry chain take the chain's end to come early, and put the choices behind.
  function automatic logic below(input logic [IdBits-1:0] a, input logic [IdBits-1:0] b);
    integer i;
    begin
      below = 1'b0;
      for (i = 0; i < IdBits; i = i + 1) below = (!a[i] && b[i]) || (a[i] == b[i] && below);
    end
  endfunction

  // With its sign inverted, number orders as an unsigned value.
  logic                seen, valid_d, valid_q, moved;
  logic [KeyBits-1:0]  key_d, key_q, key, move_key;
  integer              s;
  assign move_key = {move_code_i, move_id_i, !move_number_i[NumberBits-1], move_number_i[NumberBits-2:0]};
  assign moved    = move_valid_i
                 && ((!valid_q && late_valid_q == '0)
                     || (valid_q && key_q[NumberBits+IdBits +: 4] == move_code_i
                         && below(move_id_i, key_q[NumberBits +: IdBits])));
  always_comb begin
    seen  = valid_q;
    key_d = key_q;
    key   = key_q;
    for (s = 0; s < Sources; s = s + 1) begin
      if (late_valid_q[s]) begin
        key = {code_q[s*4 +: 4], id_q[s*IdBits +: IdBits], !number_q[s*64+63], number_q[s*64 +: NumberBits-1]};
        if (!seen || key < key_d) key_d = key;
        seen = 1'b1;
      end
    end
    if (moved) key_d = move_key;
    valid_d = (seen || move_valid_i) && !clear_i;
  end

  always_ff @(posedge clk_i) begin
    if (!rst_ni) valid_q <= 1'b0;
    else valid_q <= valid_d;
  end
  always_ff @(posedge clk_i) begin
    if (late_valid_q != '0 || moved) key_q <= key_d;
  end

  logic [KeyBits-1:0] least;
  assign valid_o = valid_q || move_valid_i;
  assign least   = moved ? move_key : key_q;
  assign code_o  = valid_o ? least[NumberBits+IdBits +: 4] : 4'd0;
  assign id_o    = valid_o ? least[NumberBits +: IdBits] : '0;
  logic signed [NumberBits-1:0] number;
  assign number = valid_o ? $signed({!least[NumberBits-1], least[NumberBits-2:0]}) : '0;
  cuboct_resize #(.InBits(NumberBits), .OutBits(64)) u_number (.a_i(number), .y_o(number_o));
  logic unused_numbers;
  assign unused_numbers = ^{number_q, move_number_i};
endmodule
