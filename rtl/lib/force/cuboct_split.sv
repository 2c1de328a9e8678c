// SPDX-License-Identifier: MIT
// What the pipes take of a mask: its ForcePipes lowest bits, the lowest for pipe 0, and what is left of it.
module cuboct_split #(
  parameter int FilterLanes = 8,  // bits of the mask
  parameter int ForcePipes  = 1,  // >= 1
  parameter int SlotBits    = 4   // of a slot's number
) (
  input  logic [FilterLanes-1:0]         mask_i,   // lanes that may interact
  output logic [ForcePipes-1:0]          valid_o,  // per pipe: a bit is for it
  output logic [ForcePipes*SlotBits-1:0] lane_o,   // with valid_o: which one
  output logic [FilterLanes-1:0]         rest_o    // the bits above
);
  // The lane whose bit is set. A slot's number needs no more bits: lanes beyond the last slot never pass.
  function automatic logic [SlotBits-1:0] lane_of(input logic [FilterLanes-1:0] onehot);
    integer l;
    begin
      lane_of = '0;
      for (l = 0; l < FilterLanes; l = l + 1) begin
        if (onehot[l]) lane_of = lane_of | l[SlotBits-1:0];
      end
    end
  endfunction

  logic [FilterLanes-1:0] rest, below;  // what the pipes before leave; bits above its lowest
  integer                 f, k;
  always_comb begin
    rest    = mask_i;
    below   = '0;
    valid_o = '0;
    lane_o  = '0;
    for (f = 0; f < ForcePipes; f = f + 1) begin
      for (k = 1; k < FilterLanes; k = k + 1) below[k] = below[k-1] || rest[k-1];
      valid_o[f]                     = (rest != '0);
      lane_o[f*SlotBits +: SlotBits] = lane_of(rest & ~below);
      rest                           = rest & below;
    end
    rest_o = rest;
  end
endmodule
