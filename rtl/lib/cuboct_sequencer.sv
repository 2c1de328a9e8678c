// SPDX-License-Identifier: MIT
// The main state machine: steps, phases and their events. A phase's unit says when its last cycle is.
module cuboct_sequencer #(
  parameter int Axes    = 3,  // 2 or 3; with 2 the machine has neither EXCHANGE_Z nor MIGRATE_Z
  parameter int Overlap = 1  // 1: the force engine starts with the exchange, 0: with FORCE
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
  output logic        exchange_o,       // in an exchange phase
  output logic        update_o,         // in UPDATE
  output logic        migrate_o,        // in a migration phase
  output logic        dump_o,           // in DUMP
  output logic [1:0]  axis_o,           // of exchange or migration
  output logic        engine_o,         // the force engine runs
  output logic [Axes-1:0] past_exchange_o,  // EXCHANGE_X, _Y, _Z of this step is over; only while the engine runs
  output logic        step_end_o,       // last cycle of the last migration phase
  output logic [7:0]  phase_start_o,    // first cycle of exchange x y z, force, update, migrate x y z
  output logic [7:0]  phase_end_o
);
  typedef enum logic [3:0] {
    ExchangeX, ExchangeY, ExchangeZ, Force, Update, MigrateX, MigrateY, MigrateZ, Dump, Idle
  } state_t;

  state_t      state_d, state_q;
  logic        first_d, first_q;  // first cycle of a state
  logic [31:0] steps_d, steps_q;  // still to do, this one included

  always_comb begin
    state_d = state_q;
    steps_d = steps_q;
    unique case (state_q)
      ExchangeX: if (exchange_done_i) state_d = ExchangeY;
      ExchangeY: if (exchange_done_i) state_d = (Axes == 3) ? ExchangeZ : Force;
      ExchangeZ: if (exchange_done_i) state_d = Force;
      Force:     if (force_done_i) state_d = Update;
      Update:    if (update_done_i) state_d = MigrateX;
      MigrateX:  if (migrate_done_i) state_d = MigrateY;
      MigrateY:  if (migrate_done_i) state_d = MigrateZ;
      MigrateZ:  state_d = MigrateZ;
      Dump:      if (dump_done_i) state_d = Idle;
      default: begin
        if (start_i) begin
          steps_d = steps_i;
          state_d = ExchangeX;
          if (steps_i == 32'd0) state_d = Dump;
        end
      end
    endcase
    if (step_end_o) begin
      steps_d = steps_q - 32'd1;
      state_d = ExchangeX;
      if (steps_q == 32'd1) state_d = Dump;
    end
  end
  assign first_d = (state_d != state_q);

  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      state_q <= Idle;
      first_q <= 1'b0;
      steps_q <= '0;
    end else begin
      state_q <= state_d;
      first_q <= first_d;
      steps_q <= steps_d;
    end
  end

  logic in_force, engine_first;
  assign in_force     = (state_q == Force);
  assign engine_first = first_q && ((Overlap != 0) ? (state_q == ExchangeX) : in_force);

  assign idle_o          = (state_q == Idle);
  assign exchange_o      = (state_q == ExchangeX) || (state_q == ExchangeY) || (state_q == ExchangeZ);
  assign update_o        = (state_q == Update);
  assign migrate_o       = (state_q == MigrateX) || (state_q == MigrateY) || (state_q == MigrateZ);
  assign dump_o          = (state_q == Dump);
  assign engine_o        = in_force || ((Overlap != 0) && exchange_o);
  assign past_exchange_o[0]      = in_force || (state_q == ExchangeZ) || (state_q == ExchangeY);
  assign past_exchange_o[Axes-1] = in_force;
  if (Axes == 3) begin : gen_middle
    assign past_exchange_o[1] = in_force || (state_q == ExchangeZ);
  end
  assign step_end_o = (state_q == ((Axes == 3) ? MigrateZ : MigrateY)) && migrate_done_i;
  always_comb begin
    axis_o = 2'd0;
    unique case (state_q)
      ExchangeY, MigrateY: axis_o = 2'd1;
      ExchangeZ, MigrateZ: axis_o = 2'd2;
      default:             axis_o = 2'd0;
    endcase
  end

  assign phase_start_o = {first_q && (state_q == MigrateZ), first_q && (state_q == MigrateY),
                          first_q && (state_q == MigrateX), first_q && update_o, engine_first,
                          first_q && (state_q == ExchangeZ), first_q && (state_q == ExchangeY),
                          first_q && (state_q == ExchangeX)};
  assign phase_end_o   = {(state_q == MigrateZ) && migrate_done_i, (state_q == MigrateY) && migrate_done_i,
                          (state_q == MigrateX) && migrate_done_i, update_o && update_done_i,
                          in_force && force_done_i, (state_q == ExchangeZ) && exchange_done_i,
                          (state_q == ExchangeY) && exchange_done_i, (state_q == ExchangeX) && exchange_done_i};
endmodule
