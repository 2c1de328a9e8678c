// SPDX-License-Identifier: MIT
// The walk of UPDATE and DUMP over the own slots. UPDATE takes one after the other and ends Tail steps after the last,
// DUMP ends with the last; without particles both end at once. The ends are known a cycle ahead: what asks the slots'
// memory waits for them.
module cuboct_tick #(
  parameter int Tail      = 2,  // steps of UPDATE beyond the last particle, >= 0
  parameter int Registered = 0, // 0, 1: count_i stays from the cycle before a phase on, and step_i is 1
  parameter int CountBits = 5,  // of the number of own particles
  parameter int TickBits  = 5   // of a step's number, that hold Capacity + Tail
) (
  input  logic                 clk_i,
  input  logic                 rst_ni,
  input  logic                 update_i,       // the machine is in UPDATE
  input  logic                 dump_i,         // in DUMP
  input  logic                 step_i,         // with update_i: the next step follows; DUMP steps in every cycle
  input  logic [CountBits-1:0] count_i,        // own particles; stays in both phases
  output logic [TickBits-1:0]  tick_o,         // the slot of this step, 0 at rest
  // In a phase with particles; after the last cycle of UPDATE, too.
  output logic [TickBits-1:0]  next_o,         // tick_o of the next cycle
  output logic                 more_o,         // tick_o < count_i, in UPDATE
  output logic                 update_done_o,  // last cycle of UPDATE
  output logic                 dump_done_o     // last cycle of DUMP
);
  localparam int WideBits = CountBits + TickBits;
  localparam logic [WideBits-1:0] WideOne = 1;
  localparam logic [TickBits-1:0] One = 1;

  logic [TickBits-1:0] tick_d, tick_q, next_d, next_q;  // next_q: tick_q and 1
  logic                last_d, last_q;  // tick_q + 1 == count_i > 1
  logic [Tail:0]       past_d, past_q;  // bit k: tick_q >= count_i + k
  logic                none, few, moves, done;
  logic [WideBits-1:0] after_next, count;

  // few: the first slot is the last.
  if (Registered != 0) begin : gen_registered
    logic none_q, few_q;
    always_ff @(posedge clk_i) begin
      none_q <= (count_i == '0);
      few_q  <= ((count_i >> 1) == '0);
    end
    assign none = none_q;
    assign few  = few_q;
    // Nothing pauses, and at rest the slot is 0.
    assign next_o = (past_q[Tail] || !(dump_i || update_i)) ? '0 : next_q;
  end else begin : gen_at_once
    assign none = (count_i == '0);
    assign few  = ((count_i >> 1) == '0);
    assign next_o = past_q[Tail] ? '0 : moves ? next_q : tick_q;  // from registers
  end
  assign moves      = dump_i || (update_i && step_i);
  assign done       = update_done_o || dump_done_o;
  assign after_next = {{CountBits{1'b0}}, next_q} + WideOne;
  assign count      = {{TickBits{1'b0}}, count_i};
  always_comb begin
    tick_d = tick_q;
    next_d = next_q;
    last_d = last_q;
    past_d = past_q;
    if (moves) begin
      tick_d    = next_q;
      next_d    = next_q + 1'b1;
      last_d    = (after_next == count);
      past_d    = past_q << 1;
      past_d[0] = past_q[0] || last_q || few;
    end
    if (done) begin
      tick_d = '0;
      next_d = One;
      last_d = 1'b0;
      past_d = '0;
    end
  end
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      tick_q <= '0;
      next_q <= One;
      last_q <= 1'b0;
      past_q <= '0;
    end else begin
      tick_q <= tick_d;
      next_q <= next_d;
      last_q <= last_d;
      past_q <= past_d;
    end
  end

  assign tick_o        = tick_q;
  assign more_o        = !none && !past_q[0];
  assign update_done_o = update_i && (none || past_q[Tail]);
  assign dump_done_o   = dump_i && (few || last_q);
endmodule
