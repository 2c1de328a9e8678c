// SPDX-License-Identifier: MIT
// The ULX3S: ECP5 LFE5U-85F, 25 MHz, FT231X. Pins: pins.lpf.
module cuboct_board_top (
  input  logic clk_i,         // 25 MHz
  input  logic reset_i,       // button FIRE1, high while pressed
  input  logic uart_rx_i,
  output logic uart_tx_o,
  output logic led_idle_o,    // LED 0, lit while no run is under way
  output logic led_fault_o,   // LED 1, lit after a fault until the host's RESET
  output logic wifi_gpio0_o   // high: else the ESP32 of the board may hold the FPGA's configuration
);
  logic rst_n, busy, fault;
  cuboct_board_reset u_reset (.clk_i, .reset_i, .rst_no(rst_n));
  cuboct_board u_board (
    .clk_i, .rst_ni(rst_n), .rx_i(uart_rx_i), .tx_o(uart_tx_o), .busy_o(busy), .fault_o(fault)
  );
  assign led_idle_o   = !busy;
  assign led_fault_o  = fault;
  assign wifi_gpio0_o = 1'b1;
endmodule
