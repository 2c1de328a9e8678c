// SPDX-License-Identifier: MIT
// A synchronous reset: 16 cycles after the bitstream's load, and as long as a button is pressed. It relies on
// registers that the bitstream's load sets to zero.
module cuboct_board_reset (
  input  logic clk_i,
  input  logic reset_i,  // the button; not synchronous
  output logic rst_no    // active low
);
  logic [1:0] sync_q = 2'b00;
  logic [4:0] count_q = 5'd0;
  always_ff @(posedge clk_i) begin
    sync_q <= {sync_q[0], reset_i};
    if (sync_q[1]) count_q <= 5'd0;
    else if (!count_q[4]) count_q <= count_q + 5'd1;
  end
  assign rst_no = count_q[4];
endmodule
