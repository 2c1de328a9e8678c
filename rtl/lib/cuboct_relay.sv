// SPDX-License-Identifier: MIT
// The sender of the exchange phases: own records, then the halos that the axes before this one brought, to both links
// of the axis in lock step. One thing per cycle: an empty segment is left, or a beat is loaded, or it waits. From narrow
// memories halos come word by word, a beat each.
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
  input  logic [(2*Axes-1)*CountBits-1:0] counts_i,
  output logic [2*Axes-2:0]      pick_o,      // which one, one bit each; none for the end beat
  output logic [AddrBits-1:0]    addr_o,      // of the next cycle's record
  output logic [SlotBits-1:0]    slot_o,      // addr_o, for the own particles
  input  logic [HaloBits-1:0]    record_i,    // of pick_o, at addr_o of the cycle before; of none 0; Narrow: own ones only
  output logic [WordBits-1:0]    word_o,      // Narrow: number of the next cycle's halo word
  input  logic [LinkBits-1:0]    word_i,      // Narrow: of pick_o, word_o of the cycle before; of none 0
  // To the link registers.
  input  logic                   can_load_i,  // both links can
  output logic                   load_o,      // both load this beat
  output logic                   end_o,       // it is an end beat
  output logic [LinkBits-1:0]    data_o,      // with load_o: payload
  output logic                   first_own_o, // the first beat of an own record is loaded
  output logic                   sent_o       // the end beat was loaded
);
  localparam int Beats    = (HaloBits + LinkBits - 1) / LinkBits;
  localparam int BeatBits = (Beats > 1) ? $clog2(Beats) : 1;
  localparam int LastBeat = Beats - 1;
  localparam int Segments = 2 * Axes - 1;

  logic [2:0]           segment_d, segment_q, segments;
  logic [Segments-1:0]  pick_d, pick_q;  // from registers: what is picked comes late in the cycle
  logic [AddrBits-1:0]  record_d, record_q;
  logic [BeatBits-1:0]  beat_d, beat_q;
  logic                 sent_d, sent_q;
  logic [CountBits-1:0] count;
  logic                 past, empty, working, last_record;

  assign segments = {axis_i, 1'b1};  // one more than two per axis before this one
  integer s;
  always_comb begin
    count = '0;
    for (s = 0; s < Segments; s = s + 1) begin
      count     = count | (counts_i[s*CountBits +: CountBits] & {CountBits{pick_q[s]}});
      pick_d[s] = (segment_d == s[2:0]) && (segment_d != segments);
    end
  end

  assign working     = active_i && !sent_q;
  assign past        = (pick_q == '0);
  assign empty       = (count == '0);
  assign last_record = (count == {{(CountBits - AddrBits) {1'b0}}, record_q} + 1'b1);
  assign end_o       = working && past && can_load_i;
  assign load_o      = working && can_load_i && (past || !empty);

  always_comb begin
    segment_d = segment_q;
    record_d  = record_q;
    beat_d    = beat_q;
    sent_d    = sent_q;
    if (working && !past && empty) begin
      segment_d = segment_q + 3'd1;
    end else if (end_o) begin
      sent_d = 1'b1;
    end else if (load_o) begin
      beat_d = beat_q + 1'b1;
      if (beat_q == LastBeat[BeatBits-1:0]) begin
        beat_d   = '0;
        record_d = record_q + 1'b1;
        if (last_record) begin
          record_d  = '0;
          segment_d = segment_q + 3'd1;
        end
      end
    end
    if (done_i) begin
      segment_d = 3'd0;
      sent_d    = 1'b0;
    end
  end
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      segment_q <= 3'd0;
      pick_q    <= {{(Segments - 1) {1'b0}}, 1'b1};
      record_q  <= '0;
      beat_q    <= '0;
      sent_q    <= 1'b0;
    end else begin
      segment_q <= segment_d;
      pick_q    <= pick_d;
      record_q  <= record_d;
      beat_q    <= beat_d;
      sent_q    <= sent_d;
    end
  end

  assign pick_o      = pick_q;
  assign addr_o      = record_d;
  assign slot_o      = record_d[SlotBits-1:0];
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
      if (segment_d != segment_q) word_d = FirstWord[WordBits-1:0];
    end
    always_ff @(posedge clk_i) begin
      if (!rst_ni) word_q <= FirstWord[WordBits-1:0];
      else word_q <= word_d;
    end
    assign word_o = word_d;
    assign data_o = pick_q[0] ? beat : word_i;
  end else begin : gen_records
    logic unused_word;
    assign unused_word = ^word_i;
    assign word_o      = '0;
    assign data_o      = beat;
  end
endmodule
