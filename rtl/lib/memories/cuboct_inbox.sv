// SPDX-License-Identifier: MIT
// What came over one face in this step: its halo records, and the particles that migrate, each in a memory of their
// own. The particles' is small, so that it may lie in distributed memory: an arrival goes through many choices in the
// cycle in which it is read. A halo that is appended in cycle t counts, and can be asked for, from t+1 on; a particle
// counts from t+2 on, when the memory can have answered.
module cuboct_inbox #(
  parameter int HaloBits     = 66,   // of a halo record, >= 1
  parameter int ParticleBits = 128,  // >= 1
  parameter int HaloDepth    = 16,   // halo records, >= 1
  parameter int Capacity     = 16,   // particles, >= 1
  parameter int Particles    = 1,    // 0: no particle ever comes
  parameter int Relayed      = 1,    // 1: a second read port for the relay
  parameter int Arrival      = 0,    // 1: the relay's records come apart, and what the streamer reads is a cycle later
  parameter int Ahead        = 0,    // 1: the relay reads in order, and a block memory is asked a record ahead for it
  parameter int AddrBits     = 4,    // of the halos' read addresses, >= clog2(HaloDepth)
  parameter int CountBits    = 5     // of the halos' count, >= clog2(HaloDepth+1)
) (
  input  logic                    clk_i,
  input  logic                    rst_ni,
  // Halos.
  input  logic                    clear_i,       // the step's halos are read
  input  logic                    append_i,      // a halo record came
  input  logic [HaloBits-1:0]     halo_i,        // with append_i
  output logic [CountBits-1:0]    count_o,       // records that came in this step
  input  logic                    read_i,        // the streamer asks; without it the answer stays
  input  logic [AddrBits-1:0]     addr_i,        // with read_i
  input  logic                    next_i,        // Arrival: what the memory answers is shown from the next cycle on
  output logic [HaloBits-1:0]     halo_o,        // from the next cycle on, Arrival: from the one after next_i on; a
                                                 // migration phase leaves it
  input  logic                    relay_append_i,  // Arrival: a record for the relay came
  input  logic [HaloBits-1:0]     relay_record_i,  // with relay_append_i
  output logic [CountBits-1:0]    relay_count_o,   // records for the relay that came in this step
  input  logic                    relay_read_i,  // the relay asks; without it the answer stays
  input  logic                    relay_clear_i, // with relay_read_i: the answer is 0
  input  logic [AddrBits-1:0]     relay_addr_i,  // with relay_read_i
  input  logic [AddrBits-1:0]     relay_ahead_i, // with relay_read_i: relay_addr_i and 1; Ahead only
  output logic [HaloBits-1:0]     relay_halo_o,  // from the next cycle on
  // Particles, first in, first out.
  input  logic                    migrating_i,   // a migration phase, or before: the oldest is shown, a cycle later on
  input  logic                    push_i,        // only when not full
  input  logic [ParticleBits-1:0] particle_i,    // with push_i
  output logic                    full_o,        // Capacity particles are held
  input  logic                    pop_i,         // only when not empty
  output logic [ParticleBits-1:0] particle_o,    // the oldest, without empty_o
  output logic                    empty_o,       // no particle counts yet
  output logic                    empty_next_o   // empty_o of the next cycle
);
  localparam int LevelBits = $clog2(Capacity + 1);
  localparam int PlaceBits = (Capacity > 1) ? $clog2(Capacity) : 1;
  localparam int Last      = Capacity - 1;  // place of a particle
  localparam int Second    = (Capacity > 1) ? 1 : 0;

  logic [CountBits-1:0] count_d, count_q;
  logic [PlaceBits-1:0] write_d, write_q, read_d, read_q, after_d, after_q;  // after: the place behind read
  logic [LevelBits-1:0] held_d, held_q;    // particles in the memory
  logic [LevelBits-1:0] shown_d, shown_q;  // of these, those that count
  logic                 pushed_q, empty_d, empty_q;  // empty: shown is 0
  always_comb begin
    count_d = count_q;
    write_d = write_q;
    read_d  = read_q;
    after_d = after_q;
    held_d  = held_q;
    shown_d = shown_q;
    if (append_i) count_d = count_q + 1'b1;
    if (clear_i) count_d = '0;
    if (push_i) write_d = (write_q == Last[PlaceBits-1:0]) ? '0 : write_q + 1'b1;
    if (pop_i) begin
      read_d  = after_q;
      after_d = (after_q == Last[PlaceBits-1:0]) ? '0 : after_q + 1'b1;
    end
    if (push_i && !pop_i) held_d = held_q + 1'b1;
    if (pop_i && !push_i) held_d = held_q - 1'b1;
    if (pushed_q && !pop_i) shown_d = shown_q + 1'b1;
    if (pop_i && !pushed_q) shown_d = shown_q - 1'b1;
    empty_d = !pushed_q && (empty_q || (pop_i && shown_q == {{(LevelBits - 1) {1'b0}}, 1'b1}));
  end
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      count_q  <= '0;
      write_q  <= '0;
      read_q   <= '0;
      after_q  <= Second[PlaceBits-1:0];
      held_q   <= '0;
      shown_q  <= '0;
      pushed_q <= 1'b0;
      empty_q  <= 1'b1;
    end else begin
      count_q  <= count_d;
      write_q  <= write_d;
      read_q   <= read_d;
      after_q  <= after_d;
      held_q   <= held_d;
      shown_q  <= shown_d;
      pushed_q <= push_i;
      empty_q  <= empty_d;
    end
  end

  logic [HaloBits-1:0] word;
  cuboct_ram #(.Bits(HaloBits), .Depth(HaloDepth), .AddrBits(AddrBits)) u_words (
    .clk_i, .write_i(append_i), .write_addr_i(count_q[AddrBits-1:0]), .write_data_i(halo_i), .read_i(read_i),
    .clear_i(1'b0), .read_addr_i(addr_i), .read_data_o(word)
  );
  if (Arrival != 0) begin : gen_arrival
    // A block memory answers late in its cycle: what follows begins at a register.
    logic [HaloBits-1:0]  halo_q;
    logic [CountBits-1:0] relay_count_d, relay_count_q;
    assign relay_count_d = clear_i ? '0 : relay_append_i ? relay_count_q + 1'b1 : relay_count_q;
    always_ff @(posedge clk_i) begin
      if (next_i) halo_q <= word;
    end
    always_ff @(posedge clk_i) begin
      if (!rst_ni) relay_count_q <= '0;
      else relay_count_q <= relay_count_d;
    end
    assign halo_o        = halo_q;
    assign relay_count_o = relay_count_q;
  end else begin : gen_phases
    assign halo_o        = word;
    assign relay_count_o = count_q;
    logic unused_relay_record;
    assign unused_relay_record = ^{relay_append_i, relay_record_i, next_i};
  end
  if (Particles != 0) begin : gen_particles
    cuboct_ram #(.Bits(ParticleBits), .Depth(Capacity), .AddrBits(PlaceBits)) u_particles (
      .clk_i, .write_i(push_i), .write_addr_i(write_q), .write_data_i(particle_i), .read_i(migrating_i),
      .clear_i(1'b0), .read_addr_i(read_d), .read_data_o(particle_o)
    );
    assign full_o       = (held_q == Capacity[LevelBits-1:0]);
    assign empty_o      = empty_q;
    assign empty_next_o = empty_d;
  end else begin : gen_no_particles
    logic unused_particles;
    assign unused_particles = ^{migrating_i, particle_i, write_q, read_d, held_q, empty_q};
    assign particle_o       = '0;
    assign full_o           = 1'b0;
    assign empty_o          = 1'b1;
    assign empty_next_o     = 1'b1;
  end
  // The relay's answer rests at 0 while another face is read, so that its clock can.
  logic relay_wanted, relay_zero_q;
  assign relay_wanted = relay_read_i && !(relay_clear_i && relay_zero_q);
  always_ff @(posedge clk_i) begin
    if (!rst_ni) relay_zero_q <= 1'b0;
    else if (relay_read_i) relay_zero_q <= relay_clear_i;
  end
  if (Relayed != 0 && Ahead != 0 && HaloDepth > 16) begin : gen_relay_ahead
    // A block memory answers late in its cycle: what the link registers choose from begins at a register. The memory
    // holds the record after that; where the relay reads another face that is the first one.
    logic [AddrBits-1:0] ahead;
    logic [HaloBits-1:0] after, relay_halo_q;
    logic                comes, ask, first_q;  // the first record comes; the memory's answer is that one
    assign ahead = relay_ahead_i & {AddrBits{!relay_clear_i}};
    assign comes = append_i && (count_q == '0);
    assign ask   = relay_read_i && !(relay_clear_i && first_q);
    always_ff @(posedge clk_i) begin
      if (!rst_ni) first_q <= 1'b0;
      else if (comes) first_q <= 1'b0;
      else if (relay_read_i) first_q <= relay_clear_i;
    end
    cuboct_ram #(.Bits(HaloBits), .Depth(HaloDepth), .AddrBits(AddrBits)) u_halos (
      .clk_i, .write_i(append_i), .write_addr_i(count_q[AddrBits-1:0]), .write_data_i(halo_i), .read_i(ask),
      .clear_i(1'b0), .read_addr_i(ahead), .read_data_o(after)
    );
    always_ff @(posedge clk_i) begin
      if (relay_wanted) begin
        if (relay_clear_i) relay_halo_q <= '0;
        else relay_halo_q <= after;
      end
    end
    assign relay_halo_o = relay_halo_q;
    logic unused_relay_addr;
    assign unused_relay_addr = ^relay_addr_i;
  end else if (Relayed != 0) begin : gen_relay
    logic unused_ahead;
    assign unused_ahead = ^relay_ahead_i;
    cuboct_ram #(.Bits(HaloBits), .Depth(HaloDepth), .AddrBits(AddrBits)) u_halos (
      .clk_i, .write_i((Arrival != 0) ? relay_append_i : append_i), .write_addr_i(relay_count_o[AddrBits-1:0]),
      .write_data_i((Arrival != 0) ? relay_record_i : halo_i), .read_i(relay_wanted), .clear_i(relay_clear_i),
      .read_addr_i(relay_addr_i), .read_data_o(relay_halo_o)
    );
  end else begin : gen_no_relay
    logic unused_relay;
    assign unused_relay = ^{relay_wanted, relay_clear_i, relay_addr_i, relay_ahead_i, relay_record_i};
    assign relay_halo_o = '0;
  end

  assign count_o = count_q;
endmodule
