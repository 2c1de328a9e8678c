// SPDX-License-Identifier: MIT
// Two whole nodes of a rule with several rounds side by side, all of cuboct_rule_core that controls: what the pair
// finder, the pipelines and the slots give, and what the beats carry, is any value, at any time that the cycle
// contract allows, so that any number of particles goes anywhere. Any loads, any number of steps, any stalls of the two
// links. Halos of a round never meet those of another, nor of another step; neighbours are never more than a round
// apart; there is no state in which both wait for ever, and nothing is under way at the end.
`include "rule_parts.svh"
module rounds_neighbours_formal #(
  parameter int Axis     = 0,  // the nodes are neighbours along x or y
  parameter int Capacity = 1,
  parameter int Rounds   = 2,  // 1 ... 3
  parameter int Second   = 3,  // bits of a record of the second round; 0: there is none
  parameter int LinkBits = 10,
  parameter int Overlap  = 1,
  parameter int Steps    = 2   // of a run, at most
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
  localparam int Room         = ((Axis == 0) ? 1 : 3) * Capacity;  // of the face's halo memories, at most 15
  localparam int ParticleBits = 6;             // x y away_y id field: 1 1 2 1 1
  localparam int Phases       = 5 * Rounds + 3;
  localparam int First        = 5;             // bits of a record of the first round
  localparam int Third        = 2;
  localparam int Most         = (Rounds > 1 && Second > First) ? Second : First;
  localparam int Later        = ((Rounds > 1) ? Second : 0) + ((Rounds > 2) ? Third : 0);
  localparam logic [47:0] RecordBits   = {Third[15:0], Second[15:0], First[15:0]};
  localparam logic [47:0] FinishCycles = {16'd4, 16'd5, 16'd4};  // by round
  localparam int Longest      = 5;             // of these
  localparam int Streams      = Rounds + 1;    // of a step

  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;

  logic [1:0]          valid, ends, ready, idle, step, met;  // met: a round's last cycle
  logic [2*Faces-1:0]  all_ready;
  logic [2*Phases-1:0] phase_start, phase_end;
  logic                start;
  // A node does not know a step's number, only whether it is the last one.
  always_comb assume (steps_i <= Steps);
  assign start = running_q && start_i && idle == 2'b11 && load_i == 2'b00;
  for (genvar n = 0; n < 2; n++) begin : gen_node
    localparam int Face = (n == 0) ? Above : Below;
    logic [Faces-1:0]          link_valid, link_end, link_ready_in, link_valid_in, link_end_in, link_ready, has_link;
    logic [Faces*LinkBits-1:0] link_data, link_data_in;
    logic                      observe, fault, id;
    logic [ParticleBits-1:0]   observed;
    logic [3:0]                code, stage;
    logic [4:0]                event_now;
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
    assign all_ready[n*Faces +: Faces] = link_ready;
    cuboct_rule_core #(
      .Axes(2), .Capacity(Capacity), .FilterLanes(1), .ForcePipes(1), .QueueDepth(1), .Overlap(Overlap),
      .LinkBits(LinkBits), .IdBits(1), .PositionFrac(1), .FilterFrac(1), .ParticleBits(ParticleBits), .IdLsb(4),
      .Rounds(Rounds), .RecordBits(RecordBits[Rounds*16-1:0]), .FinishCycles(FinishCycles[Rounds*16-1:0]),
      .MostBits(Most), .LaterBits(Later)
    ) u_node (
      .clk_i, .rst_ni(running_q), .start_i(start), .steps_i, .has_link_i(has_link),
      .load_valid_i(running_q && load_i[n]), .load_data_i({ParticleBits {1'b0}}), .link_valid_o(link_valid),
      .link_end_o(link_end), .link_data_o(link_data), .link_ready_i(link_ready_in), .link_valid_i(link_valid_in),
      .link_end_i(link_end_in), .link_data_i(link_data_in), .link_ready_o(link_ready),
      .phase_start_o(phase_start[Phases*n +: Phases]), .phase_end_o(phase_end[Phases*n +: Phases]),
      .force_event_o(event_now), .observe_valid_o(observe), .observe_data_o(observed), .fault_valid_o(fault),
      .fault_code_o(code), .fault_stage_o(stage), .fault_id_o(id), .fault_number_o(number), .idle_o(idle[n])
    );
    assign step[n] = phase_end[Phases*n+5*Rounds+1];  // MIGRATE_Y is the last of a step
    logic [Rounds-1:0] updates;
    for (genvar r = 0; r < Rounds; r++) begin : gen_met
      assign updates[r] = phase_end[Phases*n+5*r+4];
    end
    assign met[n] = (updates != '0);

    // What the contract says of the units that are cut out: the finder is done only in FORCE, as the last segment is
    // there only then (proof `round_streamer`); a finish writes a slot two cycles before its result may be read.
    (* keep *) logic                tap_finder_done, tap_take, tap_update_write;
    (* keep *) logic [1:0]          tap_past_exchange;
    (* keep *) logic [Rounds-1:0]   tap_round;
    (* keep *) logic [SlotBits-1:0] tap_tick_slot, tap_update_slot;
    logic [Longest*SlotBits-1:0]    slots_q;  // taken before, the last one lowest
    logic [Longest*Rounds-1:0]      takes_q;  // and by round whether one was
    logic                           writes;
    logic [SlotBits-1:0]            slot;
    integer                         k;
    always_ff @(posedge clk_i) begin
      takes_q <= running_q ? {takes_q[(Longest-1)*Rounds-1:0], tap_round & {Rounds{tap_take}}} : '0;
      slots_q <= {slots_q[(Longest-1)*SlotBits-1:0], tap_tick_slot};
    end
    always_comb begin
      writes = 1'b0;
      slot   = '0;
      for (k = 0; k < Rounds; k = k + 1) begin
        if (takes_q[(FinishCycles[k*16 +: 16]-3)*Rounds+k]) begin
          writes = 1'b1;
          slot   = slots_q[(FinishCycles[k*16 +: 16]-3)*SlotBits +: SlotBits];
        end
      end
      assume (!tap_finder_done || tap_past_exchange[1]);
      assume (tap_update_write == writes);
      if (writes) assume (tap_update_slot == slot);
    end
  end

  localparam logic [3:0] ExchangeY = 4'd1, Force = 4'd3, Update = 4'd4, MigrateX = 4'd5, MigrateY = 4'd6;
  localparam logic [2:0] TakeLow = 3'd3, TakeHigh = 3'd4;
  localparam logic [Rounds-1:0] FirstRound = 1;

  // The place of a stream in all that go over a link: its step, modulo 4, and its number in it. Of the n-th of a step,
  // which may be of the next ones; of the one behind it.
  function automatic logic [3:0] place(input logic [1:0] of_step, input logic [3:0] n);
    begin
      place = (n < Streams) ? {of_step, n[1:0]} : {of_step + 2'd1, n[1:0] - Streams[1:0]};
      if (n >= 2 * Streams) place = {of_step + 2'd2, n[1:0] - 2'd2 * Streams[1:0]};
    end
  endfunction
  function automatic logic [3:0] after(input logic [3:0] p);
    after = (p[1:0] == Rounds[1:0]) ? {p[3:2] + 2'd1, 2'd0} : {p[3:2], p[1:0] + 2'd1};
  endfunction

  function automatic logic [3:0] index_of(input logic [Rounds-1:0] round);
    integer i;
    begin
      index_of = '0;
      for (i = 0; i < Rounds; i = i + 1) if (round[i]) index_of = i[3:0];
    end
  endfunction
  function automatic logic [3:0] number_of(input logic [Rounds-1:0] flags);
    integer i;
    begin
      number_of = '0;
      for (i = 0; i < Rounds; i = i + 1) if (flags[i]) number_of = number_of + 4'd1;
    end
  endfunction
  // Streams of this step that a node has sent, and has used up, along the axis: halos are used up, of all rounds
  // together, with the last round's FORCE.
  function automatic logic [3:0] sent_of(input logic [3:0] state, input logic [3:0] round, input logic sent,
                                         input logic [2:0] migrate);
    begin
      sent_of = '0;
      if (state <= Update) sent_of = round + {3'd0, (state == Axis) ? sent : state > Axis};
      if (state >= MigrateX && state < 4'd8) sent_of = Rounds[3:0];
      if (state == 4'd5 + Axis && (migrate == TakeLow || migrate == TakeHigh)) sent_of = Streams[3:0];
      if (state > 4'd5 + Axis && state < 4'd8) sent_of = Streams[3:0];
    end
  endfunction
  // It is between a stream's first beat and its end, if it has begun.
  function automatic logic sending(input logic [3:0] state, input logic sent, input logic [2:0] migrate);
    sending = (state == Axis && !sent) || (state == 4'd5 + Axis && migrate < TakeLow);
  endfunction
  function automatic logic [3:0] used_of(input logic [3:0] state, input logic last);
    begin
      used_of = '0;
      if ((state == Update && last) || (state >= MigrateX && state < 4'd8)) used_of = Rounds[3:0];
      if (state > 4'd5 + Axis && state < 4'd8) used_of = Streams[3:0];
    end
  endfunction
  // Rounds of this step that a node has done.
  function automatic logic [3:0] done_of(input logic [3:0] state, input logic [3:0] round);
    done_of = (state <= Update) ? round : (state < 4'd8) ? Rounds[3:0] : 4'd0;
  endfunction
  // Rounds whose halos a node must have: those before this one, and this one where its exchange is over.
  function automatic logic [Rounds-1:0] needed(input logic [3:0] state, input logic [Rounds-1:0] round);
    begin
      needed = '0;
      if (state < Update || (state == Update && !round[Rounds-1])) needed = round - 1'b1;
      if (state > Axis && state < Update) needed = needed | round;
      if (state == Update && !round[Rounds-1]) needed = needed | round;
    end
  endfunction
  // Streams end in order.
  function automatic logic in_order(input logic [3:0] used, input logic [Rounds-1:0] halos, input logic particles);
    in_order = (halos & (halos + 1'b1)) == '0
               && ((used == Rounds) ? (particles || halos == '0) : (halos == '1 || !particles));
  endfunction
  // A node that does nothing until something comes.
  function automatic logic waiting(input logic [3:0] state, input logic sent, input logic [2:0] migrate,
                                   input logic [1:0] none, input logic [1:0] ended, input logic [1:0] halo_ended,
                                   input logic idle_now);
    begin
      waiting = idle_now;
      if (state == 4'd0 || state == 4'd1) waiting = sent && (halo_ended != 2'b11);
      if (state == MigrateX || state == MigrateY) begin
        waiting = (migrate == TakeLow && none[0] && !ended[0]) || (migrate == TakeHigh && none[1] && !ended[1]);
      end
    end
  endfunction

  logic [1:0]        waits;
  logic signed [2:0] ahead_q;  // steps that the first has done more than the second
  logic              apart_q, waited_q;  // the first was a round ahead, and sent; and waited for the second
  always_ff @(posedge clk_i) begin
    if (!running_q || start) ahead_q <= '0;
    else ahead_q <= ahead_q + ((step == 2'b01) ? 3'sd1 : (step == 2'b10) ? -3'sd1 : 3'sd0);
  end

  // Where node 0 is, and what comes in.
  (* keep *) logic [3:0]               tap_state_0;
  (* keep *) logic [9:0]               tap_states_0;
  (* keep *) logic [Rounds-1:0]        tap_round_0;
  (* keep *) logic                     tap_exchange_0, tap_migrating_0;
  (* keep *) logic [2:0]               tap_axis_0;        // of the sequencer
  (* keep *) logic [Rounds-1:0]        tap_sent_0;        // by round, of its relay: the end is sent
  (* keep *) logic                     tap_cleared_0;     // halos are cleared at this cycle's end
  (* keep *) logic [2:0]               tap_migrate_0;     // state of the migration
  (* keep *) logic [1:0]               tap_axis_halo_0;
  (* keep *) logic [Faces-1:0]         tap_empty_0, tap_migrate_ended_0;  // by face, of particles
  (* keep *) logic [Faces-1:0]         tap_face_0;        // that migration takes from
  (* keep *) logic [1:0]               tap_taking_0;      // what migration keeps of it: from below, from above;
  (* keep *) logic [1:0]               tap_some_0, tap_over_0;  // what it is told of the axis
  (* keep *) logic                     tap_last_0;        // of the steps
  (* keep *) logic [31:0]              tap_steps_0;       // to do
  (* keep *) logic [Faces*Rounds-1:0]  tap_halo_0;        // by face, round: a record comes
  (* keep *) logic [Rounds*Faces-1:0]  tap_halo_end_0, tap_halo_ended_0;  // by round, face: an end comes, has come
  (* keep *) logic [Faces-1:0]         tap_arrival_0, tap_arrival_end_0, tap_full_0;
  (* keep *) logic [(Rounds+1)*Faces-1:0] tap_next_0;     // by face: the stream that comes, a bit each
  (* keep *) logic [Faces-1:0]         tap_load_0;        // by face: a beat is loaded,
  (* keep *) logic                     tap_send_end_0;    // it is an end
  logic                                sent_0;            // of this round
  logic [Rounds-1:0]                   come_0, come_end_0, ended_0;  // by round, over the link: records, ends
  logic                                arrives_0, arrives_end_0;
  logic [1:0]                          axis_empty_0, axis_ended_0;
  logic [Faces-1:0]                    all_ended_0;
  logic [3:0]                          round_0, used_0, place_sent_0_q, place_told_0_q;
  logic [2:0]                          step_0_q, done_0_q, all_done_0;
  // By round, over the link, of this step: records that came; there is no room for the one that comes; an end comes
  // after more or less of them than came of the first round.
  logic [4*Rounds-1:0]                 records_0_q;
  logic [Rounds-1:0]                   over_0, differs_0;
  assign sent_0       = ((tap_sent_0 & tap_round_0) != '0);
  assign come_0       = tap_halo_0[Above*Rounds +: Rounds];
  assign arrives_0    = tap_arrival_0[Above];
  assign arrives_end_0 = tap_arrival_end_0[Above];
  assign all_ended_0  = tap_migrate_ended_0 | ~(4'd1 << Above);
  assign axis_empty_0 = tap_axis_0[1] ? tap_empty_0[3:2] : tap_empty_0[1:0];
  assign axis_ended_0 = tap_axis_0[1] ? all_ended_0[3:2] : all_ended_0[1:0];
  assign round_0      = index_of(tap_round_0);
  assign all_done_0   = step_0_q * Rounds[2:0] + done_of(tap_state_0, round_0);
  assign used_0       = used_of(tap_state_0, tap_round_0[Rounds-1]);
  for (genvar q = 0; q < Rounds; q++) begin : gen_over_0
    assign come_end_0[q] = tap_halo_end_0[q*Faces+Above];
    assign ended_0[q]    = tap_halo_ended_0[q*Faces+Above];
    assign over_0[q]     = come_0[q] && records_0_q[4*q +: 4] == Room[3:0];
    assign differs_0[q]  = come_end_0[q] && RecordBits[16*q +: 16] != 16'd0
                           && records_0_q[4*q +: 4] != records_0_q[3:0];
    always_ff @(posedge clk_i) begin
      if (!running_q || tap_cleared_0) records_0_q[4*q +: 4] <= '0;
      else if (come_0[q]) records_0_q[4*q +: 4] <= records_0_q[4*q +: 4] + 4'd1;
    end
  end
  assign waits[0] = waiting(tap_state_0, sent_0, tap_migrate_0, axis_empty_0, axis_ended_0, tap_axis_halo_0, idle[0]);
  // What makes it provable: streams are followed where they are sent and where they are told; each place is what the
  // node's phase says. Rounds and steps are counted modulo 8.
  always_ff @(posedge clk_i) begin
    if (!running_q) begin
      {place_sent_0_q, place_told_0_q, step_0_q, done_0_q} <= '0;
    end else begin
      if (tap_load_0[Above] && tap_send_end_0) place_sent_0_q <= after(place_sent_0_q);
      if (come_end_0 != '0 || arrives_end_0) place_told_0_q <= after(place_told_0_q);
      if (step[0]) step_0_q <= step_0_q + 1'b1;
      if (met[0]) done_0_q <= done_0_q + 1'b1;
    end
  end

  // Where node 1 is, and what comes in.
  (* keep *) logic [3:0]               tap_state_1;
  (* keep *) logic [9:0]               tap_states_1;
  (* keep *) logic [Rounds-1:0]        tap_round_1;
  (* keep *) logic                     tap_exchange_1, tap_migrating_1;
  (* keep *) logic [2:0]               tap_axis_1;        // of the sequencer
  (* keep *) logic [Rounds-1:0]        tap_sent_1;        // by round, of its relay: the end is sent
  (* keep *) logic                     tap_cleared_1;     // halos are cleared at this cycle's end
  (* keep *) logic [2:0]               tap_migrate_1;     // state of the migration
  (* keep *) logic [1:0]               tap_axis_halo_1;
  (* keep *) logic [Faces-1:0]         tap_empty_1, tap_migrate_ended_1;  // by face, of particles
  (* keep *) logic [Faces-1:0]         tap_face_1;        // that migration takes from
  (* keep *) logic [1:0]               tap_taking_1;      // what migration keeps of it: from below, from above;
  (* keep *) logic [1:0]               tap_some_1, tap_over_1;  // what it is told of the axis
  (* keep *) logic                     tap_last_1;        // of the steps
  (* keep *) logic [31:0]              tap_steps_1;       // to do
  (* keep *) logic [Faces*Rounds-1:0]  tap_halo_1;        // by face, round: a record comes
  (* keep *) logic [Rounds*Faces-1:0]  tap_halo_end_1, tap_halo_ended_1;  // by round, face: an end comes, has come
  (* keep *) logic [Faces-1:0]         tap_arrival_1, tap_arrival_end_1, tap_full_1;
  (* keep *) logic [(Rounds+1)*Faces-1:0] tap_next_1;     // by face: the stream that comes, a bit each
  (* keep *) logic [Faces-1:0]         tap_load_1;        // by face: a beat is loaded,
  (* keep *) logic                     tap_send_end_1;    // it is an end
  logic                                sent_1;            // of this round
  logic [Rounds-1:0]                   come_1, come_end_1, ended_1;  // by round, over the link: records, ends
  logic                                arrives_1, arrives_end_1;
  logic [1:0]                          axis_empty_1, axis_ended_1;
  logic [Faces-1:0]                    all_ended_1;
  logic [3:0]                          round_1, used_1, place_sent_1_q, place_told_1_q;
  logic [2:0]                          step_1_q, done_1_q, all_done_1;
  // By round, over the link, of this step: records that came; there is no room for the one that comes; an end comes
  // after more or less of them than came of the first round.
  logic [4*Rounds-1:0]                 records_1_q;
  logic [Rounds-1:0]                   over_1, differs_1;
  assign sent_1       = ((tap_sent_1 & tap_round_1) != '0);
  assign come_1       = tap_halo_1[Below*Rounds +: Rounds];
  assign arrives_1    = tap_arrival_1[Below];
  assign arrives_end_1 = tap_arrival_end_1[Below];
  assign all_ended_1  = tap_migrate_ended_1 | ~(4'd1 << Below);
  assign axis_empty_1 = tap_axis_1[1] ? tap_empty_1[3:2] : tap_empty_1[1:0];
  assign axis_ended_1 = tap_axis_1[1] ? all_ended_1[3:2] : all_ended_1[1:0];
  assign round_1      = index_of(tap_round_1);
  assign all_done_1   = step_1_q * Rounds[2:0] + done_of(tap_state_1, round_1);
  assign used_1       = used_of(tap_state_1, tap_round_1[Rounds-1]);
  for (genvar q = 0; q < Rounds; q++) begin : gen_over_1
    assign come_end_1[q] = tap_halo_end_1[q*Faces+Below];
    assign ended_1[q]    = tap_halo_ended_1[q*Faces+Below];
    assign over_1[q]     = come_1[q] && records_1_q[4*q +: 4] == Room[3:0];
    assign differs_1[q]  = come_end_1[q] && RecordBits[16*q +: 16] != 16'd0
                           && records_1_q[4*q +: 4] != records_1_q[3:0];
    always_ff @(posedge clk_i) begin
      if (!running_q || tap_cleared_1) records_1_q[4*q +: 4] <= '0;
      else if (come_1[q]) records_1_q[4*q +: 4] <= records_1_q[4*q +: 4] + 4'd1;
    end
  end
  assign waits[1] = waiting(tap_state_1, sent_1, tap_migrate_1, axis_empty_1, axis_ended_1, tap_axis_halo_1, idle[1]);
  // What makes it provable: streams are followed where they are sent and where they are told; each place is what the
  // node's phase says. Rounds and steps are counted modulo 8.
  always_ff @(posedge clk_i) begin
    if (!running_q) begin
      {place_sent_1_q, place_told_1_q, step_1_q, done_1_q} <= '0;
    end else begin
      if (tap_load_1[Below] && tap_send_end_1) place_sent_1_q <= after(place_sent_1_q);
      if (come_end_1 != '0 || arrives_end_1) place_told_1_q <= after(place_told_1_q);
      if (step[1]) step_1_q <= step_1_q + 1'b1;
      if (met[1]) done_1_q <= done_1_q + 1'b1;
    end
  end

  logic signed [2:0] rounds_ahead;
  assign rounds_ahead = $signed(done_0_q - done_1_q);
  always_ff @(posedge clk_i) begin
    apart_q  <= running_q && (apart_q || (rounds_ahead == 3'sd1 && (Rounds == 1 || (tap_state_1 == Force
                                          && come_1 != '0 && (come_1 & tap_round_1) == '0))));
    waited_q <= running_q && (waited_q || (apart_q && waits[0] && tap_round_0[Rounds-1] && tap_state_0 == Axis));
  end

  always_ff @(posedge clk_i) begin
    if (running_q) begin
      // Halos of another round, of the next step and arrivals never meet what is still in use.
      if ((come_0 | come_end_0) != '0) a_halo_0: assert (((come_0 | come_end_0) & ended_0) == '0 && !tap_cleared_0
                                                       && !(tap_state_0 == Force && tap_round_0[Rounds-1]));
      if (arrives_0 || arrives_end_0) a_arrival_0: assert (!tap_migrate_ended_0[Above]);
      a_room_0: assert (over_0 == '0);
      a_same_0: assert (differs_0 == '0);
      if (arrives_0) a_fifo_0: assert (!tap_full_0[Above]);
      // Halos of another round, of the next step and arrivals never meet what is still in use.
      if ((come_1 | come_end_1) != '0) a_halo_1: assert (((come_1 | come_end_1) & ended_1) == '0 && !tap_cleared_1
                                                       && !(tap_state_1 == Force && tap_round_1[Rounds-1]));
      if (arrives_1 || arrives_end_1) a_arrival_1: assert (!tap_migrate_ended_1[Below]);
      a_room_1: assert (over_1 == '0);
      a_same_1: assert (differs_1 == '0);
      if (arrives_1) a_fifo_1: assert (!tap_full_1[Below]);
      i_sent_0:  assert (place_sent_0_q == place(step_0_q[1:0], sent_of(tap_state_0, round_0, sent_0, tap_migrate_0)));
      i_told_0:  assert (((valid[1] && ends[1]) ? after(place_told_0_q) : place_told_0_q) == place_sent_1_q);
      i_used_0:  assert (place_told_0_q
                        == place(step_0_q[1:0], used_0 + number_of(ended_0) + {3'd0, tap_migrate_ended_0[Above]}));
      i_beat_0:  assert (!valid[0] || ends[0] || sending(tap_state_0, sent_0, tap_migrate_0));
      i_high_0:  assert (tap_migrate_0 != TakeHigh || axis_ended_0[0]);
      i_past_0:  assert ((needed(tap_state_0, tap_round_0) & ~ended_0) == '0);
      i_next_0:  assert (tap_next_0[Above*(Rounds+1) +: Rounds+1] == ({{Rounds {1'b0}}, 1'b1} << place_told_0_q[1:0]));
      i_flags_0: assert (in_order(used_0, ended_0, tap_migrate_ended_0[Above]));
      i_cleared_0: assert (!tap_cleared_0 || (tap_state_0 == Force && tap_round_0[Rounds-1]));
      i_groups_0: assert (tap_exchange_0 == (tap_states_0[2:0] != '0)
                          && tap_migrating_0 == (tap_states_0[7:5] != '0));
      i_states_0: assert (tap_states_0 != '0 && (tap_states_0 & (tap_states_0 - 1'b1)) == '0);
      i_state_0: assert (tap_state_0 != 4'd2 && tap_state_0 != 4'd7 && tap_state_0 <= 4'd9);
      i_round_0: assert (tap_round_0 != '0 && (tap_round_0 & (tap_round_0 - 1'b1)) == '0
                         && (tap_state_0 < 4'd8 || tap_round_0 == FirstRound)
                         && (tap_state_0 < MigrateX || tap_state_0 >= 4'd8 || tap_round_0[Rounds-1]));
      i_done_0:  assert (done_0_q == all_done_0);
      i_run_0:   assert ((tap_state_0 < 4'd8) == (tap_steps_0 != '0) && tap_steps_0 <= Steps);
      i_ended_0: assert (tap_sent_0 == '0 || (tap_state_0 <= 4'd1 && (tap_sent_0 & ~tap_round_0) == '0));
      i_axis_0:  assert (tap_axis_0 == ((tap_state_0 == ExchangeY || tap_state_0 == MigrateY) ? 3'b010 : 3'b001));
      i_face_0:  assert (tap_face_0
                        == ({2'b00, tap_migrate_0 == TakeHigh, tap_migrate_0 == TakeLow} << {tap_axis_0[1], 1'b0}));
      i_phase_0: assert (tap_migrate_0 <= TakeHigh
                         && (tap_migrate_0 == 3'd0 || tap_state_0 == MigrateX || tap_state_0 == MigrateY));
      i_taking_0: assert (tap_taking_0 == {tap_migrate_0 == TakeHigh, tap_migrate_0 == TakeLow});
      i_last_0:  assert ((tap_state_0 == '0 && tap_round_0[0]) || tap_state_0 > 4'd7
                         || tap_last_0 == (tap_steps_0 == 32'd1));
      i_told_axis_0: assert ((tap_state_0 != MigrateX && tap_state_0 != MigrateY)
                             || (tap_some_0 == ~axis_empty_0 && tap_over_0 == (axis_empty_0 & axis_ended_0)));
      i_sent_1:  assert (place_sent_1_q == place(step_1_q[1:0], sent_of(tap_state_1, round_1, sent_1, tap_migrate_1)));
      i_told_1:  assert (((valid[0] && ends[0]) ? after(place_told_1_q) : place_told_1_q) == place_sent_0_q);
      i_used_1:  assert (place_told_1_q
                        == place(step_1_q[1:0], used_1 + number_of(ended_1) + {3'd0, tap_migrate_ended_1[Below]}));
      i_beat_1:  assert (!valid[1] || ends[1] || sending(tap_state_1, sent_1, tap_migrate_1));
      i_high_1:  assert (tap_migrate_1 != TakeHigh || axis_ended_1[0]);
      i_past_1:  assert ((needed(tap_state_1, tap_round_1) & ~ended_1) == '0);
      i_next_1:  assert (tap_next_1[Below*(Rounds+1) +: Rounds+1] == ({{Rounds {1'b0}}, 1'b1} << place_told_1_q[1:0]));
      i_flags_1: assert (in_order(used_1, ended_1, tap_migrate_ended_1[Below]));
      i_cleared_1: assert (!tap_cleared_1 || (tap_state_1 == Force && tap_round_1[Rounds-1]));
      i_groups_1: assert (tap_exchange_1 == (tap_states_1[2:0] != '0)
                          && tap_migrating_1 == (tap_states_1[7:5] != '0));
      i_states_1: assert (tap_states_1 != '0 && (tap_states_1 & (tap_states_1 - 1'b1)) == '0);
      i_state_1: assert (tap_state_1 != 4'd2 && tap_state_1 != 4'd7 && tap_state_1 <= 4'd9);
      i_round_1: assert (tap_round_1 != '0 && (tap_round_1 & (tap_round_1 - 1'b1)) == '0
                         && (tap_state_1 < 4'd8 || tap_round_1 == FirstRound)
                         && (tap_state_1 < MigrateX || tap_state_1 >= 4'd8 || tap_round_1[Rounds-1]));
      i_done_1:  assert (done_1_q == all_done_1);
      i_run_1:   assert ((tap_state_1 < 4'd8) == (tap_steps_1 != '0) && tap_steps_1 <= Steps);
      i_ended_1: assert (tap_sent_1 == '0 || (tap_state_1 <= 4'd1 && (tap_sent_1 & ~tap_round_1) == '0));
      i_axis_1:  assert (tap_axis_1 == ((tap_state_1 == ExchangeY || tap_state_1 == MigrateY) ? 3'b010 : 3'b001));
      i_face_1:  assert (tap_face_1
                        == ({2'b00, tap_migrate_1 == TakeHigh, tap_migrate_1 == TakeLow} << {tap_axis_1[1], 1'b0}));
      i_phase_1: assert (tap_migrate_1 <= TakeHigh
                         && (tap_migrate_1 == 3'd0 || tap_state_1 == MigrateX || tap_state_1 == MigrateY));
      i_taking_1: assert (tap_taking_1 == {tap_migrate_1 == TakeHigh, tap_migrate_1 == TakeLow});
      i_last_1:  assert ((tap_state_1 == '0 && tap_round_1[0]) || tap_state_1 > 4'd7
                         || tap_last_1 == (tap_steps_1 == 32'd1));
      i_told_axis_1: assert ((tap_state_1 != MigrateX && tap_state_1 != MigrateY)
                             || (tap_some_1 == ~axis_empty_1 && tap_over_1 == (axis_empty_1 & axis_ended_1)));
      a_ready:    assert (all_ready == '1);
      a_step:     assert (ahead_q >= -3'sd1 && ahead_q <= 3'sd1);
      a_round:    assert (rounds_ahead >= -3'sd1 && rounds_ahead <= 3'sd1);
      a_deadlock: assert (!(waits == 2'b11 && idle != 2'b11 && valid == 2'b00));
      a_stop:     assert (idle != 2'b11 || (valid == 2'b00 && ended_0 == '0 && ended_1 == '0
                                            && !tap_migrate_ended_0[Above] && !tap_migrate_ended_1[Below]));
      i_steps:    assert (tap_steps_0[2:0] + step_0_q == tap_steps_1[2:0] + step_1_q);
      i_ahead:    assert (ahead_q == $signed(step_0_q - step_1_q));
      c_apart:    cover (apart_q);
      c_waits:    cover (waited_q);
      c_step:     cover (step_0_q == 3'd1 && idle == 2'b11);
      c_same:     cover (come_end_0[Rounds-1] && records_0_q[4*(Rounds-1) +: 4] == Capacity[3:0]);
    end
  end
endmodule
