// SPDX-License-Identifier: MIT
// cuboct_tick through any number of UPDATE and DUMP phases, with any counts and any pauses of UPDATE: a phase takes the
// slots 0, 1, ... each once and no other, UPDATE ends Tail steps after the last, DUMP with the last, both at once where
// there is none; at rest the walk is at slot 0.
module tick_formal #(
  parameter int Tail     = 2,
  parameter int Capacity = 3
) (
  input logic clk_i,
  input logic update_i,  // which phase begins, if one does
  input logic dump_i,
  input logic step_i,
  input logic [$clog2(Capacity+1)-1:0] count_i
);
  localparam int CountBits = $clog2(Capacity + 1);
  localparam int TickBits  = $clog2(Capacity + Tail + 2);
  localparam int WideBits  = CountBits + TickBits;

  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;

  // A phase follows another at once or after a rest, with another count.
  logic                 update_q, dump_q, update_done, dump_done, free;
  logic [CountBits-1:0] count_q;
  assign free = (!update_q && !dump_q) || update_done || dump_done;
  always_ff @(posedge clk_i) begin
    if (!running_q) {update_q, dump_q} <= 2'b00;
    else if (free) {update_q, dump_q} <= {update_i && !dump_i, dump_i};
    if (free) count_q <= count_i;
  end
  always_comb assume (count_q <= Capacity[CountBits-1:0]);

  logic [TickBits-1:0] tick, next, next_q;
  logic                more;
  cuboct_tick #(.Tail(Tail), .CountBits(CountBits), .TickBits(TickBits)) u_dut (
    .clk_i, .rst_ni(running_q), .update_i(update_q), .dump_i(dump_q), .step_i, .count_i(count_q), .tick_o(tick),
    .next_o(next), .more_o(more), .update_done_o(update_done), .dump_done_o(dump_done)
  );

  // Steps of the phase so far.
  logic [WideBits-1:0] steps_q, count, last;
  assign count = {{TickBits{1'b0}}, count_q};
  assign last  = dump_q ? count - 1'b1 : count + Tail[WideBits-1:0];
  logic over, over_q, asked_q;  // over_q: an UPDATE with particles
  assign over = (count_q == '0) || (steps_q == last);
  always_ff @(posedge clk_i) begin
    if (!running_q || free) steps_q <= '0;
    else if (dump_q || step_i) steps_q <= steps_q + 1'b1;
    next_q  <= next;
    asked_q <= running_q;
    over_q  <= running_q && update_done && count_q != '0;
  end

  always_ff @(posedge clk_i) begin
    if (running_q) begin
      a_slot:   assert ({{CountBits{1'b0}}, tick} == steps_q);
      a_rest:   assert (update_q || dump_q || tick == '0);
      a_more:   assert (!update_q || more == (steps_q < count));
      a_update: assert (update_done == (update_q && over));
      a_dump:   assert (dump_done == (dump_q && over));
      a_next:   assert (!asked_q || !(update_q || dump_q) || count_q == '0 || steps_q == '0 || tick == next_q);
      a_over:   assert (!over_q || next_q == '0);
      c_update: cover (update_done && count_q == Capacity[CountBits-1:0] && update_i);
      c_dump:   cover (dump_done && count_q == Capacity[CountBits-1:0]);
      c_none:   cover (update_done && count_q == '0);
      c_pause:  cover (update_q && !step_i && steps_q == count);
    end
  end
endmodule
