// SPDX-License-Identifier: MIT
// From a frame's bytes to the line's: the inverse of cuboct_frame_rx.
module cuboct_frame_tx (
  input  logic       clk_i,
  input  logic       rst_ni,
  input  logic       valid_i,  // stays until ready_o
  input  logic       flag_i,   // a frame's first or last mark instead of data_i
  input  logic [7:0] data_i,   // of a frame
  output logic       ready_o,  // a byte is taken in a cycle with valid_i and ready_o
  output logic       valid_o,  // a byte for the line
  output logic [7:0] data_o,   // with valid_o
  input  logic       ready_i   // the line takes it
);
  localparam logic [7:0] Flag   = 8'h7e;
  localparam logic [7:0] Escape = 8'h7d;

  // The escape goes out while the byte waits; then the byte, changed.
  logic special, escaped_d, escaped_q;
  assign special = !flag_i && (data_i == Flag || data_i == Escape);
  always_comb begin
    escaped_d = escaped_q;
    if (valid_i && ready_i) escaped_d = special && !escaped_q;
    data_o = data_i;
    if (flag_i) data_o = Flag;
    else if (escaped_q) data_o = {data_i[7:6], !data_i[5], data_i[4:0]};
    else if (special) data_o = Escape;
  end
  assign valid_o = valid_i;
  assign ready_o = ready_i && (!special || escaped_q);
  always_ff @(posedge clk_i) begin
    if (!rst_ni) escaped_q <= 1'b0;
    else escaped_q <= escaped_d;
  end
endmodule
