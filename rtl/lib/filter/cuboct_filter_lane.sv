// SPDX-License-Identifier: MIT
// One filter lane: may the candidate interact with the particle of this lane's slot? Adders and comparators only, on
// the leading FilterFrac bits of the positions. With e the difference of these, size = e, or -e - 1 if e < 0;
// cuboct_planar tests the sizes. Combinational, or with a register between sizes and tests.
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
  logic [Axes*(FilterFrac+1)-1:0] sizes;
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
      assign sizes[a*(FilterFrac+1) +: FilterFrac+1] = size_q;
    end else begin : gen_direct
      assign sizes[a*(FilterFrac+1) +: FilterFrac+1] = size_d;
    end
  end
  if (Registered == 0) begin : gen_no_register
    logic unused_clock;
    assign unused_clock = clk_i ^ en_i;
  end

  cuboct_planar #(
    .Axes(Axes), .FilterFrac(FilterFrac), .PlanarOne(PlanarOne), .PlanarTwo(PlanarTwo), .PlanarThree(PlanarThree)
  ) u_planar (.test_i, .size_i(sizes), .near_o);
endmodule
