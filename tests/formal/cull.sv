// SPDX-License-Identifier: MIT
// cuboct_cull with a box of any size and a stream of records, one watched: three cycles after it came it passes,
// unchanged, if the step had not begun or the test lets it through, else it does not; ends come three cycles later. The
// test is told here by magnitudes: of the box's nearest point. And it drops no record that cuboct_filter_lane would
// find near any particle inside the box.
module cull_formal #(
  parameter int Axes        = 2,
  parameter int FilterFrac  = 3,
  parameter int PlanarOne   = 4,
  parameter int PlanarTwo   = 6,
  parameter int PlanarThree = 7,
  parameter int HaloBits    = 2
) (
  input logic                           clk_i,
  input logic                           begin_i,  // the step begins,
  input logic                           over_i,   // is over
  input logic                           clear_i,  // of a box between steps
  input logic [Axes*FilterFrac-1:0]     low_i, high_i,
  input logic                           empty_i,
  input logic                           valid_i,
  input logic                           end_i,
  input logic [HaloBits-1:0]            halo_i,
  input logic [Axes*(FilterFrac+2)-1:0] x_i,
  input logic                           watch_i   // the record that comes now is the watched one
);
  localparam int Bits  = FilterFrac + 6;
  localparam int Tests = (Axes == 3) ? 5 : 2;

  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;

  // The box stays while the step is run.
  logic                       run_q, empty_q;
  logic [Axes*FilterFrac-1:0] low_q, high_q;
  always_ff @(posedge clk_i) begin
    if (!running_q) run_q <= 1'b0;
    else run_q <= run_q ? !over_i : begin_i;
    if (!running_q || (!run_q && clear_i)) begin
      low_q   <= low_i;
      high_q  <= high_i;
      empty_q <= empty_i;
    end
  end
  // A particle anywhere in it.
  (* anyconst *) logic [Axes*FilterFrac-1:0] inside;
  integer i;
  always_comb begin
    if (!running_q) assume (!valid_i && !end_i);
    if (valid_i) assume (!end_i);
    // Records come from neighbouring cells: -2^F <= x < 2^(F+1).
    for (i = 0; i < Axes; i = i + 1) begin
      assume (x_i[i*(FilterFrac+2)+FilterFrac +: 2] != 2'b10);
      assume (low_i[i*FilterFrac +: FilterFrac] <= high_i[i*FilterFrac +: FilterFrac]);
    end
  end

  logic                valid, last;
  logic [HaloBits-1:0] halo;
  cuboct_cull #(
    .Axes(Axes), .FilterFrac(FilterFrac), .PlanarOne(PlanarOne), .PlanarTwo(PlanarTwo), .PlanarThree(PlanarThree),
    .HaloBits(HaloBits)
  ) u_dut (
    .clk_i, .rst_ni(running_q), .run_i(run_q), .empty_i(empty_q), .low_i(low_q), .high_i(high_q), .valid_i, .halo_i,
    .x_i, .end_i, .valid_o(valid), .halo_o(halo), .end_o(last)
  );

  // The watched record: where it is, and what shall become of it, with the box a cycle after it came.
  logic [2:0]                     place_q, held_q, ends_q;
  logic                           watched_q, expected_q, in_box, met_q;
  logic [HaloBits-1:0]            halo_q;
  logic [Axes*(FilterFrac+2)-1:0] x_q;
  logic [3*Bits-1:0]              sizes;  // nothing along an axis that is not there
  logic [Axes-1:0]                within;
  for (genvar a = 0; a < 3; a++) begin : gen_axis
    if (a < Axes) begin : gen_size
      logic signed [Bits-1:0] position, least, most;
      assign position = $signed({{(Bits - FilterFrac - 2) {x_q[a*(FilterFrac+2)+FilterFrac+1]}},
                                 x_q[a*(FilterFrac+2) +: FilterFrac+2]});
      assign least    = $signed({{(Bits - FilterFrac) {1'b0}}, low_q[a*FilterFrac +: FilterFrac]});
      assign most     = $signed({{(Bits - FilterFrac) {1'b0}}, high_q[a*FilterFrac +: FilterFrac]});
      assign sizes[a*Bits +: Bits] = (position < least) ? least - position - 1
                                 : (position > most) ? position - most : '0;
      assign within[a] = inside[a*FilterFrac +: FilterFrac] >= low_q[a*FilterFrac +: FilterFrac]
                      && inside[a*FilterFrac +: FilterFrac] <= high_q[a*FilterFrac +: FilterFrac];
    end else begin : gen_none
      assign sizes[a*Bits +: Bits] = '0;
    end
  end
  logic [Bits-1:0] x, y, z;
  logic            near;
  assign x      = sizes[0 +: Bits];
  assign y      = sizes[Bits +: Bits];
  assign z      = sizes[2*Bits +: Bits];
  assign near   = x <= PlanarOne && y <= PlanarOne && z <= PlanarOne && x + y <= PlanarTwo && y + z <= PlanarTwo
                  && z + x <= PlanarTwo && x + y + z <= PlanarThree;
  assign in_box = (within == '1) && !empty_q;

  logic [Tests-1:0] tests;
  cuboct_filter_lane #(
    .Axes(Axes), .FilterFrac(FilterFrac), .PlanarOne(PlanarOne), .PlanarTwo(PlanarTwo), .PlanarThree(PlanarThree)
  ) u_lane (.clk_i, .en_i(1'b0), .test_i(in_box), .own_i(inside), .candidate_i(x_q), .near_o(tests));

  always_ff @(posedge clk_i) begin
    if (!running_q) begin
      watched_q <= 1'b0;
      place_q   <= '0;
      held_q    <= '0;
      ends_q    <= '0;
    end else begin
      place_q <= {place_q[1:0], valid_i && watch_i && !watched_q};
      held_q  <= {held_q[1:0], valid_i};
      ends_q  <= {ends_q[1:0], end_i};
      if (valid_i && watch_i && !watched_q) begin
        watched_q <= 1'b1;
        halo_q    <= halo_i;
        x_q       <= x_i;
      end
    end
    if (place_q[0]) begin
      expected_q <= !run_q || (!empty_q && near);
      met_q      <= (tests == '1);  // the particle in the box and the record would be a pair to look at
    end
  end
  always_ff @(posedge clk_i) begin
    if (running_q) begin
      a_end: assert (last == ends_q[2]);
      if (valid) a_held: assert (held_q[2]);
      if (place_q[2]) begin
        a_passes: assert (valid == expected_q);
        if (met_q) a_keeps: assert (valid);
        if (valid) a_same: assert (halo == halo_q);
      end
      c_culled: cover (place_q[2] && !valid && !empty_q);
      c_met:    cover (place_q[2] && valid && met_q && run_q && x != '0 && y != '0);
      c_before: cover (place_q[2] && valid && !near && run_q && x_q[FilterFrac+1]);
      c_none:   cover (place_q[2] && !valid && near && empty_q);
    end
  end
endmodule
