// SPDX-License-Identifier: MIT
// Assembles the records of one link. Streams alternate: halo, migrate, halo, ...; an end beat closes each. The outputs
// are valid in the cycle in which the last beat of a record, or the end beat, is taken; the consumer registers them.
module cuboct_link_rx #(
  parameter int LinkBits    = 32,  // payload of a beat, >= 1
  parameter int HaloBits    = 32,  // bits of a halo record, >= 1
  parameter int MigrateBits = 32   // bits of a particle, >= 1
) (
  input  logic                   clk_i,
  input  logic                   rst_ni,
  // From the neighbour. There always is room (docs/reference/node.md, section Order), so ready is constant.
  input  logic                   valid_i,          // a beat is there
  input  logic                   end_i,            // an end beat
  input  logic [LinkBits-1:0]    data_i,           // payload
  output logic                   ready_o,          // it is taken
  // Pulses, and what they are about.
  output logic                   halo_valid_o,     // last beat of a halo record
  output logic [HaloBits-1:0]    halo_o,           // with halo_valid_o
  output logic                   halo_end_o,       // end of the halo stream
  output logic                   migrate_valid_o,  // last beat of a particle
  output logic [MigrateBits-1:0] migrate_o,        // with migrate_valid_o
  output logic                   migrate_end_o     // end of the migration stream
);
  localparam int HaloBeats    = (HaloBits + LinkBits - 1) / LinkBits;
  localparam int MigrateBeats = (MigrateBits + LinkBits - 1) / LinkBits;
  localparam int MaxBeats     = (HaloBeats > MigrateBeats) ? HaloBeats : MigrateBeats;
  localparam int BeatBits     = (MaxBeats > 1) ? $clog2(MaxBeats) : 1;
  localparam int HaloLast     = HaloBeats - 1;
  localparam int MigrateLast  = MigrateBeats - 1;

  logic                migrating_d, migrating_q;  // the stream that comes next, or is coming
  logic [BeatBits-1:0] beat_d, beat_q, last_beat, other_last;  // last: of a record of this stream, of one of the next
  logic                last_d, last_q;             // beat_q is last_beat
  logic                halo_last_q, migrate_last_q;  // and the stream is one of halos, of particles
  logic                take, record_done;

  assign ready_o     = 1'b1;
  assign take        = valid_i && !end_i;
  assign last_beat   = migrating_q ? MigrateLast[BeatBits-1:0] : HaloLast[BeatBits-1:0];
  assign other_last  = migrating_q ? HaloLast[BeatBits-1:0] : MigrateLast[BeatBits-1:0];
  assign record_done = take && last_q;

  always_comb begin
    beat_d      = beat_q;
    migrating_d = migrating_q;
    last_d      = last_q;
    if (record_done) begin
      beat_d = '0;
      last_d = (last_beat == '0);
    end else if (take) begin
      beat_d = beat_q + 1'b1;
      last_d = (beat_q + 1'b1 == last_beat);
    end
    if (valid_i && end_i) begin
      migrating_d = !migrating_q;
      last_d      = (beat_q == other_last);
    end
  end

  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      beat_q      <= '0;
      last_q      <= (HaloLast == 0);
      halo_last_q <= (HaloLast == 0);
      migrate_last_q <= 1'b0;
      migrating_q <= 1'b0;
    end else begin
      beat_q      <= beat_d;
      last_q      <= last_d;
      halo_last_q <= last_d && !migrating_d;
      migrate_last_q <= last_d && migrating_d;
      migrating_q <= migrating_d;
    end
  end

  // Beats before the last one; the last comes straight from the link.
  logic [MaxBeats*LinkBits-1:0] halo_padded, migrate_padded;
  if (MaxBeats > 1) begin : gen_parts
    logic [LinkBits-1:0] part_q [0:MaxBeats-2];
    for (genvar b = 0; b < MaxBeats - 1; b++) begin : gen_part
      localparam int Beat = b;
      always_ff @(posedge clk_i) begin
        if (take && beat_q == Beat[BeatBits-1:0]) part_q[b] <= data_i;
      end
      assign halo_padded[b*LinkBits +: LinkBits]    = (b == HaloBeats - 1) ? data_i : part_q[b];
      assign migrate_padded[b*LinkBits +: LinkBits] = (b == MigrateBeats - 1) ? data_i : part_q[b];
    end
  end
  assign halo_padded[(MaxBeats-1)*LinkBits +: LinkBits]    = data_i;
  assign migrate_padded[(MaxBeats-1)*LinkBits +: LinkBits] = data_i;

  assign halo_o          = halo_padded[HaloBits-1:0];
  assign migrate_o       = migrate_padded[MigrateBits-1:0];
  assign halo_valid_o    = take && halo_last_q;
  assign migrate_valid_o = take && migrate_last_q;
  assign halo_end_o      = valid_i && end_i && !migrating_q;
  assign migrate_end_o   = valid_i && end_i && migrating_q;

  logic unused_padding;
  assign unused_padding = ^{halo_padded, migrate_padded};
endmodule
