// SPDX-License-Identifier: MIT
// A machine behind AXI4-Lite: four registers of 32 bits at the byte addresses 0, 4, 8, 12
// (cuboct_mailbox), through which a host sends requests and gets replies. One clock, one reset.
module cuboct_axi4lite #(
  parameter int ClockHz = 100000000,  // told to the host
  parameter int Depth   = 64          // bytes of each queue, 1 to 255
) (
  input  logic        clk_i,          // ACLK
  input  logic        rst_ni,         // ARESETn, synchronous
  input  logic        axi_awvalid_i,  // stays, with address and protection, until axi_awready_o
  output logic        axi_awready_o,  // with axi_wready_o
  input  logic [3:0]  axi_awaddr_i,   // byte address; the lowest two bits are not looked at
  input  logic [2:0]  axi_awprot_i,   // not looked at
  input  logic        axi_wvalid_i,   // stays, with data and strobes, until axi_wready_o
  output logic        axi_wready_o,   // with axi_awready_o
  input  logic [31:0] axi_wdata_i,    // with axi_wvalid_i
  input  logic [3:0]  axi_wstrb_i,    // with axi_wvalid_i: the bytes that count
  output logic        axi_bvalid_o,   // stays, with its response, until axi_bready_i
  input  logic        axi_bready_i,   // the response is taken
  output logic [1:0]  axi_bresp_o,    // OKAY, or SLVERR where nothing was written
  input  logic        axi_arvalid_i,  // stays, with address and protection, until axi_arready_o
  output logic        axi_arready_o,  // the address is taken
  input  logic [3:0]  axi_araddr_i,   // as axi_awaddr_i
  input  logic [2:0]  axi_arprot_i,   // not looked at
  output logic        axi_rvalid_o,   // stays, with data and response, until axi_rready_i
  input  logic        axi_rready_i,   // the data are taken
  output logic [31:0] axi_rdata_o,    // with axi_rvalid_o
  output logic [1:0]  axi_rresp_o,    // OKAY
  output logic        interrupt_o   // a level: STATUS & ENABLE
);
  logic        write, write_error, read;
  logic [1:0]  write_register, read_register;
  logic [31:0] write_data, read_data;
  logic [3:0]  write_strobe;
  logic        rx_valid, rx_ready, tx_valid, tx_ready, busy, fault;
  logic [7:0]  rx_data, tx_data;
  cuboct_axi4lite_port u_port (
    .clk_i, .rst_ni, .axi_awvalid_i, .axi_awready_o, .axi_awaddr_i, .axi_awprot_i, .axi_wvalid_i,
    .axi_wready_o, .axi_wdata_i, .axi_wstrb_i, .axi_bvalid_o, .axi_bready_i, .axi_bresp_o, .axi_arvalid_i,
    .axi_arready_o, .axi_araddr_i, .axi_arprot_i, .axi_rvalid_o, .axi_rready_i, .axi_rdata_o, .axi_rresp_o,
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
