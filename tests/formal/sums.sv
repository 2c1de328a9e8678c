// SPDX-License-Identifier: MIT
// cuboct_sums: of a watched slot, any, the answer in the cycle after a question is minus the sum of all that was pushed
// since the reset or since it was taken last, whatever happens to the others; kicks of one slot may follow one another
// in consecutive cycles, and a take may follow a kick, but where the sums lie in a memory (Spaced).
`include "torn_ram.svh"
module sums_formal #(
  parameter int Axes     = 2,
  parameter int KickBits = 2,
  parameter int SumBits  = 3,
  parameter int Capacity = 3,
  parameter int Spaced   = 0
) (
  input logic                     clk_i,
  input logic                     kick_i, take_i,
  input logic [Axes*KickBits-1:0] push_i,
  input logic [3:0]               slot_i
);
  localparam int SlotBits = (Capacity > 1) ? $clog2(Capacity) : 1;

  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;
  (* anyconst *) logic [SlotBits-1:0] watched;
  logic [SlotBits-1:0]     asked_q;
  logic                    after_kick_q;
  logic [Axes*SumBits-1:0] sum;
  always_comb begin
    assume (watched < Capacity && slot_i < Capacity);
    assume (!(kick_i && take_i) && (running_q || (!kick_i && !take_i)));
    assume (Spaced == 0 || !after_kick_q || (!kick_i && !take_i));
  end
  always_ff @(posedge clk_i) begin
    asked_q      <= slot_i[SlotBits-1:0];
    after_kick_q <= running_q && kick_i;
  end
  cuboct_sums #(
    .Axes(Axes), .KickBits(KickBits), .SumBits(SumBits), .Capacity(Capacity), .Spaced(Spaced), .SlotBits(SlotBits)
  ) u_dut (
    .clk_i, .rst_ni(running_q), .kick_valid_i(kick_i), .push_i, .next_slot_i(slot_i[SlotBits-1:0]), .take_i,
    .sum_o(sum)
  );

  logic [Axes*SumBits-1:0] value_q;
  logic                    here, kicked_q;
  integer                  a;
  assign here = running_q && asked_q == watched;
  always_ff @(posedge clk_i) begin
    if (!running_q || (here && take_i)) begin
      value_q <= '0;
    end else if (here && kick_i) begin
      for (a = 0; a < Axes; a = a + 1) begin
        value_q[a*SumBits +: SumBits] <= value_q[a*SumBits +: SumBits]
            - {{(SumBits - KickBits) {push_i[(a+1)*KickBits-1]}}, push_i[a*KickBits +: KickBits]};
      end
    end
    kicked_q <= here && kick_i;
  end
  always_ff @(posedge clk_i) begin
    if (running_q) begin
      if (here && (Spaced == 0 || !after_kick_q)) a_sum: assert (sum == value_q);
      c_twice: cover (here && kick_i && value_q != '0 && (Spaced != 0 || kicked_q));
      c_taken: cover (here && take_i && value_q != '0 && watched == Capacity - 1);
    end
  end
endmodule
