// SPDX-License-Identifier: MIT
// One filter lane: may the candidate interact with the particle of this lane's slot? Adders and comparators only: each
// |d_a|, each sum of two and, of three axes, the sum of all against bounds that no pair inside the cutoff exceeds.
// Combinational.
module cuboct_filter_lane #(
  parameter int          Axes            = 3,      // 2 or 3
  parameter int          PositionFrac    = 20,     // P
  parameter int          DifferenceShift = 4,      // P - D, >= 0
  parameter logic [63:0] PlanarOne       = 64'd0,  // D fractional bits
  parameter logic [63:0] PlanarTwo       = 64'd0,
  parameter logic [63:0] PlanarThree     = 64'd0
) (
  input  logic                          test_i,       // the lane's slot exists and is not the candidate itself
  input  logic [Axes*PositionFrac-1:0]  own_i,        // x, y, z, unsigned
  input  logic [Axes*(PositionFrac+2)-1:0] candidate_i,  // x, y, z, signed
  output logic                          pass_o
);
  // |x_j - x_i| <= 2^(P+1), so |d| <= 2^(D+1), and a sum of three takes D+4 bits with the sign; one to spare.
  localparam int Bits = PositionFrac - DifferenceShift + 5;

  logic [Bits-1:0] size [0:Axes-1];
  for (genvar a = 0; a < Axes; a++) begin : gen_axis
    logic signed [PositionFrac+2:0] difference;
    logic signed [Bits-1:0]         d;
    assign difference = $signed({candidate_i[(a+1)*(PositionFrac+2)-1],
                                 candidate_i[a*(PositionFrac+2) +: PositionFrac+2]})
                      - $signed({3'b000, own_i[a*PositionFrac +: PositionFrac]});
    cuboct_round_odd #(.InBits(PositionFrac + 3), .Shift(DifferenceShift), .OutBits(Bits)) u_round (
      .a_i(difference), .y_o(d)
    );
    assign size[a] = d[Bits-1] ? -d : d;
  end

  logic [Bits-1:0] xy;
  logic            near;
  assign xy = size[0] + size[1];
  if (Axes == 3) begin : gen_space
    logic [Bits-1:0] yz, zx;
    assign yz   = size[1] + size[2];
    assign zx   = size[2] + size[0];
    assign near = (size[2] <= PlanarOne[Bits-1:0]) && (yz <= PlanarTwo[Bits-1:0]) && (zx <= PlanarTwo[Bits-1:0])
               && (xy + size[2] <= PlanarThree[Bits-1:0]);
  end else begin : gen_plane
    assign near = 1'b1;  // PlanarTwo <= PlanarThree
  end
  assign pass_o = test_i && (size[0] <= PlanarOne[Bits-1:0]) && (size[1] <= PlanarOne[Bits-1:0])
               && (xy <= PlanarTwo[Bits-1:0]) && near;
endmodule
