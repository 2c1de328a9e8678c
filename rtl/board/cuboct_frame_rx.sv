// SPDX-License-Identifier: MIT
// From the line's bytes to a frame's: 7e ends a frame (and begins the next), 7d says that the next byte has
// its bit 5 inverted. After `enable_i` was low, bytes count from the next 7e on. Combinational but for its
// two states.
module cuboct_frame_rx (
  input  logic       clk_i,
  input  logic       rst_ni,
  input  logic       enable_i, // low: out of frame
  input  logic       valid_i,  // a byte of the line
  input  logic [7:0] data_i,   // with valid_i
  output logic       valid_o,  // a byte of a frame
  output logic [7:0] data_o,   // with valid_o
  output logic       end_o     // the frame's end; also of empty ones
);
  localparam logic [7:0] Flag   = 8'h7e;
  localparam logic [7:0] Escape = 8'h7d;

  logic inside_d, inside_q, escaped_d, escaped_q;
  always_comb begin
    inside_d  = inside_q;
    escaped_d = escaped_q;
    valid_o   = 1'b0;
    end_o     = 1'b0;
    if (valid_i) begin
      escaped_d = 1'b0;
      if (data_i == Flag) begin
        end_o    = inside_q;
        inside_d = 1'b1;
      end else if (data_i == Escape) escaped_d = 1'b1;
      else valid_o = inside_q;
    end
    if (!enable_i) begin
      inside_d  = 1'b0;
      escaped_d = 1'b0;
    end
  end
  assign data_o = {data_i[7:6], data_i[5] ^ escaped_q, data_i[4:0]};
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      inside_q  <= 1'b0;
      escaped_q <= 1'b0;
    end else begin
      inside_q  <= inside_d;
      escaped_q <= escaped_d;
    end
  end
endmodule
