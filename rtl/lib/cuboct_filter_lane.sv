// SPDX-License-Identifier: MIT
// One filter lane: may the candidate interact with the particle of this lane's slot? Adders and comparators only, on
// the leading FilterFrac bits of the positions. With e the difference of these, size = e, or -e - 1 if e < 0; each
// size, each sum of two and, of three axes, the sum of all stand against bounds that no pair inside the cutoff exceeds
// (model/contract/fixed_rule.h). Combinational, or with a register between sizes and sums; near_o are the tests one by
// one, for who has a register to put between.
module cuboct_filter_lane #(
  parameter int          Axes        = 3,      // 2 or 3
  parameter int          FilterFrac  = 8,      // B
  parameter logic [63:0] PlanarOne   = 64'd0,  // B fractional bits; bound of a size
  parameter logic [63:0] PlanarTwo   = 64'd0,  // of a sum of two sizes
  parameter logic [63:0] PlanarThree = 64'd0,  // of the sum of all
  parameter int          Registered  = 0,      // 0, 1: near_o is of the positions that stood there with en_i
  // Derived; do not set.
  localparam int         Tests       = (Axes == 3) ? 5 : 2
) (
  input  logic                           clk_i,
  input  logic                           en_i,         // Registered: takes the positions
  input  logic                           test_i,       // with near_o: the slot exists and is not the candidate itself
  input  logic [Axes*FilterFrac-1:0]     own_i,        // x, y, z, unsigned
  input  logic [Axes*(FilterFrac+2)-1:0] candidate_i,  // x, y, z, signed
  output logic [Tests-1:0]               near_o        // it may if all are set
);
  // |e| < 2^(B+1), and a sum of three sizes, or a bound, lies below 2^(B+3).
  localparam int Bits = FilterFrac + 3;

  logic [Bits-1:0] size [0:Axes-1];
  for (genvar a = 0; a < Axes; a++) begin : gen_axis
    logic [FilterFrac+1:0] e;
    logic [FilterFrac:0]   size_d;
    assign e      = candidate_i[a*(FilterFrac+2) +: FilterFrac+2] - {2'b00, own_i[a*FilterFrac +: FilterFrac]};
    assign size_d = e[FilterFrac:0] ^ {(FilterFrac + 1) {e[FilterFrac+1]}};
    if (Registered != 0) begin : gen_register
      logic [FilterFrac:0] size_q;
      always_ff @(posedge clk_i) begin
        if (en_i) size_q <= size_d;
      end
      assign size[a] = {2'b00, size_q};
    end else begin : gen_direct
      assign size[a] = {2'b00, size_d};
    end
  end
  if (Registered == 0) begin : gen_no_register
    logic unused_clock;
    assign unused_clock = clk_i ^ en_i;
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
