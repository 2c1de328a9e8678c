// SPDX-License-Identifier: MIT
// AXI4-Lite (AMBA IHI 0022) to a register file that answers at once. All outputs to the bus are registers. A write is
// taken when its address and its data are there; one write and one read are under way at most, and each may wait for
// its response's ready.
module cuboct_axi4lite_port (
  input  logic        clk_i,          // ACLK
  input  logic        rst_ni,         // ARESETn, synchronous
  // The bus.
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
  // The registers.
  output logic        write_o,           // a register is written
  output logic [1:0]  write_register_o,  // with write_o: which
  output logic [31:0] write_data_o,      // with write_o
  output logic [3:0]  write_strobe_o,    // with write_o
  input  logic        write_error_i,     // with write_o: refused
  output logic        read_o,            // a register is read
  output logic [1:0]  read_register_o,   // with read_o: which
  input  logic [31:0] read_data_i        // with read_o
);
  logic        write_d, write_q, written_d, written_q, refused_d, refused_q;
  logic        read_d, read_q, answered_d, answered_q;
  logic [31:0] answer_d, answer_q;
  logic        unused_bits;
  assign unused_bits = ^{axi_awaddr_i[1:0], axi_araddr_i[1:0], axi_awprot_i, axi_arprot_i};
  // Ready in the cycle after both are seen: valid stays until then.
  assign write_d    = axi_awvalid_i && axi_wvalid_i && !write_q && !written_q;
  assign written_d  = write_q || (written_q && !axi_bready_i);
  assign refused_d  = write_q ? write_error_i : refused_q;
  assign read_d     = axi_arvalid_i && !read_q && !answered_q;
  assign answered_d = read_q || (answered_q && !axi_rready_i);
  assign answer_d   = read_q ? read_data_i : answer_q;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      write_q    <= 1'b0;
      written_q  <= 1'b0;
      read_q     <= 1'b0;
      answered_q <= 1'b0;
    end else begin
      write_q    <= write_d;
      written_q  <= written_d;
      read_q     <= read_d;
      answered_q <= answered_d;
    end
  end
  always_ff @(posedge clk_i) begin
    refused_q <= refused_d;
    answer_q  <= answer_d;
  end
  assign axi_awready_o    = write_q;
  assign axi_wready_o     = write_q;
  assign axi_bvalid_o     = written_q;
  assign axi_bresp_o      = {refused_q, 1'b0};
  assign axi_arready_o    = read_q;
  assign axi_rvalid_o     = answered_q;
  assign axi_rdata_o      = answer_q;
  assign axi_rresp_o      = 2'b00;
  assign write_o          = write_q;
  assign write_register_o = axi_awaddr_i[3:2];
  assign write_data_o     = axi_wdata_i;
  assign write_strobe_o   = axi_wstrb_i;
  assign read_o           = read_q;
  assign read_register_o  = axi_araddr_i[3:2];
endmodule
