// SPDX-License-Identifier: MIT
// The planar tests of a difference of positions: each axis's size, each sum of two and, of three axes, the sum of all
// against bounds that no pair inside the cutoff exceeds (set_planar in model/contract/fixed_rule.h). near_o has the
// tests one by one, so that the caller can place a register before their conjunction.
module cuboct_planar #(
  parameter int          Axes        = 3,      // 2 or 3
  parameter int          FilterFrac  = 8,      // B
  parameter logic [63:0] PlanarOne   = 64'd0,  // B fractional bits; bound of a size
  parameter logic [63:0] PlanarTwo   = 64'd0,  // of a sum of two sizes
  parameter logic [63:0] PlanarThree = 64'd0,  // of the sum of all
  // Derived; do not set.
  localparam int         Tests       = (Axes == 3) ? 5 : 2
) (
  input  logic                           test_i,  // ands with the test of single sizes
  input  logic [Axes*(FilterFrac+1)-1:0] size_i,  // x, y, z: e, or -e - 1 of a difference e < 0
  output logic [Tests-1:0]               near_o   // may interact if all are set
);
  // |e| < 2^(B+1), and a sum of three sizes, or a bound, lies below 2^(B+3).
  localparam int Bits = FilterFrac + 3;

  logic [Bits-1:0] size [0:Axes-1];
  for (genvar a = 0; a < Axes; a++) begin : gen_size
    assign size[a] = {2'b00, size_i[a*(FilterFrac+1) +: FilterFrac+1]};
  end

  // Each sum is one with its bound, so that no adder waits for another: negative is near.
  logic [Bits-1:0] xy;
  assign xy        = size[0] + size[1] - (PlanarTwo[Bits-1:0] + 1'b1);
  assign near_o[1] = xy[Bits-1];
  if (Axes == 3) begin : gen_space
    logic [Bits-1:0] yz, zx;
    logic [Bits:0]   xyz;
    assign yz  = size[1] + size[2] - (PlanarTwo[Bits-1:0] + 1'b1);
    assign zx  = size[2] + size[0] - (PlanarTwo[Bits-1:0] + 1'b1);
    assign xyz = {1'b0, size[0]} + {1'b0, size[1]} + {1'b0, size[2]} - (PlanarThree[Bits:0] + 1'b1);
    assign near_o[0]   = test_i && (size[0] <= PlanarOne[Bits-1:0]) && (size[1] <= PlanarOne[Bits-1:0])
                      && (size[2] <= PlanarOne[Bits-1:0]);
    assign near_o[4:2] = {xyz[Bits], zx[Bits-1], yz[Bits-1]};
  end else begin : gen_plane
    // PlanarTwo <= PlanarThree
    assign near_o[0] = test_i && (size[0] <= PlanarOne[Bits-1:0]) && (size[1] <= PlanarOne[Bits-1:0]);
  end
endmodule
