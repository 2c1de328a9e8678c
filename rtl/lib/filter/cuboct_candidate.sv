// SPDX-License-Identifier: MIT
// What of an own particle the others see: its position with sign bits, its type and its velocity where the rule needs
// them. Wires only.
module cuboct_candidate #(
  parameter int Axes          = 3,    // 2 or 3
  parameter int PositionFrac  = 20,   // P, per axis
  parameter int VelLsb        = 64,   // where the velocity starts
  parameter int VelBits       = 0,    // of all axes; 0: not needed
  parameter int TypeLsb       = 151,  // where the type starts
  parameter int TypeBits      = 0,    // 0: not needed
  parameter int OwnBits       = 160,  // of an own particle's slot
  parameter int CandidateBits = 66    // Axes * (PositionFrac + 2) + TypeBits + VelBits
) (
  input  logic [OwnBits-1:0]       own_i,       // an own particle
  output logic [CandidateBits-1:0] candidate_o  // the same as a candidate
);
  localparam int Axis = PositionFrac + 2;
  for (genvar a = 0; a < Axes; a++) begin : gen_axis
    assign candidate_o[a*Axis +: Axis] = {2'b00, own_i[a*PositionFrac +: PositionFrac]};
  end
  if (TypeBits > 0) begin : gen_type
    assign candidate_o[Axes*Axis +: TypeBits] = own_i[TypeLsb +: TypeBits];
  end
  if (VelBits > 0) begin : gen_velocity
    assign candidate_o[Axes*Axis+TypeBits +: VelBits] = own_i[VelLsb +: VelBits];
  end
  logic unused_own;
  assign unused_own = ^own_i;
endmodule
