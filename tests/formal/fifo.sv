// SPDX-License-Identifier: MIT
// cuboct_fifo under any pushes and pops that its contract allows: a watched entry, any of those pushed, comes
// out once, after those before it and before those after it, as it went in.
module fifo_formal #(
  parameter int Depth = 3,
  parameter int Bits  = 2
) (
  input logic            clk_i,
  input logic            push_i,
  input logic            pop_i,
  input logic [Bits-1:0] data_i,
  input logic            watch_i   // the entry pushed in this cycle is the one watched; anyone may be
);
  localparam int PtrBits   = (Depth > 1) ? $clog2(Depth) : 1;
  localparam int CountBits = $clog2(Depth + 1);

  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;

  logic            full, empty;
  logic [Bits-1:0] data;
  cuboct_fifo #(.Bits(Bits), .Depth(Depth)) u_dut (
    .clk_i, .rst_ni(running_q), .push_i, .data_i, .full_o(full), .pop_i, .data_o(data), .empty_o(empty)
  );

  always_comb begin
    if (push_i) assume (running_q && !full);
    if (pop_i) assume (running_q && !empty);
  end

  // How many there are, and how many stand before the watched one.
  logic [CountBits-1:0] count_q, before_q;
  logic                 watched_q, inside_q;  // the watched entry was pushed; it is inside
  logic [Bits-1:0]      value_q;
  always_ff @(posedge clk_i) begin
    if (!running_q) begin
      count_q   <= '0;
      watched_q <= 1'b0;
      inside_q  <= 1'b0;
    end else begin
      count_q <= count_q + {{(CountBits - 1) {1'b0}}, push_i} - {{(CountBits - 1) {1'b0}}, pop_i};
      if (push_i && watch_i && !watched_q) begin
        watched_q <= 1'b1;
        inside_q  <= 1'b1;
        value_q   <= data_i;
        before_q  <= count_q - {{(CountBits - 1) {1'b0}}, pop_i};
      end else if (inside_q && pop_i) begin
        before_q <= before_q - 1'b1;
        if (before_q == '0) inside_q <= 1'b0;
      end
    end
  end

  always_ff @(posedge clk_i) begin
    if (running_q) begin
      a_empty: assert (empty == (count_q == '0));
      a_full:  assert (full == (count_q == Depth[CountBits-1:0]));
      if (inside_q) a_held: assert (!empty);
      if (inside_q && before_q == '0) a_value: assert (data == value_q);
      c_full:    cover (full);
      c_drained: cover (empty && watched_q);
      c_wrapped: cover (full && watched_q && !inside_q && tap_read == '0);
    end
  end

  // What makes it inductive: the counters agree, and the watched entry lies where its place in the queue
  // says.
  (* keep *) logic [PtrBits-1:0]    tap_write, tap_read;
  (* keep *) logic [CountBits-1:0]  tap_count;
  (* keep *) logic [Depth*Bits-1:0] tap_mem;
  logic [PtrBits+1:0] last, slot;
  logic [Bits-1:0]    lies;
  integer             e;
  always_comb begin
    last = {2'b00, tap_read} + {{(PtrBits + 2 - CountBits) {1'b0}}, tap_count};
    if (last >= Depth[PtrBits+1:0]) last = last - Depth[PtrBits+1:0];
    slot = {2'b00, tap_read} + {{(PtrBits + 2 - CountBits) {1'b0}}, before_q};
    if (slot >= Depth[PtrBits+1:0]) slot = slot - Depth[PtrBits+1:0];
    lies = '0;
    for (e = 0; e < Depth; e = e + 1) begin
      if (slot == e[PtrBits+1:0]) lies = tap_mem[e*Bits +: Bits];
    end
  end
  always_ff @(posedge clk_i) begin
    if (running_q) begin
      i_count: assert (tap_count == count_q && count_q <= Depth[CountBits-1:0]);
      i_read:  assert ({2'b00, tap_read} < Depth[PtrBits+1:0]);
      i_write: assert ({2'b00, tap_write} == last);
      if (inside_q) begin
        i_before: assert (before_q < count_q);
        i_slot:   assert (lies == value_q);
      end
    end
  end
endmodule
