// SPDX-License-Identifier: MIT
// The receiving side of the six links: assembly, one memory per face for halos in the node's own frame and for
// migrating particles, and the flags that say which streams have ended.
module cuboct_halos #(
  parameter int Axes          = 3,    // 2 or 3
  parameter int PositionFrac  = 20,   // P
  parameter int Capacity      = 16,
  parameter int LinkBits      = 32,
  parameter int HaloBits      = 62,   // of a halo record: x[P+2] y[P+2] z[P] rest; with two axes x[P+2] y[P] rest
  parameter int CandidateBits = 64,   // of a halo as it is read: all axes of P+2 bits, rest; HaloBits + 2
  parameter int ParticleBits  = 128,
  parameter int AddrBits      = 8,    // of a record's number in any segment
  parameter int CountBits     = 9,    // of a segment's count
  parameter int Arrival       = 0,    // 1: records are used as they come
  parameter int Streamers     = 1,    // 1, or 2 for the faces below and above; Arrival only
  // Of the cull; Arrival only.
  parameter int          FilterFrac  = 8,
  parameter logic [63:0] PlanarOne   = 64'd0,
  parameter logic [63:0] PlanarTwo   = 64'd0,
  parameter logic [63:0] PlanarThree = 64'd0,
  localparam int Faces        = 2 * Axes
) (
  input  logic                       clk_i,
  input  logic                       rst_ni,
  input  logic [Faces-1:0]           has_link_i,
  input  logic [Faces-1:0]           link_valid_i,
  input  logic [Faces-1:0]           link_end_i,
  input  logic [Faces*LinkBits-1:0]  link_data_i,
  output logic [Faces-1:0]           link_ready_o,
  // Halos.
  input  logic                       halo_clear_i,   // the step's halos are read; with the last cycle of FORCE
  output logic [Faces-1:0]           halo_end_o,     // complete; always where there is no link
  output logic [Faces-1:0]           halo_end_next_o,  // halo_end_o of the next cycle
  output logic [Faces*CountBits-1:0] halo_count_o,   // by face: records that came in this step, as the relay sees them
  output logic [Faces-1:0]           halo_came_o,    // one comes: it counts from the next cycle on
  output logic [Faces-1:0]           stream_end_next_o,  // as the streamer sees them: complete in the next cycle,
  output logic [Faces-1:0]           stream_came_o,  // and a record comes: it may be read from the next cycle on
  input  logic [Faces-1:0]           stream_read_i,  // by face: the streamer asks
  input  logic [Faces-1:0]           stream_next_i,  // by face, Arrival: its answer is shown, a cycle later on
  input  logic [Streamers*AddrBits-1:0] stream_addr_i,  // read by it: what it gets is there in the next cycle (Arrival:
  output logic [Faces*CandidateBits-1:0] stream_data_o,  // behind stream_next_i), by face, and stays until the next
  // The box of the own particles; Arrival only.
  input  logic                       run_i,          // the step has begun
  input  logic                       box_empty_i,    // there is no own particle
  input  logic [Axes*FilterFrac-1:0] box_low_i,      // without box_empty_i: x, y, z
  input  logic [Axes*FilterFrac-1:0] box_high_i,     // without box_empty_i
  // For the relay, of all axes but the last.
  input  logic                       relay_read_i,   // it asks; without it the answers stay
  input  logic [Faces-3:0]           relay_clear_i,  // with relay_read_i, by face: the answer becomes 0
  input  logic [AddrBits-1:0]        relay_addr_i,   // with relay_read_i
  input  logic [AddrBits-1:0]        relay_ahead_i,  // with relay_read_i: relay_addr_i and 1; not Arrival
  output logic [(Faces-2)*CandidateBits-1:0] relay_data_o,  // by face, from the next cycle on
  // Migrating particles.
  input  logic                       migrating_i,    // a migration phase
  input  logic [Faces-1:0]           migrate_clear_i,  // by face: last cycle of its axis's migration
  output logic [Faces-1:0]           migrate_end_o,  // complete; always where there is no link
  output logic [Faces-1:0]           migrate_empty_o,  // by face: no particle waits
  output logic [Faces-1:0]           migrate_some_next_o,  // in the next cycle one waits;
  output logic [Faces-1:0]           migrate_over_next_o,  // none does and the stream is complete, if it is not cleared
  output logic [Faces*ParticleBits-1:0] migrate_data_o,  // by face: the oldest particle
  input  logic [Faces-1:0]           migrate_pop_i   // by face: it is taken
);
  localparam int RestBits = HaloBits - Axes * PositionFrac - 2 * (Axes - 1);
  localparam int CandPos  = Axes * (PositionFrac + 2);
  localparam int LastLsb  = (Axes - 1) * (PositionFrac + 2);  // of the last axis, which has no sign on the link

  logic [Faces-1:0] halo_end_d, halo_end_q, migrate_end_d, migrate_end_q, halo_end, migrate_end;
  // What has no link is complete from the reset on, so that no one has to ask for the link.
  assign halo_end_d    = ((halo_end_q | halo_end) & ~{Faces{halo_clear_i}}) | ~has_link_i;
  assign migrate_end_d = ((migrate_end_q | migrate_end) & ~migrate_clear_i) | ~has_link_i;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      halo_end_q    <= ~has_link_i;
      migrate_end_q <= ~has_link_i;
    end else begin
      halo_end_q    <= halo_end_d;
      migrate_end_q <= migrate_end_d;
    end
  end
  assign halo_end_o    = halo_end_q;
  assign halo_end_next_o = halo_end_d;
  assign migrate_end_o = migrate_end_q;

  logic [Faces-1:0] stream_end;
  if (Arrival != 0) begin : gen_stream_end
    logic [Faces-1:0] stream_end_d, stream_end_q;
    assign stream_end_d = ((stream_end_q | stream_end) & ~{Faces{halo_clear_i}}) | ~has_link_i;
    always_ff @(posedge clk_i) begin
      if (!rst_ni) stream_end_q <= ~has_link_i;
      else stream_end_q <= stream_end_d;
    end
    assign stream_end_next_o = stream_end_d;
  end else begin : gen_one_end
    assign stream_end_next_o = halo_end_d;
    logic unused_stream_end;
    assign unused_stream_end = ^{stream_end, run_i, box_empty_i, box_low_i, box_high_i, PlanarOne, PlanarTwo,
                                 PlanarThree};
  end

  for (genvar f = 0; f < Faces; f++) begin : gen_face
    localparam int Axis  = f / 2;
    localparam int Port  = f % Streamers;
    localparam int Depth = ((Axis == 0) ? 1 : (Axis == 1) ? 3 : 9) * Capacity;

    logic                     halo_valid, migrate_valid, migrate_full, empty_next;
    logic [CountBits-1:0]     stream_count;
    logic [HaloBits-1:0]      halo;
    logic [ParticleBits-1:0]  particle;
    cuboct_link_rx #(.LinkBits(LinkBits), .HaloBits(HaloBits), .MigrateBits(ParticleBits)) u_rx (
      .clk_i, .rst_ni, .valid_i(link_valid_i[f] && has_link_i[f]), .end_i(link_end_i[f]),
      .data_i(link_data_i[f*LinkBits +: LinkBits]), .ready_o(link_ready_o[f]),
      .halo_valid_o(halo_valid), .halo_o(halo), .halo_end_o(halo_end[f]),
      .migrate_valid_o(migrate_valid), .migrate_o(particle), .migrate_end_o(migrate_end[f])
    );

    // One node further along the axis: -2^P from below, +2^P from above. The memory holds records as they are on the
    // link; the sign of the last axis, which is not sent, is the same for all records of a face.
    localparam logic [1:0] LastSign = (Axis < Axes - 1) ? 2'b00 : (f % 2 == 0) ? 2'b11 : 2'b01;
    logic [HaloBits-1:0] moved, streamed, relayed;
    logic                relay_clear;
    if (Axis < Axes - 1) begin : gen_moved
      // From 00, 01, 11: one less from below, one more from above.
      localparam int SignLsb = Axis * (PositionFrac + 2) + PositionFrac;
      localparam logic Below = (f % 2 == 0);
      assign moved = halo ^ ({{(HaloBits - 2) {1'b0}}, halo[SignLsb] ^ Below, 1'b1} << SignLsb);
    end else begin : gen_last
      assign moved = halo;
    end

    // What the streamer gets.
    logic                append;
    logic [HaloBits-1:0] kept;
    if (Arrival != 0) begin : gen_cull
      logic [Axes*(FilterFrac+2)-1:0] x;
      for (genvar a = 0; a < Axes; a++) begin : gen_coarse
        localparam int Lsb = a * (PositionFrac + 2) + PositionFrac - FilterFrac;
        if (a < Axes - 1) begin : gen_signed
          assign x[a*(FilterFrac+2) +: FilterFrac+2] = moved[Lsb +: FilterFrac+2];
        end else begin : gen_last_axis
          assign x[a*(FilterFrac+2) +: FilterFrac+2] = {LastSign, moved[Lsb +: FilterFrac]};
        end
      end
      cuboct_cull #(
        .Axes(Axes), .FilterFrac(FilterFrac), .PlanarOne(PlanarOne), .PlanarTwo(PlanarTwo), .PlanarThree(PlanarThree),
        .HaloBits(HaloBits)
      ) u_cull (
        .clk_i, .rst_ni, .run_i, .empty_i(box_empty_i), .low_i(box_low_i), .high_i(box_high_i), .valid_i(halo_valid),
        .halo_i(moved), .x_i(x), .end_i(halo_end[f]), .valid_o(append), .halo_o(kept), .end_o(stream_end[f])
      );
    end else begin : gen_all
      assign append        = halo_valid;
      assign kept          = moved;
      assign stream_end[f] = 1'b0;
    end

    cuboct_inbox #(
      .HaloBits(HaloBits), .ParticleBits(ParticleBits), .HaloDepth(Depth), .Capacity(Capacity),
      .Relayed((Axis < Axes - 1) ? 1 : 0), .Arrival(Arrival), .Ahead(1 - Arrival), .AddrBits(AddrBits),
      .CountBits(CountBits)
    ) u_inbox (
      .clk_i, .rst_ni, .clear_i(halo_clear_i), .append_i(append), .halo_i(kept),
      .count_o(stream_count), .read_i(stream_read_i[f]), .next_i(stream_next_i[f]),
      .addr_i(stream_addr_i[Port*AddrBits +: AddrBits]), .halo_o(streamed), .relay_append_i(halo_valid),
      .relay_record_i(moved), .relay_count_o(halo_count_o[f*CountBits +: CountBits]), .relay_read_i,
      .relay_clear_i(relay_clear), .relay_addr_i, .relay_ahead_i, .relay_halo_o(relayed),
      .migrating_i, .push_i(migrate_valid), .particle_i(particle), .full_o(migrate_full), .pop_i(migrate_pop_i[f]),
      .particle_o(migrate_data_o[f*ParticleBits +: ParticleBits]), .empty_o(migrate_empty_o[f]),
      .empty_next_o(empty_next)
    );
    assign halo_came_o[f]         = halo_valid;
    assign stream_came_o[f]       = append;
    assign migrate_some_next_o[f] = !empty_next;
    assign migrate_over_next_o[f] = empty_next && (migrate_end_q[f] || migrate_end[f]);
    assign stream_data_o[f*CandidateBits +: CandPos] = {LastSign, streamed[LastLsb+PositionFrac-1:0]};
    if (RestBits > 0) begin : gen_rest
      assign stream_data_o[f*CandidateBits+CandPos +: RestBits] = streamed[HaloBits-1 -: RestBits];
    end
    if (Axis < Axes - 1) begin : gen_relay
      assign relay_clear = relay_clear_i[f];
      assign relay_data_o[f*CandidateBits +: CandPos] = {LastSign, relayed[LastLsb+PositionFrac-1:0]};
      if (RestBits > 0) begin : gen_relay_rest
        assign relay_data_o[f*CandidateBits+CandPos +: RestBits] = relayed[HaloBits-1 -: RestBits];
      end
    end else begin : gen_no_relay
      logic unused_relay;
      assign relay_clear  = 1'b0;
      assign unused_relay = ^relayed;
    end

`ifndef SYNTHESIS
    always_ff @(posedge clk_i) begin
      if (rst_ni && halo_valid) a_halo_room: assert (halo_count_o[f*CountBits +: CountBits] != Depth[CountBits-1:0]);
      if (rst_ni && migrate_valid) a_migrate_room: assert (!migrate_full);
    end
`endif
    logic unused_full;
    assign unused_full = ^{migrate_full, stream_count};
  end
endmodule
