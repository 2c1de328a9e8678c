// SPDX-License-Identifier: MIT
// A machine behind a serial line: what the tops of all boards hold.
module cuboct_board (
  input  logic clk_i,
  input  logic rst_ni,   // synchronous
  input  logic rx_i,     // not synchronous
  output logic tx_o,
  output logic busy_o,   // a run is under way
  output logic fault_o   // some node met a fault since the host's last RESET
);
  logic       rx_valid, rx_ready, tx_valid, tx_ready;
  logic [7:0] rx_data, tx_data;
  cuboct_uart_rx #(.BitClocks16(cuboct_board_pkg::BitClocks16)) u_uart_rx (
    .clk_i, .rst_ni, .rx_i, .valid_o(rx_valid), .data_o(rx_data)
  );
  cuboct_uart_tx #(.BitClocks16(cuboct_board_pkg::BitClocks16)) u_uart_tx (
    .clk_i, .rst_ni, .valid_i(tx_valid), .data_i(tx_data), .ready_o(tx_ready), .tx_o
  );
  cuboct_machine #(.ClockHz(cuboct_board_pkg::ClockHz)) u_machine (
    .clk_i, .rst_ni, .rx_valid_i(rx_valid), .rx_data_i(rx_data), .rx_ready_o(rx_ready), .tx_valid_o(tx_valid),
    .tx_data_o(tx_data), .tx_ready_i(tx_ready), .busy_o, .fault_o
  );
  logic unused_ready;  // a line does not wait: what comes while a reply is sent is lost
  assign unused_ready = rx_ready;
endmodule
