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
  input logic                      move_valid_i,
  input logic [3:0]                move_code_i,
  input logic [IdBits-1:0]         move_id_i
);
  logic running_q = 1'b0;  // reset in the first cycle only
  logic spoke_q = 1'b0;    // a source, in the cycle before
  always_ff @(posedge clk_i) begin
    running_q <= 1'b1;
    spoke_q   <= running_q && valid_i != '0;
  end
  // Sources are silent once migration has spoken and in a step's last two cycles, and have lower codes than migration,
  // whose codes never fall; a number belongs to each of them.
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
    if (!running_q) assume (valid_i == '0 && !move_valid_i);
    if (clear_i) assume (valid_i == '0 && !spoke_q);
    if (move_valid_i || moved_q) assume (valid_i == '0);
    if (move_valid_i) assume (move_code_i >= reached_q);
    for (n = 0; n < Sources; n = n + 1) begin
      assume (code_i[n*4 +: 4] < 4'd6);
      // Every number fits NumberBits.
      for (m = NumberBits; m < 64; m = m + 1) assume (number_i[n*64+m] == number_i[n*64+63]);
      assume (number_i[n*64+NumberBits-1] == number_i[n*64+63]);
    end
  end

  logic               valid;
  logic [3:0]         code;
  logic [IdBits-1:0]  id;
  logic signed [63:0] number;
  cuboct_least_fault #(.Sources(Sources), .IdBits(IdBits), .NumberBits(NumberBits)) u_dut (
    .clk_i, .rst_ni(running_q), .clear_i, .valid_i, .code_i, .id_i, .number_i, .move_valid_i, .move_code_i, .move_id_i,
    .move_number_i(move_number), .valid_o(valid), .code_o(code), .id_o(id), .number_o(number)
  );

  // Of all of the step: of the sources in turn, of migration last.
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
    for (s = 0; s <= Sources; s = s + 1) begin
      if (s == Sources) begin
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

  // For induction: what the block keeps, and what spoke in the cycle before, make that least.
  (* keep *) logic                           tap_valid;
  (* keep *) logic [4+IdBits+NumberBits-1:0] tap_key;
  (* keep *) logic [Sources-1:0]             tap_late_valid;
  (* keep *) logic [Sources*4-1:0]           tap_code;
  (* keep *) logic [Sources*IdBits-1:0]      tap_id;
  (* keep *) logic [Sources*64-1:0]          tap_number;
  logic               kept_some, late_good;  // codes of sources; numbers that fit
  logic [3:0]         kept_code;
  logic [IdBits-1:0]  kept_id;
  logic signed [63:0] kept_number, late_number;
  integer             k;
  always_comb begin
    kept_some   = tap_valid;
    kept_code   = tap_key[NumberBits+IdBits +: 4];
    kept_id     = tap_key[NumberBits +: IdBits];
    kept_number = {{(65 - NumberBits) {!tap_key[NumberBits-1]}}, tap_key[NumberBits-2:0]};
    late_number = '0;
    late_good   = 1'b1;
    for (k = 0; k < Sources; k = k + 1) begin
      late_number = $signed(tap_number[k*64 +: 64]);
      if (tap_late_valid[k]
          && (!kept_some || tap_code[k*4 +: 4] < kept_code
              || (tap_code[k*4 +: 4] == kept_code
                  && (tap_id[k*IdBits +: IdBits] < kept_id
                      || (tap_id[k*IdBits +: IdBits] == kept_id && late_number < kept_number))))) begin
        kept_code   = tap_code[k*4 +: 4];
        kept_id     = tap_id[k*IdBits +: IdBits];
        kept_number = late_number;
      end
      kept_some = kept_some || tap_late_valid[k];
      if (tap_late_valid[k]
          && (tap_code[k*4 +: 4] >= 4'd6 || tap_number[k*64+NumberBits-1 +: 65-NumberBits]
                                            != {(65 - NumberBits) {tap_number[k*64+63]}})) late_good = 1'b0;
    end
  end
  logic            both_q;  // a step with faults of both kinds
  always_ff @(posedge clk_i) both_q <= running_q && !clear_i && (both_q || (spoke_q && move_valid_i));
  always_ff @(posedge clk_i) begin
    if (running_q) begin
      i_some:  assert (kept_some == some_q && (tap_late_valid != '0) == spoke_q);
      if (some_q) i_least: assert (kept_code == code_q && kept_id == id_q && kept_number == number_q);
      // Of migration's: the code reached, with its number.
      i_moved: assert (reached_q >= 4'd6 && (moved_q || reached_q == 4'd6) && (!moved_q || tap_valid || spoke_q));
      if (tap_valid && tap_key[NumberBits+IdBits +: 4] >= 4'd6)
        i_code: assert (moved_q && tap_late_valid == '0 && tap_key[NumberBits+IdBits +: 4] <= reached_q
                        && tap_key[NumberBits-1:0] == {1'b1, {(NumberBits - 2) {1'b0}}, tap_key[NumberBits+IdBits]});
      i_late:  assert (late_good);
      if (clear_i) begin
        a_valid: assert (valid == some_d);
        if (some_d) a_least: assert (code == code_d && id == id_d && number == number_d);
        if (!some_d) a_none: assert (code == '0 && id == '0 && number == '0);
      end
      c_negative: cover (clear_i && valid && number < 64'sd0);
      c_moved:    cover (clear_i && move_valid_i && code == move_code_i && id == move_id_i && some_q);
      c_both:     cover (clear_i && valid && both_q);
      c_all:      cover (valid_i == '1);
    end
  end
endmodule
