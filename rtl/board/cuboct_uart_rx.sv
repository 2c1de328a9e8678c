// SPDX-License-Identifier: MIT
// A serial line in: 8 data bits, least significant first, no parity, one stop bit. The line is sampled every
// clock; a bit is the majority of the three samples about its middle. A byte whose stop bit is low is
// dropped.
module cuboct_uart_rx #(
  parameter int BitClocks16 = 192  // length of a bit in 1/16 clocks, >= 64
) (
  input  logic       clk_i,
  input  logic       rst_ni,
  input  logic       rx_i,     // not synchronous
  output logic       valid_o,  // for one cycle
  output logic [7:0] data_o    // with valid_o
);
  localparam int TimerBits = $clog2(BitClocks16 + 16);
  localparam int Clock     = 16;
  localparam logic [TimerBits-1:0] One  = Clock[TimerBits-1:0];
  localparam int HalfBit = BitClocks16 / 2 - Clock / 2;
  localparam logic [TimerBits-1:0] Half = HalfBit[TimerBits-1:0];
  localparam logic [TimerBits-1:0] Next = BitClocks16[TimerBits-1:0] - One;

  logic [1:0] sync_q;
  logic [1:0] past_q;  // the samples before sync_q[1]
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      sync_q <= 2'b11;
      past_q <= 2'b11;
    end else begin
      sync_q <= {sync_q[0], rx_i};
      past_q <= {past_q[0], sync_q[1]};
    end
  end
  logic level;
  assign level = (sync_q[1] && past_q[0]) || (sync_q[1] && past_q[1]) || (past_q[0] && past_q[1]);

  // The start bit began up to a clock before the cycle t that sees it. A timer of half a bit less half a
  // clock, set in t, runs out in the cycle whose three samples lie about its middle, at most one clock early.
  logic                 busy_d, busy_q, tick;
  logic [TimerBits-1:0] timer_d, timer_q;
  logic [3:0]           count_d, count_q;  // bits taken, the start bit included
  logic [7:0]           data_d, data_q;
  assign tick = busy_q && (timer_q[TimerBits-1:4] == '0);
  always_comb begin
    busy_d  = busy_q;
    timer_d = timer_q - One;
    count_d = count_q;
    data_d  = data_q;
    valid_o = 1'b0;
    if (!busy_q) begin
      timer_d = Half;
      count_d = '0;
      busy_d  = !sync_q[1];
    end else if (tick) begin
      timer_d = timer_q + Next;
      count_d = count_q + 4'd1;
      if (count_q == 4'd0) busy_d = !level;
      else if (count_q == 4'd9) begin
        busy_d  = 1'b0;
        valid_o = level;
      end else data_d = {level, data_q[7:1]};
    end
  end
  always_ff @(posedge clk_i) begin
    if (!rst_ni) busy_q <= 1'b0;
    else busy_q <= busy_d;
  end
  always_ff @(posedge clk_i) begin
    timer_q <= timer_d;
    count_q <= count_d;
    data_q  <= data_d;
  end
  assign data_o = data_q;
endmodule
