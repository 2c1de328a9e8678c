// SPDX-License-Identifier: MIT
// cuboct_filter_lane against the planar test told by magnitudes, for every pair of positions: each |d|, each sum of two
// and the sum of all within its bound. Combinational: one cycle is all of it.
module filter_lane_formal #(
  parameter int Axes            = 3,
  parameter int PositionFrac    = 8,
  parameter int DifferenceShift = 2,
  parameter int PlanarOne       = 50,
  parameter int PlanarTwo       = 70,
  parameter int PlanarThree     = 80
) (
  input logic                             clk_i,
  input logic                             test_i,
  input logic [Axes*PositionFrac-1:0]     own_i,
  input logic [Axes*(PositionFrac+2)-1:0] candidate_i
);
  localparam int Bits = PositionFrac + 6;

  logic pass;
  cuboct_filter_lane #(
    .Axes(Axes), .PositionFrac(PositionFrac), .DifferenceShift(DifferenceShift), .PlanarOne(PlanarOne),
    .PlanarTwo(PlanarTwo), .PlanarThree(PlanarThree)
  ) u_dut (.test_i, .own_i, .candidate_i, .pass_o(pass));

  logic [3*Bits-1:0] sizes;  // |d| by axis; nothing along one that is not there
  for (genvar a = 0; a < 3; a++) begin : gen_axis
    if (a < Axes) begin : gen_size
      logic [PositionFrac+1:0] other;
      logic [Bits-1:0]         difference, size;
      assign other      = candidate_i[a*(PositionFrac+2) +: PositionFrac+2];
      assign difference = {{(Bits - PositionFrac - 2) {other[PositionFrac+1]}}, other}
                        - {{(Bits - PositionFrac) {1'b0}}, own_i[a*PositionFrac +: PositionFrac]};
      assign size       = difference[Bits-1] ? -difference : difference;
      assign sizes[a*Bits +: Bits] = (DifferenceShift == 0) ? size
                                     : (size + ({{(Bits - 1) {1'b0}}, 1'b1} << DifferenceShift >> 1)) >> DifferenceShift;
    end else begin : gen_none
      assign sizes[a*Bits +: Bits] = '0;
    end
  end
  logic [Bits-1:0] x, y, z;
  assign x = sizes[0 +: Bits];
  assign y = sizes[Bits +: Bits];
  assign z = sizes[2*Bits +: Bits];
  logic near;
  assign near = x <= PlanarOne && y <= PlanarOne && z <= PlanarOne && x + y <= PlanarTwo && y + z <= PlanarTwo
                && z + x <= PlanarTwo && x + y + z <= PlanarThree;

  always_ff @(posedge clk_i) begin
    a_pass: assert (pass == (test_i && near));
    c_edge: cover (pass && x + y == PlanarTwo && x != y && (Axes == 2 || x + y + z == PlanarThree));
  end
endmodule
