// SPDX-License-Identifier: MIT
// The iCEBreaker: iCE40UP5K, 12 MHz, FTDI's second channel. Pins: pins.pcf.
module cuboct_board_top (
  input  logic clk_i,        // 12 MHz
  input  logic reset_ni,     // user button, low while pressed
  input  logic uart_rx_i,
  output logic uart_tx_o,
  output logic led_idle_no,  // green, lit while no run is under way
  output logic led_fault_no  // red, lit after a fault until the host's RESET
);
  logic rst_n, busy, fault;
  cuboct_board_reset u_reset (.clk_i, .reset_i(!reset_ni), .rst_no(rst_n));
  cuboct_board u_board (
    .clk_i, .rst_ni(rst_n), .rx_i(uart_rx_i), .tx_o(uart_tx_o), .busy_o(busy), .fault_o(fault)
  );
  assign led_idle_no  = busy;
  assign led_fault_no = !fault;
endmodule
