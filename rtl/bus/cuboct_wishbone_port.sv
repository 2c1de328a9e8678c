// SPDX-License-Identifier: MIT
// Wishbone B4, classic cycles, to a register file that answers at once. A request is answered in the cycle after it is
// seen, by a register; the request stays until then.
module cuboct_wishbone_port (
  input  logic        clk_i,     // CLK_I
  input  logic        rst_ni,    // RST_I inverted, synchronous
  // The bus.
  input  logic        wb_cyc_i,  // with wb_stb_i: a request; stays until it is answered
  input  logic        wb_stb_i,  // with wb_cyc_i
  input  logic        wb_we_i,   // a write
  input  logic [3:0]  wb_adr_i,  // byte address; the lowest two bits are not looked at
  input  logic [3:0]  wb_sel_i,  // the bytes that count
  input  logic [31:0] wb_dat_i,  // with wb_we_i
  output logic [31:0] wb_dat_o,  // with wb_ack_o of a read
  output logic        wb_ack_o,  // the request is done
  output logic        wb_err_o,  // in place of wb_ack_o, where nothing was written
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
  logic        request, ack_d, ack_q, err_d, err_q;
  logic [31:0] answer_d, answer_q;
  logic        unused_address;
  assign unused_address   = ^wb_adr_i[1:0];
  assign request          = wb_cyc_i && wb_stb_i && !ack_q && !err_q;
  assign write_o          = request && wb_we_i;
  assign write_register_o = wb_adr_i[3:2];
  assign write_data_o     = wb_dat_i;
  assign write_strobe_o   = wb_sel_i;
  assign read_o           = request && !wb_we_i;
  assign read_register_o  = wb_adr_i[3:2];
  assign err_d            = write_o && write_error_i;
  assign ack_d            = request && !err_d;
  assign answer_d         = read_o ? read_data_i : answer_q;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      ack_q <= 1'b0;
      err_q <= 1'b0;
    end else begin
      ack_q <= ack_d;
      err_q <= err_d;
    end
  end
  always_ff @(posedge clk_i) answer_q <= answer_d;
  assign wb_dat_o = answer_q;
  assign wb_ack_o = ack_q;
  assign wb_err_o = err_q;
endmodule
