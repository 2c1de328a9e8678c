// SPDX-License-Identifier: MIT
// The one read port of the own slots of a node whose rule has two rounds, which the relays of both rounds, both
// finishes, migration and dump share: each of them asks a cycle ahead, the addresses are put together by OR, and the
// memory says nothing of a word that is asked for in the cycle in which it is written. Whenever one of them looks at
// the answer, it is that of the slot meant, and what was written last: so a round's records are made of what the finish
// before it wrote. And an arrival is taken only if its inbox was asked in the cycle before. All of cuboct_rule_core
// that controls; the rest is any value, as are the four links.
`include "rule_parts.svh"
module rounds_main_port_formal #(
  parameter int Capacity = 2,
  parameter int Second   = 3,  // bits of a record of the second round; 0: there is none
  parameter int LinkBits = 10,
  parameter int Finish   = 4,  // cycles of the first round's finish, of the second's: 4 ... 7
  parameter int Last     = 5,
  parameter int Overlap  = 1,
  parameter int Steps    = 2   // of a run, at most
) (
  input logic                  clk_i,
  input logic                  start_i,
  input logic [31:0]           steps_i,
  input logic                  load_i,
  input logic [3:0]            link_valid_i, link_end_i, link_ready_i,
  input logic [4*LinkBits-1:0] link_data_i
);
  localparam int Rounds    = 2;
  localparam int Faces     = 4;
  localparam int Longest   = 5;  // cycles from take to write
  localparam int SlotBits  = (Capacity > 1) ? $clog2(Capacity) : 1;
  localparam int AddrBits  = $clog2(3 * Capacity);
  localparam int CountBits = AddrBits + 1;
  localparam int First     = 5;  // bits of a record of the first round
  localparam int Most      = (Second > First) ? Second : First;

  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;

  (* anyconst *) logic [Faces-1:0] has_link;
  logic [Faces-1:0]          link_valid, link_end, link_ready;
  logic [Faces*LinkBits-1:0] link_data;
  logic [5*Rounds+2:0]       phase_start, phase_end;
  logic [3:0]                code, stage;
  logic [4:0]                event_now;
  logic                      observe, fault, id, idle;
  logic [5:0]                observed;
  logic [63:0]               number;
  always_comb begin
    assume (steps_i <= Steps);
    if (!running_q || load_i) assume (!start_i);
    if (!running_q) assume (!load_i && link_valid_i == '0);
  end
  cuboct_rule_core #(
    .Axes(2), .Capacity(Capacity), .FilterLanes(1), .ForcePipes(1), .QueueDepth(1), .Overlap(Overlap),
    .LinkBits(LinkBits), .IdBits(1), .PositionFrac(1), .FilterFrac(1), .ParticleBits(6), .IdLsb(4), .Rounds(Rounds),
    .RecordBits({Second[15:0], First[15:0]}), .FinishCycles({Last[15:0], Finish[15:0]}), .MostBits(Most),
    .LaterBits(Second)
  ) u_node (
    .clk_i, .rst_ni(running_q), .start_i, .steps_i, .has_link_i(has_link), .load_valid_i(load_i), .load_data_i(6'd0),
    .link_valid_o(link_valid), .link_end_o(link_end), .link_data_o(link_data), .link_ready_i, .link_valid_i,
    .link_end_i, .link_data_i, .link_ready_o(link_ready), .phase_start_o(phase_start), .phase_end_o(phase_end),
    .force_event_o(event_now), .observe_valid_o(observe), .observe_data_o(observed), .fault_valid_o(fault),
    .fault_code_o(code), .fault_stage_o(stage), .fault_id_o(id), .fault_number_o(number), .idle_o(idle)
  );

  // What the contract says of what is cut out, and of the links: the finder is done only in FORCE; a finish writes a
  // slot two cycles before its result may be read; no halo of a round after the end of its stream
  // (`rounds_neighbours`), no record beyond the room of its memory (`rounds_neighbours_room`).
  (* keep *) logic                        tap_finder_done, tap_take, tap_update_write;
  (* keep *) logic [1:0]                  tap_past_exchange;
  (* keep *) logic [Rounds-1:0]           tap_round;
  (* keep *) logic [SlotBits-1:0]         tap_tick_slot, tap_update_slot;
  (* keep *) logic [Faces*Rounds-1:0]     tap_halo;                      // by face, round
  (* keep *) logic [Rounds*Faces-1:0]     tap_halo_end, tap_halo_ended;  // by round, face
  (* keep *) logic [Faces-1:0]            tap_arrival, tap_full;
  (* keep *) logic [Faces*CountBits-1:0]  tap_count;
  logic [Longest*SlotBits-1:0]            slots_q;  // taken before, the last one lowest
  logic [Longest*Rounds-1:0]              takes_q;  // and by round whether one was
  logic [Rounds-1:0]                      writes;
  integer                                 f;
  always_ff @(posedge clk_i) begin
    takes_q <= running_q ? {takes_q[(Longest-1)*Rounds-1:0], tap_round & {Rounds{tap_take}}} : '0;
    slots_q <= {slots_q[(Longest-1)*SlotBits-1:0], tap_tick_slot};
  end
  assign writes = {takes_q[(Last-3)*Rounds+1], takes_q[(Finish-3)*Rounds]};
  always_comb begin
    assume (!tap_finder_done || tap_past_exchange[1]);
    assume (tap_update_write == (writes != '0));
    if (writes[0]) assume (tap_update_slot == slots_q[(Finish-3)*SlotBits +: SlotBits]);
    if (writes[1]) assume (tap_update_slot == slots_q[(Last-3)*SlotBits +: SlotBits]);
    assume ((tap_arrival & tap_full) == '0);
    assume ((tap_halo_end & tap_halo_ended) == '0);
    for (f = 0; f < Faces; f = f + 1) begin
      assume ((tap_halo[f*Rounds +: Rounds] & {tap_halo_ended[Faces+f], tap_halo_ended[f]}) == '0);
      if (tap_halo[f*Rounds]) assume (tap_count[f*CountBits +: CountBits] < ((f < 2) ? Capacity : 3 * Capacity));
    end
  end

  // Who looks at the answer now, and of which slot it shall be.
  (* keep *) logic                        tap_relay_load, tap_relay_end, tap_in_migrate, tap_in_dump;
  (* keep *) logic                        tap_scans;
  (* keep *) logic [2:0]                  tap_migrate_state;
  (* keep *) logic                        tap_knows;  // of migration: a particle leaves, as kept before its phase
  (* keep *) logic [1:0]                  tap_leaving, tap_axis;
  (* keep *) logic [3*Rounds-1:0]         tap_pick;        // by round: what its relay sends
  (* keep *) logic [Rounds*CountBits-1:0] tap_relay_next;  // by round, and 1
  (* keep *) logic [CountBits-1:0]        tap_own_count, tap_migrate_next;
  (* keep *) logic                        tap_write, tap_main_read;
  (* keep *) logic [SlotBits-1:0]         tap_write_slot, tap_main_slot;
  (* keep *) logic                        tap_pop, tap_inbox_asked;
  (* keep *) logic [3:0]                  tap_face;
  logic                                   relays, scans, dumps, together_q, migrated_q;
  logic [SlotBits-1:0]                    asked_q, own;
  assign own    = (tap_round[1] ? tap_relay_next[CountBits +: SlotBits] : tap_relay_next[0 +: SlotBits]) - 1'b1;
  assign relays = tap_relay_load && !tap_relay_end && (tap_round[1] ? tap_pick[3] : tap_pick[0]);
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
      c_relay:   cover (relays && asked_q == Capacity - 1 && tap_round[0]);
      c_again:   cover ((relays || Second == 0) && tap_round[1] && asked_q == Capacity - 1);
      c_update:  cover (tap_take && asked_q == Capacity - 1 && tap_round[0]);
      c_last:    cover (tap_take && asked_q == Capacity - 1 && tap_round[1]);
      c_migrate: cover (scans && asked_q == Capacity - 1);
      c_dump:    cover (dumps && asked_q == Capacity - 1);
    end
  end
endmodule
