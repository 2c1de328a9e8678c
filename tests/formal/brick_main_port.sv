// SPDX-License-Identifier: MIT
// The one read port of a brick's own slots that relay, update, migration and dump share: each of them asks a cycle
// ahead for a slot of the next cycle's cell, the numbers are put together by OR. Whenever one of them looks at the
// answer, it is that of the slot and cell meant, and no update writes then; what the relay looks at of a halo is of its
// cell's place in its layer; the sums were asked for the slot that is taken, and are never set to zero while a pipe is
// busy; an arrival is taken only if its inbox was asked in the cycle before. Where a particle goes is asked of the slot
// that the migration looks at, and what is written in the cycle of a question is told to be. All of cuboct_brick_core
// that controls; the rest is any value, as are the four links.
module brick_main_port_formal #(
  parameter int BrickX   = 2,
  parameter int BrickY   = 1,
  parameter int Capacity = 1,
  parameter int LinkBits = 10,
  parameter int Weighted = 0,  // 0, 1: masses differ, an update of two cycles more
  parameter int Pd       = 0,  // 0, 1: types held by force only, an update of three cycles more
  parameter int Steps    = 2   // of a run, at most
) (
  input logic                  clk_i,
  input logic                  start_i,
  input logic [31:0]           steps_i,
  input logic                  load_i, load_cell_i,
  input logic [3:0]            link_valid_i, link_end_i, link_ready_i,
  input logic [4*LinkBits-1:0] link_data_i
);
  localparam int Faces    = 4;
  localparam int Taken    = (Pd != 0) ? 5 : (Weighted != 0) ? 4 : 2;  // cycles from take to write
  localparam int Cells    = BrickX * BrickY;
  localparam int CellBits = $clog2(Cells);
  localparam int Longest  = (BrickX > BrickY) ? BrickX : BrickY;
  localparam int GridBits = $clog2(Longest + 2);
  localparam int LayerY   = BrickX + 2;
  localparam int TagBits  = $clog2((BrickY > LayerY) ? BrickY : LayerY);
  localparam int SlotBits = (Capacity > 1) ? $clog2(Capacity) : 1;
  localparam int CountBits = SlotBits + 1;
  localparam int AddrBits = CellBits + SlotBits;
  localparam int HaloAddrBits = TagBits + SlotBits;
  localparam logic [GridBits-1:0] One = 1;

  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;

  (* anyconst *) logic [Faces-1:0]       has_link;
  (* anyconst *) logic [3*GridBits-1:0]  extent;
  (* anyconst *) logic [Cells*Faces-1:0] exits;
  logic [Faces-1:0]          link_valid, link_end, link_ready;
  logic [Faces*LinkBits-1:0] link_data;
  logic [7:0]                phase_start, phase_end;
  logic [3:0]                code;
  logic [4:0]                events;
  logic                      observe, fault, id, idle;
  logic [CellBits-1:0]       observed_cell, fault_cell, load_cell;
  logic [8+2*Pd:0]           observed, loaded;
  logic [63:0]               number;
  always_comb begin
    assume (extent[0 +: GridBits] >= 1 && extent[0 +: GridBits] <= BrickX);
    assume (extent[GridBits +: GridBits] >= 1 && extent[GridBits +: GridBits] <= BrickY);
    assume (extent[2*GridBits +: GridBits] == One);
    assume (steps_i <= Steps);
    if (!running_q || load_i) assume (!start_i);
    if (!running_q) assume (!load_i && link_valid_i == '0);
    load_cell = load_cell_i;
    loaded    = '0;
  end
  cuboct_brick_core #(
    .Axes(2), .BrickX(BrickX), .BrickY(BrickY), .BrickZ(1), .Capacity(Capacity), .FilterLanes(1), .ForcePipes(1),
    .QueueDepth(1), .LinkBits(LinkBits), .IdBits(1), .PositionFrac(1), .Guard(1), .VelocityBits(1),
    .RelativeVelocityBits(1), .DifferenceShift(0), .FilterFrac(1), .Weighted(Weighted), .Pd(Pd), .DisplacementBits(1),
    .Overlap(1)
  ) u_node (
    .clk_i, .rst_ni(running_q), .start_i, .steps_i, .has_link_i(has_link), .extent_i(extent), .exit_i(exits),
    .load_valid_i(load_i), .load_cell_i(load_cell), .load_data_i(loaded), .velocity_i(1'b0), .link_valid_o(link_valid),
    .link_end_o(link_end), .link_data_o(link_data), .link_ready_i, .link_valid_i, .link_end_i, .link_data_i,
    .link_ready_o(link_ready), .phase_start_o(phase_start), .phase_end_o(phase_end), .force_event_o(events),
    .observe_valid_o(observe), .observe_cell_o(observed_cell), .observe_data_o(observed), .fault_valid_o(fault),
    .fault_code_o(code), .fault_id_o(id), .fault_cell_o(fault_cell), .fault_number_o(number), .idle_o(idle)
  );

  // What the contract says of what is cut out: the finder is done only in FORCE, pipes are busy only while the engine
  // runs, the update writes a slot so many cycles after it took it.
  (* keep *) logic       tap_finder_done, tap_take, tap_update_write, tap_pipe_busy, tap_engine;
  (* keep *) logic [1:0] tap_past_exchange;
  // Of the links: no halo after the end of its stream (`brick_neighbours`), none beyond the room of its cell.
  (* keep *) logic [Faces-1:0]           tap_halo, tap_halo_end, tap_halo_ended;
  (* keep *) logic [Faces*CountBits-1:0] tap_halos;  // there are of the cell that the record is of
  integer                f;
  logic [Taken-1:0]      takes_q;
  always_ff @(posedge clk_i) takes_q <= running_q ? {takes_q[Taken-2:0], tap_take} : '0;
  always_comb begin
    assume (!tap_finder_done || tap_past_exchange[1]);
    assume (!tap_pipe_busy || tap_engine);
    assume (tap_update_write == takes_q[Taken-1]);
    assume (((tap_halo | tap_halo_end) & tap_halo_ended) == '0);
    for (f = 0; f < Faces; f = f + 1) assume (!tap_halo[f] || tap_halos[f*CountBits +: CountBits] < Capacity);
  end

  // Who looks at the answer now, and of which slot of which cell it shall be.
  (* keep *) logic                      tap_relay_end, tap_in_migrate, tap_in_dump, tap_visit, tap_load, tap_land;
  (* keep *) logic [1:0]                tap_relay_load, tap_pop;
  (* keep *) logic [2:0]                tap_migrate_state;
  (* keep *) logic [3*GridBits-1:0]     tap_cell;
  (* keep *) logic [CellBits-1:0]       tap_own, tap_relay_own;
  (* keep *) logic [3*TagBits-1:0]      tap_layer;
  (* keep *) logic [CountBits-1:0]      tap_count, tap_migrate_slot;
  (* keep *) logic [SlotBits-1:0]       tap_relay_slot, tap_tick_slot;
  (* keep *) logic [AddrBits-1:0]       tap_main_addr, tap_sums_addr, tap_away_addr, tap_write_addr;
  (* keep *) logic [AddrBits-1:0]       tap_update_place;
  (* keep *) logic                      tap_leave, tap_own_write, tap_main_written, tap_away_written;
  (* keep *) logic [3*HaloAddrBits-1:0] tap_halo_addr;
  logic                      relays, scans, dumps, below, above, migrated_q;
  logic [AddrBits-1:0]       asked_q, summed_q, away_next, away_q;
  logic [Taken*AddrBits-1:0] places_q;
  logic [3*HaloAddrBits-1:0] halo_q;
  logic [GridBits-1:0]       x;
  assign x      = tap_cell[0 +: GridBits];
  assign below  = (x == '0);  // along x the relay of y walks halos too
  assign above  = (x > extent[0 +: GridBits]);
  assign away_next = tap_leave ? tap_away_addr : away_q;
  // The update writes where it took.
  always_comb assume (!tap_update_write || tap_update_place == places_q[(Taken-1)*AddrBits +: AddrBits]);
  assign relays = (tap_relay_load != 2'b00) && !tap_relay_end;
  assign scans  = tap_in_migrate && tap_migrate_state == 3'd1 && tap_visit;
  assign dumps  = tap_in_dump && tap_count != '0;
  always_ff @(posedge clk_i) begin
    asked_q    <= tap_main_addr;
    summed_q   <= tap_sums_addr;
    halo_q     <= tap_halo_addr;
    away_q     <= running_q ? away_next : '0;
    places_q   <= {places_q[(Taken-1)*AddrBits-1:0], tap_own, tap_tick_slot};
    migrated_q <= running_q && tap_in_migrate;
  end
  function automatic logic [AddrBits-1:0] place(input logic [CellBits-1:0] at, input logic [SlotBits-1:0] slot);
    logic [7:0] wide;
    begin
      wide  = {{(8 - CellBits) {1'b0}}, at} * Capacity[7:0] + {{(8 - SlotBits) {1'b0}}, slot};
      place = wide[AddrBits-1:0];
    end
  endfunction
  logic [7:0] halo_place;
  assign halo_place = {{(8 - TagBits) {1'b0}}, tap_layer[0 +: TagBits]} * Capacity[7:0]
                    + {{(8 - SlotBits) {1'b0}}, tap_relay_slot};
  always_ff @(posedge clk_i) begin
    if (running_q) begin
      a_relay:   assert (!relays || below || above || asked_q == place(tap_relay_own, tap_relay_slot));
      a_halo:    assert (!relays || !(below || above) || halo_q[0 +: HaloAddrBits] == halo_place[HaloAddrBits-1:0]);
      a_update:  assert (!tap_take || asked_q == place(tap_own, tap_tick_slot));
      a_sums:    assert (!tap_take || summed_q == place(tap_own, tap_tick_slot));
      a_zero:    assert (!(tap_take || tap_load || tap_land) || !tap_pipe_busy);
      a_migrate: assert (!scans || asked_q == place(tap_own, tap_migrate_slot[SlotBits-1:0]));
      a_away:    assert (!scans || away_q == place(tap_own, tap_migrate_slot[SlotBits-1:0]));
      a_written: assert (!tap_own_write || (tap_main_written == (tap_write_addr == tap_main_addr)
                                            && tap_away_written == (tap_write_addr == away_next)));
      a_dump:    assert (!dumps || asked_q == place(tap_own, tap_tick_slot));
      a_fresh:   assert (!(relays || scans || dumps) || !tap_update_write);
      a_take:    assert (tap_pop == 2'b00 || migrated_q);
      c_take:    cover (tap_pop == 2'd2);
      c_relay:   cover (relays && !below && !above && asked_q == Cells * Capacity - 1);
      c_halo:    cover (relays && above && has_link == '1);
      c_update:  cover (tap_take && asked_q == Cells * Capacity - 1);
      c_migrate: cover (scans && asked_q == Cells * Capacity - 1);
      c_dump:    cover (dumps && asked_q == Cells * Capacity - 1);
    end
  end
endmodule
