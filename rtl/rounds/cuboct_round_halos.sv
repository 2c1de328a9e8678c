// SPDX-License-Identifier: MIT
// The receiving side of the links of a node whose rule has several rounds: assembly, and by face a memory for the first
// round's halo records in the node's own frame, one for the numbers of each later round, at the same addresses, and one
// for migrating particles. A neighbour may be a round ahead, and so what it sends has a place of its own.
//   link record of the first round: x[P+2] y[P+2] z[P] rest; with two axes x[P+2] y[P] rest
//   candidate: x[P+2] y[P+2] z[P+2] rest, then the numbers of the second, third, ... round
module cuboct_round_halos #(
  parameter int Axes          = 3,    // 2 or 3
  parameter int PositionFrac  = 20,   // P
  parameter int Capacity      = 16,
  parameter int LinkBits      = 32,
  parameter int Rounds        = 2,    // 1 ... 5
  parameter logic [Rounds*16-1:0] RecordBits = {Rounds{16'd62}},  // by round: of a record on the link
  parameter int HaloBits      = 62,   // of the first round's record
  parameter int MostBits      = 62,   // of any round's
  parameter int CandidateBits = 126,
  parameter int ParticleBits  = 128,
  parameter int Moves         = 1,    // 0: no particle ever comes
  parameter int AddrBits      = 8,    // of a record's number in any segment
  parameter int CountBits     = 9,    // of a segment's count
  localparam int Faces        = 2 * Axes
) (
  input  logic                       clk_i,
  input  logic                       rst_ni,
  input  logic [Faces-1:0]           has_link_i,
  input  logic [Faces-1:0]           link_valid_i,
  input  logic [Faces-1:0]           link_end_i,
  input  logic [Faces*LinkBits-1:0]  link_data_i,
  // Halos.
  input  logic                       halo_clear_i,   // the step's halos are read: last cycle of the last round's FORCE
  output logic [Rounds*Faces-1:0]    halo_end_o,     // by round, face: complete; always where there is no link
  output logic [Faces*CountBits-1:0] halo_count_o,   // by face: records of the first round
  output logic [Faces-1:0]           halo_came_o,    // by face: one of them comes
  input  logic [Faces-1:0]           stream_read_i,  // by face: the streamer asks
  input  logic [AddrBits-1:0]        stream_addr_i,  // with stream_read_i
  output logic [Faces*CandidateBits-1:0] stream_data_o,  // by face, from the next cycle on, until it reads again
  // For the relays of the rounds, of all axes but the last.
  input  logic [Rounds-1:0]          relay_read_i,   // by round: it asks; without it the answers stay
  input  logic [Rounds*(Faces-2)-1:0] relay_clear_i, // with relay_read_i, by round, face: the answer becomes 0
  input  logic [Rounds*AddrBits-1:0] relay_addr_i,   // with relay_read_i
  output logic [Rounds*MostBits-1:0] relay_data_o,   // by round: of the face picked, from the next cycle on
  // Migrating particles.
  input  logic                       migrating_i,    // a migration phase
  input  logic [Faces-1:0]           migrate_clear_i,  // by face: last cycle of its axis's migration
  output logic [Faces-1:0]           migrate_empty_o,  // by face: no particle waits
  output logic [Faces-1:0]           migrate_some_next_o,  // in the next cycle one waits;
  output logic [Faces-1:0]           migrate_over_next_o,  // none does and the stream is complete, if it is not cleared
  output logic [Faces*ParticleBits-1:0] migrate_data_o,  // by face: the oldest particle
  input  logic [Faces-1:0]           migrate_pop_i   // by face: it is taken
);
  localparam int RestBits = HaloBits - Axes * PositionFrac - 2 * (Axes - 1);
  localparam int CandPos  = Axes * (PositionFrac + 2);
  localparam int LastLsb  = (Axes - 1) * (PositionFrac + 2);  // of the last axis, which has no sign on the link

  // Where a later round's numbers are among all of them.
  function automatic integer later_lsb(input integer round);
    integer k;
    begin
      later_lsb = 0;
      for (k = 1; k < round; k = k + 1) later_lsb = later_lsb + {16'd0, RecordBits[k*16 +: 16]};
    end
  endfunction

  logic [Rounds*Faces-1:0] halo_end_d, halo_end_q, halo_end;
  logic [Faces-1:0]        migrate_end_d, migrate_end_q, migrate_end;
  assign halo_end_d    = (halo_end_q | halo_end) & ~{(Rounds * Faces) {halo_clear_i}};
  assign migrate_end_d = (migrate_end_q | migrate_end) & ~migrate_clear_i;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      halo_end_q    <= '0;
      migrate_end_q <= '0;
    end else begin
      halo_end_q    <= halo_end_d;
      migrate_end_q <= migrate_end_d;
    end
  end
  assign halo_end_o = halo_end_q | ~{Rounds{has_link_i}};

  logic [Faces*Rounds*MostBits-1:0] relayed;  // by face, round; 0 where the face is not picked
  for (genvar f = 0; f < Faces; f++) begin : gen_face
    localparam int Axis  = f / 2;
    localparam int Depth = ((Axis == 0) ? 1 : (Axis == 1) ? 3 : 9) * Capacity;

    logic [Rounds-1:0]        halo_valid, end_of;
    localparam int MigrateBits = (Moves != 0) ? ParticleBits : 1;
    logic                     migrate_valid, migrate_full, empty_next;
    logic [MostBits-1:0]      halo;
    logic [MigrateBits-1:0]   particle, oldest;
    cuboct_round_rx #(
      .LinkBits(LinkBits), .Rounds(Rounds), .RecordBits(RecordBits), .MostBits(MostBits), .MigrateBits(MigrateBits)
    ) u_rx (
      .clk_i, .rst_ni, .valid_i(link_valid_i[f] && has_link_i[f]), .end_i(link_end_i[f]),
      .data_i(link_data_i[f*LinkBits +: LinkBits]), .halo_valid_o(halo_valid), .halo_o(halo), .halo_end_o(end_of),
      .migrate_valid_o(migrate_valid), .migrate_o(particle), .migrate_end_o(migrate_end[f])
    );
    for (genvar k = 0; k < Rounds; k++) begin : gen_end
      assign halo_end[k*Faces+f] = end_of[k];
    end

    // One node further along the axis: -2^P from below, +2^P from above. The memory holds records as they are on the
    // link; the sign of the last axis, which is not sent, is the same for all records of a face.
    localparam logic [1:0] LastSign = (Axis < Axes - 1) ? 2'b00 : (f % 2 == 0) ? 2'b11 : 2'b01;
    logic [HaloBits-1:0] moved, streamed, relayed_first;
    if (Axis < Axes - 1) begin : gen_moved
      // From 00, 01, 11: one less from below, one more from above.
      localparam int SignLsb = Axis * (PositionFrac + 2) + PositionFrac;
      localparam logic Below = (f % 2 == 0);
      assign moved = halo[HaloBits-1:0] ^ ({{(HaloBits - 2) {1'b0}}, halo[SignLsb] ^ Below, 1'b1} << SignLsb);
    end else begin : gen_last
      assign moved = halo[HaloBits-1:0];
    end

    localparam int Relayed = (Axis < Axes - 1) ? 1 : 0;
    logic                relay_clear;
    logic [CountBits-1:0] stream_count;
    cuboct_inbox #(
      .HaloBits(HaloBits), .ParticleBits(MigrateBits), .HaloDepth(Depth), .Capacity(Capacity), .Particles(Moves),
      .Relayed(Relayed), .Arrival(0), .AddrBits(AddrBits), .CountBits(CountBits)
    ) u_inbox (
      .clk_i, .rst_ni, .clear_i(halo_clear_i), .append_i(halo_valid[0]), .halo_i(moved), .count_o(stream_count),
      .read_i(stream_read_i[f]), .addr_i(stream_addr_i), .next_i(1'b0), .halo_o(streamed), .relay_append_i(1'b0),
      .relay_record_i(moved), .relay_count_o(halo_count_o[f*CountBits +: CountBits]), .relay_read_i(relay_read_i[0]),
      .relay_clear_i(relay_clear), .relay_addr_i(relay_addr_i[AddrBits-1:0]),
      .relay_ahead_i({AddrBits{1'b0}}), .relay_halo_o(relayed_first),
      .migrating_i, .push_i(migrate_valid), .particle_i(particle), .full_o(migrate_full), .pop_i(migrate_pop_i[f]),
      .particle_o(oldest), .empty_o(migrate_empty_o[f]), .empty_next_o(empty_next)
    );
    if (Moves != 0) begin : gen_particles
      assign migrate_data_o[f*ParticleBits +: ParticleBits] = oldest;
    end else begin : gen_no_particles
      logic unused_oldest;
      assign unused_oldest = ^oldest;
      assign migrate_data_o[f*ParticleBits +: ParticleBits] = '0;
    end
    assign halo_came_o[f]         = halo_valid[0];
    assign migrate_some_next_o[f] = !empty_next;
    assign migrate_over_next_o[f] = empty_next && (migrate_end_q[f] || migrate_end[f] || !has_link_i[f]);
    assign stream_data_o[f*CandidateBits +: CandPos] = {LastSign, streamed[LastLsb+PositionFrac-1:0]};
    if (RestBits > 0) begin : gen_rest
      assign stream_data_o[f*CandidateBits+CandPos +: RestBits] = streamed[HaloBits-1 -: RestBits];
    end
    if (Relayed != 0) begin : gen_relay
      assign relay_clear = relay_clear_i[f];
      if (MostBits > HaloBits) begin : gen_wide
        assign relayed[f*Rounds*MostBits +: MostBits] = {{(MostBits - HaloBits) {1'b0}}, relayed_first};
      end else begin : gen_same
        assign relayed[f*Rounds*MostBits +: MostBits] = relayed_first;
      end
    end else begin : gen_no_relay
      logic unused_relay;
      assign relay_clear  = 1'b0;
      assign unused_relay = ^relayed_first;
      assign relayed[f*Rounds*MostBits +: MostBits] = '0;
    end

    for (genvar k = 1; k < Rounds; k++) begin : gen_later
      localparam int Bits = {16'd0, RecordBits[k*16 +: 16]};
      localparam int Lsb  = CandPos + RestBits + later_lsb(k);
      localparam int To   = (f * Rounds + k) * MostBits;
      if (Bits > 0) begin : gen_numbers
        logic [AddrBits-1:0] place_d, place_q;  // where the next one goes
        assign place_d = halo_clear_i ? '0 : halo_valid[k] ? place_q + 1'b1 : place_q;
        always_ff @(posedge clk_i) begin
          if (!rst_ni) place_q <= '0;
          else place_q <= place_d;
        end
        cuboct_ram #(.Bits(Bits), .Depth(Depth), .AddrBits(AddrBits)) u_numbers (
          .clk_i, .write_i(halo_valid[k]), .write_addr_i(place_q), .write_data_i(halo[Bits-1:0]),
          .read_i(stream_read_i[f]), .clear_i(1'b0), .read_addr_i(stream_addr_i),
          .read_data_o(stream_data_o[f*CandidateBits+Lsb +: Bits])
        );
        if (Relayed != 0) begin : gen_relay
          logic [Bits-1:0] numbers;
          cuboct_ram #(.Bits(Bits), .Depth(Depth), .AddrBits(AddrBits)) u_relayed (
            .clk_i, .write_i(halo_valid[k]), .write_addr_i(place_q), .write_data_i(halo[Bits-1:0]),
            .read_i(relay_read_i[k]), .clear_i(relay_clear_i[k*(Faces-2)+f]),
            .read_addr_i(relay_addr_i[k*AddrBits +: AddrBits]), .read_data_o(numbers)
          );
          if (MostBits > Bits) begin : gen_wide
            assign relayed[To +: MostBits] = {{(MostBits - Bits) {1'b0}}, numbers};
          end else begin : gen_same
            assign relayed[To +: MostBits] = numbers;
          end
        end else begin : gen_no_relay
          assign relayed[To +: MostBits] = '0;
        end
      end else begin : gen_none
        assign relayed[To +: MostBits] = '0;
        logic unused_valid;
        assign unused_valid = halo_valid[k];
      end
    end

`ifndef SYNTHESIS
    always_ff @(posedge clk_i) begin
      if (rst_ni && halo_valid[0]) a_halo_room: assert (halo_count_o[f*CountBits +: CountBits] != Depth[CountBits-1:0]);
      if (rst_ni && migrate_valid) a_migrate_room: assert (Moves != 0 && !migrate_full);
    end
`endif
    logic unused_full;
    assign unused_full = ^{migrate_full, stream_count};
  end

  integer g;
  always_comb begin
    relay_data_o = '0;
    for (g = 0; g < Faces; g = g + 1) relay_data_o = relay_data_o | relayed[g*Rounds*MostBits +: Rounds*MostBits];
  end
  logic unused_sizes;
  assign unused_sizes = ^{relay_read_i, relay_clear_i, relay_addr_i};
endmodule
