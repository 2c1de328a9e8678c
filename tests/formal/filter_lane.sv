// SPDX-License-Identifier: MIT
// cuboct_filter_lane against the planar test told by magnitudes, for every pair of leading bits of positions:
// with e their difference, size = |e|, less one where e < 0; each size, each sum of two and the sum of all
// within its bound. Combinational: one cycle is all of it.
module filter_lane_formal #(
  parameter int Axes            = 3,
  parameter int FilterFrac      = 8,
  parameter int PlanarOne       = 200,
  parameter int PlanarTwo       = 280,
  parameter int PlanarThree     = 320
) (
  input logic                             clk_i,
  input logic                             test_i,
  input logic [Axes*FilterFrac-1:0]       own_i,
  input logic [Axes*(FilterFrac+2)-1:0]   candidate_i
);
  localparam int Bits = FilterFrac + 6;

  logic                             pass;
  logic [((Axes == 3) ? 5 : 2)-1:0] tests;
  assign pass = (tests == '1);
  cuboct_filter_lane #(
    .Axes(Axes), .FilterFrac(FilterFrac), .PlanarOne(PlanarOne), .PlanarTwo(PlanarTwo),
    .PlanarThree(PlanarThree)
  ) u_dut (.clk_i, .en_i(1'b0), .test_i, .own_i, .candidate_i, .near_o(tests));

  logic [3*Bits-1:0] sizes;  // by axis; nothing along one that is not there
  for (genvar a = 0; a < 3; a++) begin : gen_axis
    if (a < Axes) begin : gen_size
      logic [FilterFrac+1:0] other;
      logic [Bits-1:0]       difference;
      assign other      = candidate_i[a*(FilterFrac+2) +: FilterFrac+2];
      assign difference = {{(Bits - FilterFrac - 2) {other[FilterFrac+1]}}, other}
                        - {{(Bits - FilterFrac) {1'b0}}, own_i[a*FilterFrac +: FilterFrac]};
      assign sizes[a*Bits +: Bits] = difference[Bits-1] ? -difference - 1'b1 : difference;
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
