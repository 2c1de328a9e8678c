// SPDX-License-Identifier: MIT
// Two nodes of bricks side by side, all of cuboct_brick_core that controls: what the finder, the datapath
// and the slots give, and what the beats carry, is any value, at any time; so any number of particles goes
// anywhere. Any loads, any number of steps, any extents, any stalls of the two links. Streams of one step never meet
// those of the next, neighbours are never more than a step apart, and there is no state in which both wait for ever.
module brick_neighbours_formal #(
  parameter int Axis     = 0,  // the nodes are neighbours along x or y
  parameter int BrickX   = 2,
  parameter int BrickY   = 1,
  parameter int Capacity = 1,
  parameter int LinkBits = 10,
  parameter int Steps    = 2   // of a run, at most
) (
  input logic        clk_i,
  input logic        start_i,
  input logic [31:0] steps_i,
  input logic [1:0]  load_i,            // by node
  input logic [1:0]  load_cell_i,
  input logic [2*LinkBits-1:0] wire_i,  // what the links carry; only ends and counts matter here
  input logic [1:0]  stall_i            // of the link to the second, to the first
);
  localparam int Faces        = 4;
  localparam int Below        = 2 * Axis;      // the face of the second node towards the first
  localparam int Above        = 2 * Axis + 1;  // of the first towards the second
  localparam int Cells        = BrickX * BrickY;
  localparam int CellBits     = $clog2(Cells);
  localparam int Longest      = (BrickX > BrickY) ? BrickX : BrickY;
  localparam int GridBits     = $clog2(Longest + 2);
  localparam int ParticleBits = 9;             // x y away_y v id residue: 1 1 2 1 1 1 1 1
  localparam int Thin         = (((Axis == 0) ? BrickX : BrickY) == 1) ? 1 : 0;
  localparam logic [GridBits-1:0] One = 1;

  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;

  logic [1:0]         valid, ends, ready, idle, step;
  logic [2*Faces-1:0] all_ready;
  logic [15:0]        phase_start, phase_end;
  logic               start;
  // A node does not know a step's number, only whether it is the last one.
  always_comb assume (steps_i <= Steps);
  assign start = running_q && start_i && idle == 2'b11 && load_i == 2'b00;
  for (genvar n = 0; n < 2; n++) begin : gen_node
    localparam int Face = (n == 0) ? Above : Below;
    (* anyconst *) logic [3*GridBits-1:0]  extent;
    (* anyconst *) logic [Cells*Faces-1:0] exits;
    logic [Faces-1:0]          link_valid, link_end, link_ready_in, link_valid_in, link_end_in, link_ready, has_link;
    logic [Faces*LinkBits-1:0] link_data, link_data_in;
    logic                      observe, fault, id, load;
    logic [ParticleBits-1:0]   observed;
    logic [CellBits-1:0]       observed_cell, fault_cell, load_cell;
    logic [3:0]                code;
    logic [4:0]                events;
    logic [63:0]               number;
    always_comb begin
      assume (extent[0 +: GridBits] >= 1 && extent[0 +: GridBits] <= BrickX);
      assume (extent[GridBits +: GridBits] >= 1 && extent[GridBits +: GridBits] <= BrickY);
      assume (extent[2*GridBits +: GridBits] == One);
      has_link            = '0;
      has_link[Face]      = 1'b1;
      link_valid_in       = '0;
      link_valid_in[Face] = valid[1-n] && !stall_i[n];
      link_end_in         = '0;
      link_end_in[Face]   = ends[1-n];
      link_data_in        = '0;
      link_data_in[Face*LinkBits +: LinkBits] = wire_i[n*LinkBits +: LinkBits];
      link_ready_in       = '0;
      link_ready_in[Face] = ready[1-n] && !stall_i[1-n];
      load                = running_q && load_i[n];
      load_cell           = load_cell_i[n];
    end
    assign valid[n] = link_valid[Face];
    assign ends[n]  = link_end[Face];
    assign ready[n] = link_ready[Face];
    assign all_ready[n*Faces +: Faces] = link_ready;
    cuboct_brick_core #(
      .Axes(2), .BrickX(BrickX), .BrickY(BrickY), .BrickZ(1), .Capacity(Capacity), .FilterLanes(1), .ForcePipes(1),
      .QueueDepth(1), .LinkBits(LinkBits), .IdBits(1), .PositionFrac(1), .Guard(1), .VelocityBits(1),
      .RelativeVelocityBits(1), .DifferenceShift(0), .FilterFrac(1), .Overlap(1)
    ) u_node (
      .clk_i, .rst_ni(running_q), .start_i(start), .steps_i, .has_link_i(has_link), .extent_i(extent), .exit_i(exits),
      .load_valid_i(load), .load_cell_i(load_cell), .load_data_i(9'd0), .velocity_i(1'b0), .link_valid_o(link_valid),
      .link_end_o(link_end),
      .link_data_o(link_data), .link_ready_i(link_ready_in), .link_valid_i(link_valid_in), .link_end_i(link_end_in),
      .link_data_i(link_data_in), .link_ready_o(link_ready), .phase_start_o(phase_start[8*n +: 8]),
      .phase_end_o(phase_end[8*n +: 8]), .force_event_o(events), .observe_valid_o(observe),
      .observe_cell_o(observed_cell),
      .observe_data_o(observed), .fault_valid_o(fault), .fault_code_o(code), .fault_id_o(id), .fault_cell_o(fault_cell),
      .fault_number_o(number), .idle_o(idle[n])
    );
    assign step[n] = phase_end[8*n+6];  // MIGRATE_Y is the last of a step

    // The finder is done only in FORCE, as the last segment is there only then (proof `brick_streamer`).
    (* keep *) logic       tap_finder_done;
    (* keep *) logic [1:0] tap_past_exchange;
    always_comb assume (!tap_finder_done || tap_past_exchange[1]);
  end

  // Where a node is, and what comes in.
  (* keep *) logic [3:0] tap_state_0, tap_state_1;
  (* keep *) logic [9:0] tap_states_0, tap_states_1;
  (* keep *) logic       tap_exchange_0, tap_exchange_1, tap_migrating_0, tap_migrating_1;
  (* keep *) logic       tap_sent_0, tap_sent_1, tap_pass_1;  // of the relay
  (* keep *) logic [2:0] tap_axis_0, tap_axis_1;              // of the sequencer
  (* keep *) logic       tap_last_0, tap_last_1;              // of the steps
  (* keep *) logic [2:0] tap_migrate_0, tap_migrate_1;        // state of the migration
  (* keep *) logic [1:0] tap_axis_halo_0, tap_axis_halo_1, tap_axis_ended_0, tap_axis_ended_1;
  // by face: a record, an end comes
  (* keep *) logic [3:0] tap_halo_0, tap_halo_1, tap_halo_end_0, tap_halo_end_1;
  (* keep *) logic [3:0] tap_arrival_0, tap_arrival_1, tap_arrival_end_0, tap_arrival_end_1;
  (* keep *) logic [3:0] tap_halo_ended_0, tap_halo_ended_1, tap_migrate_ended_0, tap_migrate_ended_1;
  localparam logic [3:0] ExchangeY = 4'd1, Force = 4'd3, Update = 4'd4, MigrateX = 4'd5, MigrateY = 4'd6;
  localparam logic [2:0] Wait = 3'd3, Land = 3'd4;

  // A node that does nothing until something comes.
  function automatic logic waiting(input logic [3:0] state, input logic sent, input logic [2:0] migrate,
                                   input logic [1:0] ended, input logic [1:0] halo_ended, input logic idle_now);
    begin
      waiting = idle_now;
      if (state == 4'd0 || state == 4'd1) waiting = sent && (halo_ended != 2'b11);
      if (state == MigrateX || state == MigrateY) waiting = (migrate == Wait && ended != 2'b11);
    end
  endfunction
  logic [1:0] waits;
  assign waits[0] = waiting(tap_state_0, tap_sent_0, tap_migrate_0, tap_axis_ended_0, tap_axis_halo_0, idle[0]);
  assign waits[1] = waiting(tap_state_1, tap_sent_1, tap_migrate_1, tap_axis_ended_1, tap_axis_halo_1, idle[1]);

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
  (* keep *) logic [3:0]  tap_next_0, tap_next_1;          // by face: the stream that comes next is a migration
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
  // The second node's face is the low one: its stream is over before the pass to the high face, if there is one.
  logic over_1;
  assign over_1 = tap_sent_1 || (Thin == 0 && tap_pass_1 && tap_state_1 == Axis);
  // Streams of this step that a node has sent, and has used up, along the axis.
  function automatic logic [2:0] sent_of(input logic [3:0] state, input logic sent, input logic [2:0] migrate);
    begin
      sent_of = 3'd1;
      if (state == 4'd8 || state == 4'd9 || state < Axis) sent_of = 3'd0;
      if (state == Axis) sent_of = {2'b00, sent};
      if (state == 4'd5 + Axis) sent_of = (migrate == Wait || migrate == Land) ? 3'd2 : 3'd1;
      if (state > 4'd5 + Axis && state < 4'd8) sent_of = 3'd2;
    end
  endfunction
  // It is between a stream's first beat and its end, if it has begun.
  function automatic logic sending(input logic [3:0] state, input logic sent, input logic [2:0] migrate);
    begin
      sending = (state == Axis && !sent) || (state == 4'd5 + Axis && migrate < Wait);
    end
  endfunction
  function automatic logic [2:0] used_of(input logic [3:0] state);
    begin
      used_of = 3'd0;
      if (state >= Update && state <= 4'd5 + Axis) used_of = 3'd1;
      if (state > 4'd5 + Axis && state < 4'd8) used_of = 3'd2;
    end
  endfunction
  logic [2:0] ready_0, ready_1;  // streams told and not yet used up
  assign ready_0 = {2'b00, tap_halo_ended_0[Above]} + {2'b00, tap_migrate_ended_0[Above]};
  assign ready_1 = {2'b00, tap_halo_ended_1[Below]} + {2'b00, tap_migrate_ended_1[Below]};

  always_ff @(posedge clk_i) begin
    if (running_q) begin
      // Halos of the next step never meet those of this one, nor arrivals.
      if (tap_halo_0[Above] || tap_halo_end_0[Above])
        a_halo_0: assert (tap_state_0 != Force && !tap_halo_ended_0[Above]);
      if (tap_halo_1[Below] || tap_halo_end_1[Below])
        a_halo_1: assert (tap_state_1 != Force && !tap_halo_ended_1[Below]);
      if (tap_arrival_0[Above] || tap_arrival_end_0[Above]) a_arrival_0: assert (!tap_migrate_ended_0[Above]);
      if (tap_arrival_1[Below] || tap_arrival_end_1[Below]) a_arrival_1: assert (!tap_migrate_ended_1[Below]);
      a_ready:    assert (all_ready == '1);
      a_step:     assert (ahead_q >= -3'sd1 && ahead_q <= 3'sd1);
      a_deadlock: assert (!(waits == 2'b11 && idle != 2'b11 && valid == 2'b00));
      a_stop:     assert (idle != 2'b11 || valid == 2'b00);
      i_sent_0: assert (sent_0_q == {step_0_q[1:0], 1'b0} + sent_of(tap_state_0, tap_sent_0, tap_migrate_0));
      i_sent_1: assert (sent_1_q == {step_1_q[1:0], 1'b0} + sent_of(tap_state_1, over_1, tap_migrate_1));
      i_told_0: assert (told_0_q + {2'b00, valid[1] && ends[1]} == sent_1_q);
      i_told_1: assert (told_1_q + {2'b00, valid[0] && ends[0]} == sent_0_q);
      i_used_0: assert (told_0_q == {step_0_q[1:0], 1'b0} + used_of(tap_state_0) + ready_0);
      i_used_1: assert (told_1_q == {step_1_q[1:0], 1'b0} + used_of(tap_state_1) + ready_1);
      i_beat_0: assert (!valid[0] || ends[0] || sending(tap_state_0, tap_sent_0, tap_migrate_0));
      i_beat_1: assert (!valid[1] || ends[1] || sending(tap_state_1, over_1, tap_migrate_1));
      i_axis_0: assert (tap_axis_0 == ((tap_state_0 == ExchangeY || tap_state_0 == MigrateY) ? 3'b010 : 3'b001));
      i_axis_1: assert (tap_axis_1 == ((tap_state_1 == ExchangeY || tap_state_1 == MigrateY) ? 3'b010 : 3'b001));
      i_land:   assert ((tap_migrate_0 != Land || tap_axis_ended_0 == 2'b11)
                        && (tap_migrate_1 != Land || tap_axis_ended_1 == 2'b11));
      i_past_0: assert (!(tap_state_0 > Axis && tap_state_0 <= Force) || tap_halo_ended_0[Above]);
      i_past_1: assert (!(tap_state_1 > Axis && tap_state_1 <= Force) || tap_halo_ended_1[Below]);
      i_next_0: assert (tap_next_0[Above] == told_0_q[0]);
      i_next_1: assert (tap_next_1[Below] == told_1_q[0]);
      i_flags_0: assert ((used_of(tap_state_0) == 3'd1) ? (tap_migrate_ended_0[Above] || !tap_halo_ended_0[Above])
                                                        : (tap_halo_ended_0[Above] || !tap_migrate_ended_0[Above]));
      i_flags_1: assert ((used_of(tap_state_1) == 3'd1) ? (tap_migrate_ended_1[Below] || !tap_halo_ended_1[Below])
                                                        : (tap_halo_ended_1[Below] || !tap_migrate_ended_1[Below]));
      i_groups: assert (tap_exchange_0 == (tap_states_0[2:0] != '0) && tap_migrating_0 == (tap_states_0[7:5] != '0)
                        && tap_exchange_1 == (tap_states_1[2:0] != '0) && tap_migrating_1 == (tap_states_1[7:5] != '0));
      i_states: assert (tap_states_0 != '0 && (tap_states_0 & (tap_states_0 - 1'b1)) == '0
                        && tap_states_1 != '0 && (tap_states_1 & (tap_states_1 - 1'b1)) == '0);
      i_state:  assert (tap_state_0 != 4'd2 && tap_state_1 != 4'd2 && tap_state_0 != 4'd7 && tap_state_1 != 4'd7
                        && tap_state_0 <= 4'd9 && tap_state_1 <= 4'd9);
      i_steps:  assert (tap_steps_0 <= Steps && tap_steps_1 <= Steps
                        && tap_steps_0[2:0] + step_0_q == tap_steps_1[2:0] + step_1_q);
      i_run:    assert ((tap_state_0 < 4'd8) == (tap_steps_0 != '0) && (tap_state_1 < 4'd8) == (tap_steps_1 != '0));
      i_sent:   assert ((!tap_sent_0 || tap_state_0 <= 4'd1) && (!tap_sent_1 || tap_state_1 <= 4'd1));
      i_pass:   assert (!tap_pass_1 || (tap_state_1 <= 4'd1 && !tap_sent_1));
      i_last:   assert ((tap_state_0 == '0 || tap_state_0 > 4'd7 || tap_last_0 == (tap_steps_0 == 32'd1))
                        && (tap_state_1 == '0 || tap_state_1 > 4'd7 || tap_last_1 == (tap_steps_1 == 32'd1)));
      i_phase:  assert ((tap_migrate_0 == 3'd0 || tap_state_0 == MigrateX || tap_state_0 == MigrateY)
                        && (tap_migrate_1 == 3'd0 || tap_state_1 == MigrateX || tap_state_1 == MigrateY)
                        && tap_migrate_0 <= Land && tap_migrate_1 <= Land);
      i_ahead:  assert (ahead_q == $signed(step_0_q - step_1_q));
      c_apart:    cover (apart_q);
      c_waits:    cover (waits[0] && tap_state_0 == Axis && tap_state_1 == Force);
    end
  end
endmodule
