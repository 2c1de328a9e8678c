// SPDX-License-Identifier: MIT
// cuboct_brick_inbox: the k-th halo of a cell since the clear, cell and k any, is what both ports answer in the cycle
// after they asked for place k of that cell; the streamer's answer stays until the memory is read for someone else. A
// watched particle, any of those pushed, is shown once, after those before it and before those after it, unchanged,
// from the second cycle after its push on. Counts of a watched cell are exact, and whether any particle came.
`include "torn_ram.svh"
module brick_inbox_formal #(
  parameter int HaloCells    = 2,
  parameter int FaceCells    = 2,
  parameter int Capacity     = 1,
  parameter int HaloBits     = 1,
  parameter int ParticleBits = 2,
  parameter int Relayed      = 1
) (
  input logic                    clk_i,
  input logic                    clear_i,
  input logic                    append_i,
  input logic [2:0]              halo_cell_i,
  input logic [HaloBits-1:0]     halo_i,
  input logic                    read_i,
  input logic [5:0]              addr_i, relay_addr_i,
  input logic [2:0]              stream_cell_i, relay_cell_i, land_cell_i,
  input logic                    migrating_i,
  input logic                    forget_i,
  input logic                    push_i,
  input logic [2:0]              particle_cell_i,
  input logic [ParticleBits-1:0] particle_i,
  input logic                    pop_i,
  input logic                    watch_i  // the particle pushed in this cycle is the one watched; any may be
);
  localparam int Most      = (HaloCells > FaceCells) ? HaloCells : FaceCells;
  localparam int TagBits   = (Most > 1) ? $clog2(Most) : 1;
  localparam int CountBits = $clog2(Capacity + 1);
  localparam int SlotBits  = (Capacity > 1) ? $clog2(Capacity) : 1;
  localparam int AddrBits  = TagBits + SlotBits;
  localparam int All       = FaceCells * Capacity;

  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;
  (* anyconst *) logic [2:0] cell_at, face_at;  // the watched cell of the layer, of the face

  logic [CountBits-1:0]    stream_count, relay_count, land_count;
  logic [HaloBits-1:0]     halo, relay_halo;
  logic                    none;
  logic [ParticleBits-1:0] particle;
  cuboct_brick_inbox #(
    .HaloBits(HaloBits), .ParticleBits(ParticleBits), .Capacity(Capacity), .HaloCells(HaloCells),
    .FaceCells(FaceCells), .Relayed(Relayed), .TagBits(TagBits), .CountBits(CountBits), .AddrBits(AddrBits)
  ) u_dut (
    .clk_i, .rst_ni(running_q), .clear_i, .append_i, .halo_cell_i(halo_cell_i[TagBits-1:0]), .halo_i,
    .stream_cell_i(stream_cell_i[TagBits-1:0]), .stream_count_o(stream_count), .read_i, .addr_i(addr_i[AddrBits-1:0]),
    .halo_o(halo), .relay_cell_i(relay_cell_i[TagBits-1:0]), .relay_count_o(relay_count),
    .relay_addr_i(relay_addr_i[AddrBits-1:0]), .relay_halo_o(relay_halo), .migrating_i, .forget_i, .push_i,
    .particle_cell_i(particle_cell_i[TagBits-1:0]), .particle_i,
    .land_cell_i(land_cell_i[TagBits-1:0]), .land_count_o(land_count), .pop_i,
    .particle_o(particle), .none_o(none)
  );

  // Counts of every cell: what comes has room, as a cell has no more particles than Capacity.
  logic [HaloCells*CountBits-1:0] halos_q;
  logic [FaceCells*CountBits-1:0] came_q;
  logic [CountBits-1:0]           halos_here, came_here, halos, came;
  logic [5:0]                     held_q;
  integer                         h, c;
  always_comb begin
    halos_here = '0;
    came_here  = '0;
    halos      = '0;
    came       = '0;
    for (h = 0; h < HaloCells; h = h + 1) begin
      if (halo_cell_i == h[2:0]) halos_here = halos_q[h*CountBits +: CountBits];
      if (cell_at == h[2:0]) halos = halos_q[h*CountBits +: CountBits];
    end
    for (c = 0; c < FaceCells; c = c + 1) begin
      if (particle_cell_i == c[2:0]) came_here = came_q[c*CountBits +: CountBits];
      if (face_at == c[2:0]) came = came_q[c*CountBits +: CountBits];
    end
  end
  // A link brings one record at a time (proof `link`), no halo in the cycle of the clear (proof `brick_neighbours`); a
  // phase of migration ends when all that came has landed.
  always_comb begin
    assume (cell_at < HaloCells && face_at < FaceCells);
    if (append_i) assume (running_q && !clear_i && !push_i && halo_cell_i < HaloCells && halos_here != Capacity);
    if (push_i) assume (running_q && !forget_i && particle_cell_i < FaceCells && came_here != Capacity);
    if (pop_i) assume (running_q && held_q != '0);
    if (forget_i) assume (held_q == {5'd0, pop_i});
  end
  always_ff @(posedge clk_i) begin
    for (h = 0; h < HaloCells; h = h + 1) begin
      if (!running_q || clear_i) halos_q[h*CountBits +: CountBits] <= '0;
      else if (append_i && halo_cell_i == h[2:0]) begin
        halos_q[h*CountBits +: CountBits] <= halos_q[h*CountBits +: CountBits] + 1'b1;
      end
    end
    for (c = 0; c < FaceCells; c = c + 1) begin
      if (!running_q || forget_i) came_q[c*CountBits +: CountBits] <= '0;
      else if (push_i && particle_cell_i == c[2:0]) begin
        came_q[c*CountBits +: CountBits] <= came_q[c*CountBits +: CountBits] + 1'b1;
      end
    end
  end

  // The watched halo, and what is known of the answers.
  (* anyconst *) logic [CountBits-1:0] number;
  logic [5:0]                          place;
  logic                                there, cleared_q, asked_q, relayed_q, kept_q;
  logic [HaloBits-1:0]                 value_q, answer_q, relay_answer_q;
  assign place = {3'd0, cell_at} * Capacity[5:0] + {{(6 - CountBits) {1'b0}}, number};
  assign there = (number < halos);
  always_comb assume (number < Capacity);
  always_ff @(posedge clk_i) begin
    if (!running_q) begin
      cleared_q <= 1'b0;
      asked_q   <= 1'b0;
      relayed_q <= 1'b0;
      kept_q    <= 1'b0;
    end else begin
      cleared_q <= cleared_q || (clear_i && halos == Capacity);
      if (read_i || migrating_i) asked_q <= !migrating_i && there && addr_i[AddrBits-1:0] == place;
      kept_q    <= asked_q && !read_i && !migrating_i;  // the answer stays
      relayed_q <= there && relay_addr_i[AddrBits-1:0] == place;
    end
    if (append_i && halo_cell_i == cell_at && halos == number) value_q <= halo_i;
    if (read_i) answer_q <= value_q;
    relay_answer_q <= value_q;
  end

  // The watched particle: how many stand before it.
  logic                    watched_q, inside_q, shown_q, migrating_q, again_q;
  logic [5:0]              before_q;
  logic [ParticleBits-1:0] particle_q;
  always_ff @(posedge clk_i) begin
    migrating_q <= running_q && migrating_i;
    if (!running_q) begin
      held_q    <= '0;
      watched_q <= 1'b0;
      inside_q  <= 1'b0;
      shown_q   <= 1'b0;
      again_q   <= 1'b0;
    end else begin
      held_q  <= held_q + {5'd0, push_i} - {5'd0, pop_i};
      shown_q <= inside_q;
      again_q <= again_q || (forget_i && came != '0);
      if (push_i && watch_i && !watched_q) begin
        watched_q  <= 1'b1;
        inside_q   <= 1'b1;
        particle_q <= particle_i;
        before_q   <= held_q - {5'd0, pop_i};
      end else if (inside_q && pop_i) begin
        before_q <= before_q - 1'b1;
        if (before_q == '0) inside_q <= 1'b0;
      end
    end
  end

  // Helpers: the queue holds what came less what was shown, the words lie where they are said to.
  localparam int TotalBits = $clog2(All + 1);
  localparam int First     = HaloCells * Capacity;
  (* keep *) logic [TotalBits-1:0]                    tap_write, tap_read;
  (* keep *) logic [(First + All)*ParticleBits-1:0] tap_mem;
  logic [5:0]              total;
  logic [ParticleBits-1:0] queued, stored;
  integer                  t, m;
  always_comb begin
    total  = '0;
    queued = '0;
    stored = '0;
    for (t = 0; t < FaceCells; t = t + 1) total = total + {{(6 - CountBits) {1'b0}}, came_q[t*CountBits +: CountBits]};
    for (m = 0; m < First + All; m = m + 1) begin
      if (First + tap_read + before_q == m) queued = tap_mem[m*ParticleBits +: ParticleBits];
      if (place == m) stored = tap_mem[m*ParticleBits +: ParticleBits];
    end
  end

  always_ff @(posedge clk_i) begin
    if (running_q) begin
      i_total:  assert (tap_write == total && tap_write <= All);
      i_held:   assert (tap_write == tap_read + held_q && held_q <= All);
      i_queued: assert (!inside_q || (before_q < held_q && queued == particle_q));
      i_stored: assert (!there || stored[HaloBits-1:0] == value_q);
      a_count:    assert (stream_cell_i != cell_at || stream_count == halos);
      a_relays:   assert (relay_cell_i != cell_at || relay_count == halos);
      a_land:     assert (land_cell_i != face_at || land_count == came);
      a_none:     assert (none == (came_q == '0));
      a_halo:     assert (!asked_q || halo == answer_q);
      a_relay:    assert (!relayed_q || Relayed == 0 || relay_halo == relay_answer_q);
      a_particle: assert (!(inside_q && shown_q && before_q == '0 && migrating_q) || particle == particle_q);
      c_all:     cover (halos == Capacity && came == Capacity && asked_q && relayed_q && value_q == '1
                        && cell_at == HaloCells - 1 && number == Capacity - 1);
      c_again:   cover (cleared_q && there && asked_q && value_q == '1);
      c_kept:    cover (kept_q && asked_q && halos == '0 && answer_q == '1);
      c_full:    cover (held_q == All && inside_q && before_q == All - 1);
      c_second:  cover (again_q && inside_q && shown_q && before_q == '0 && migrating_q && particle_q == '1
                        && (All == 1 || push_i));
    end
  end
endmodule
