// SPDX-License-Identifier: MIT
// The sender of the exchange phases: own records, then the halos that the axes before this one brought, to both links
// of the axis in lock step. One thing per cycle: an empty segment is left, or a beat is loaded, or it waits. From
// narrow memories halos come word by word, a beat each.
module cuboct_relay #(
  parameter int Axes      = 3,   // 2 or 3
  parameter int LinkBits  = 32,  // payload of a beat
  parameter int HaloBits  = 32,  // bits of a record
  parameter int SlotBits  = 4,   // of an own slot's number
  parameter int AddrBits  = 8,   // of a record's number in any segment
  parameter int CountBits = 8,   // of a segment's count
  parameter int Narrow    = 0,   // 0, 1
  parameter int FirstWord = 0,   // of a face's halos; Narrow only
  parameter int WordBits  = 1    // of a word's number; Narrow only
) (
  input  logic                   clk_i,
  input  logic                   rst_ni,
  input  logic                   active_i,    // the machine is in an exchange phase
  input  logic [1:0]             axis_i,      // below Axes
  input  logic                   done_i,      // last cycle of the phase
  // Segments: 0 own, then the halos of -x, +x and, with three axes, -y, +y; their counts, and where to read.
  input  logic [(2*Axes-1)*CountBits-1:0] counts_i,  // constant in a phase; of own ones the next cycle's
  output logic [2*Axes-2:0]      pick_o,      // which one, one bit each; none for the end beat
  output logic [2*Axes-2:0]      clear_o,     // with read_o, by segment: it is not picked next, its answer is 0
  output logic                   read_o,      // asks all for what comes next; without it the answers stay
  output logic [AddrBits-1:0]    addr_o,      // with read_o: of the record
  output logic [AddrBits-1:0]    ahead_o,     // with read_o: addr_o and 1; not Narrow
  output logic [SlotBits-1:0]    slot_o,      // addr_o, for the own particles; 0 outside of a phase
  input  logic [HaloBits-1:0]    record_i,    // an own one, as asked for
  input  logic [HaloBits-1:0]    halo_i,      // of the segment picked, as asked for; 0 if own or none; not Narrow
  output logic [WordBits-1:0]    word_o,      // Narrow: number of the next cycle's halo word
  input  logic [LinkBits-1:0]    word_i,      // Narrow: of pick_o, word_o of the cycle before; of none 0
  // To the link registers.
  input  logic                   can_load_i,  // both links can
  output logic                   load_o,      // both load this beat
  output logic                   end_o,       // it is an end beat
  output logic [LinkBits-1:0]    data_o,      // with load_o: payload but for halos; 0 outside of a phase
  output logic [LinkBits-1:0]    halo_data_o, // with load_o: payload of halos, or 0; late in the cycle
  output logic                   first_own_o, // the first beat of an own record is loaded
  output logic                   sent_o       // the end beat was loaded
);
  localparam int Beats    = (HaloBits + LinkBits - 1) / LinkBits;
  localparam int BeatBits = (Beats > 1) ? $clog2(Beats) : 1;
  localparam int LastBeat = Beats - 1;
  localparam int Segments = 2 * Axes - 1;
  localparam logic [CountBits-1:0] One = 1;
  localparam logic [CountBits-1:0] Two = 2;

  // What is asked for next depends on registers alone, whether it is asked for on the links.
  logic [Segments-1:0]  pick_d, pick_q, pick_next;
  logic [BeatBits-1:0]  beat_d, beat_q;
  logic                 sent_d, sent_q;
  logic [CountBits-1:0] count_d, count_q, next_count;  // of this segment, of the one after it
  logic [CountBits-1:0] next_d, next_q, after_d, after_q;  // the record's number and 1, and 2
  logic                 past_d, past_q;                // behind the last segment: pick_q is 0
  logic                 some_d, some_q;                // the segment has this record,
  logic                 few_d, few_q;                  // and none behind it
  logic                 working, leaves, last_segment, last_beat, stays, moves;

  integer s;
  always_comb begin
    next_count   = '0;
    last_segment = pick_q[0] && (axis_i == 2'd0);
    for (s = 1; s < Segments; s = s + 1) begin
      next_count = next_count | (counts_i[s*CountBits +: CountBits] & {CountBits{pick_q[s-1]}});
      if (pick_q[s] && {axis_i, 1'b0} == s[2:0]) last_segment = 1'b1;
    end
  end
  assign working = active_i && !sent_q;
  assign end_o   = working && past_q && can_load_i;
  assign load_o  = working && can_load_i && (past_q || some_q);
  // To the next record, or to the next segment, or past them all.
  assign leaves    = active_i && few_q;
  assign stays     = active_i && some_q;  // but for the last beat
  assign last_beat = (Beats == 1) || (beat_q == LastBeat[BeatBits-1:0]);
  assign read_o    = !stays || (can_load_i && last_beat);
  assign moves     = working && !past_q && read_o;
  assign pick_next = !leaves ? pick_q : last_segment ? '0 : pick_q << 1;

  always_comb begin
    pick_d  = pick_q;
    count_d = count_q;
    next_d  = next_q;
    after_d = after_q;
    beat_d  = beat_q;
    sent_d  = sent_q || end_o;
    past_d  = past_q;
    some_d  = some_q;
    few_d   = few_q;
    if (load_o && !past_q && Beats > 1) beat_d = beat_q + 1'b1;
    if (moves) begin
      pick_d = pick_next;
      beat_d = '0;
      next_d  = leaves ? One : after_q;
      after_d = leaves ? Two : after_q + 1'b1;
      some_d  = leaves ? !last_segment && (next_count != '0) : 1'b1;
      few_d   = leaves ? (next_count[CountBits-1:1] == '0) : (count_q == after_q);
      past_d  = leaves && last_segment;
      if (leaves) count_d = next_count;
    end
    if (!active_i || done_i) begin
      pick_d  = {{(Segments - 1) {1'b0}}, 1'b1};
      past_d  = 1'b0;
      count_d = counts_i[0 +: CountBits];
      some_d  = (counts_i[0 +: CountBits] != '0);
      few_d   = (counts_i[1 +: CountBits-1] == '0);
      sent_d  = 1'b0;
    end
  end
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      pick_q  <= {{(Segments - 1) {1'b0}}, 1'b1};
      past_q  <= 1'b0;
      count_q <= '0;
      some_q  <= 1'b0;
      few_q   <= 1'b1;
      next_q  <= One;
      after_q <= Two;
      beat_q  <= '0;
      sent_q  <= 1'b0;
    end else begin
      pick_q  <= pick_d;
      past_q  <= past_d;
      count_q <= count_d;
      some_q  <= some_d;
      few_q   <= few_d;
      next_q  <= next_d;
      after_q <= after_d;
      beat_q  <= beat_d;
      sent_q  <= sent_d;
    end
  end

  assign pick_o      = pick_q;
  assign clear_o     = ~pick_next;
  assign addr_o      = (active_i && !past_q && !few_q) ? next_q[AddrBits-1:0] : '0;
  assign ahead_o     = (active_i && !past_q && !few_q) ? after_q[AddrBits-1:0] : One[AddrBits-1:0];
  assign slot_o      = addr_o[SlotBits-1:0];
  assign sent_o      = sent_q;
  assign first_own_o = load_o && pick_q[0] && (beat_q == '0);

  logic [LinkBits-1:0] beat;
  cuboct_beat #(.Bits(HaloBits), .LinkBits(LinkBits), .BeatBits(BeatBits)) u_beat (
    .word_i(record_i), .beat_i(beat_q), .data_o(beat)
  );
  if (Narrow != 0) begin : gen_words
    logic [WordBits-1:0] word_d, word_q;
    always_comb begin
      word_d = word_q;
      if (load_o && !pick_q[0]) word_d = word_q + 1'b1;
      if ((moves && leaves) || done_i) word_d = FirstWord[WordBits-1:0];
    end
    always_ff @(posedge clk_i) begin
      if (!rst_ni) word_q <= FirstWord[WordBits-1:0];
      else word_q <= word_d;
    end
    assign word_o      = word_d;
    assign data_o      = !active_i ? '0 : pick_q[0] ? beat : word_i;
    assign halo_data_o = '0;
    logic unused_halo;
    assign unused_halo = ^halo_i;
  end else begin : gen_records
    logic unused_word;
    assign unused_word = ^word_i;
    assign word_o      = '0;
    assign data_o      = (active_i && pick_q[0]) ? beat : '0;
    cuboct_beat #(.Bits(HaloBits), .LinkBits(LinkBits), .BeatBits(BeatBits)) u_halo_beat (
      .word_i(halo_i), .beat_i(beat_q), .data_o(halo_data_o)
    );
  end
endmodule
