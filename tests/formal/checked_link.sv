// SPDX-License-Identifier: MIT
// cuboct_link_send, a wire that stalls, changes, drops and repeats beats and changes acknowledgements as often as it
// likes, cuboct_link_take. Beat n carries n: what comes out is 0, 1, 2, ... whatever the wire does. With Wire = 1 it
// does at most one thing wrong and never stalls: that is told within a bound and, with Retry, healed. With Wire = 2 it
// only stalls: nothing is told.
module checked_link_formal #(
  parameter int SequenceBits = 2,
  parameter int Window       = 2,
  parameter int Patience     = 4,
  parameter int Retry        = 1,
  parameter int Wire         = 0,
  parameter int LinkBits     = 3
) (
  input logic                             clk_i,
  input logic                             want_i,      // the node has a beat
  input logic                             stall_i,
  input logic [LinkBits+SequenceBits+8:0] flip_i,      // of the beat that is taken: {crc, sequence, payload, end}
  input logic                             drop_i,
  input logic                             repeat_i,
  input logic [SequenceBits+7:0]          flip_ack_i
);
  localparam int CrcBits  = 8;
  localparam int WireBits = LinkBits + SequenceBits + CrcBits;
  localparam int AckBits  = SequenceBits + 8;
  localparam int Entry    = CrcBits + 1 + LinkBits;
  localparam int ToldIn   = Patience + 3;
  localparam int HealedIn = Window * (Patience + 2) + 5;

  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;

  // Beats that the node gave, and that came out.
  logic [7:0] sent_q, came_q;
  logic       ready, tx_valid, tx_end, rx_ready, out_valid, out_end;
  logic       ack_wrong, silent, wrong, order;
  logic [WireBits-1:0] tx_data;
  logic [LinkBits-1:0] out_data;
  logic [AckBits-1:0]  ack;

  // The wire: fewer wrong bits than the distance of its checks, which is 4 for beats and 6 for acknowledgements.
  logic [WireBits:0]  copy_q, seen;  // {data, end}
  logic               repeat_q, taken, faulty, rx_valid;
  logic [WireBits:0]  flip_one, flip_two, flip_three;
  logic [AckBits-1:0] ack_one, ack_two, ack_three;
  assign flip_one   = flip_i & (flip_i - 1'b1);
  assign flip_two   = flip_one & (flip_one - 1'b1);
  assign flip_three = flip_two & (flip_two - 1'b1);
  assign ack_one    = flip_ack_i & (flip_ack_i - 1'b1);
  assign ack_two    = ack_one & (ack_one - 1'b1);
  assign ack_three  = ack_two & (ack_two - 1'b1);
  assign taken      = tx_valid && rx_ready && !stall_i && !repeat_q;
  assign seen       = repeat_q ? copy_q : {tx_data, tx_end} ^ flip_i;
  assign rx_valid   = repeat_q || (taken && !drop_i);
  assign faulty     = (taken && (flip_i != '0 || drop_i || repeat_i)) || (flip_ack_i != '0);
  always_comb begin
    assume (flip_three == '0 && ack_three == '0);
    if (!taken) assume (flip_i == '0 && !drop_i && !repeat_i);
    // Each beat meets one fault.
    if (flip_i != '0) assume (!drop_i && !repeat_i);
    if (drop_i) assume (!repeat_i);
  end
  always_ff @(posedge clk_i) begin
    repeat_q <= running_q && taken && repeat_i;
    copy_q   <= {tx_data, tx_end};
  end

  function logic end_of(input logic [7:0] n);
    end_of = n[1] ^ n[0];
  endfunction
  cuboct_link_send #(
    .LinkBits(LinkBits), .SequenceBits(SequenceBits), .Window(Window), .Patience(Patience), .Retry(Retry),
    .CrcBits(CrcBits), .CrcPolynomial(32'h0000002f), .CrcStart(32'h000000ff)
  ) u_send (
    .clk_i, .rst_ni(running_q), .has_link_i(1'b1), .valid_i(want_i), .end_i(end_of(sent_q)),
    .data_i(sent_q[LinkBits-1:0]), .ready_o(ready), .valid_o(tx_valid), .end_o(tx_end), .data_o(tx_data),
    .ready_i(rx_ready && !stall_i && !repeat_q), .ack_i(ack ^ flip_ack_i), .wrong_o(ack_wrong), .silent_o(silent)
  );
  cuboct_link_take #(
    .LinkBits(LinkBits), .SequenceBits(SequenceBits), .Retry(Retry), .CrcBits(CrcBits), .CrcPolynomial(32'h0000002f),
    .CrcStart(32'h000000ff)
  ) u_take (
    .clk_i, .rst_ni(running_q), .valid_i(rx_valid), .end_i(seen[0]), .data_i(seen[WireBits:1]), .ready_o(rx_ready),
    .ack_o(ack), .valid_o(out_valid), .end_o(out_end), .data_o(out_data), .wrong_o(wrong), .order_o(order)
  );
  always_ff @(posedge clk_i) begin
    if (!running_q) begin
      sent_q <= '0;
      came_q <= '0;
    end else begin
      if (want_i && ready) sent_q <= sent_q + 1'b1;
      if (out_valid) came_q <= came_q + 1'b1;
    end
  end

  // What has been wrong, told, and waited for.
  logic       told, told_q, fault_q, repaired_q;
  logic [7:0] since_q, waits_q;
  assign told = ack_wrong || silent || wrong || order;
  always_ff @(posedge clk_i) begin
    if (!running_q) begin
      told_q     <= 1'b0;
      fault_q    <= 1'b0;
      repaired_q <= 1'b0;
      since_q    <= '0;
      waits_q    <= '0;
    end else begin
      told_q     <= told_q || told;
      fault_q    <= fault_q || faulty;
      repaired_q <= repaired_q || (fault_q && told_q && out_valid && sent_q > 8'd3);
      since_q    <= (fault_q && !told_q) ? since_q + 1'b1 : '0;
      waits_q    <= (sent_q == came_q || out_valid) ? '0 : waits_q + 1'b1;
    end
  end
  always_comb begin
    if (Wire == 1) begin
      assume (!stall_i);
      if (fault_q) assume (!faulty);
    end
    if (Wire == 2) assume (!faulty);
  end

  always_ff @(posedge clk_i) begin
    if (running_q) begin
      if (out_valid) a_order: assert (out_data == came_q[LinkBits-1:0] && out_end == end_of(came_q));
      a_sent: assert (!out_valid || came_q != sent_q);
      // No false alarm, no fault that is not told, no beat that is not sent again.
      if (Wire != 0 && !fault_q && !faulty) a_quiet: assert (!wrong && !order && !ack_wrong && !silent);
      if (Wire == 1) a_told: assert (since_q <= ToldIn[7:0]);
      if (Wire == 1 && Retry != 0) a_heals: assert (waits_q <= HealedIn[7:0]);
      c_run: cover (came_q == 8'd4 && !fault_q);
      // Where the wire only stalls there is nothing to be told: some beat instead.
      c_silent:   cover (silent || (Wire == 2 && sent_q == 8'd1));
      c_order:    cover (order || (Wire == 2 && sent_q == 8'd2));
      c_wrong:    cover (wrong || (Wire == 2 && came_q == 8'd1));
      c_repaired: cover (repaired_q || ((Wire == 2 || Retry == 0) && came_q == 8'd2));
    end
  end

  // What makes it inductive. Counts of beats: the oldest unacknowledged one, the next for the wire, the one on it.
  (* keep *) logic [SequenceBits-1:0] tap_base, tap_next, tap_head, tap_expected;
  (* keep *) logic                    tap_load;
  (* keep *) logic [AckBits-1:0]      tap_ack;
  logic [SequenceBits-1:0] pending, sent, received, came, told_ack, got_ack;
  logic [7:0]              wire_q, copied_q, next_count, behind;
  assign pending    = tap_head - tap_base;
  assign sent       = tap_next - tap_base;
  assign received   = tap_expected - tap_base;
  assign told_ack   = ack[SequenceBits-1:0] - tap_base;
  assign got_ack    = tap_ack[SequenceBits-1:0] - tap_base;
  assign next_count = sent_q - {{(8 - SequenceBits) {1'b0}}, tap_head - tap_next};
  always_ff @(posedge clk_i) begin
    if (tap_load) wire_q <= next_count;
    copied_q <= wire_q;
  end
  assign behind = sent_q - came_q;
  logic [7:0] on_wire, copied;
  assign on_wire = sent_q - wire_q;
  assign copied  = sent_q - copied_q;

  logic [CrcBits-1:0] wire_crc, copy_crc;
  cuboct_link_crc #(
    .Bits(LinkBits + 1 + SequenceBits), .Width(CrcBits), .Polynomial(32'h0000002f), .Start(32'h000000ff)
  ) u_wire_crc (.data_i({wire_q[SequenceBits-1:0], end_of(wire_q), wire_q[LinkBits-1:0]}), .crc_o(wire_crc));
  cuboct_link_crc #(
    .Bits(LinkBits + 1 + SequenceBits), .Width(CrcBits), .Polynomial(32'h0000002f), .Start(32'h000000ff)
  ) u_copy_crc (.data_i({copied_q[SequenceBits-1:0], end_of(copied_q), copied_q[LinkBits-1:0]}), .crc_o(copy_crc));
  logic [7:0] told_crc, got_crc;
  cuboct_link_crc #(
    .Bits(SequenceBits), .Width(8), .Polynomial(32'h00000037), .Start(32'h000000ff)
  ) u_told_crc (.data_i(ack[SequenceBits-1:0]), .crc_o(told_crc));
  cuboct_link_crc #(
    .Bits(SequenceBits), .Width(8), .Polynomial(32'h00000037), .Start(32'h000000ff)
  ) u_got_crc (.data_i(tap_ack[SequenceBits-1:0]), .crc_o(got_crc));

  logic [SequenceBits-1:0] came_low;
  assign came_low = came_q[SequenceBits-1:0] + {{(SequenceBits - 1) {1'b0}}, out_valid};
  always_ff @(posedge clk_i) begin
    if (running_q && Wire == 0) begin
      i_head:     assert (tap_head == sent_q[SequenceBits-1:0]);
      i_window:   assert (pending <= Window[SequenceBits-1:0] && sent <= pending);
      i_expected: assert (tap_expected == came_low);
      i_received: assert (received <= pending && behind <= 8'd0 + Window[7:0] + 8'd1);
      i_behind:   assert ({1'b0, behind} == {{(9 - SequenceBits) {1'b0}}, pending - received} + {8'd0, out_valid});
      i_told:     assert (told_ack <= received && ack[SequenceBits +: 8] == told_crc);
      if (tap_ack[SequenceBits +: 8] == got_crc) i_got: assert (got_ack <= told_ack);
      if (tx_valid) begin
        i_wire:   assert (on_wire >= 8'd1 && on_wire <= Window[7:0]);
        i_word:   assert (tx_data == {wire_crc, wire_q[SequenceBits-1:0], wire_q[LinkBits-1:0]}
                          && tx_end == end_of(wire_q));
      end
      if (repeat_q) begin
        i_copied: assert (copied >= 8'd1 && copied <= Window[7:0] + 8'd1);
        i_copy:   assert (copy_q == {copy_crc, copied_q[SequenceBits-1:0], copied_q[LinkBits-1:0],
                                     end_of(copied_q)});
      end
    end
  end
  (* keep *) logic [Window*Entry-1:0] tap_kept;
  logic [Window-1:0] kept_wrong;
  for (genvar k = 0; k < Window; k++) begin : gen_slot
    // The beat of the window that this slot holds.
    localparam int Slot = k;
    logic [7:0]         count, age, last;
    logic [CrcBits-1:0] crc;
    assign last  = sent_q - 8'd1;
    assign age   = (last - Slot[7:0]) & (Window[7:0] - 8'd1);
    assign count = last - age;
    cuboct_link_crc #(
      .Bits(LinkBits + 1 + SequenceBits), .Width(CrcBits), .Polynomial(32'h0000002f), .Start(32'h000000ff)
    ) u_crc (.data_i({count[SequenceBits-1:0], end_of(count), count[LinkBits-1:0]}), .crc_o(crc));
    assign kept_wrong[k] = (Retry != 0) && (age < {{(8 - SequenceBits) {1'b0}}, pending})
                           && (tap_kept[k*Entry +: Entry] != {crc, end_of(count), count[LinkBits-1:0]});
  end
  always_ff @(posedge clk_i) begin
    if (running_q && Wire == 0) i_kept: assert (kept_wrong == '0);
  end
endmodule
