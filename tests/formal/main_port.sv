// SPDX-License-Identifier: MIT
// The one read port of a node's own slots that relay, update, migration and dump share: each of them asks a
// cycle ahead, the addresses are put together by OR, and the memory says nothing of a word that is asked
// for in the cycle in which it is written. Whenever one of them looks at the answer, it is that of the slot
// meant, and what was written last. And an arrival is taken only if its inbox was asked in the cycle
// before. All of cuboct_node_core that controls; the rest is any value, as are the four links.
module main_port_formal #(
  parameter int Capacity = 2,
  parameter int LinkBits = 10,
  parameter int Weighted = 0,  // 0, 1: masses differ, an update of two cycles more
  parameter int Pd       = 0,  // 0, 1: types held by force only, an update of three cycles more
  parameter int Arrival  = 0,  // 0, 1: halos on arrival, slots written through a register
  parameter int Steps    = 2   // of a run, at most
) (
  input logic                  clk_i,
  input logic                  start_i,
  input logic [31:0]           steps_i,
  input logic                  load_i,
  input logic [3:0]            link_valid_i, link_end_i, link_ready_i,
  input logic [4*LinkBits-1:0] link_data_i
);
  localparam int Faces     = 4;
  localparam int Taken     = (Pd != 0) ? 5 : (Weighted != 0) ? 4 : 2;  // cycles from take to write
  localparam int SlotBits  = (Capacity > 1) ? $clog2(Capacity) : 1;
  localparam int CountBits = $clog2(3 * Capacity) + 1;
  localparam int AddrBits  = $clog2(3 * Capacity);

  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;

  (* anyconst *) logic [Faces-1:0] has_link;
  logic [Faces-1:0]          link_valid, link_end, link_ready;
  logic [Faces*LinkBits-1:0] link_data;
  logic [7:0]                phase_start, phase_end;
  logic [3:0]                code;
  logic [4:0]                event_now;
  logic                      observe, fault, id, idle;
  logic [8+2*Pd:0]           observed;
  logic [63:0]               number;
  always_comb begin
    assume (steps_i <= Steps);
    if (!running_q || load_i) assume (!start_i);
    if (!running_q) assume (!load_i && link_valid_i == '0);
  end
  cuboct_node_core #(
    .Axes(2), .Capacity(Capacity), .FilterLanes(1), .ForcePipes(1), .QueueDepth(1), .LinkBits(LinkBits),
    .IdBits(1), .PositionFrac(1), .Guard(1), .VelocityBits(1), .RelativeVelocityBits(1), .DifferenceShift(0),
    .FilterFrac(1), .Weighted(Weighted), .Pd(Pd), .DisplacementBits(1), .Overlap(1),
    .Arrival(Arrival)
  ) u_node (
    .clk_i, .rst_ni(running_q), .start_i, .steps_i, .has_link_i(has_link), .load_valid_i(load_i),
    .load_data_i({(9+2*Pd) {1'b0}}), .velocity_i(1'b0), .link_valid_o(link_valid), .link_end_o(link_end),
    .link_data_o(link_data), .link_ready_i, .link_valid_i, .link_end_i, .link_data_i,
    .link_ready_o(link_ready), .phase_start_o(phase_start), .phase_end_o(phase_end),
    .force_event_o(event_now), .observe_valid_o(observe), .observe_data_o(observed), .fault_valid_o(fault),
    .fault_code_o(code), .fault_id_o(id), .fault_number_o(number), .idle_o(idle)
  );

  // What the contract says of what is cut out, and of the links: the finder is done only in FORCE, with
  // Arrival when all streams have ended; the update
  // writes a slot so many cycles after it took it; no halo after the end of its stream (`neighbours`), no
  // record beyond the room of its memory (`neighbours_room`).
  (* keep *) logic                       tap_finder_done, tap_take, tap_update_write;
  (* keep *) logic [1:0]                 tap_past_exchange;
  (* keep *) logic [Faces-1:0]           tap_stream_end;  // Arrival: the streamer knows the end
  (* keep *) logic [SlotBits-1:0]        tap_tick_slot, tap_update_slot;
  (* keep *) logic [Faces-1:0]           tap_halo, tap_halo_end, tap_halo_ended, tap_arrival, tap_full;
  (* keep *) logic [Faces*CountBits-1:0] tap_count;
  logic [Taken*SlotBits-1:0]             slots_q;  // taken before, the last one lowest
  logic [Taken-1:0]                      takes_q;
  integer                                f;
  always_ff @(posedge clk_i) begin
    takes_q <= running_q ? {takes_q[Taken-2:0], tap_take} : '0;
    slots_q <= {slots_q[(Taken-1)*SlotBits-1:0], tap_tick_slot};
  end
  always_comb begin
    if (Arrival != 0) assume (!tap_finder_done || tap_stream_end == '1);
    else assume (!tap_finder_done || tap_past_exchange[1]);
    assume (tap_update_write == takes_q[Taken-1]);
    if (takes_q[Taken-1]) assume (tap_update_slot == slots_q[(Taken-1)*SlotBits +: SlotBits]);
    assume (((tap_halo | tap_halo_end) & tap_halo_ended) == '0);
    assume ((tap_arrival & tap_full) == '0);
    for (f = 0; f < Faces; f = f + 1) begin
      if (tap_halo[f]) assume (tap_count[f*CountBits +: CountBits] < ((f < 2) ? Capacity : 3 * Capacity));
    end
  end

  // Who looks at the answer now, and of which slot it shall be.
  (* keep *) logic                tap_relay_load, tap_relay_end, tap_in_migrate, tap_in_dump;
  (* keep *) logic                tap_scans;
  // Whether a particle leaves: what migration kept of it in the cycle before its phase, and what there is to know.
  (* keep *) logic [2:0]          tap_migrate_state;
  (* keep *) logic                tap_knows;
  (* keep *) logic [1:0]          tap_leaving, tap_axis;
  (* keep *) logic [2:0]          tap_pick;  // what the relay sends
  (* keep *) logic [CountBits-1:0] tap_own_count;
  (* keep *) logic [CountBits-1:0] tap_relay_next;  // and 1
  (* keep *) logic [CountBits-1:0] tap_migrate_next;
  (* keep *) logic                tap_write, tap_main_read;
  (* keep *) logic [SlotBits-1:0] tap_write_slot, tap_main_slot;
  (* keep *) logic                tap_pop, tap_inbox_asked;
  (* keep *) logic [3:0]          tap_face;
  logic                           relays, scans, dumps, together_q, migrated_q;
  logic [SlotBits-1:0]            asked_q;
  // With Arrival the relay looks at the answer as it takes it into a register; its k-th look in a step is of slot k.
  (* keep *) logic                tap_observe, tap_in_exchange;
  logic [SlotBits-1:0]            seen_q, own;
  always_ff @(posedge clk_i) begin
    if (!running_q || !tap_in_exchange) seen_q <= '0;
    else if (tap_observe) seen_q <= seen_q + 1'b1;
  end
  assign own    = (Arrival != 0) ? seen_q : tap_relay_next[SlotBits-1:0] - 1'b1;
  assign relays = (Arrival != 0) ? tap_observe : tap_relay_load && !tap_relay_end && tap_pick[0];
  assign scans  = tap_in_migrate && tap_scans;
  assign dumps  = tap_in_dump && tap_own_count != '0;
  always_ff @(posedge clk_i) begin
    if (tap_main_read) asked_q <= tap_main_slot;
    migrated_q <= tap_inbox_asked;
    // As it was asked for, or since.
    together_q <= tap_write && tap_write_slot == (tap_main_read ? tap_main_slot : asked_q)
                  || (together_q && !tap_main_read);
  end
  always_ff @(posedge clk_i) begin
    if (running_q) begin
      if (relays) a_relay: assert (asked_q == own);
      if (tap_take) a_update: assert (asked_q == tap_tick_slot);
      if (scans) a_migrate: assert (asked_q == tap_migrate_next[SlotBits-1:0] - 1'b1);
      if (dumps) a_dump: assert (asked_q == tap_tick_slot);
      if (relays || tap_take || scans || dumps) a_fresh: assert (!together_q);
      if (tap_in_migrate && tap_migrate_state == 3'd0)
        a_leaving: assert (tap_knows == ((tap_leaving & tap_axis) != '0 && tap_own_count != '0));
      if (tap_pop) a_take: assert (migrated_q);
      c_take:    cover (tap_pop && (tap_face & 4'b1010) != '0);
      c_relay:   cover (relays && asked_q == Capacity - 1);
      c_update:  cover (tap_take && asked_q == Capacity - 1);
      c_migrate: cover (scans && asked_q == Capacity - 1);
      c_dump:    cover (dumps && asked_q == Capacity - 1);
    end
  end
endmodule
