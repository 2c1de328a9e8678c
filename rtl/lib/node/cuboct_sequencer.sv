// SPDX-License-Identifier: MIT
// The main state machine: steps, phases and their events. A phase's unit says when its last cycle is.
module cuboct_sequencer #(
  parameter int Axes    = 3,  // 2 or 3; with 2 the machine has neither EXCHANGE_Z nor MIGRATE_Z
  parameter int Overlap = 1, // 1: the force engine starts with the exchange, 0: with FORCE
  parameter int Rounds  = 1, // of the rule, >= 1: each exchanges, meets and updates; MIGRATE follows the last one
  localparam int RoundPhases = 5 * Rounds,  // before the migrations
  localparam int Phases      = RoundPhases + 3
) (
  input  logic        clk_i,
  input  logic        rst_ni,
  input  logic        start_i,          // in IDLE: begins a run
  input  logic [31:0] steps_i,          // with start_i; 0 goes to DUMP
  // Last cycles.
  input  logic        exchange_done_i,  // of the present exchange phase
  input  logic        force_done_i,     // of the force engine's phase
  input  logic        update_done_i,    // of UPDATE
  input  logic        migrate_done_i,   // of the present migration phase
  input  logic        dump_done_i,      // of DUMP
  // Where the machine is.
  output logic        idle_o,
  output logic [Rounds-1:0] round_o,    // of these phases, one bit each; in others the first or any
  output logic        exchange_o,       // in an exchange phase
  output logic        update_o,         // in UPDATE
  output logic        migrate_o,        // in a migration phase
  output logic        dump_o,           // in DUMP
  output logic [1:0]  axis_o,           // of exchange or migration, else 0
  output logic [Axes-1:0] onehot_o,     // axis_o, one bit each
  output logic [Axes-1:0] onehot_next_o,  // onehot_o of the next cycle
  output logic        engine_o,         // the force engine runs
  output logic [Axes-1:0] past_exchange_o,  // EXCHANGE_X, _Y, _Z of this round is over; only while the engine runs
  output logic [Axes-1:0] past_next_o,  // past_exchange_o of the next cycle, if the engine runs on
  output logic        step_end_o,       // last cycle of the last migration phase
  output logic [Phases-1:0] phase_start_o,  // first cycle of exchange x y z, force, update by round, of migrate x y z
  output logic [Phases-1:0] phase_end_o
);
  // One bit each: what depends on the machine's state depends on a register, and the way from a phase's last cycle to
  // the next state is two choices long.
  localparam int ExchangeX = 0;
  localparam int ExchangeY = 1;
  localparam int ExchangeZ = 2;
  localparam int Force     = 3;
  localparam int Update    = 4;
  localparam int MigrateX  = 5;
  localparam int MigrateY  = 6;
  localparam int MigrateZ  = 7;
  localparam int Dump      = 8;
  localparam int Idle      = 9;
  localparam int LastExchange = (Axes == 3) ? ExchangeZ : ExchangeY;
  localparam int LastMigrate  = (Axes == 3) ? MigrateZ : MigrateY;

  logic [Idle:0] state_d, state_q, enter, leave;  // leave: of the states that the machine is not in, anything
  logic          first_d, first_q;  // first cycle of a state
  logic          exchange_d, exchange_q, migrate_d, migrate_q;  // any of their states
  logic          y_d, z_d;
  logic [2:0]    axis_d, axis_q;  // as onehot_o
  logic [31:0]   steps_d, steps_q;  // still to do, this one included
  logic          last_step_q;       // the step is the last one: known a cycle after the step's first
  logic          start, none;
  logic          last_round, again;  // again: another round begins

  if (Rounds > 1) begin : gen_rounds
    logic [Rounds-1:0] round_d, round_q;
    assign round_d = again ? round_q << 1 : state_q[Idle] || step_end_o ? {{(Rounds - 1) {1'b0}}, 1'b1} : round_q;
    always_ff @(posedge clk_i) begin
      if (!rst_ni) round_q <= {{(Rounds - 1) {1'b0}}, 1'b1};
      else round_q <= round_d;
    end
    assign round_o = round_q;
  end else begin : gen_one_round
    assign round_o = 1'b1;
  end
  assign last_round = round_o[Rounds-1];
  assign again      = state_q[Update] && update_done_i && !last_round;
  assign start     = state_q[Idle] && start_i;
  assign none      = (steps_i == 32'd0);
  assign enter[ExchangeX] = (start && !none) || (step_end_o && !last_step_q) || again;
  assign enter[ExchangeY] = state_q[ExchangeX] && exchange_done_i;
  assign enter[ExchangeZ] = (Axes == 3) && state_q[ExchangeY] && exchange_done_i;
  assign enter[Force]     = state_q[LastExchange] && exchange_done_i;
  assign enter[Update]    = state_q[Force] && force_done_i;
  assign enter[MigrateX]  = state_q[Update] && update_done_i && last_round;
  assign enter[MigrateY]  = state_q[MigrateX] && migrate_done_i;
  assign enter[MigrateZ]  = (Axes == 3) && state_q[MigrateY] && migrate_done_i;
  assign enter[Dump]      = (start && none) || (step_end_o && last_step_q);
  assign enter[Idle]      = state_q[Dump] && dump_done_i;
  assign leave            = {start, dump_done_i, {3{migrate_done_i}}, update_done_i, force_done_i,
                             {3{exchange_done_i}}};
  assign first_d          = (enter != '0);
  assign state_d          = enter | (state_q & ~leave);
  assign z_d              = enter[ExchangeZ] || enter[MigrateZ] || (axis_q[2] && !enter[Force] && !step_end_o);
  assign y_d              = enter[ExchangeY] || enter[MigrateY] || (axis_q[1] && !z_d && !enter[Force] && !step_end_o);
  assign axis_d           = {z_d, y_d, !z_d && !y_d};
  assign exchange_d       = enter[ExchangeX] || (exchange_q && !enter[Force]);
  assign migrate_d        = enter[MigrateX] || (migrate_q && !step_end_o);
  assign steps_d          = start ? steps_i : step_end_o ? steps_q - 32'd1 : steps_q;

  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      state_q    <= {1'b1, {Idle {1'b0}}};
      first_q    <= 1'b0;
      steps_q    <= '0;
      exchange_q <= 1'b0;
      migrate_q  <= 1'b0;
      axis_q     <= 3'b001;
    end else begin
      state_q    <= state_d;
      first_q    <= first_d;
      steps_q    <= steps_d;
      exchange_q <= exchange_d;
      migrate_q  <= migrate_d;
      axis_q     <= axis_d;
    end
  end

  always_ff @(posedge clk_i) last_step_q <= (steps_q == 32'd1);

  logic in_force, engine_first;
  assign in_force     = state_q[Force];
  assign engine_first = first_q && ((Overlap != 0) ? state_q[ExchangeX] : in_force);

  assign idle_o          = state_q[Idle];
  assign exchange_o      = exchange_q;
  assign update_o        = state_q[Update];
  assign migrate_o       = migrate_q;
  assign dump_o          = state_q[Dump];
  assign engine_o        = in_force || ((Overlap != 0) && exchange_o);
  assign past_exchange_o[0]      = in_force || state_q[ExchangeZ] || state_q[ExchangeY];
  assign past_exchange_o[Axes-1] = in_force;
  if (Axes == 3) begin : gen_middle
    assign past_exchange_o[1] = in_force || state_q[ExchangeZ];
  end
  assign past_next_o[0]      = past_exchange_o[0] || (state_q[ExchangeX] && exchange_done_i);
  assign past_next_o[Axes-1] = past_exchange_o[Axes-1] || (state_q[LastExchange] && exchange_done_i);
  if (Axes == 3) begin : gen_middle_next
    assign past_next_o[1] = past_exchange_o[1] || (state_q[ExchangeY] && exchange_done_i);
  end
  assign step_end_o = state_q[LastMigrate] && migrate_done_i;
  assign axis_o     = axis_q[2:1];
  assign onehot_o   = axis_q[Axes-1:0];
  assign onehot_next_o = axis_d[Axes-1:0];

  logic [4:0] begins, ends;  // of a round's phases
  assign begins = {first_q && update_o, engine_first, first_q && state_q[ExchangeZ], first_q && state_q[ExchangeY],
                   first_q && state_q[ExchangeX]};
  assign ends   = {update_o && update_done_i, in_force && force_done_i, state_q[ExchangeZ] && exchange_done_i,
                   state_q[ExchangeY] && exchange_done_i, state_q[ExchangeX] && exchange_done_i};
  for (genvar r = 0; r < Rounds; r++) begin : gen_round_phases
    assign phase_start_o[5*r +: 5] = begins & {5{round_o[r]}};
    assign phase_end_o[5*r +: 5]   = ends & {5{round_o[r]}};
  end
  assign phase_start_o[RoundPhases +: 3] = {first_q && state_q[MigrateZ], first_q && state_q[MigrateY],
                                            first_q && state_q[MigrateX]};
  assign phase_end_o[RoundPhases +: 3]   = {state_q[MigrateZ] && migrate_done_i, state_q[MigrateY] && migrate_done_i,
                                            state_q[MigrateX] && migrate_done_i};

  // The state's number, for proofs.
  logic [3:0] unused_number;
  assign unused_number = {state_q[Dump] || state_q[Idle],
                          state_q[Update] || state_q[MigrateX] || state_q[MigrateY] || state_q[MigrateZ],
                          state_q[ExchangeZ] || state_q[Force] || state_q[MigrateY] || state_q[MigrateZ],
                          state_q[ExchangeY] || state_q[Force] || state_q[MigrateX] || state_q[MigrateZ]
                          || state_q[Idle]};
endmodule
