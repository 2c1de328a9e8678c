// SPDX-License-Identifier: MIT
// cuboct_least_fault: what is shown in a step's last cycle is the least of all faults of the step, by code, id and
// signed number, that cycle's of migration too.
module least_fault_formal #(
  parameter int Sources = 2,
  parameter int IdBits  = 3,
  parameter int NumberBits = 64
) (
  input logic                      clk_i,
  input logic                      clear_i,
  input logic [Sources-1:0]        valid_i,
  input logic [Sources*4-1:0]      code_i,
  input logic [Sources*IdBits-1:0] id_i,
  input logic [Sources*64-1:0]     number_i,
  input logic                      update_valid_i,
  input logic [3:0]                update_code_i,
  input logic [IdBits-1:0]         update_id_i,
  input logic [63:0]               update_number_i,
  input logic                      move_valid_i,
  input logic [3:0]                move_code_i,
  input logic [IdBits-1:0]         move_id_i
);
  localparam int Levels = $clog2(Sources);
  logic running_q = 1'b0;          // reset in the first cycle only
  logic updated_q = 1'b0;          // the update spoke in the cycle before
  logic [Levels:0] spoke_q = '0;   // a pipe, in the cycle before and those before it
  always_ff @(posedge clk_i) begin
    running_q  <= 1'b1;
    updated_q  <= running_q && update_valid_i;
    spoke_q[0] <= running_q && valid_i != '0;
  end
  for (genvar l = 1; l <= Levels; l++) begin : gen_spoke
    always_ff @(posedge clk_i) spoke_q[l] <= running_q && spoke_q[l-1];
  end
  // Pipes and update are silent once migration has spoken and in a step's last cycles. Pipes have lower codes than the
  // update, and it lower ones than migration, whose codes never fall; a number belongs to each of them.
  logic                  moved_q;
  logic [3:0]            reached_q;
  logic [63:0]           move_number;
  assign move_number = {63'd0, move_code_i[0]};
  always_ff @(posedge clk_i) begin
    moved_q <= running_q && !clear_i && (moved_q || move_valid_i);
    if (!running_q || clear_i) reached_q <= 4'd6;
    else if (move_valid_i) reached_q <= move_code_i;
  end
  integer n, m;
  always_comb begin
    if (!running_q) assume (valid_i == '0 && !update_valid_i && !move_valid_i);
    if (clear_i) assume (valid_i == '0 && spoke_q == '0 && !update_valid_i && !updated_q);
    if (move_valid_i || moved_q) assume (valid_i == '0 && !update_valid_i);
    if (move_valid_i) assume (move_code_i >= reached_q);
    for (n = 0; n < Sources; n = n + 1) begin
      assume (code_i[n*4 +: 4] < 4'd3);
      // Every number fits NumberBits.
      for (m = NumberBits; m < 64; m = m + 1) assume (number_i[n*64+m] == number_i[n*64+63]);
      assume (number_i[n*64+NumberBits-1] == number_i[n*64+63]);
    end
    assume (update_code_i >= 4'd3 && update_code_i < 4'd6);
    for (m = NumberBits - 1; m < 64; m = m + 1) assume (update_number_i[m] == update_number_i[63]);
  end

  logic               valid;
  logic [3:0]         code;
  logic [IdBits-1:0]  id;
  logic signed [63:0] number;
  cuboct_least_fault #(.Sources(Sources), .IdBits(IdBits), .NumberBits(NumberBits)) u_dut (
    .clk_i, .rst_ni(running_q), .clear_i, .valid_i, .code_i, .id_i, .number_i, .update_valid_i, .update_code_i,
    .update_id_i, .update_number_i, .move_valid_i, .move_code_i, .move_id_i, .move_number_i(move_number),
    .valid_o(valid), .code_o(code), .id_o(id), .number_o(number)
  );

  // Of all of the step: of the pipes in turn, of the update and of migration.
  logic               some_d, some_q, less;
  logic [3:0]         code_d, code_q, new_code;
  logic [IdBits-1:0]  id_d, id_q, new_id;
  logic signed [63:0] number_d, number_q, new_number;
  logic               speaks;
  integer             s;
  always_comb begin
    some_d     = some_q;
    code_d     = code_q;
    id_d       = id_q;
    number_d   = number_q;
    less       = 1'b0;
    new_code   = '0;
    new_id     = '0;
    new_number = '0;
    speaks     = 1'b0;
    for (s = 0; s <= Sources + 1; s = s + 1) begin
      if (s == Sources) begin
        speaks     = update_valid_i;
        new_code   = update_code_i;
        new_id     = update_id_i;
        new_number = $signed(update_number_i);
      end else if (s == Sources + 1) begin
        speaks     = move_valid_i;
        new_code   = move_code_i;
        new_id     = move_id_i;
        new_number = move_number;
      end else begin
        speaks     = valid_i[s];
        new_code   = code_i[s*4 +: 4];
        new_id     = id_i[s*IdBits +: IdBits];
        new_number = $signed(number_i[s*64 +: 64]);
      end
      less = (new_code < code_d)
          || (new_code == code_d && (new_id < id_d || (new_id == id_d && new_number < number_d)));
      if (speaks && (!some_d || less)) begin
        code_d   = new_code;
        id_d     = new_id;
        number_d = new_number;
      end
      some_d = some_d || speaks;
    end
  end
  always_ff @(posedge clk_i) begin
    some_q   <= running_q && some_d && !clear_i;
    code_q   <= code_d;
    id_q     <= id_d;
    number_q <= number_d;
  end

  // For induction: what the block keeps and what is on its way have that least.
  (* keep *) logic                           tap_valid;
  (* keep *) logic [4+IdBits+NumberBits-1:0] tap_key;
  (* keep *) logic [2*Sources-1:1]           tap_late;
  (* keep *) logic [2*Sources*(4+IdBits+NumberBits)-1:4+IdBits+NumberBits] tap_late_key;
  localparam int KeyBits = 4 + IdBits + NumberBits;
  logic               held_some;
  logic [KeyBits-1:0] held_key;
  logic signed [63:0] held_number;
  logic               on_time, in_code;  // what is on its way was said as long ago as its place tells; its code
  integer             k, depth;
  always_comb begin
    held_some = tap_valid;
    held_key  = tap_key;
    on_time   = 1'b1;
    in_code   = 1'b1;
    depth     = 0;
    for (k = 1; k < 2 * Sources; k = k + 1) begin
      depth = $clog2(k + 1) - 1;
      if (tap_late[k] && (!held_some || tap_late_key[k*KeyBits +: KeyBits] < held_key))
        held_key = tap_late_key[k*KeyBits +: KeyBits];
      held_some = held_some || tap_late[k];
      if (tap_late[k] && !spoke_q[Levels-depth] && !(depth < Levels && spoke_q[(depth < Levels) ? Levels-depth-1 : 0])
          && !(k == 1 && updated_q)) on_time = 1'b0;
      if (tap_late[k] && tap_late_key[k*KeyBits+KeyBits-4 +: 4] >= ((k == 1) ? 4'd6 : 4'd3)) in_code = 1'b0;
    end
    held_number = {{(65 - NumberBits) {!held_key[NumberBits-1]}}, held_key[NumberBits-2:0]};
  end
  logic            both_q;  // a step with faults of both kinds
  always_ff @(posedge clk_i) both_q <= running_q && !clear_i && (both_q || (spoke_q[0] && move_valid_i));
  always_ff @(posedge clk_i) begin
    if (running_q) begin
      i_some:  assert (held_some == some_q);
      if (some_q) i_least: assert (held_key[KeyBits-1 -: 4] == code_q && held_key[NumberBits +: IdBits] == id_q
                                   && held_number == number_q);
      i_late:  assert (on_time && in_code);
      // Of migration's: the code reached, with its number.
      i_moved: assert (reached_q >= 4'd6 && (moved_q || reached_q == 4'd6) && (!moved_q || held_some));
      if (tap_valid && tap_key[NumberBits+IdBits +: 4] >= 4'd6)
        i_code: assert (moved_q && tap_late == '0 && tap_key[NumberBits+IdBits +: 4] <= reached_q
                        && tap_key[NumberBits-1:0] == {1'b1, {(NumberBits - 2) {1'b0}}, tap_key[NumberBits+IdBits]});
      if (clear_i) begin
        a_valid: assert (valid == some_d);
        if (some_d) a_least: assert (code == code_d && id == id_d && number == number_d);
        if (!some_d) a_none: assert (code == '0 && id == '0 && number == '0);
      end
      c_negative: cover (clear_i && valid && number < 64'sd0);
      c_moved:    cover (clear_i && move_valid_i && code == move_code_i && id == move_id_i && some_q);
      c_both:     cover (clear_i && valid && both_q);
      c_all:      cover (valid_i == '1 && update_valid_i);
      c_updated:  cover (clear_i && valid && code >= 4'd3 && code < 4'd6);
    end
  end
endmodule
