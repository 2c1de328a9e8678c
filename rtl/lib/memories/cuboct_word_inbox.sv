// SPDX-License-Identifier: MIT
// What came over one face in this step, word by word: a beat of the link is a word of the memory. The particles that
// migrate lie from word 0 on, the halo records behind the room of Capacity particles: each stream is written from its
// place on, as what the one before left there was used up (docs/reference/node.md, section Order). One port to read. A
// record counts from the cycle after its last beat on; a word can be asked for from then on and is there a cycle later.
// Streams alternate: halo, migrate, halo, ...; an end beat closes each.
module cuboct_word_inbox #(
  parameter int LinkBits     = 16,  // of a beat, >= 1
  parameter int HaloBits     = 66,  // of a halo record, >= 1
  parameter int ParticleBits = 128, // >= 1
  parameter int HaloDepth    = 16,  // halo records, >= 1
  parameter int Capacity     = 16,  // particles, >= 1
  parameter int CountBits    = 5,   // of the halos' count
  parameter int WordBits     = 8,   // of a word's number
  parameter int Signed       = 1,   // 1: two bits of a halo record are a sign that changes on the way:
  parameter int SignLsb      = 20,  // where; from 00, 01, 11
  parameter int Below        = 0    // 1: one less, from below; 0: one more
) (
  input  logic                 clk_i,
  input  logic                 rst_ni,
  // From the neighbour. There always is room (docs/reference/node.md, section Order).
  input  logic                 valid_i,        // a beat is there
  input  logic                 end_i,          // an end beat
  input  logic [LinkBits-1:0]  data_i,         // payload: a word
  output logic                 halo_end_o,     // pulse
  output logic                 migrate_end_o,  // pulse
  // Halos.
  input  logic                 clear_i,        // the step's halos are read
  output logic [CountBits-1:0] count_o,        // records that came in this step
  // Particles.
  input  logic                 pop_i,          // the oldest particle is done with
  output logic                 empty_o,        // no particle waits
  output logic                 full_o,         // Capacity particles wait
  // The port.
  input  logic [WordBits-1:0]  word_i,         // asked for in every cycle
  output logic [LinkBits-1:0]  data_o          // from the next cycle on
);
  localparam int HaloBeats    = (HaloBits + LinkBits - 1) / LinkBits;
  localparam int MigrateBeats = (ParticleBits + LinkBits - 1) / LinkBits;
  localparam int MaxBeats     = (HaloBeats > MigrateBeats) ? HaloBeats : MigrateBeats;
  localparam int BeatBits     = (MaxBeats > 1) ? $clog2(MaxBeats) : 1;
  localparam int HaloLast     = HaloBeats - 1;
  localparam int MigrateLast  = MigrateBeats - 1;
  localparam int First        = Capacity * MigrateBeats;  // of the halos
  localparam int Depth        = First + HaloDepth * HaloBeats;
  localparam int LevelBits    = $clog2(Capacity + 1);

  logic                 migrating_d, migrating_q;  // the stream that comes next, or is coming
  logic [BeatBits-1:0]  beat_d, beat_q, last_beat;
  logic                 take, record_done, append, push;
  logic [WordBits-1:0]  word_d, word_q;        // to be written next
  logic [CountBits-1:0] count_d, count_q;
  logic [LevelBits-1:0] held_d, held_q;

  assign take        = valid_i && !end_i;
  assign last_beat   = migrating_q ? MigrateLast[BeatBits-1:0] : HaloLast[BeatBits-1:0];
  assign record_done = take && (beat_q == last_beat);
  assign append      = record_done && !migrating_q;
  assign push        = record_done && migrating_q;
  always_comb begin
    beat_d      = beat_q;
    migrating_d = migrating_q;
    word_d      = word_q;
    count_d     = count_q;
    held_d      = held_q;
    if (record_done) beat_d = '0;
    else if (take) beat_d = beat_q + 1'b1;
    if (take) word_d = word_q + 1'b1;
    if (valid_i && end_i) begin
      migrating_d = !migrating_q;
      word_d      = migrating_q ? First[WordBits-1:0] : '0;
    end
    if (append) count_d = count_q + 1'b1;
    if (clear_i) count_d = '0;
    if (push && !pop_i) held_d = held_q + 1'b1;
    if (pop_i && !push) held_d = held_q - 1'b1;
  end
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      beat_q      <= '0;
      migrating_q <= 1'b0;
      word_q      <= First[WordBits-1:0];
      count_q     <= '0;
      held_q      <= '0;
    end else begin
      beat_q      <= beat_d;
      migrating_q <= migrating_d;
      word_q      <= word_d;
      count_q     <= count_d;
      held_q      <= held_d;
    end
  end

  // The sign's lower bit always changes, the upper one where the lower one was clear (below) or set. The two may lie in
  // two words.
  logic [LinkBits-1:0] flips;
  if (Signed != 0) begin : gen_signed
    localparam int LowBeat  = SignLsb / LinkBits;
    localparam int LowBit   = SignLsb % LinkBits;
    localparam int HighBeat = (SignLsb + 1) / LinkBits;
    localparam int HighBit  = (SignLsb + 1) % LinkBits;
    logic low, carries;
    assign carries = (Below != 0) ? !low : low;
    if (LowBeat == HighBeat) begin : gen_together
      assign low = data_i[LowBit];
    end else begin : gen_apart
      logic low_q;
      always_ff @(posedge clk_i) begin
        if (take) low_q <= data_i[LowBit];
      end
      assign low = low_q;
    end
    always_comb begin
      flips = '0;
      if (!migrating_q && beat_q == LowBeat[BeatBits-1:0]) flips[LowBit] = 1'b1;
      if (!migrating_q && beat_q == HighBeat[BeatBits-1:0]) flips[HighBit] = carries;
    end
  end else begin : gen_unsigned
    assign flips = '0;
  end

  cuboct_ram #(.Bits(LinkBits), .Depth(Depth), .AddrBits(WordBits)) u_words (
    .clk_i, .write_i(take), .write_addr_i(word_q), .write_data_i(data_i ^ flips), .read_i(1'b1), .clear_i(1'b0),
    .read_addr_i(word_i), .read_data_o(data_o)
  );

  assign count_o       = count_q;
  assign empty_o       = (held_q == '0);
  assign full_o        = (held_q == Capacity[LevelBits-1:0]);
  assign halo_end_o    = valid_i && end_i && !migrating_q;
  assign migrate_end_o = valid_i && end_i && migrating_q;

`ifndef SYNTHESIS
  always_ff @(posedge clk_i) begin
    if (rst_ni && append) a_halo_room: assert (count_q != HaloDepth[CountBits-1:0]);
    if (rst_ni && push) a_migrate_room: assert (!full_o);
  end
`endif
endmodule
