// SPDX-License-Identifier: MIT
// What came over one face of a brick in this step, in one memory: halo records, Capacity places for each cell of the
// layer over the face, with a count per cell; behind them the particles that migrate, first in, first out, with a count
// per cell that they go to. What is appended in cycle t counts, and can be asked for, from t+1 on; a particle is shown
// from t+2 on.
module cuboct_brick_inbox #(
  parameter int HaloBits     = 60,  // of a halo record without its cell, >= 1
  parameter int ParticleBits = 128,  // > HaloBits: a particle has an id too
  parameter int Capacity     = 16,  // of a cell
  parameter int HaloCells    = 4,   // of the layer
  parameter int FaceCells    = 4,   // of the own face
  parameter int Relayed      = 1,   // 1: a second read port for the relay
  parameter int TagBits      = 2,   // of a cell's number
  parameter int CountBits    = 5,   // >= clog2(Capacity + 1)
  parameter int AddrBits     = 6,   // of streamer's and relay's addresses, >= TagBits, and clog2(HaloCells * Capacity)
  localparam int TotalBits   = $clog2(FaceCells * Capacity + 1)
) (
  input  logic                    clk_i,
  input  logic                    rst_ni,
  // Halos.
  input  logic                    clear_i,         // the step's halos are read
  input  logic                    append_i,        // a halo record came
  input  logic [TagBits-1:0]      halo_cell_i,     // its cell
  input  logic [HaloBits-1:0]     halo_i,          // with append_i
  input  logic [TagBits-1:0]      stream_cell_i,   // cell of the streamer
  output logic [CountBits-1:0]    stream_count_o,  // records of that cell, without latency
  input  logic                    read_i,          // the streamer asks; without it the answer stays
  input  logic [AddrBits-1:0]     addr_i,          // cell * Capacity + record
  output logic [HaloBits-1:0]     halo_o,          // from the next cycle on
  input  logic [TagBits-1:0]      relay_cell_i,    // cell of the relay
  output logic [CountBits-1:0]    relay_count_o,   // its records, without latency
  input  logic [AddrBits-1:0]     relay_addr_i,    // the relay asks in every cycle
  output logic [HaloBits-1:0]     relay_halo_o,    // from the next cycle on
  // Particles.
  input  logic                    migrating_i,     // a migration phase: the oldest particle is shown, a cycle later on
  input  logic                    forget_i,        // the phase's end: all have landed
  input  logic                    push_i,          // a particle came
  input  logic [TagBits-1:0]      particle_cell_i, // the cell that it goes to
  input  logic [ParticleBits-1:0] particle_i,      // with push_i
  input  logic [TagBits-1:0]      land_cell_i,     // of a cell
  output logic [CountBits-1:0]    land_count_o,    // the particles that came to it in this phase, without latency
  input  logic                    pop_i,           // the oldest is taken
  output logic [ParticleBits-1:0] particle_o,      // the oldest
  output logic                    none_o           // none came
);
  localparam int First     = HaloCells * Capacity;  // halos lie below, particles from here on
  localparam int Depth     = First + FaceCells * Capacity;
  localparam int WordBits  = $clog2(Depth + 1);
  localparam int Wide      = ((WordBits > AddrBits) ? WordBits : AddrBits) + 1;

  // Counts.
  logic [CountBits-1:0] halo_count, particle_count, added;
  logic                 any_halo, unused_any;
  assign unused_any = any_halo;
  cuboct_brick_counts #(.Cells(HaloCells), .AddrBits(TagBits), .Bits(CountBits), .Reads(3)) u_halo_counts (
    .clk_i, .rst_ni, .clear_i, .write_i(append_i), .write_addr_i(halo_cell_i), .count_i(added),
    .addr_i({relay_cell_i, stream_cell_i, halo_cell_i}), .count_o({relay_count_o, stream_count_o, halo_count}),
    .any_o(any_halo)
  );
  assign added = halo_count + 1'b1;
  logic [CountBits-1:0] landing;
  assign landing = particle_count + 1'b1;
  logic any_particle;
  cuboct_brick_counts #(.Cells(FaceCells), .AddrBits(TagBits), .Bits(CountBits), .Reads(2)) u_particle_counts (
    .clk_i, .rst_ni, .clear_i(forget_i), .write_i(push_i), .write_addr_i(particle_cell_i), .count_i(landing),
    .addr_i({land_cell_i, particle_cell_i}), .count_o({land_count_o, particle_count}), .any_o(any_particle)
  );
  assign none_o = !any_particle;

  // The queue of particles never wraps: it is empty at the end of each phase.
  logic [TotalBits-1:0] write_d, write_q, read_d, read_q;
  always_comb begin
    write_d = write_q;
    read_d  = read_q;
    if (push_i) write_d = write_q + 1'b1;
    if (pop_i) read_d = read_q + 1'b1;
    if (forget_i) begin
      write_d = '0;
      read_d  = '0;
    end
  end
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      write_q <= '0;
      read_q  <= '0;
    end else begin
      write_q <= write_d;
      read_q  <= read_d;
    end
  end

  logic [Wide-1:0] halo_at, particle_at, shown_at, streamed_at;
  cuboct_brick_addr #(
    .Factor(Capacity), .CellBits(TagBits), .SlotBits(CountBits), .AddrBits(Wide)
  ) u_halo_at (.cell_i(halo_cell_i), .slot_i(halo_count), .addr_o(halo_at));
  assign particle_at = First[Wide-1:0] + {{(Wide - TotalBits) {1'b0}}, write_q};
  assign shown_at    = First[Wide-1:0] + {{(Wide - TotalBits) {1'b0}}, read_d};
  assign streamed_at = {{(Wide - AddrBits) {1'b0}}, addr_i};

  logic [ParticleBits-1:0] halo_word, word;
  assign halo_word = {{(ParticleBits - HaloBits) {1'b0}}, halo_i};
  cuboct_ram #(.Bits(ParticleBits), .Depth(Depth), .AddrBits(Wide)) u_words (
    .clk_i, .write_i(append_i || push_i), .write_addr_i(push_i ? particle_at : halo_at),
    .write_data_i(push_i ? particle_i : halo_word), .read_i(read_i || migrating_i), .clear_i(1'b0),
    .read_addr_i(migrating_i ? shown_at : streamed_at), .read_data_o(word)
  );
  assign halo_o     = word[HaloBits-1:0];
  assign particle_o = word;
  if (Relayed != 0) begin : gen_relay
    cuboct_ram #(.Bits(HaloBits), .Depth(First), .AddrBits(Wide)) u_halos (
      .clk_i, .write_i(append_i), .write_addr_i(halo_at), .write_data_i(halo_i), .read_i(1'b1), .clear_i(1'b0),
      .read_addr_i({{(Wide - AddrBits) {1'b0}}, relay_addr_i}), .read_data_o(relay_halo_o)
    );
  end else begin : gen_no_relay
    logic unused_relay;
    assign unused_relay = ^relay_addr_i;
    assign relay_halo_o = '0;
  end

`ifndef SYNTHESIS
  always_ff @(posedge clk_i) begin
    if (rst_ni && append_i) a_halo_room: assert (halo_count != Capacity[CountBits-1:0]);
    if (rst_ni && push_i) a_particle_room: assert (particle_count != Capacity[CountBits-1:0]);
    if (rst_ni && pop_i) a_particle: assert (read_q != write_q);
  end
`endif
endmodule
