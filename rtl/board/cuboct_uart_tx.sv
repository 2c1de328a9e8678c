// SPDX-License-Identifier: MIT
// A serial line out: as cuboct_uart_rx hears it.
module cuboct_uart_tx #(
  parameter int BitClocks16 = 192  // length of a bit in 1/16 clocks, >= 64
) (
  input  logic       clk_i,
  input  logic       rst_ni,
  input  logic       valid_i,  // a byte
  input  logic [7:0] data_i,   // with valid_i
  output logic       ready_o,  // a byte is taken in a cycle with valid_i and ready_o
  output logic       tx_o      // the line, high at rest
);
  localparam int TimerBits = $clog2(BitClocks16 + 16);
  localparam int Clock     = 16;
  localparam logic [TimerBits-1:0] One  = Clock[TimerBits-1:0];
  localparam logic [TimerBits-1:0] Next = BitClocks16[TimerBits-1:0] - One;

  logic                 tick;
  logic [TimerBits-1:0] timer_d, timer_q;
  logic [3:0]           left_d, left_q;    // bits still to send, the present one included
  logic [9:0]           shift_d, shift_q;  // the present bit is the lowest; {stop, data, start}
  assign tick    = (timer_q[TimerBits-1:4] == '0);
  assign ready_o = (left_q == '0);
  always_comb begin
    timer_d = tick ? timer_q + Next : timer_q - One;
    left_d  = left_q;
    shift_d = shift_q;
    if (ready_o) begin
      timer_d = Next;
      if (valid_i) begin
        left_d  = 4'd10;
        shift_d = {1'b1, data_i, 1'b0};
      end
    end else if (tick) begin
      left_d  = left_q - 4'd1;
      shift_d = {1'b1, shift_q[9:1]};
    end
  end
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      left_q  <= '0;
      shift_q <= '1;
    end else begin
      left_q  <= left_d;
      shift_q <= shift_d;
    end
  end
  always_ff @(posedge clk_i) timer_q <= timer_d;
  assign tx_o = shift_q[0];
endmodule
