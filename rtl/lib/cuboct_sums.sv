// SPDX-License-Identifier: MIT
// The summed kicks of the node's particles, of one pipe. Exact: a sum holds every kick that a node can see. A kick
// accepted in cycle t counts from t+1 on. Taking a sum clears it.
module cuboct_sums #(
  parameter int Axes     = 3,   // 2 or 3
  parameter int KickBits = 18,  // of one axis of a kick
  parameter int SumBits  = 28,  // of one axis of a sum, >= KickBits + clog2(3^Axes * Capacity)
  parameter int Capacity = 16,
  parameter int SlotBits = 4    // of a slot's number, >= clog2(Capacity)
) (
  input  logic                  clk_i,
  input  logic                  rst_ni,
  input  logic                  kick_valid_i,
  input  logic [SlotBits-1:0]   kick_slot_i,
  input  logic [Axes*KickBits-1:0] kick_i,
  input  logic                  take_i,       // never in a cycle with a kick
  input  logic [SlotBits-1:0]   take_slot_i,
  output logic [Axes*SumBits-1:0] sum_o         // of take_slot_i, without latency, in a cycle with take_i
);
  localparam int IndexBits = (Capacity > 1) ? $clog2(Capacity) : 1;

  logic [Capacity-1:0]  held_d, held_q;  // slots whose sum is not zero by default
  logic [SlotBits-1:0]  slot;
  logic [Axes*SumBits-1:0] mem_q [0:Capacity-1];
  logic [Axes*SumBits-1:0] old, added;

  assign slot = take_i ? take_slot_i : kick_slot_i;
  assign old  = held_q[slot[IndexBits-1:0]] ? mem_q[slot[IndexBits-1:0]] : '0;
  for (genvar a = 0; a < Axes; a++) begin : gen_axis
    logic signed [SumBits-1:0] kick;
    cuboct_resize #(.InBits(KickBits), .OutBits(SumBits)) u_kick (
      .a_i($signed(kick_i[a*KickBits +: KickBits])), .y_o(kick)
    );
    assign added[a*SumBits +: SumBits] = old[a*SumBits +: SumBits] + kick;
  end

  always_comb begin
    held_d = held_q;
    if (take_i) held_d[slot[IndexBits-1:0]] = 1'b0;
    else if (kick_valid_i) held_d[slot[IndexBits-1:0]] = 1'b1;
  end
  always_ff @(posedge clk_i) begin
    if (!rst_ni) held_q <= '0;
    else held_q <= held_d;
  end
  always_ff @(posedge clk_i) begin
    if (kick_valid_i) mem_q[slot[IndexBits-1:0]] <= added;
  end
  assign sum_o = old;
endmodule
