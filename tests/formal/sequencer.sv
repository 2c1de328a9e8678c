// SPDX-License-Identifier: MIT
// cuboct_sequencer with units that end their phases when they like: phases come in order, as many steps as
// asked for, each phase starts in the cycle after the one before it ended, and one unit is told to work at a
// time; the force engine beside the exchange if it overlaps.
module sequencer_formal #(
  parameter int Axes    = 3,
  parameter int Overlap = 1,
  parameter int Steps   = 3    // at most
) (
  input logic        clk_i,
  input logic        start_i,
  input logic [31:0] steps_i,
  input logic        exchange_i,  // the unit ends its phase
  input logic        force_i,
  input logic        update_i,
  input logic        migrate_i,
  input logic        dump_i
);
  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;
  always_comb assume (steps_i <= Steps);

  logic            idle, exchange, update, migrate, dump, engine, step_end;
  logic [1:0]      axis;
  logic [Axes-1:0] past, onehot;
  logic [7:0]      starts, ends;
  cuboct_sequencer #(.Axes(Axes), .Overlap(Overlap)) u_dut (
    .clk_i, .rst_ni(running_q), .start_i, .steps_i, .exchange_done_i(exchange_i), .force_done_i(force_i),
    .update_done_i(update_i), .migrate_done_i(migrate_i), .dump_done_i(dump_i), .idle_o(idle),
        .exchange_o(exchange),
    .update_o(update), .migrate_o(migrate), .dump_o(dump), .axis_o(axis), .onehot_o(onehot), .engine_o(engine),
        .past_exchange_o(past),
    .step_end_o(step_end), .phase_start_o(starts), .phase_end_o(ends)
  );

  // The phase that the machine must be in: 0 to Axes-1 exchange, then force, update, migrate; then dump,
  // idle.
  localparam logic [3:0] Force = Axes, Update = Axes + 1, Migrate = Axes + 2, Dump = 2 * Axes + 2,
      Idle = 2 * Axes + 3;
  logic [3:0]  phase_q, phase_d;
  logic [31:0] left_q;   // steps still to end
  logic        first_q, in_exchange, in_migrate;
  always_comb begin
    phase_d     = phase_q;
    in_exchange = (phase_q < Force);
    in_migrate  = (phase_q >= Migrate && phase_q < Dump);
    if (phase_q == Idle) phase_d = !start_i ? Idle : (steps_i == '0) ? Dump : 4'd0;
    else if (phase_q == Dump) phase_d = dump_i ? Idle : Dump;
    else if ((in_exchange && exchange_i) || (phase_q == Force && force_i) || (phase_q == Update && update_i)
             || (in_migrate && migrate_i)) begin
      phase_d = phase_q + 4'd1;
      if (phase_d == Dump && left_q != 32'd1) phase_d = 4'd0;
    end
  end
  always_ff @(posedge clk_i) begin
    if (!running_q) begin
      phase_q <= Idle;
      first_q <= 1'b0;
      left_q  <= '0;
    end else begin
      phase_q <= phase_d;
      first_q <= (phase_d != phase_q);
      if (phase_q == Idle && start_i) left_q <= steps_i;
      else if (phase_q == Dump - 4'd1 && migrate_i) left_q <= left_q - 1'b1;
    end
  end

  // Events are numbered as if there always were three axes.
  logic [7:0] here, starting, ending;
  logic [3:0] migrate_axis;
  always_comb begin
    here         = '0;
    migrate_axis = phase_q - Migrate;
    if (in_exchange) here[phase_q[1:0]] = 1'b1;
    if (phase_q == Force) here[3] = 1'b1;
    if (phase_q == Update) here[4] = 1'b1;
    if (in_migrate) here[3'd5 + migrate_axis[2:0]] = 1'b1;
    starting = first_q ? here : '0;
    if (Overlap != 0) starting[3] = starting[0];
    ending = (phase_d != phase_q) ? here : '0;
  end
  logic [1:0] axis_due;
  assign axis_due = in_exchange ? phase_q[1:0] : in_migrate ? migrate_axis[1:0] : 2'd0;
  integer a;
  logic   past_right;
  always_comb begin
    past_right = 1'b1;
    for (a = 0; a < Axes; a = a + 1) begin
      if (past[a] != (phase_q > a && phase_q <= Force)) past_right = 1'b0;
    end
  end

  always_ff @(posedge clk_i) begin
    if (running_q) begin
      a_where:  assert ({idle, exchange, update, migrate, dump} == {phase_q == Idle, in_exchange,
          phase_q == Update, in_migrate, phase_q == Dump});
      a_axis:   assert (axis == axis_due);
      a_onehot: assert (onehot == ({{(Axes - 1) {1'b0}}, 1'b1} << axis_due));
      a_engine: assert (engine == (phase_q == Force || (Overlap != 0 && in_exchange)));
      if (engine) a_past: assert (past_right);
      a_start:  assert (starts == starting);
      a_end:    assert (ends == ending);
      a_step:   assert (step_end == (phase_q == Dump - 4'd1 && migrate_i));
      c_last:   cover (idle && first_q && left_q == '0 && more_q);
      c_short:  cover (dump && left_q == '0 && !more_q);
    end
  end
  logic more_q;  // two steps were done
  always_ff @(posedge clk_i) more_q <= running_q && (more_q || (step_end && left_q == 32'd2));
endmodule
