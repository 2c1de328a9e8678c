// SPDX-License-Identifier: MIT
// Lets pass the halo records of a face that may interact with a particle somewhere in the box of the own ones: the
// planar test against the box's nearest point, in three cycles. What is tested before the step begins passes, as the
// box is not known yet. The end of the face's stream goes through the same registers.
module cuboct_cull #(
  parameter int          Axes        = 3,      // 2 or 3
  parameter int          FilterFrac  = 8,      // leading bits of a position that are tested
  parameter logic [63:0] PlanarOne   = 64'd0,
  parameter logic [63:0] PlanarTwo   = 64'd0,
  parameter logic [63:0] PlanarThree = 64'd0,
  parameter int          HaloBits    = 66      // of a record, >= 1
) (
  input  logic                           clk_i,
  input  logic                           rst_ni,
  // The box; constant while run_i.
  input  logic                           run_i,    // the step has begun
  input  logic                           empty_i,  // there is no own particle
  input  logic [Axes*FilterFrac-1:0]     low_i,    // x, y, z
  input  logic [Axes*FilterFrac-1:0]     high_i,   // x, y, z
  // From the link.
  input  logic                           valid_i,  // a record comes
  input  logic [HaloBits-1:0]            halo_i,   // with valid_i
  input  logic [Axes*(FilterFrac+2)-1:0] x_i,      // with valid_i: its place, leading bits, signed, in the own frame
  input  logic                           end_i,    // the stream ends
  // To the streamer's memory, three cycles later.
  output logic                           valid_o,  // a record passes
  output logic [HaloBits-1:0]            halo_o,   // with valid_o
  output logic                           end_o     // the stream has ended
);
  localparam int Tests = (Axes == 3) ? 5 : 2;
  localparam int Wide  = FilterFrac + 3;

  logic [2:0] valid_d, valid_q, end_d, end_q;
  assign valid_d = {valid_q[1:0], valid_i};
  assign end_d   = {end_q[1:0], end_i};
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      valid_q <= '0;
      end_q   <= '0;
    end else begin
      valid_q <= valid_d;
      end_q   <= end_d;
    end
  end
  cuboct_hold #(.Bits(HaloBits), .Depth(3), .Interval(1)) u_halo (
    .clk_i, .valid_i({valid_q, valid_i}), .d_i(halo_i), .q_o(halo_o)
  );

  // 1: the record. 2: its distances from the box. 3: the tests.
  logic [Axes*(FilterFrac+2)-1:0] x_q;
  logic [Axes*(FilterFrac+1)-1:0] size_d, size_q;
  logic                           known_2_q, known_3_q, none_2_q;
  logic [Tests-1:0]               near, near_q;
  for (genvar a = 0; a < Axes; a++) begin : gen_axis
    logic [FilterFrac+1:0] x;
    logic [Wide-1:0]       below, above;  // low - x - 1, x - high: not negative on that side of the box
    assign x     = x_q[a*(FilterFrac+2) +: FilterFrac+2];
    assign below = {3'b000, low_i[a*FilterFrac +: FilterFrac]} + ~{x[FilterFrac+1], x};
    assign above = {x[FilterFrac+1], x} - {3'b000, high_i[a*FilterFrac +: FilterFrac]};
    assign size_d[a*(FilterFrac+1) +: FilterFrac+1] = !below[Wide-1] ? below[FilterFrac:0]
                                                    : !above[Wide-1] ? above[FilterFrac:0] : '0;
    logic unused_high;
    assign unused_high = ^{below, above};
  end
  cuboct_planar #(
    .Axes(Axes), .FilterFrac(FilterFrac), .PlanarOne(PlanarOne), .PlanarTwo(PlanarTwo), .PlanarThree(PlanarThree)
  ) u_planar (.test_i(!none_2_q), .size_i(size_q), .near_o(near));
  always_ff @(posedge clk_i) begin
    if (valid_i) x_q <= x_i;
    if (valid_q[0]) size_q <= size_d;
    if (valid_q[1]) near_q <= near;
    known_2_q <= run_i;
    none_2_q  <= empty_i;
    known_3_q <= known_2_q;
  end

  assign valid_o = valid_q[2] && (!known_3_q || near_q == '1);
  assign end_o   = end_q[2];
endmodule
