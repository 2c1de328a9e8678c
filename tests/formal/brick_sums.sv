// SPDX-License-Identifier: MIT
// cuboct_brick_sums: of a watched slot, any, that was set to zero once, the answer in the cycle after a question is
// minus the sum of all that was pushed since then, whatever else is written; kicks of one slot may follow one another
// in consecutive cycles. Nothing is said of the answer to who asks in the cycle in which the slot is set to zero.
`include "torn_ram.svh"
module brick_sums_formal #(
  parameter int Axes     = 2,
  parameter int KickBits = 2,
  parameter int SumBits  = 3,
  parameter int Depth    = 3,
  parameter int AddrBits = 2
) (
  input logic                     clk_i,
  input logic                     kick_i, zero_i, busy_i,
  input logic [Axes*KickBits-1:0] push_i,
  input logic [AddrBits-1:0]      zero_addr_i, kick_addr_i, look_addr_i
);
  (* anyconst *) logic [AddrBits-1:0] watched;
  logic [AddrBits-1:0]     next_addr, asked_q;
  assign next_addr = busy_i ? kick_addr_i : look_addr_i;
  logic                    torn_q = 1'b1;
  logic [Axes*SumBits-1:0] sum;
  always_comb begin
    assume (watched < Depth);
    assume (kick_addr_i < Depth && look_addr_i < Depth && zero_addr_i < Depth);
    if (kick_i) assume (busy_i && !zero_i && !torn_q);  // the sum was asked for in the cycle before
  end
  always_ff @(posedge clk_i) begin
    asked_q <= next_addr;
    torn_q  <= zero_i && zero_addr_i == next_addr;
  end
  cuboct_brick_sums #(
    .Axes(Axes), .KickBits(KickBits), .SumBits(SumBits), .Depth(Depth), .AddrBits(AddrBits)
  ) u_dut (
    .clk_i, .kick_valid_i(kick_i), .push_i, .zero_i, .zero_addr_i, .busy_i, .kick_addr_i, .look_addr_i,
    .sum_o(sum)
  );

  logic                    known_q = 1'b0, twice_q;
  logic [Axes*SumBits-1:0] value_q;
  logic                    kicked;
  integer                  a;
  assign kicked = kick_i && asked_q == watched;
  always_ff @(posedge clk_i) begin
    if (zero_i && zero_addr_i == watched) begin
      known_q <= 1'b1;
      value_q <= '0;
    end else if (kicked) begin
      for (a = 0; a < Axes; a = a + 1) begin
        value_q[a*SumBits +: SumBits] <= value_q[a*SumBits +: SumBits]
            - {{(SumBits - KickBits) {push_i[(a+1)*KickBits-1]}}, push_i[a*KickBits +: KickBits]};
      end
    end
    twice_q <= kicked;
  end
  always_ff @(posedge clk_i) begin
    if (known_q) begin
      if (asked_q == watched && !torn_q) a_sum: assert (sum == value_q);
      c_twice: cover (twice_q && kicked && value_q != '0 && push_i[KickBits-1:0] != '0);
      c_zero:  cover (asked_q == watched && !torn_q && value_q == '0 && twice_q);
      c_far:   cover (watched == Depth - 1 && asked_q == watched && !kicked && value_q == '1);
    end
  end
endmodule
