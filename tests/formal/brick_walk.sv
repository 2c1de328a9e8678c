// SPDX-License-Identifier: MIT
// cuboct_brick_walk through any number of walks, over any boxes: the n-th cell of a walk is that whose place in the
// box, x first, is n; so each cell of the box is walked once, in order, and `last` is told at the last one alone. Then
// the same box may be walked again at once, or another one is begun.
module brick_walk_formal #(
  parameter int GridBits = 2
) (
  input logic                  clk_i,
  input logic                  advance_i,
  input logic                  restart_i,
  input logic [3*GridBits-1:0] low_i, high_i  // of the walk that a restart begins
);
  localparam int Bits = 3 * GridBits + 1;
  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;

  // A box lasts until the walk is begun anew; after the reset it is one that begins at (1, 1, 1).
  logic [3*GridBits-1:0] low_q, high_q;
  logic [Bits-1:0]       number_q;
  logic                  last, ok, ok_in;
  integer                a;
  localparam logic [GridBits-1:0] One = 1;
  always_comb begin
    ok    = 1'b1;
    ok_in = 1'b1;
    for (a = 0; a < 3; a = a + 1) begin
      ok    = ok && low_q[a*GridBits +: GridBits] <= high_q[a*GridBits +: GridBits];
      ok_in = ok_in && low_i[a*GridBits +: GridBits] <= high_i[a*GridBits +: GridBits];
    end
    if (!running_q) assume (low_q == {3{One}} && ok);
    if (restart_i) assume (ok_in);
  end
  always_ff @(posedge clk_i) begin
    if (!running_q) begin
      number_q <= '0;
    end else begin
      if (restart_i) begin
        low_q    <= low_i;
        high_q   <= high_i;
        number_q <= '0;
      end else if (advance_i) begin
        number_q <= last ? '0 : number_q + 1'b1;
      end
    end
  end

  logic [3*GridBits-1:0] at, after, next;
  cuboct_brick_walk #(.GridBits(GridBits)) u_dut (
    .clk_i, .rst_ni(running_q), .low_i(low_q), .high_i(high_q), .advance_i, .restart_i, .first_i(low_i), .cell_o(at),
    .after_o(after), .next_o(next), .last_o(last)
  );

  logic [Bits-1:0] x, y, z, wide, deep, all, place, wide_after;
  assign x     = {{(Bits - GridBits) {1'b0}}, at[0 +: GridBits] - low_q[0 +: GridBits]};
  assign y     = {{(Bits - GridBits) {1'b0}}, at[GridBits +: GridBits] - low_q[GridBits +: GridBits]};
  assign z     = {{(Bits - GridBits) {1'b0}}, at[2*GridBits +: GridBits] - low_q[2*GridBits +: GridBits]};
  assign wide  = {{(Bits - GridBits) {1'b0}}, high_q[0 +: GridBits] - low_q[0 +: GridBits]} + 1'b1;
  assign deep  = {{(Bits - GridBits) {1'b0}}, high_q[GridBits +: GridBits] - low_q[GridBits +: GridBits]} + 1'b1;
  assign all   = wide * deep
               * ({{(Bits - GridBits) {1'b0}}, high_q[2*GridBits +: GridBits] - low_q[2*GridBits +: GridBits]} + 1'b1);
  assign place = x + wide * (y + deep * z);

  // What was said of the next cycle, and what comes after.
  logic [3*GridBits-1:0] next_q, after_q;
  logic                  said_q, moved_q, again_q;
  always_ff @(posedge clk_i) begin
    next_q  <= next;
    after_q <= after;
    said_q  <= running_q;
    moved_q <= running_q && advance_i && !restart_i;
    again_q <= running_q && (again_q || (advance_i && last && !restart_i));
  end
  always_ff @(posedge clk_i) begin
    if (running_q) begin
      i_box:   assert (ok);
      a_in:    assert (x < wide && y < deep && z <= all);
      a_place: assert (place == number_q);
      a_last:  assert (last == (number_q + 1'b1 == all) && number_q < all);
      if (said_q) a_next: assert (at == next_q);
      if (moved_q) a_after: assert (at == after_q);
      c_all:   cover (last && wide == 3 && deep == 2 && all == 12);
      c_one:   cover (last && all == 1 && advance_i && moved_q);
      c_again: cover (again_q && number_q == 2 && all != 3);
    end
  end
endmodule
