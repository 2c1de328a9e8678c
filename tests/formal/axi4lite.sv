// SPDX-License-Identifier: MIT
// cuboct_axi4lite_port before any master that keeps AXI4-Lite's rules and any register file: its own rules hold, each
// address and data taken is one write of the registers with these, answered once, and each read likewise.
module axi4lite_formal (
  input logic        clk_i,
  input logic        awvalid_i,
  input logic        wvalid_i,
  input logic        bready_i,
  input logic        arvalid_i,
  input logic        rready_i,
  input logic [3:0]  awaddr_i,
  input logic [3:0]  araddr_i,
  input logic [31:0] wdata_i,
  input logic [3:0]  wstrb_i,
  input logic        error_i,
  input logic [31:0] answer_i
);
  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;

  logic awready, wready, bvalid, arready, rvalid, write, read;
  logic [1:0]  bresp, rresp, write_register, read_register;
  logic [31:0] rdata, write_data;
  logic [3:0]  write_strobe;
  cuboct_axi4lite_port u_dut (
    .clk_i, .rst_ni(running_q), .axi_awvalid_i(awvalid_i), .axi_awready_o(awready), .axi_awaddr_i(awaddr_i),
    .axi_awprot_i(3'd0), .axi_wvalid_i(wvalid_i), .axi_wready_o(wready), .axi_wdata_i(wdata_i),
    .axi_wstrb_i(wstrb_i), .axi_bvalid_o(bvalid), .axi_bready_i(bready_i), .axi_bresp_o(bresp),
    .axi_arvalid_i(arvalid_i), .axi_arready_o(arready), .axi_araddr_i(araddr_i), .axi_arprot_i(3'd0),
    .axi_rvalid_o(rvalid), .axi_rready_i(rready_i), .axi_rdata_o(rdata), .axi_rresp_o(rresp), .write_o(write),
    .write_register_o(write_register), .write_data_o(write_data), .write_strobe_o(write_strobe),
    .write_error_i(error_i), .read_o(read), .read_register_o(read_register), .read_data_i(answer_i)
  );

  // The cycle before.
  logic        awvalid_q, awready_q, wvalid_q, wready_q, arvalid_q, arready_q, bvalid_q, bready_q, rvalid_q, rready_q;
  logic [3:0]  awaddr_q, araddr_q, wstrb_q;
  logic [31:0] wdata_q, rdata_q;
  logic [1:0]  bresp_q;
  logic        past_q;
  always_ff @(posedge clk_i) begin
    past_q <= running_q;
    {awvalid_q, wvalid_q, arvalid_q, bready_q, rready_q} <= {awvalid_i, wvalid_i, arvalid_i, bready_i, rready_i};
    {awready_q, wready_q, arready_q, bvalid_q, rvalid_q} <= {awready, wready, arready, bvalid, rvalid};
    {awaddr_q, araddr_q, wstrb_q, wdata_q, rdata_q, bresp_q} <= {awaddr_i, araddr_i, wstrb_i, wdata_i, rdata, bresp};
    if (!running_q) past_q <= 1'b0;
  end

  // What the master keeps: nothing during the reset; what is valid stays, unchanged, until it is taken.
  always_comb begin
    if (!running_q) assume (!awvalid_i && !wvalid_i && !arvalid_i);
    if (past_q && awvalid_q && !awready_q) assume (awvalid_i && awaddr_i == awaddr_q);
    if (past_q && wvalid_q && !wready_q) assume (wvalid_i && wdata_i == wdata_q && wstrb_i == wstrb_q);
    if (past_q && arvalid_q && !arready_q) assume (arvalid_i && araddr_i == araddr_q);
  end

  // Responses owed: of addresses taken, of data taken, of reads.
  logic [1:0]  addresses_q, datas_q, reads_q;
  logic        refused_q;
  logic [31:0] answer_q;
  always_ff @(posedge clk_i) begin
    if (!running_q) begin
      addresses_q <= '0;
      datas_q     <= '0;
      reads_q     <= '0;
    end else begin
      addresses_q <= addresses_q + {1'b0, awvalid_i && awready} - {1'b0, bvalid && bready_i};
      datas_q     <= datas_q + {1'b0, wvalid_i && wready} - {1'b0, bvalid && bready_i};
      reads_q     <= reads_q + {1'b0, arvalid_i && arready} - {1'b0, rvalid && rready_i};
    end
    if (write) refused_q <= error_i;
    if (read) answer_q <= answer_i;
  end

  always_ff @(posedge clk_i) begin
    if (running_q) begin
      // A response only to what was taken, and one.
      a_write_owed: assert (!bvalid || (addresses_q == 2'd1 && datas_q == 2'd1));
      a_read_owed:  assert (!rvalid || reads_q == 2'd1);
      a_few:        assert (addresses_q <= 2'd1 && datas_q <= 2'd1 && reads_q <= 2'd1);
      // Taken and done in one cycle, with what the master gives.
      a_write:      assert (write == (awvalid_i && awready) && write == (wvalid_i && wready));
      a_read:       assert (read == (arvalid_i && arready));
      if (write)
        a_written: assert (write_register == awaddr_i[3:2] && write_data == wdata_i && write_strobe == wstrb_i);
      if (read) a_which: assert (read_register == araddr_i[3:2]);
      if (bvalid) a_bresp: assert (bresp == {refused_q, 1'b0});
      if (rvalid) a_rdata: assert (rdata == answer_q && rresp == 2'b00);
      if (past_q && bvalid_q && !bready_q) a_b_stays: assert (bvalid && bresp == bresp_q);
      if (past_q && rvalid_q && !rready_q) a_r_stays: assert (rvalid && rdata == rdata_q);
      // A write that waits goes on: taken within two cycles once no response waits, answered in the next.
      if (past_q && awvalid_q && wvalid_q && !awready_q && !bvalid_q) a_write_soon: assert (awready && wready);
      if (past_q && arvalid_q && !arready_q && !rvalid_q) a_read_soon: assert (arready);
      if (past_q && awvalid_q && awready_q) a_answered: assert (bvalid);
      c_refused: cover (bvalid && bresp == 2'b10 && bready_i);
      c_both:    cover (bvalid && rvalid && bready_i && rready_i);
    end
  end
endmodule
