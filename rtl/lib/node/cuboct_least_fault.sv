// SPDX-License-Identifier: MIT
// Keeps the least fault of a step, by (code, id, number); number is signed, code 0 is none. What pipes say in one cycle
// goes through a tree of registers, that halves it in each cycle; what the update says enters at its root, as it counts
// only where no pipe spoke: its codes are above theirs. What the root has is compared with what is kept a cycle later.
// Migration speaks in the step's last cycle too, so what it says is shown at once: its codes are above all others and
// never fall within a step, so that its id alone is compared, and that with faults of the same code.
module cuboct_least_fault #(
  parameter int Sources    = 1,  // pipes, that may speak in one cycle; >= 1
  parameter int IdBits     = 8,  // of an id, >= 1
  parameter int NumberBits = 64, // that hold every number, <= 64
  parameter int CodeBits   = 4   // of a code: of a rule of several rounds with the stage above it
) (
  input  logic                      clk_i,
  input  logic                      rst_ni,
  input  logic                      clear_i,          // the step's last cycle: neither in it nor in the one before
                                                      // the update spoke, nor a pipe in $clog2(Sources) more
  input  logic [Sources-1:0]        valid_i,          // per pipe: a fault
  input  logic [Sources*CodeBits-1:0] code_i,         // 1 or 2, or with a stage
  input  logic [Sources*IdBits-1:0] id_i,             // of the particle
  input  logic [Sources*64-1:0]     number_i,         // signed
  input  logic                      update_valid_i,   // a fault of the update
  input  logic [CodeBits-1:0]       update_code_i,    // 3 to 5, or with a stage
  input  logic [IdBits-1:0]         update_id_i,      // of the particle
  input  logic [63:0]               update_number_i,  // signed
  input  logic                      move_valid_i,     // a fault of migration
  input  logic [CodeBits-1:0]       move_code_i,      // 6 to 11, or with a stage; none below an earlier one of the step
  input  logic [IdBits-1:0]         move_id_i,        // of the particle
  input  logic [63:0]               move_number_i,    // one for each code, >= 0
  output logic                      valid_o,          // with clear_i: there was one in the step
  output logic [CodeBits-1:0]       code_o,           // of the least; 0 where there is none
  output logic [IdBits-1:0]         id_o,             // 0 where there is none
  output logic signed [63:0]        number_o          // 0 where there is none
);
  // With its sign inverted, number orders as an unsigned value.
  localparam int KeyBits = CodeBits + IdBits + NumberBits;
  localparam int Nodes   = 2 * Sources;  // 1 is the root; n holds the lesser of 2n and 2n+1, or pipe n-Sources

  logic [Nodes-1:1]               late_q;  // a fault on its way
  logic [Nodes*KeyBits-1:KeyBits] late_key_q;
  logic [KeyBits-1:0]             update_key;
  assign update_key = {update_code_i, update_id_i, !update_number_i[63], update_number_i[NumberBits-2:0]};
  for (genvar n = 1; n < Nodes; n++) begin : gen_node
    logic               some, all;
    logic [KeyBits-1:0] key, all_key;
    if (n >= Sources) begin : gen_pipe
      localparam int S = n - Sources;
      assign some = valid_i[S];
      assign key  = {code_i[S*CodeBits +: CodeBits], id_i[S*IdBits +: IdBits], !number_i[S*64+63],
                     number_i[S*64 +: NumberBits-1]};
    end else begin : gen_lesser
      logic upper;
      assign some  = late_q[2*n] || late_q[2*n+1];
      assign upper = !late_q[2*n]
                  || (late_q[2*n+1] && late_key_q[(2*n+1)*KeyBits +: KeyBits] < late_key_q[2*n*KeyBits +: KeyBits]);
      assign key   = upper ? late_key_q[(2*n+1)*KeyBits +: KeyBits] : late_key_q[2*n*KeyBits +: KeyBits];
    end
    assign all     = some || (n == 1 && update_valid_i);
    assign all_key = (n == 1 && !some) ? update_key : key;
    always_ff @(posedge clk_i) begin
      if (!rst_ni) late_q[n] <= 1'b0;
      else late_q[n] <= all;
    end
    always_ff @(posedge clk_i) begin
      if (all) late_key_q[n*KeyBits +: KeyBits] <= all_key;
    end
  end

  // Bit by bit: tools that build it from a carry chain take the chain's end to come early, and put the choices behind.
  function automatic logic below(input logic [IdBits-1:0] a, input logic [IdBits-1:0] b);
    integer i;
    begin
      below = 1'b0;
      for (i = 0; i < IdBits; i = i + 1) below = (!a[i] && b[i]) || (a[i] == b[i] && below);
    end
  endfunction

  logic               valid_q, moved, less;
  logic [KeyBits-1:0] key_d, key_q, move_key;
  assign move_key = {move_code_i, move_id_i, !move_number_i[NumberBits-1], move_number_i[NumberBits-2:0]};
  assign moved    = move_valid_i
                 && ((!valid_q && late_q == '0)
                     || (valid_q && key_q[NumberBits+IdBits +: CodeBits] == move_code_i
                         && below(move_id_i, key_q[NumberBits +: IdBits])));
  assign less     = late_q[1] && (!valid_q || late_key_q[KeyBits +: KeyBits] < key_q);
  assign key_d    = moved ? move_key : late_key_q[KeyBits +: KeyBits];

  always_ff @(posedge clk_i) begin
    if (!rst_ni) valid_q <= 1'b0;
    else valid_q <= (valid_q || late_q[1] || moved) && !clear_i;
  end
  always_ff @(posedge clk_i) begin
    if (less || moved) key_q <= key_d;
  end

  logic [KeyBits-1:0] least;
  assign valid_o = valid_q || move_valid_i;
  assign least   = moved ? move_key : key_q;
  assign code_o  = valid_o ? least[NumberBits+IdBits +: CodeBits] : '0;
  assign id_o    = valid_o ? least[NumberBits +: IdBits] : '0;
  logic signed [NumberBits-1:0] number;
  assign number = valid_o ? $signed({!least[NumberBits-1], least[NumberBits-2:0]}) : '0;
  cuboct_resize #(.InBits(NumberBits), .OutBits(64)) u_number (.a_i(number), .y_o(number_o));
  logic unused_numbers;
  assign unused_numbers = ^{number_i, update_number_i, move_number_i};
endmodule
