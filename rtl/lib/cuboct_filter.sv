// SPDX-License-Identifier: MIT
// The filter: register F0 holds a candidate (in the memories' output registers) and a row, FilterLanes lanes test the
// candidate against the row's slots, register F1 holds the mask of those that may interact. Both keep their contents
// in a stalled cycle.
module cuboct_filter #(
  parameter int          Axes            = 3,   // 2 or 3
  parameter int          PositionFrac    = 20,
  parameter int          FilterFrac      = 8,   // leading bits of a position that the lanes test
  parameter logic [63:0] PlanarOne       = 64'd0,
  parameter logic [63:0] PlanarTwo       = 64'd0,
  parameter logic [63:0] PlanarThree     = 64'd0,
  parameter int          CandidateBits   = 66,  // a candidate; its position is least significant
  parameter int          FilterLanes     = 8,
  parameter int          RowBits         = 1,
  parameter int          SlotBits        = 4,
  parameter int          CountBits       = 8
) (
  input  logic                                clk_i,
  input  logic                                rst_ni,
  // From the streamer.
  input  logic                                present_i,
  input  logic [RowBits-1:0]                  row_i,
  input  logic                                own_i,         // the candidate is an own particle,
  input  logic [SlotBits-1:0]                 slot_i,        // of this slot
  input  logic [CountBits-1:0]                own_count_i,
  // Beside F0, from the memories: the candidate, and the row of own positions.
  input  logic [CandidateBits-1:0]            candidate_i,
  input  logic [FilterLanes*Axes*FilterFrac-1:0] row_data_i,
  // To the queue.
  input  logic                                full_i,
  output logic                                stall_o,
  output logic                                push_o,
  output logic [CandidateBits-1:0]            candidate_o,
  output logic [RowBits-1:0]                  row_f1_o,
  output logic [FilterLanes-1:0]              mask_o,
  output logic                                busy_o         // F0 or F1 holds something
);
  localparam int RowSlots = CountBits + $clog2(FilterLanes + 1);

  logic                     f0_valid_d, f0_valid_q, f0_own_q, f1_valid_d, f1_valid_q;
  logic [CandidateBits-1:0] f1_candidate_q;
  logic [RowBits-1:0]       f0_row_q, f1_row_q;
  logic [SlotBits-1:0]      f0_slot_q;
  logic [FilterLanes-1:0]   mask, f1_mask_q;
  logic                     wants_push;

  assign wants_push = f1_valid_q && (f1_mask_q != '0);
  assign stall_o    = wants_push && full_i;
  assign push_o     = wants_push && !full_i;
  assign f0_valid_d = stall_o ? f0_valid_q : present_i;
  assign f1_valid_d = stall_o ? f1_valid_q : f0_valid_q;

  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      f0_valid_q <= 1'b0;
      f1_valid_q <= 1'b0;
    end else begin
      f0_valid_q <= f0_valid_d;
      f1_valid_q <= f1_valid_d;
    end
  end
  always_ff @(posedge clk_i) begin
    if (present_i && !stall_o) begin
      f0_row_q  <= row_i;
      f0_own_q  <= own_i;
      f0_slot_q <= slot_i;
    end
    if (f0_valid_q && !stall_o) begin
      f1_candidate_q <= candidate_i;
      f1_row_q       <= f0_row_q;
      f1_mask_q      <= mask;
    end
  end

  logic [Axes*(FilterFrac+2)-1:0] coarse;
  for (genvar a = 0; a < Axes; a++) begin : gen_coarse
    assign coarse[a*(FilterFrac+2) +: FilterFrac+2]
      = candidate_i[a*(PositionFrac+2)+PositionFrac-FilterFrac +: FilterFrac+2];
  end

  for (genvar l = 0; l < FilterLanes; l++) begin : gen_lane
    localparam int Lane = l;
    logic [RowSlots-1:0] slot;
    logic                exists, itself;
    logic [((Axes == 3) ? 5 : 2)-1:0] near;
    assign mask[l] = (near == '1);
    assign slot   = {{(RowSlots - RowBits) {1'b0}}, f0_row_q} * FilterLanes[RowSlots-1:0] + Lane[RowSlots-1:0];
    assign exists = (slot < {{(RowSlots - CountBits) {1'b0}}, own_count_i});
    assign itself = f0_own_q && (slot == {{(RowSlots - SlotBits) {1'b0}}, f0_slot_q});
    cuboct_filter_lane #(
      .Axes(Axes), .FilterFrac(FilterFrac), .PlanarOne(PlanarOne), .PlanarTwo(PlanarTwo), .PlanarThree(PlanarThree)
    ) u_lane (
      .test_i(exists && !itself), .own_i(row_data_i[l*Axes*FilterFrac +: Axes*FilterFrac]), .candidate_i(coarse),
      .near_o(near)
    );
  end

  assign candidate_o = f1_candidate_q;
  assign row_f1_o    = f1_row_q;
  assign mask_o      = f1_mask_q;
  assign busy_o      = f0_valid_q || f1_valid_q;
endmodule
