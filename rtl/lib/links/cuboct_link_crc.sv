// SPDX-License-Identifier: MIT
// A cyclic redundancy check over one word, reflected: bit 0 of data_i comes first, and crc_o continues it. Each bit of
// the check is one exclusive-or over the bits that it depends on, so that tools balance it. Combinational.
module cuboct_link_crc #(
  parameter int          Bits       = 71,            // of the message, >= 1
  parameter int          Width      = 16,            // of the check, <= 32
  parameter logic [31:0] Polynomial = 32'h00003d65,  // without the leading term
  parameter logic [31:0] Start      = 32'h0000ffff   // the remainder before the first bit
) (
  input  logic [Bits-1:0]  data_i,  // the message
  output logic [Width-1:0] crc_o    // its check
);
  // The polynomial with its highest coefficient in bit 0.
  function [Width-1:0] reversed(input integer unused);
    integer k;
    begin
      reversed = {Width{1'b0}};
      for (k = 0; k < Width; k = k + 1) reversed[k] = Polynomial[Width-1-k];
      if (unused != 0) reversed = {Width{1'b0}};
    end
  endfunction
  localparam logic [Width-1:0] Reversed = reversed(0);

  // The message bits that the bit of the check in `row`, one-hot, depends on: the last bit's remainder is the
  // polynomial, and each bit before it has gone one step further.
  function [Bits-1:0] taps(input logic [Width-1:0] row);
    integer i;
    logic [Width-1:0] r;
    begin
      taps = {Bits{1'b0}};
      r = Reversed;
      for (i = Bits - 1; i >= 0; i = i - 1) begin
        taps[i] = |(r & row);
        r = {1'b0, r[Width-1:1]} ^ (r[0] ? Reversed : {Width{1'b0}});
      end
    end
  endfunction

  // What is left of the start after the whole message.
  function [Width-1:0] started(input integer steps);
    integer i;
    begin
      started = Start[Width-1:0];
      for (i = 0; i < steps; i = i + 1) begin
        started = {1'b0, started[Width-1:1]} ^ (started[0] ? Reversed : {Width{1'b0}});
      end
    end
  endfunction
  localparam logic [Width-1:0] Started = started(Bits);

  for (genvar j = 0; j < Width; j++) begin : gen_bit
    localparam logic [Bits-1:0] Taps = taps({{(Width - 1) {1'b0}}, 1'b1} << j);
    assign crc_o[j] = (^(data_i & Taps)) ^ Started[j];
  end
endmodule
