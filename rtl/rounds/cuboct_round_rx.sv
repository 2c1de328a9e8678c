// SPDX-License-Identifier: MIT
// Assembles the records of one link of a node whose rule has several rounds. Streams follow one another: the halo of
// each round, particles, the halo of the first round again; an end beat closes each. The outputs are valid in the cycle
// in which the last beat of a record, or the end beat, is taken; the consumer registers them.
module cuboct_round_rx #(
  parameter int                   LinkBits    = 32,  // payload of a beat, >= 1
  parameter int                   Rounds      = 2,   // >= 1
  parameter logic [Rounds*16-1:0] RecordBits  = {Rounds{16'd32}},  // by round: of a record; 0: none ever comes
  parameter int                   MostBits    = 32,  // of any round's record, >= 1
  parameter int                   MigrateBits = 32   // of a particle, >= 1
) (
  input  logic                   clk_i,
  input  logic                   rst_ni,
  input  logic                   valid_i,          // a beat is there; there always is room for it
  input  logic                   end_i,            // an end beat
  input  logic [LinkBits-1:0]    data_i,           // payload
  output logic [Rounds-1:0]      halo_valid_o,     // by round: last beat of a halo record
  output logic [MostBits-1:0]    halo_o,           // with halo_valid_o, in the least significant bits
  output logic [Rounds-1:0]      halo_end_o,       // by round: end of the halo stream
  output logic                   migrate_valid_o,  // last beat of a particle
  output logic [MigrateBits-1:0] migrate_o,        // with migrate_valid_o
  output logic                   migrate_end_o     // end of the migration stream
);
  localparam int MigrateBeats = (MigrateBits + LinkBits - 1) / LinkBits;
  localparam int HaloBeats    = (MostBits + LinkBits - 1) / LinkBits;
  localparam int MaxBeats     = (HaloBeats > MigrateBeats) ? HaloBeats : MigrateBeats;
  localparam int BeatBits     = (MaxBeats > 1) ? $clog2(MaxBeats) : 1;
  localparam int MigrateLast  = MigrateBeats - 1;

  logic [Rounds:0]     stream_d, stream_q;  // the stream that comes next, or is coming: one bit each, particles last
  logic [BeatBits-1:0] beat_d, beat_q, last_beat;
  logic [Rounds*BeatBits-1:0] last_of;  // by round
  logic                take, record_done;

  for (genvar k = 0; k < Rounds; k++) begin : gen_last
    localparam int Bits = {16'd0, RecordBits[k*16 +: 16]};
    localparam int Last = (Bits > LinkBits) ? (Bits + LinkBits - 1) / LinkBits - 1 : 0;
    assign last_of[k*BeatBits +: BeatBits] = Last[BeatBits-1:0];
  end
  integer r;
  always_comb begin
    last_beat = stream_q[Rounds] ? MigrateLast[BeatBits-1:0] : '0;
    for (r = 0; r < Rounds; r = r + 1) begin
      last_beat = last_beat | (last_of[r*BeatBits +: BeatBits] & {BeatBits{stream_q[r]}});
    end
  end
  assign take        = valid_i && !end_i;
  assign record_done = take && (beat_q == last_beat);
  assign beat_d      = record_done ? '0 : take ? beat_q + 1'b1 : beat_q;
  assign stream_d    = (valid_i && end_i) ? {stream_q[Rounds-1:0], stream_q[Rounds]} : stream_q;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      beat_q   <= '0;
      stream_q <= {{Rounds{1'b0}}, 1'b1};
    end else begin
      beat_q   <= beat_d;
      stream_q <= stream_d;
    end
  end

  // Beats before the last one; the last comes straight from the link.
  logic [MaxBeats*LinkBits-1:0] padded;
  if (MaxBeats > 1) begin : gen_parts
    logic [LinkBits-1:0] part_q [0:MaxBeats-2];
    for (genvar b = 0; b < MaxBeats - 1; b++) begin : gen_part
      localparam int Beat = b;
      always_ff @(posedge clk_i) begin
        if (take && beat_q == Beat[BeatBits-1:0]) part_q[b] <= data_i;
      end
      assign padded[b*LinkBits +: LinkBits] = (last_beat == Beat[BeatBits-1:0]) ? data_i : part_q[b];
    end
  end
  assign padded[(MaxBeats-1)*LinkBits +: LinkBits] = data_i;

  assign halo_o          = padded[MostBits-1:0];
  assign migrate_o       = padded[MigrateBits-1:0];
  assign halo_valid_o    = stream_q[Rounds-1:0] & {Rounds{record_done}};
  assign migrate_valid_o = record_done && stream_q[Rounds];
  assign halo_end_o      = stream_q[Rounds-1:0] & {Rounds{valid_i && end_i}};
  assign migrate_end_o   = valid_i && end_i && stream_q[Rounds];

  logic unused_padding;
  assign unused_padding = ^padded;
endmodule
