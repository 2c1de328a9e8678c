// SPDX-License-Identifier: MIT
// Two whole nodes side by side, all of cuboct_node_core that controls: what the pair finder, the
// datapath and the slots give, and what the beats carry, is any value, at any time that the cycle
// contract allows, so that any number of particles goes anywhere. Any loads, any number of steps, any stalls
// of the two links. Order is kept (docs/reference/node.md, section Order), nothing overflows, neighbours are
// never more than a step apart, and there is no state in which both wait for ever.
module neighbours_formal #(
  parameter int Axis     = 0,  // the nodes are neighbours along x or y
  parameter int Capacity = 1,
  parameter int LinkBits = 10,
  parameter int Steps    = 3,  // of a run, at most
  parameter int Narrow   = 0,  // narrow memories
  parameter int Arrival  = 0   // halos on arrival
) (
  input logic        clk_i,
  input logic        start_i,
  input logic [31:0] steps_i,
  input logic [1:0]  load_i,        // by node
  input logic [2*LinkBits-1:0] wire_i,  // what the links carry; only ends and counts matter here
  input logic [1:0]  stall_i        // of the link to the second, to the first
);
  localparam int Faces        = 4;
  localparam int Below        = 2 * Axis;      // the face of the second node towards the first
  localparam int Above        = 2 * Axis + 1;  // of the first towards the second
  localparam int SlotBits     = (Capacity > 1) ? $clog2(Capacity) : 1;
  localparam int CountBits    = $clog2(3 * Capacity) + 1;
  localparam logic [3:0] Has0 = 4'd1 << Above;   // faces of the first node that have a link,
  localparam logic [3:0] Has1 = 4'd1 << Below;   // and of the second
  localparam int Culls        = 3;              // registers of cuboct_cull
  localparam int Room         = ((Axis == 0) ? 1 : 3) * Capacity;  // of the face's halo memory
  localparam int ParticleBits = 9;             // x y away_y v id residue: 1 1 2 1 1 1 1 1

  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;

  logic [1:0]              valid, ends, ready, idle, step;
  logic [2*Faces-1:0]      all_valid, all_ready;
  logic [15:0]             phase_start, phase_end;
  logic                    start;
  // A node does not know a step's number, only whether it is the last one.
  always_comb assume (steps_i <= Steps);
  assign start = running_q && start_i && idle == 2'b11 && load_i == 2'b00;
  for (genvar n = 0; n < 2; n++) begin : gen_node
    localparam int Face = (n == 0) ? Above : Below;
    logic [Faces-1:0]          link_valid, link_end, link_ready_in, link_valid_in, link_end_in, link_ready,
        has_link;
    logic [Faces*LinkBits-1:0] link_data, link_data_in;
    logic                      observe, fault;
    logic [ParticleBits-1:0]   observed;
    logic [3:0]                code;
    logic                      id;
    logic [63:0]               number;
    always_comb begin
      has_link             = '0;
      has_link[Face]       = 1'b1;
      link_valid_in        = '0;
      link_valid_in[Face]  = valid[1-n] && !stall_i[n];
      link_end_in          = '0;
      link_end_in[Face]    = ends[1-n];
      link_data_in         = '0;
      link_data_in[Face*LinkBits +: LinkBits] = wire_i[n*LinkBits +: LinkBits];
      link_ready_in        = '0;
      link_ready_in[Face]  = ready[1-n] && !stall_i[1-n];
    end
    assign valid[n] = link_valid[Face];
    assign ends[n]  = link_end[Face];
    assign ready[n] = link_ready[Face];
    assign all_valid[n*Faces +: Faces]    = link_valid;
    assign all_ready[n*Faces +: Faces]    = link_ready;
    cuboct_node_core #(
      .Axes(2), .Capacity(Capacity), .FilterLanes(1), .ForcePipes(1), .QueueDepth(1), .LinkBits(LinkBits),
          .IdBits(1),
      .PositionFrac(1), .Guard(1), .VelocityBits(1), .RelativeVelocityBits(1), .DifferenceShift(0),
          .FilterFrac(1), .Overlap((Narrow != 0) ? 0 : 1), .Narrow(Narrow), .Arrival(Arrival)
    ) u_node (
      .clk_i, .rst_ni(running_q), .start_i(start), .steps_i, .has_link_i(has_link),
      .load_valid_i(running_q && load_i[n]), .load_data_i(9'd0), .velocity_i(1'b0),
      .link_valid_o(link_valid), .link_end_o(link_end), .link_data_o(link_data), .link_ready_i(link_ready_in),
      .link_valid_i(link_valid_in), .link_end_i(link_end_in), .link_data_i(link_data_in),
          .link_ready_o(link_ready),
      .phase_start_o(phase_start[8*n +: 8]), .phase_end_o(phase_end[8*n +: 8]), .observe_valid_o(observe),
      .observe_data_o(observed), .fault_valid_o(fault), .fault_code_o(code), .fault_id_o(id),
      .fault_number_o(number), .idle_o(idle[n])
    );
    assign step[n] = phase_end[8*n+6];  // MIGRATE_Y is the last of a step

    // What the contract says of the units that are cut out: the finder is done only in FORCE, as the last
    // segment is there only then (proof `streamer`), or with Arrival only when all streams have ended (proof
    // `arrival_streamer`); the update writes a slot two cycles after it was read.
    (* keep *) logic       tap_finder_done, tap_take, tap_update_write;
    (* keep *) logic [1:0] tap_past_exchange;
    (* keep *) logic [3:0] tap_stream_end;  // Arrival: by face, all that is not culled is there for the streamer
    (* keep *) logic [SlotBits-1:0] tap_tick_slot, tap_update_slot;
    logic [SlotBits-1:0]            slot_1_q, slot_2_q;
    logic                  take_1_q, take_2_q;
    always_ff @(posedge clk_i) begin
      take_1_q <= running_q && tap_take;
      take_2_q <= running_q && take_1_q;
      slot_1_q <= tap_tick_slot;
      slot_2_q <= slot_1_q;
    end
    always_comb begin
      if (Arrival != 0) assume (!tap_finder_done || tap_stream_end == 4'b1111);
      else assume (!tap_finder_done || tap_past_exchange[1]);
      assume (tap_update_write == take_2_q && (!take_2_q || tap_update_slot == slot_2_q));
    end
  end

  // Where a node is, and what comes in.
  (* keep *) logic [3:0] tap_state_0, tap_state_1;
  (* keep *) logic [9:0] tap_states_0, tap_states_1;
  (* keep *) logic       tap_exchange_0, tap_exchange_1, tap_migrating_0, tap_migrating_1;
  (* keep *) logic [2:0] tap_axis_0, tap_axis_1;        // of the sequencer
  // Of the relay: the axis' end is sent; with Arrival by axis, else of the present one.
  (* keep *) logic [Arrival:0] tap_sent_0, tap_sent_1;
  (* keep *) logic       tap_cleared_0, tap_cleared_1;  // Arrival: halos are cleared at this cycle's end
  (* keep *) logic [2:0] tap_migrate_0, tap_migrate_1;  // state of the migration
  (* keep *) logic [1:0] tap_axis_halo_0, tap_axis_halo_1;
  (* keep *) logic [3:0] tap_holds_0, tap_holds_1;    // by face: a link of the axis that must be taken from first
  (* keep *) logic [1:0] tap_linked_0, tap_linked_1;  // which faces of the axis have a link
  (* keep *) logic [3:0] tap_empty_0, tap_empty_1, tap_ended_0, tap_ended_1;  // by face, of particles
  (* keep *) logic [3:0] tap_face_0, tap_face_1;  // that migration takes from
  (* keep *) logic [1:0] tap_taking_0, tap_taking_1;  // what migration keeps of it: from below, from above;
  (* keep *) logic [1:0] tap_some_0, tap_some_1, tap_over_0, tap_over_1;  // what it is told of the axis
  (* keep *) logic       tap_last_0, tap_last_1;  // of the steps
  (* keep *) logic [7:0] tap_ends_0, tap_ends_1;  // by face: the next beat ends a halo; a particle
  logic [1:0]            axis_empty_0, axis_empty_1, axis_ended_0, axis_ended_1;
  assign axis_empty_0 = tap_axis_0[1] ? tap_empty_0[3:2] : tap_empty_0[1:0];
  assign axis_empty_1 = tap_axis_1[1] ? tap_empty_1[3:2] : tap_empty_1[1:0];
  assign axis_ended_0 = tap_axis_0[1] ? tap_ended_0[3:2] : tap_ended_0[1:0];
  assign axis_ended_1 = tap_axis_1[1] ? tap_ended_1[3:2] : tap_ended_1[1:0];
  // by face: a record, an end comes
  (* keep *) logic [3:0] tap_halo_0, tap_halo_1, tap_halo_end_0, tap_halo_end_1;
  (* keep *) logic [3:0] tap_arrival_0, tap_arrival_1, tap_arrival_end_0, tap_arrival_end_1;
  (* keep *) logic [3:0] tap_full_0, tap_full_1;
  (* keep *) logic [Faces*CountBits-1:0] tap_count_0, tap_count_1;
  (* keep *) logic [3:0] tap_halo_ended_0, tap_halo_ended_1, tap_migrate_ended_0, tap_migrate_ended_1;
  localparam logic [3:0] ExchangeY = 4'd1, Force = 4'd3, Update = 4'd4, MigrateX = 4'd5, MigrateY = 4'd6, Dump = 4'd8;
  localparam logic [2:0] End = 3'd2, TakeLow = 3'd3, TakeHigh = 3'd4;

  // The end of the stream over the two nodes' link is sent; that of the axis of an exchange phase.
  logic link_sent_0, link_sent_1, axis_sent_0, axis_sent_1, cleared_0, cleared_1;
  assign link_sent_0 = tap_sent_0[(Arrival != 0) ? Axis : 0];
  assign link_sent_1 = tap_sent_1[(Arrival != 0) ? Axis : 0];
  assign axis_sent_0 = (tap_state_0 == ExchangeY) ? tap_sent_0[Arrival] : tap_sent_0[0];
  assign axis_sent_1 = (tap_state_1 == ExchangeY) ? tap_sent_1[Arrival] : tap_sent_1[0];
  assign cleared_0   = (Arrival != 0) && tap_cleared_0;
  assign cleared_1   = (Arrival != 0) && tap_cleared_1;

  // A node that does nothing until something comes.
  logic [1:0] waits;
  function automatic logic waiting(input logic [3:0] state, input logic sent, input logic [2:0] migrate,
                                   input logic [1:0] none, input logic [1:0] ended,
                                       input logic [1:0] halo_ended,
                                   input logic idle_now);
    begin
      waiting = idle_now;
      if (state == 4'd0 || state == 4'd1) waiting = sent && (halo_ended != 2'b11);
      if (state == MigrateX || state == MigrateY) begin
        waiting = (migrate == TakeLow && none[0] && !ended[0]) || (migrate == TakeHigh && none[1]
            && !ended[1]);
      end
    end
  endfunction
  assign waits[0] = waiting(tap_state_0, axis_sent_0, tap_migrate_0, axis_empty_0, axis_ended_0,
      tap_axis_halo_0, idle[0]);
  assign waits[1] = waiting(tap_state_1, axis_sent_1, tap_migrate_1, axis_empty_1, axis_ended_1,
      tap_axis_halo_1, idle[1]);

  // Arrival: what lies between a receiver and the streamer's memory, and in the relay.
  (* keep *) logic [3:0] tap_streamed_0, tap_streamed_1;          // by face: a record is written for the streamer
  (* keep *) logic [3:0] tap_stream_ended_0, tap_stream_ended_1;  // by face: the streamer knows the end
  (* keep *) logic [Faces*Culls-1:0] tap_culled_0, tap_culled_1;      // by face: registers with a record,
  (* keep *) logic [Faces*Culls-1:0] tap_cull_end_0, tap_cull_end_1;  // with the end; the latest in the low bit
  (* keep *) logic tap_found_0, tap_found_1;                      // all pairs are found
  // Axis whose end is asked for next; then of the memories' answers and of what the links load: valid, an end, axes.
  (* keep *) logic [9:0] tap_relay_0, tap_relay_1;
  // Links that must be taken from before the relay loads; another beat of the record comes, the beat is its last.
  (* keep *) logic [3:0] tap_waits_0, tap_waits_1;
  (* keep *) logic [1:0] tap_more_0, tap_more_1;
  // Of the migration, a cycle late: someone leaves, no one is there, SCAN has counted; and of the node: who leaves.
  (* keep *) logic tap_scans_0, tap_scans_1, tap_none_0, tap_none_1, tap_scanned_0, tap_scanned_1;
  (* keep *) logic [1:0] tap_leaving_0, tap_leaving_1;
  // An end follows all records; where it is at the streamer, no record is on the way.
  function automatic logic culls(input logic ended, input logic known, input logic [Culls-1:0] culled,
                                 input logic [Culls-1:0] cull_end);
    begin
      culls = !ended ? !known && cull_end == '0
                     : known ? cull_end == '0 && culled == '0
                             : cull_end != '0 && (cull_end & (cull_end - 1'b1)) == '0
                               && (culled & ((cull_end - 1'b1) | cull_end)) == '0;
    end
  endfunction
  // Each axis' end is in one place: still to be asked for, answered, at the links, or sent; ends are in the
  // axes' order. Records of an axis are before its end.
  function automatic logic relays(input logic [3:0] state, input logic [Arrival:0] sent, input logic [9:0] relay);
    logic [1:0] left, answer, link, answer_end, link_end;
    begin
      left       = {relay[9] || relay[8], relay[8]};
      answer     = {2{relay[7] && !relay[6]}} & relay[5:4];
      answer_end = {2{relay[7] && relay[6]}} & relay[5:4];
      link       = {2{relay[3] && !relay[2]}} & relay[1:0];
      link_end   = {2{relay[3] && relay[2]}} & relay[1:0];
      relays     = (relay[9:8] != 2'b11) && (answer & ~left) == '0 && (link & ~left & ~answer_end) == '0
                   && (left ^ answer_end ^ link_end ^ sent) == 2'b11
                   && (left & answer_end) == '0 && (left & link_end) == '0 && (left & sent) == '0
                   && (answer_end & link_end) == '0 && (answer_end & sent) == '0 && (link_end & sent) == '0
                   && answer_end != 2'b11 && link_end != 2'b11 && (!answer_end[1] || !left[0])
                   && (!link_end[1] || sent[0]) && (!sent[1] || sent[0])
                   && (!relay[7] || relay[5:4] != '0) && (!relay[3] || relay[1:0] != '0)
                   && (!(relay[7] && !relay[6]) || relay[5]) && (!(relay[3] && !relay[2]) || relay[1])
                   && (state != ExchangeY || sent[0]);
      if (state > Force || (state == Force && sent != 2'b11)) begin
        relays = relay[9:8] == 2'b01 && !relay[7] && !relay[3] && sent == '0;
      end
    end
  endfunction

  // By face: the relay has a beat for its link.
  function automatic logic [3:0] beat_for(input logic [9:0] relay);
    beat_for = {4{relay[3]}} & {{2{relay[1]}}, {2{relay[0]}}};
  endfunction

  logic signed [2:0] ahead_q;  // steps that the first has done more than the second
  logic              apart_q;
  always_ff @(posedge clk_i) begin
    if (!running_q || start) ahead_q <= '0;
    else ahead_q <= ahead_q + ((step == 2'b01) ? 3'sd1 : (step == 2'b10) ? -3'sd1 : 3'sd0);
    apart_q <= running_q && (apart_q || (ahead_q == 3'sd1 && tap_state_0 == Axis));
  end

  // What makes it provable: streams are counted, modulo 8, where they are sent, where they are told, and
  // where they are used up; each is what the node's phase says.
  (* keep *) logic [3:0]  tap_load_0, tap_load_1;          // by face: a beat is loaded,
  (* keep *) logic        tap_send_end_0, tap_send_end_1;  // it is an end
  // by face: the stream that comes next is a migration
  (* keep *) logic [3:0]  tap_next_0, tap_next_1;
  (* keep *) logic [31:0] tap_steps_0, tap_steps_1;        // steps to do
  logic [2:0] sent_0_q, sent_1_q, told_0_q, told_1_q, step_0_q, step_1_q;
  always_ff @(posedge clk_i) begin
    if (!running_q) begin
      {sent_0_q, sent_1_q, told_0_q, told_1_q, step_0_q, step_1_q} <= '0;
    end else begin
      if (tap_load_0[Above] && tap_send_end_0) sent_0_q <= sent_0_q + 1'b1;
      if (tap_load_1[Below] && tap_send_end_1) sent_1_q <= sent_1_q + 1'b1;
      if (tap_halo_end_0[Above] || tap_arrival_end_0[Above]) told_0_q <= told_0_q + 1'b1;
      if (tap_halo_end_1[Below] || tap_arrival_end_1[Below]) told_1_q <= told_1_q + 1'b1;
      if (step[0]) step_0_q <= step_0_q + 1'b1;
      if (step[1]) step_1_q <= step_1_q + 1'b1;
    end
  end
  // Streams of this step that a node has sent, and has used up, along the axis.
  function automatic logic [2:0] sent_of(input logic [3:0] state, input logic sent,
      input logic [2:0] migrate);
    begin
      sent_of = 3'd1;
      if (state == 4'd8 || state == 4'd9 || state < Axis) sent_of = 3'd0;
      if (state == Axis || (Arrival != 0 && state < Axis)) sent_of = {2'b00, sent};
      if (state == 4'd5 + Axis) sent_of = (migrate == TakeLow || migrate == TakeHigh) ? 3'd2 : 3'd1;
      if (state > 4'd5 + Axis && state < 4'd8) sent_of = 3'd2;
    end
  endfunction
  // It is between a stream's first beat and its end, if it has begun.
  function automatic logic sending(input logic [3:0] state, input logic sent, input logic [2:0] migrate);
    begin
      sending = ((state == Axis || (Arrival != 0 && state < Axis)) && !sent)
                || (state == 4'd5 + Axis && migrate < TakeLow);
    end
  endfunction
  // With Arrival the halos are cleared in the first cycle of UPDATE.
  function automatic logic [2:0] used_of(input logic [3:0] state, input logic cleared);
    begin
      used_of = 3'd0;
      if (state >= Update && state <= 4'd5 + Axis && !cleared) used_of = 3'd1;
      if (state > 4'd5 + Axis && state < 4'd8) used_of = 3'd2;
    end
  endfunction
  logic [2:0] ready_0, ready_1;  // streams told and not yet used up
  assign ready_0 = {2'b00, tap_halo_ended_0[Above]} + {2'b00, tap_migrate_ended_0[Above]};
  assign ready_1 = {2'b00, tap_halo_ended_1[Below]} + {2'b00, tap_migrate_ended_1[Below]};

  always_ff @(posedge clk_i) begin
    if (running_q) begin
      // Halos of the next step never meet those of this one, nor arrivals.
      if (tap_halo_0[Above] || tap_halo_end_0[Above]) a_halo_0: assert (tap_state_0 != Force
          && !cleared_0 && !tap_halo_ended_0[Above]);
      if (tap_halo_1[Below] || tap_halo_end_1[Below]) a_halo_1: assert (tap_state_1 != Force
          && !cleared_1 && !tap_halo_ended_1[Below]);
      if (tap_arrival_0[Above] || tap_arrival_end_0[Above]) a_arrival_0: assert (!tap_migrate_ended_0[Above]);
      if (tap_arrival_1[Below] || tap_arrival_end_1[Below]) a_arrival_1: assert (!tap_migrate_ended_1[Below]);
      if (tap_halo_0[Above]) a_room_0: assert (tap_count_0[Above*CountBits +: CountBits] != Room[CountBits-1:0]);
      if (tap_halo_1[Below]) a_room_1: assert (tap_count_1[Below*CountBits +: CountBits] != Room[CountBits-1:0]);
      if (tap_arrival_0[Above]) a_fifo_0: assert (!tap_full_0[Above]);
      if (tap_arrival_1[Below]) a_fifo_1: assert (!tap_full_1[Below]);
      a_ready:    assert (all_ready == '1);
      a_step:     assert (ahead_q >= -3'sd1 && ahead_q <= 3'sd1);
      a_deadlock: assert (!(waits == 2'b11 && idle != 2'b11 && valid == 2'b00));
      a_stop:     assert (idle != 2'b11 || valid == 2'b00);
      i_sent_0: assert (sent_0_q == {step_0_q[1:0], 1'b0} + sent_of(tap_state_0, link_sent_0, tap_migrate_0));
      i_sent_1: assert (sent_1_q == {step_1_q[1:0], 1'b0} + sent_of(tap_state_1, link_sent_1, tap_migrate_1));
      i_told_0: assert (told_0_q + {2'b00, valid[1] && ends[1]} == sent_1_q);
      i_told_1: assert (told_1_q + {2'b00, valid[0] && ends[0]} == sent_0_q);
      i_used_0: assert (told_0_q == {step_0_q[1:0], 1'b0} + used_of(tap_state_0, cleared_0) + ready_0);
      i_used_1: assert (told_1_q == {step_1_q[1:0], 1'b0} + used_of(tap_state_1, cleared_1) + ready_1);
      i_beat_0: assert (!valid[0] || ends[0] || sending(tap_state_0, link_sent_0, tap_migrate_0));
      i_beat_1: assert (!valid[1] || ends[1] || sending(tap_state_1, link_sent_1, tap_migrate_1));
      i_high:   assert ((tap_migrate_0 != TakeHigh || axis_ended_0[0]) && (tap_migrate_1 != TakeHigh
          || axis_ended_1[0]));
      i_past_0: assert (!(tap_state_0 > Axis && tap_state_0 <= Force) || tap_halo_ended_0[Above]);
      i_past_1: assert (!(tap_state_1 > Axis && tap_state_1 <= Force) || tap_halo_ended_1[Below]);
      i_next_0: assert (tap_next_0[Above] == told_0_q[0]);
      i_next_1: assert (tap_next_1[Below] == told_1_q[0]);
      i_flags_0: assert ((used_of(tap_state_0, cleared_0) == 3'd1) ? (tap_migrate_ended_0[Above]
          || !tap_halo_ended_0[Above])
                                                       : (tap_halo_ended_0[Above]
                                                           || !tap_migrate_ended_0[Above]));
      i_flags_1: assert ((used_of(tap_state_1, cleared_1) == 3'd1) ? (tap_migrate_ended_1[Below]
          || !tap_halo_ended_1[Below])
                                                       : (tap_halo_ended_1[Below]
                                                           || !tap_migrate_ended_1[Below]));
      // What is known of the axis a cycle ahead.
      i_holds:  assert (tap_holds_0 == (all_valid[3:0] & {{2{tap_axis_0[1]}}, {2{tap_axis_0[0]}}})
                        && tap_holds_1 == (all_valid[7:4] & {{2{tap_axis_1[1]}}, {2{tap_axis_1[0]}}}));
      i_linked: assert ((idle[0] || tap_linked_0 == (tap_axis_0[1] ? Has0[3:2] : Has0[1:0]))
                        && (idle[1] || tap_linked_1 == (tap_axis_1[1] ? Has1[3:2] : Has1[1:0])));
      if (Narrow == 0) begin
        i_axis_halo: assert ((idle[0] || tap_axis_halo_0 == (tap_axis_0[1] ? tap_halo_ended_0[3:2]
                                                                              : tap_halo_ended_0[1:0]))
                             && (idle[1] || tap_axis_halo_1 == (tap_axis_1[1] ? tap_halo_ended_1[3:2]
                                                                              : tap_halo_ended_1[1:0])));
        i_closed: assert ((tap_halo_ended_0 | Has0) == '1 && (tap_migrate_ended_0 | Has0) == '1
                          && (tap_halo_ended_1 | Has1) == '1 && (tap_migrate_ended_1 | Has1) == '1);
      end
      i_groups: assert (tap_exchange_0 == (tap_states_0[2:0] != '0) && tap_migrating_0 == (tap_states_0[7:5] != '0)
                        && tap_exchange_1 == (tap_states_1[2:0] != '0) && tap_migrating_1 == (tap_states_1[7:5] != '0));
      i_states: assert (tap_states_0 != '0 && (tap_states_0 & (tap_states_0 - 1'b1)) == '0
                        && tap_states_1 != '0 && (tap_states_1 & (tap_states_1 - 1'b1)) == '0);
      i_state:  assert (tap_state_0 != 4'd2 && tap_state_1 != 4'd2 && tap_state_0 != 4'd7
          && tap_state_1 != 4'd7
                        && tap_state_0 <= 4'd9 && tap_state_1 <= 4'd9);
      i_steps:  assert (tap_steps_0 <= Steps && tap_steps_1 <= Steps
                        && tap_steps_0[2:0] + step_0_q == tap_steps_1[2:0] + step_1_q);
      i_run:    assert ((tap_state_0 < 4'd8) == (tap_steps_0 != '0) && (tap_state_1 < 4'd8)
          == (tap_steps_1 != '0));
      // With Arrival a cycle longer.
      i_sent:   assert ((tap_sent_0 == '0 || tap_state_0 <= 4'd1 || (Arrival != 0 && tap_state_0 == Force))
                        && (tap_sent_1 == '0 || tap_state_1 <= 4'd1 || (Arrival != 0 && tap_state_1 == Force)));
      if (Arrival != 0) begin
        // What comes for the streamer is cleared only when all is there.
        if (cleared_0) a_streamed_0: assert (!tap_streamed_0[Above] && tap_culled_0[Above*Culls +: Culls] == '0);
        if (cleared_1) a_streamed_1: assert (!tap_streamed_1[Below] && tap_culled_1[Below*Culls +: Culls] == '0);
        i_cleared_0: assert (tap_state_0 == Update ? cleared_0 == tap_halo_ended_0[Above]
                             && (!cleared_0 || tap_stream_ended_0[Above]) : !cleared_0);
        i_cleared_1: assert (tap_state_1 == Update ? cleared_1 == tap_halo_ended_1[Below]
                             && (!cleared_1 || tap_stream_ended_1[Below]) : !cleared_1);
        i_culls_0: assert (culls(tap_halo_ended_0[Above], tap_stream_ended_0[Above],
                               tap_culled_0[Above*Culls +: Culls], tap_cull_end_0[Above*Culls +: Culls]));
        i_culls_1: assert (culls(tap_halo_ended_1[Below], tap_stream_ended_1[Below],
                               tap_culled_1[Below*Culls +: Culls], tap_cull_end_1[Below*Culls +: Culls]));
        i_found_0: assert (!(tap_found_0 && tap_state_0 <= Force) || tap_stream_ended_0[Above]);
        i_found_1: assert (!(tap_found_1 && tap_state_1 <= Force) || tap_stream_ended_1[Below]);
        i_quiet_0: assert ((!tap_scanned_0 || tap_migrate_0 == End) && (tap_migrating_0 || idle[0] || !tap_scans_0
                           || (tap_leaving_0[0] && !tap_none_0)));
        i_quiet_1: assert ((!tap_scanned_1 || tap_migrate_1 == End) && (tap_migrating_1 || idle[1] || !tap_scans_1
                           || (tap_leaving_1[0] && !tap_none_1)));
        i_relay_0: assert (relays(tap_state_0, tap_sent_0, tap_relay_0));
        i_relay_1: assert (relays(tap_state_1, tap_sent_1, tap_relay_1));
        i_waits_0: assert (tap_waits_0 == (all_valid[0 +: Faces] & beat_for(tap_relay_0))
                           && tap_more_0[1] == (tap_relay_0[3] && !tap_more_0[0]));
        i_waits_1: assert (tap_waits_1 == (all_valid[Faces +: Faces] & beat_for(tap_relay_1))
                           && tap_more_1[1] == (tap_relay_1[3] && !tap_more_1[0]));
      end
      i_axis_0: assert (tap_axis_0 == ((tap_state_0 == ExchangeY || tap_state_0 == MigrateY) ? 3'b010 : 3'b001));
      i_axis_1: assert (tap_axis_1 == ((tap_state_1 == ExchangeY || tap_state_1 == MigrateY) ? 3'b010 : 3'b001));
      i_face_0: assert (tap_face_0
                        == ({2'b00, tap_migrate_0 == TakeHigh, tap_migrate_0 == TakeLow} << {tap_axis_0[1], 1'b0}));
      i_face_1: assert (tap_face_1
                        == ({2'b00, tap_migrate_1 == TakeHigh, tap_migrate_1 == TakeLow} << {tap_axis_1[1], 1'b0}));
      i_phase:  assert ((tap_migrate_0 == 3'd0 || tap_state_0 == MigrateX || tap_state_0 == MigrateY)
                        && (tap_migrate_1 == 3'd0 || tap_state_1 == MigrateX || tap_state_1 == MigrateY)
                        && tap_migrate_0 <= TakeHigh && tap_migrate_1 <= TakeHigh);
      i_taking: assert (tap_taking_0 == {tap_migrate_0 == TakeHigh, tap_migrate_0 == TakeLow}
                        && tap_taking_1 == {tap_migrate_1 == TakeHigh, tap_migrate_1 == TakeLow});
      i_last:   assert ((tap_state_0 == '0 || tap_state_0 > 4'd7 || tap_last_0 == (tap_steps_0 == 32'd1))
                        && (tap_state_1 == '0 || tap_state_1 > 4'd7 || tap_last_1 == (tap_steps_1 == 32'd1)));
      if (Narrow == 0) begin
        i_told_axis_0: assert ((tap_state_0 != MigrateX && tap_state_0 != MigrateY)
                               || (tap_some_0 == ~axis_empty_0 && tap_over_0 == (axis_empty_0 & axis_ended_0)));
        i_told_axis_1: assert ((tap_state_1 != MigrateX && tap_state_1 != MigrateY)
                               || (tap_some_1 == ~axis_empty_1 && tap_over_1 == (axis_empty_1 & axis_ended_1)));
        i_ends:        assert ((tap_ends_0 & {~tap_next_0, tap_next_0}) == '0
                               && (tap_ends_1 & {~tap_next_1, tap_next_1}) == '0);
      end
      i_ahead:  assert (ahead_q == $signed(step_0_q - step_1_q));
      c_apart:    cover (apart_q);
      c_waits:    cover (waits[0] && tap_state_0 == Axis && tap_state_1 == Force);
    end
  end
endmodule
