// SPDX-License-Identifier: MIT
// CRC-32 of IEEE 802.3, one bit per cycle, least significant bit of a byte first. A byte given in cycle t is
// in the register from t+9 on.
module cuboct_crc32 (
  input  logic       clk_i,
  input  logic       rst_ni,
  input  logic       clear_i,  // to the register's initial value
  input  logic       valid_i,  // a byte is fed; only in a cycle with ready_o
  output logic       ready_o,  // what was fed is in the register
  input  logic [7:0] data_i,   // with valid_i
  output logic [7:0] sum_o,    // the check sum's next byte; it is complete when fed four times with shift_i
  input  logic       shift_i,  // with valid_i: feed the register's own byte, which moves it out
  output logic       good_o    // what was fed ends with its own check sum
);
  localparam logic [31:0] Poly    = 32'hedb88320;
  localparam logic [31:0] Residue = 32'hdebb20e3;  // of bytes followed by the complement of their register

  logic [31:0] crc_d, crc_q;
  logic [7:0]  data_d, data_q;
  logic [3:0]  left_d, left_q;
  logic        feed;
  assign feed = data_q[0] ^ crc_q[0];
  always_comb begin
    crc_d  = crc_q;
    data_d = data_q;
    left_d = left_q;
    if (left_q != 4'd0) begin
      crc_d  = {1'b0, crc_q[31:1]} ^ (feed ? Poly : 32'd0);
      data_d = {1'b0, data_q[7:1]};
      left_d = left_q - 4'd1;
    end
    if (valid_i) begin
      data_d = shift_i ? crc_q[7:0] : data_i;
      left_d = 4'd8;
    end
    if (clear_i) begin
      crc_d  = '1;
      left_d = '0;
    end
  end
  always_ff @(posedge clk_i) begin
    if (!rst_ni) left_q <= '0;
    else left_q <= left_d;
  end
  always_ff @(posedge clk_i) begin
    crc_q  <= crc_d;
    data_q <= data_d;
  end
  assign ready_o = (left_q == '0);
  assign sum_o   = ~crc_q[7:0];
  assign good_o  = (crc_q == Residue);
endmodule
