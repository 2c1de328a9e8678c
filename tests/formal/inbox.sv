// SPDX-License-Identifier: MIT
// cuboct_inbox: the k-th halo since the clear, k any, is what both ports answer in the cycle after they asked
// for address k; the streamer's answer stays until the memory is read for someone else. A watched particle,
// any of those pushed, comes out once, after those before it and before those after it, unchanged; it counts
// from the second cycle after its push on. Neither stream touches what the other one keeps. Arrival: the relay's
// records come apart from the streamer's, and the streamer's answer is shown when it is told to. Ahead: the relay's
// answer is what stood where the memory was asked the time before, and it is asked for address 0 with each clear.
module inbox_formal #(
  parameter int HaloDepth    = 2,
  parameter int Capacity     = 2,
  parameter int HaloBits     = 2,
  parameter int ParticleBits = 1,
  parameter int Relayed      = 1,
  parameter int Arrival      = 0,
  parameter int Ahead        = 0
) (
  input logic                    clk_i,
  input logic                    clear_i,
  input logic                    append_i,
  input logic [HaloBits-1:0]     halo_i,
  input logic                    relay_append_i,
  input logic [HaloBits-1:0]     relay_record_i,
  input logic                    read_i,
  input logic                    next_i,
  input logic [7:0]              addr_i, relay_addr_i,
  input logic                    relay_read_i,
  input logic                    relay_clear_i,
  input logic                    migrating_i,
  input logic                    push_i,
  input logic                    pop_i,
  input logic [ParticleBits-1:0] particle_i,
  input logic                    watch_i  // the particle pushed in this cycle is the one watched; any may be
);
  localparam int Depth     = HaloDepth + Capacity;
  localparam int AddrBits  = (HaloDepth > 1) ? $clog2(HaloDepth) : 1;
  localparam int CountBits = $clog2(Depth + 1) + 1;  // one to spare, as where depths differ by face

  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;

  logic [CountBits-1:0]    count, relay_count;
  logic [HaloBits-1:0]     halo, relay_halo;
  logic                    full, empty;
  logic [ParticleBits-1:0] particle;
  cuboct_inbox #(
    .HaloBits(HaloBits), .ParticleBits(ParticleBits), .HaloDepth(HaloDepth), .Capacity(Capacity),
    .Relayed(Relayed), .Arrival(Arrival), .Ahead(Ahead), .AddrBits(AddrBits), .CountBits(CountBits)
  ) u_dut (
    .clk_i, .rst_ni(running_q), .clear_i, .append_i, .halo_i, .count_o(count), .read_i, .next_i,
    .addr_i(addr_i[AddrBits-1:0]), .halo_o(halo), .relay_append_i, .relay_record_i, .relay_count_o(relay_count),
    .relay_read_i, .relay_clear_i,
    .relay_addr_i(relay_addr_i[AddrBits-1:0]), .relay_ahead_i(relay_addr_i[AddrBits-1:0]),
    .relay_halo_o(relay_halo), .migrating_i, .push_i, .particle_i, .full_o(full), .pop_i,
    .particle_o(particle), .empty_o(empty)
  );

  // Halos come only where there is room and never in the cycle of the clear: cuboct_halos asserts the one,
  // the proof `neighbours` shows both. A link brings one record at a time (proof `link`).
  // What passes the cull comes cycles later, and may meet a particle.
  logic [CountBits-1:0] count_q, relay_count_q, held_q, before_q;
  always_comb begin
    if (append_i) assume (running_q && !clear_i && count_q != HaloDepth[CountBits-1:0]);
    if (append_i && Arrival == 0) assume (!push_i);
    if (relay_append_i) assume (running_q && !clear_i && !push_i && relay_count_q != HaloDepth[CountBits-1:0]);
    if (Arrival == 0) assume (relay_append_i == append_i && relay_record_i == halo_i);
    if (push_i) assume (running_q && !full);
    if (pop_i) assume (running_q && !empty);
  end

  // The watched halo, by its number, and what is known of the answers.
  (* anyconst *) logic [AddrBits-1:0] number;
  logic                               counts, relay_counts, cleared_q, asked_q, shown_halo_q, halo_known, relayed_q;
  logic                               kept_q;
  logic [HaloBits-1:0]                value_q, relay_value_q, answer_q, shown_answer_q, halo_answer, relay_answer_q;
  // Arrival: an answer is shown when it is told to.
  assign halo_known   = (Arrival != 0) ? shown_halo_q : asked_q;
  assign halo_answer  = (Arrival != 0) ? shown_answer_q : answer_q;
  logic                after_q, relay_asked;  // Ahead: what the memory was asked for last
  logic [HaloBits-1:0] after_value_q;
  assign relay_asked  = relay_counts
                     && ((Ahead != 0 && relay_clear_i) ? '0 : relay_addr_i[AddrBits-1:0]) == number;
  assign relay_counts = ({{(CountBits - AddrBits) {1'b0}}, number} < relay_count_q);
  assign counts = ({{(CountBits - AddrBits) {1'b0}}, number} < count_q);
  always_ff @(posedge clk_i) begin
    if (!running_q) begin
      count_q       <= '0;
      relay_count_q <= '0;
      cleared_q     <= 1'b0;
      asked_q       <= 1'b0;
      shown_halo_q  <= 1'b0;
      relayed_q <= 1'b0;
      after_q   <= 1'b0;
      kept_q    <= 1'b0;
    end else begin
      if (clear_i) count_q <= '0;
      else if (append_i) count_q <= count_q + 1'b1;
      if (clear_i) relay_count_q <= '0;
      else if (relay_append_i) relay_count_q <= relay_count_q + 1'b1;
      if (next_i) shown_halo_q <= asked_q;
      cleared_q <= cleared_q || (clear_i && count_q == HaloDepth[CountBits-1:0]);
      if (read_i) asked_q <= counts && addr_i[AddrBits-1:0] == number;
      kept_q    <= halo_known && !((Arrival != 0) ? next_i : read_i);  // the answer stays
      if (relay_read_i) relayed_q <= (Ahead != 0) ? after_q : relay_asked;
      if (relay_read_i && relay_clear_i) relayed_q <= 1'b1;
      if (relay_read_i) after_q <= relay_asked;
    end
    if (append_i && count_q == {{(CountBits - AddrBits) {1'b0}}, number}) value_q <= halo_i;
    if (relay_append_i && relay_count_q == {{(CountBits - AddrBits) {1'b0}}, number}) relay_value_q <= relay_record_i;
    if (read_i) answer_q <= value_q;
    if (next_i) shown_answer_q <= answer_q;
    if (relay_read_i) relay_answer_q <= (Ahead != 0) ? after_value_q : relay_value_q;
    if (relay_read_i) after_value_q <= relay_value_q;
    if (relay_read_i && relay_clear_i) relay_answer_q <= '0;
  end

  // The watched particle: how many are inside, of which the last may not count yet; how many stand before it.
  logic                    pushed_q, watched_q, inside_q, shown_q, migrating_q;
  logic [ParticleBits-1:0] particle_q;
  always_ff @(posedge clk_i) begin
    migrating_q <= running_q && migrating_i;
    if (!running_q) begin
      held_q    <= '0;
      pushed_q  <= 1'b0;
      watched_q <= 1'b0;
      inside_q  <= 1'b0;
      shown_q   <= 1'b0;
    end else begin
      held_q   <= held_q + {{(CountBits - 1) {1'b0}}, push_i} - {{(CountBits - 1) {1'b0}}, pop_i};
      pushed_q <= push_i;
      shown_q  <= inside_q;
      if (push_i && watch_i && !watched_q) begin
        watched_q  <= 1'b1;
        inside_q   <= 1'b1;
        particle_q <= particle_i;
        before_q   <= held_q - {{(CountBits - 1) {1'b0}}, pop_i};
      end else if (inside_q && pop_i) begin
        before_q <= before_q - 1'b1;
        if (before_q == '0) inside_q <= 1'b0;
      end
    end
  end

  // A word that is asked for in the cycle in which it is written has no defined answer: no one looks at it.
  localparam int PlaceBits = (Capacity > 1) ? $clog2(Capacity) : 1;
  (* keep *) logic                 tap_write, tap_read, tap_push, tap_show;
  (* keep *) logic [AddrBits-1:0]  tap_write_addr, tap_read_addr;
  (* keep *) logic [PlaceBits-1:0] tap_push_place, tap_show_place;
  logic                            torn_q, torn_particle_q;
  always_ff @(posedge clk_i) begin
    if (!running_q) begin
      torn_q          <= 1'b0;
      torn_particle_q <= 1'b0;
    end else begin
      if (tap_read) torn_q <= tap_write && tap_write_addr == tap_read_addr;
      if (tap_show) torn_particle_q <= tap_push && tap_push_place == tap_show_place;
    end
  end

  always_ff @(posedge clk_i) begin
    if (running_q) begin
      a_count: assert (count == count_q && count_q <= HaloDepth[CountBits-1:0]);
      a_relay_count: assert (relay_count == relay_count_q);
      if (halo_known) a_halo: assert (halo == halo_answer);
      if (asked_q) a_torn: assert (!torn_q);
      if (relayed_q && Relayed != 0) a_relay: assert (relay_halo == relay_answer_q);
      a_full:  assert (full == (held_q == Capacity[CountBits-1:0]));
      a_empty: assert (empty == (held_q == {{(CountBits - 1) {1'b0}}, pushed_q}));
      if (inside_q && shown_q) a_held: assert (!empty);
      if (inside_q && shown_q && before_q == '0 && migrating_q) begin
        a_particle: assert (particle == particle_q && !torn_particle_q);
      end
      c_all:     cover (count == HaloDepth[CountBits-1:0] && full && asked_q && relayed_q && value_q == '1);
      c_cleared: cover (cleared_q && count == '0);
      c_again:   cover (cleared_q && counts && asked_q && value_q == '1);
      c_kept:    cover (kept_q && halo_known && count == '0 && halo_answer == '1);
      c_drained: cover (empty && watched_q && !inside_q && held_q == '0 && !pushed_q && count != '0);
      c_wrapped: cover (full && watched_q && !inside_q);
      c_both:    cover (migrating_q && inside_q && shown_q && before_q == '0 && pop_i
                        && (Capacity == 1 || push_i));
      c_torn:    cover (torn_q && torn_particle_q);
    end
  end
endmodule
