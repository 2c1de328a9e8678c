// SPDX-License-Identifier: MIT
// The receiving side of a brick's six links: assembly, one memory per face for halos and for migrating particles, and
// the flags that say which streams have ended.
module cuboct_brick_halos #(
  parameter int Axes         = 3,   // 2 or 3
  parameter int BrickX       = 2,
  parameter int BrickY       = 2,
  parameter int BrickZ       = 2,
  parameter int Capacity     = 16,
  parameter int LinkBits     = 32,
  parameter int HaloBits     = 60,  // of a halo record: x, y, z, what the rule needs of type and v; without its cell
  parameter int ParticleBits = 128,
  parameter int TagBits      = 4,   // of a cell's number in a layer, on the link
  parameter int FaceBits     = 2,   // of a cell's number in a face, on the link; <= TagBits
  parameter int CountBits    = 5,
  parameter int AddrBits     = 8,   // of a record in any layer
  localparam int Faces       = 2 * Axes
) (
  input  logic                       clk_i,
  input  logic                       rst_ni,
  input  logic [Faces-1:0]           has_link_i,
  input  logic [Faces-1:0]           link_valid_i,
  input  logic [Faces-1:0]           link_end_i,
  input  logic [Faces*LinkBits-1:0]  link_data_i,
  output logic [Faces-1:0]           link_ready_o,
  // Halos: by face, at an address by axis, as in cuboct_brick_inbox.
  input  logic                       halo_clear_i,    // the step's halos are read; with the last cycle of FORCE
  output logic [Faces-1:0]           halo_end_o,      // complete; always where there is no link
  input  logic [3*TagBits-1:0]       stream_cell_i,   // by axis: cell of the streamer
  output logic [Faces*CountBits-1:0] stream_count_o,  // that cell's records, without latency
  input  logic                       stream_read_i,   // the streamer asks
  input  logic [3*AddrBits-1:0]      stream_addr_i,   // with stream_read_i
  output logic [Faces*HaloBits-1:0]  stream_data_o,   // from the next cycle on; stays
  input  logic [3*TagBits-1:0]       relay_cell_i,    // by axis: cell of the relay
  output logic [Faces*CountBits-1:0] relay_count_o,   // its records, without latency
  input  logic [3*AddrBits-1:0]      relay_addr_i,    // in every cycle
  output logic [Faces*HaloBits-1:0]  relay_data_o,    // not of the last axis
  // Migrating particles.
  input  logic                       migrating_i,     // a migration phase
  input  logic [Faces-1:0]           migrate_clear_i, // by face: last cycle of its axis's migration
  output logic [Faces-1:0]           migrate_end_o,   // complete; always where there is no link
  output logic [Faces-1:0]           migrate_none_o,  // none came in this phase
  input  logic [3*TagBits-1:0]       land_cell_i,     // by axis: a cell of the own face
  output logic [Faces*CountBits-1:0] land_count_o,    // by face, particles that came to it, without latency
  output logic [Faces*ParticleBits-1:0] migrate_data_o,  // by face: the oldest particle
  input  logic [Faces-1:0]           migrate_pop_i    // by face: it is taken
);
  logic [Faces-1:0] halo_end_d, halo_end_q, migrate_end_d, migrate_end_q, halo_end, migrate_end;
  assign halo_end_d    = (halo_end_q | halo_end) & ~{Faces{halo_clear_i}};
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
  assign halo_end_o    = halo_end_q | ~has_link_i;
  assign migrate_end_o = migrate_end_q | ~has_link_i;

  for (genvar f = 0; f < Faces; f++) begin : gen_face
    localparam int Axis      = f / 2;
    localparam int FaceCells = ((Axis == 0) ? 1 : BrickX) * ((Axis == 1) ? 1 : BrickY) * ((Axis == 2) ? 1 : BrickZ);
    localparam int HaloCells = ((Axis == 0) ? 1 : BrickX + 2) * ((Axis == 1) ? 1 : (Axis == 0) ? BrickY : BrickY + 2)
                             * ((Axis == 2) ? 1 : BrickZ);

    logic                             halo_valid, particle_valid;
    logic [HaloBits+TagBits-1:0]      halo;
    logic [ParticleBits+FaceBits-1:0] particle;
    logic [TagBits-1:0]               particle_cell;
    cuboct_link_rx #(
      .LinkBits(LinkBits), .HaloBits(HaloBits + TagBits), .MigrateBits(ParticleBits + FaceBits)
    ) u_rx (
      .clk_i, .rst_ni, .valid_i(link_valid_i[f] && has_link_i[f]), .end_i(link_end_i[f]),
      .data_i(link_data_i[f*LinkBits +: LinkBits]), .ready_o(link_ready_o[f]),
      .halo_valid_o(halo_valid), .halo_o(halo), .halo_end_o(halo_end[f]),
      .migrate_valid_o(particle_valid), .migrate_o(particle), .migrate_end_o(migrate_end[f])
    );
    if (TagBits > FaceBits) begin : gen_more_layers
      assign particle_cell = {{(TagBits - FaceBits) {1'b0}}, particle[ParticleBits +: FaceBits]};
    end else begin : gen_as_many
      assign particle_cell = particle[ParticleBits +: TagBits];
    end
    cuboct_brick_inbox #(
      .HaloBits(HaloBits), .ParticleBits(ParticleBits), .Capacity(Capacity), .HaloCells(HaloCells),
      .FaceCells(FaceCells), .Relayed((Axis < Axes - 1) ? 1 : 0), .TagBits(TagBits), .CountBits(CountBits),
      .AddrBits(AddrBits)
    ) u_inbox (
      .clk_i, .rst_ni, .clear_i(halo_clear_i), .append_i(halo_valid), .halo_cell_i(halo[HaloBits +: TagBits]),
      .halo_i(halo[HaloBits-1:0]), .stream_cell_i(stream_cell_i[Axis*TagBits +: TagBits]),
      .stream_count_o(stream_count_o[f*CountBits +: CountBits]), .read_i(stream_read_i),
      .addr_i(stream_addr_i[Axis*AddrBits +: AddrBits]), .halo_o(stream_data_o[f*HaloBits +: HaloBits]),
      .relay_cell_i(relay_cell_i[Axis*TagBits +: TagBits]),
      .relay_count_o(relay_count_o[f*CountBits +: CountBits]),
      .relay_addr_i(relay_addr_i[Axis*AddrBits +: AddrBits]), .relay_halo_o(relay_data_o[f*HaloBits +: HaloBits]),
      .migrating_i, .forget_i(migrate_clear_i[f]), .push_i(particle_valid), .particle_cell_i(particle_cell),
      .particle_i(particle[ParticleBits-1:0]),
      .land_cell_i(land_cell_i[Axis*TagBits +: TagBits]), .land_count_o(land_count_o[f*CountBits +: CountBits]),
      .pop_i(migrate_pop_i[f]),
      .particle_o(migrate_data_o[f*ParticleBits +: ParticleBits]), .none_o(migrate_none_o[f])
    );
  end
  logic unused_axis;  // with two axes, the third
  assign unused_axis = ^{stream_cell_i, stream_addr_i, relay_cell_i, relay_addr_i, land_cell_i};
endmodule
