// SPDX-License-Identifier: MIT
// The summed kicks of the node's particles, of one pipe. Exact: a sum holds every kick that a node can see. A kick
// accepted in cycle t counts from t+1 on. Taking a sum clears it. Where kicks never come in two cycles after one
// another (Spaced) the sums lie in a memory whose word is asked for a cycle ahead.
module cuboct_sums #(
  parameter int Axes     = 3,   // components of a kick, >= 1
  parameter int KickBits = 18,  // of one axis of a kick
  parameter int SumBits  = 28,  // of one component of a sum, that hold every partial sum
  parameter int Capacity = 16,
  parameter int Spaced   = 0,   // 0, 1
  parameter int Adds     = 0,   // 0, 1
  parameter int SlotBits = 4    // of a slot's number, >= clog2(Capacity)
) (
  input  logic                  clk_i,
  input  logic                  rst_ni,
  input  logic                  kick_valid_i, // a kick is added to the sum of slot next_slot_i of the cycle before
  input  logic [Axes*KickBits-1:0] push_i,     // minus the kick; with Adds the kick
  input  logic [SlotBits-1:0]   next_slot_i,  // the slot that the next cycle's kick or take is about
  input  logic                  take_i,       // clears that sum; never with a kick
  output logic [Axes*SumBits-1:0] sum_o         // of the cycle before's slot; if Spaced, not in the cycle after a kick
);
  localparam int IndexBits = (Capacity > 1) ? $clog2(Capacity) : 1;

  logic [Capacity-1:0]  held_d, held_q;  // slots whose sum is not zero by default
  logic [SlotBits-1:0]  slot_q;
  logic                 counts_q;          // held_q of slot_q
  logic [Axes*SumBits-1:0] word, old, added;

  always_ff @(posedge clk_i) slot_q <= next_slot_i;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) counts_q <= 1'b0;
    else counts_q <= held_d[next_slot_i[IndexBits-1:0]];
  end
  assign old = counts_q ? word : '0;
  for (genvar a = 0; a < Axes; a++) begin : gen_axis
    logic signed [KickBits-1:0] term;
    logic signed [SumBits-1:0]  push;
    assign term = push_i[a*KickBits +: KickBits];
    cuboct_resize #(.InBits(KickBits), .OutBits(SumBits)) u_push (
      .a_i(term), .y_o(push)
    );
    if (Adds != 0) begin : gen_add
      assign added[a*SumBits +: SumBits] = old[a*SumBits +: SumBits] + push;
    end else begin : gen_subtract
      assign added[a*SumBits +: SumBits] = old[a*SumBits +: SumBits] - push;
    end
  end

  // Each slot by itself: a kick and a take never come in one cycle.
  for (genvar h = 0; h < Capacity; h++) begin : gen_held
    localparam int Slot = h;
    assign held_d[h] = (held_q[h] || (kick_valid_i && slot_q == Slot[SlotBits-1:0]))
                    && !(take_i && slot_q == Slot[SlotBits-1:0]);
  end
  always_ff @(posedge clk_i) begin
    if (!rst_ni) held_q <= '0;
    else held_q <= held_d;
  end
  if (Spaced != 0) begin : gen_memory
    cuboct_ram #(.Bits(Axes * SumBits), .Depth(Capacity), .AddrBits(SlotBits)) u_words (
      .clk_i, .write_i(kick_valid_i), .write_addr_i(slot_q), .write_data_i(added), .read_i(1'b1), .clear_i(1'b0),
      .read_addr_i(next_slot_i), .read_data_o(word)
    );
  end else begin : gen_registers
    logic [Axes*SumBits-1:0] mem_q [0:Capacity-1];
    assign word = mem_q[slot_q[IndexBits-1:0]];
    always_ff @(posedge clk_i) begin
      if (kick_valid_i) mem_q[slot_q[IndexBits-1:0]] <= added;
    end
  end
  assign sum_o = old;
endmodule
