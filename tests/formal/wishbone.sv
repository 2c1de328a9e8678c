// SPDX-License-Identifier: MIT
// cuboct_wishbone_port before any master that keeps a request until it is answered: each request is one access of the
// registers with what it gives, answered once, by an acknowledgement or an error, in the next cycle.
module wishbone_formal (
  input logic        clk_i,
  input logic        cyc_i,
  input logic        stb_i,
  input logic        we_i,
  input logic [3:0]  adr_i,
  input logic [3:0]  sel_i,
  input logic [31:0] dat_i,
  input logic        error_i,
  input logic [31:0] answer_i
);
  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;

  logic ack, err, write, read;
  logic [1:0]  write_register, read_register;
  logic [31:0] dat, write_data;
  logic [3:0]  write_strobe;
  cuboct_wishbone_port u_dut (
    .clk_i, .rst_ni(running_q), .wb_cyc_i(cyc_i), .wb_stb_i(stb_i), .wb_we_i(we_i), .wb_adr_i(adr_i),
    .wb_sel_i(sel_i), .wb_dat_i(dat_i), .wb_dat_o(dat), .wb_ack_o(ack), .wb_err_o(err), .write_o(write),
    .write_register_o(write_register), .write_data_o(write_data), .write_strobe_o(write_strobe),
    .write_error_i(error_i), .read_o(read), .read_register_o(read_register), .read_data_i(answer_i)
  );

  logic        asks_q, answered_q, past_q, we_q, write_q, read_q, error_q;
  logic [3:0]  adr_q, sel_q;
  logic [31:0] dat_q, answer_q;
  always_ff @(posedge clk_i) begin
    past_q     <= running_q;
    asks_q     <= running_q && cyc_i && stb_i;
    answered_q <= ack || err;
    {we_q, adr_q, sel_q, dat_q}            <= {we_i, adr_i, sel_i, dat_i};
    {write_q, read_q, error_q, answer_q}   <= {running_q && write, running_q && read, error_i, answer_i};
  end
  always_comb begin
    if (!running_q) assume (!cyc_i && !stb_i);
    if (past_q && asks_q && !answered_q)
      assume (cyc_i && stb_i && we_i == we_q && adr_i == adr_q && sel_i == sel_q && dat_i == dat_q);
  end

  always_ff @(posedge clk_i) begin
    if (running_q) begin
      a_one:     assert (!(ack && err) && !(write && read));
      a_only:    assert (!(ack || err) || (past_q && (write_q || read_q)));
      a_each:    assert (!(past_q && (write_q || read_q)) || ack || err);
      a_not_two: assert (!(ack || err) || !(write || read));
      if (cyc_i && stb_i && !ack && !err) a_access: assert (write == we_i && read == !we_i);
      if (!cyc_i || !stb_i) a_none: assert (!write && !read);
      if (write) a_written: assert (write_register == adr_i[3:2] && write_data == dat_i && write_strobe == sel_i);
      if (read) a_which: assert (read_register == adr_i[3:2]);
      if (past_q && write_q) a_error: assert (err == error_q);
      if (past_q && read_q) a_answer: assert (ack && dat == answer_q);
      c_error: cover (err);
      c_read:  cover (ack && !we_i && cyc_i && stb_i);
    end
  end
endmodule
