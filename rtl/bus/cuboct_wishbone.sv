// SPDX-License-Identifier: MIT
// A machine behind Wishbone B4 (classic cycles): four registers of 32 bits at the byte addresses 0, 4, 8, 12
// (cuboct_mailbox), through which a host sends requests and gets replies. One clock, one reset.
module cuboct_wishbone #(
  parameter int ClockHz = 100000000,  // told to the host
  parameter int Depth   = 64          // bytes of each queue, 1 to 255
) (
  input  logic        clk_i,     // CLK_I
  input  logic        rst_ni,    // RST_I inverted, synchronous
  input  logic        wb_cyc_i,  // with wb_stb_i: a request; stays until it is answered
  input  logic        wb_stb_i,  // with wb_cyc_i
  input  logic        wb_we_i,   // a write
  input  logic [3:0]  wb_adr_i,  // byte address; the lowest two bits are not looked at
  input  logic [3:0]  wb_sel_i,  // the bytes that count
  input  logic [31:0] wb_dat_i,  // with wb_we_i
  output logic [31:0] wb_dat_o,  // with wb_ack_o of a read
  output logic        wb_ack_o,  // the request is done
  output logic        wb_err_o,  // in place of wb_ack_o, where nothing was written
  output logic        interrupt_o   // a level: STATUS & ENABLE
);
  logic        write, write_error, read;
  logic [1:0]  write_register, read_register;
  logic [31:0] write_data, read_data;
  logic [3:0]  write_strobe;
  logic        rx_valid, rx_ready, tx_valid, tx_ready, busy, fault;
  logic [7:0]  rx_data, tx_data;
  cuboct_wishbone_port u_port (
    .clk_i, .rst_ni, .wb_cyc_i, .wb_stb_i, .wb_we_i, .wb_adr_i, .wb_sel_i, .wb_dat_i, .wb_dat_o, .wb_ack_o,
    .wb_err_o,
    .write_o(write), .write_register_o(write_register), .write_data_o(write_data), .write_strobe_o(write_strobe),
    .write_error_i(write_error), .read_o(read), .read_register_o(read_register), .read_data_i(read_data)
  );
  cuboct_mailbox #(.Depth(Depth)) u_mailbox (
    .clk_i, .rst_ni, .write_i(write), .write_register_i(write_register), .write_data_i(write_data),
    .write_strobe_i(write_strobe), .write_error_o(write_error), .read_i(read), .read_register_i(read_register),
    .read_data_o(read_data), .interrupt_o, .rx_valid_o(rx_valid), .rx_data_o(rx_data), .rx_ready_i(rx_ready),
    .tx_valid_i(tx_valid), .tx_data_i(tx_data), .tx_ready_o(tx_ready), .busy_i(busy), .fault_i(fault)
  );
  cuboct_machine #(.ClockHz(ClockHz)) u_machine (
    .clk_i, .rst_ni, .rx_valid_i(rx_valid), .rx_data_i(rx_data), .rx_ready_o(rx_ready), .tx_valid_o(tx_valid),
    .tx_data_o(tx_data), .tx_ready_i(tx_ready), .busy_o(busy), .fault_o(fault)
  );
endmodule
