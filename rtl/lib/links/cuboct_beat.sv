// SPDX-License-Identifier: MIT
// One beat of a record: least significant part first, the last beat zero-padded. Combinational.
module cuboct_beat #(
  parameter int Bits     = 66,  // of the record, >= 1
  parameter int LinkBits = 32,  // of a beat, >= 1
  parameter int BeatBits = 2    // of a beat's number, >= clog2(beats)
) (
  input  logic [Bits-1:0]     word_i,  // the record
  input  logic [BeatBits-1:0] beat_i,  // which beat of it
  output logic [LinkBits-1:0] data_o   // that beat
);
  localparam int Beats = (Bits + LinkBits - 1) / LinkBits;

  logic [Beats*LinkBits-1:0] padded;
  if (Beats * LinkBits > Bits) begin : gen_pad
    assign padded = {{(Beats * LinkBits - Bits) {1'b0}}, word_i};
  end else begin : gen_exact
    assign padded = word_i;
  end

  if (Beats == 1) begin : gen_one
    logic unused_beat;
    assign unused_beat = ^beat_i;
    assign data_o = padded;
  end else begin : gen_select
    logic [LinkBits-1:0] beats [0:Beats-1];
    for (genvar b = 0; b < Beats; b++) begin : gen_beat
      assign beats[b] = padded[b*LinkBits +: LinkBits];
    end
    assign data_o = beats[beat_i];
  end
endmodule
