// SPDX-License-Identifier: MIT
// The filter: register F0 holds a candidate (in the memories' output registers) and a row, F1 holds both once more, so
// that a memory's answer is chosen in one cycle and compared in the next; FilterLanes lanes test the candidate against
// the row's slots, through registers of their sizes, F2; register F3 holds the mask of those that may interact. All
// keep their contents in a stalled cycle.
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
  parameter int          CountBits       = 8,
  parameter int          Bonds           = 0,   // above 0 a lane tests whether the candidate's id is one of so many
  parameter int          IdBits          = 1,   // Bonds only
  parameter int          IdLsb           = 0,   // of the id in a candidate; Bonds only
  localparam int         LaneBits        = (Bonds > 0) ? Bonds * IdBits : Axes * FilterFrac
) (
  input  logic                                clk_i,
  input  logic                                rst_ni,
  // From the streamer.
  input  logic                                present_i,     // a candidate is asked for
  input  logic [RowBits-1:0]                  row_i,         // to meet this row of own slots
  input  logic                                row_new_i,     // with present_i: not that of the candidate before
  input  logic                                own_i,         // the candidate is an own particle,
  input  logic [SlotBits-1:0]                 slot_i,        // of this slot
  input  logic [CountBits-1:0]                own_count_i,   // own particles
  // Beside F0, from the memories: the candidate, and the row of own positions.
  input  logic [CandidateBits-1:0]            candidate_i,   // P+2 bits per axis, rest
  input  logic [FilterLanes*LaneBits-1:0]     row_data_i,    // by lane, x lowest, or the ids of bonds
  // To the queue.
  input  logic                                full_i,        // the queue can take nothing
  output logic                                stall_o,       // F0 ... F3 stay; so must the streamer
  output logic                                push_o,        // an entry goes to the queue
  output logic [CandidateBits-1:0]            candidate_o,   // with push_o
  output logic [RowBits-1:0]                  row_o,         // with push_o
  output logic [FilterLanes-1:0]              mask_o,        // with push_o: lanes that may interact
  output logic                                busy_o         // one of the registers holds something
);
  localparam int RowSlots = CountBits + $clog2(FilterLanes + 1);

  logic [3:0]               valid_d, valid_q;  // F0 ... F3
  logic                     f0_own_q, f0_row_new_q;
  logic [RowBits-1:0]       f0_row_q, f1_row_q, f2_row_q, f3_row_q;
  logic [SlotBits-1:0]      f0_slot_q;
  logic [CandidateBits-1:0] f1_candidate_q, f2_candidate_q, f3_candidate_q;
  logic [FilterLanes*LaneBits-1:0] f1_row_data_q;
  logic [FilterLanes-1:0]   test, f1_test_q, f2_test_q;  // lanes whose slot exists and is not the candidate itself
  logic [FilterLanes-1:0]   mask, f3_mask_q;
  logic                     wants_push;

  // Whether there is something to push is asked first of all in a cycle: two lanes each have said it before F3.
  localparam int Pairs = (FilterLanes + 1) / 2;
  logic [Pairs-1:0]       some_d, some_q;
  logic [FilterLanes-1:0] early, late;  // of a lane's mask: all of its tests but the last, and that one
  logic [2*Pairs-1:0]     all_early, all_late;
  always_comb begin
    all_early = '0;
    all_late  = '0;
    all_early[FilterLanes-1:0] = early;
    all_late[FilterLanes-1:0]  = late;
  end
  for (genvar p = 0; p < Pairs; p++) begin : gen_some
    cuboct_either u_some (
      .a_early_i(all_early[2*p]), .a_late_i(all_late[2*p]), .b_early_i(all_early[2*p+1]), .b_late_i(all_late[2*p+1]),
      .or_o(some_d[p])
    );
  end
  always_ff @(posedge clk_i) begin
    if (!rst_ni) some_q <= '0;
    else if (!stall_o) some_q <= some_d;
  end
  assign wants_push = (some_q != '0);
  assign stall_o    = wants_push && full_i;
  assign push_o     = wants_push && !full_i;
  assign valid_d    = stall_o ? valid_q : {valid_q[2:0], present_i};

  always_ff @(posedge clk_i) begin
    if (!rst_ni) valid_q <= '0;
    else valid_q <= valid_d;
  end
  logic [3:1] load;  // F1 ... F3 take what the register before them holds
  assign load = valid_q[2:0] & {3{!stall_o}};
  always_ff @(posedge clk_i) begin
    if (!stall_o) begin
      f0_row_q       <= row_i;
      f0_row_new_q   <= row_new_i;
      f0_own_q       <= own_i;
      f0_slot_q      <= slot_i;
    end
    if (load[1]) begin
      f1_row_q       <= f0_row_q;
      f1_test_q      <= test;
      f1_candidate_q <= candidate_i;
    end
    if (load[1] && f0_row_new_q) f1_row_data_q <= row_data_i;
    if (load[2]) begin
      f2_row_q       <= f1_row_q;
      f2_test_q      <= f1_test_q;
      f2_candidate_q <= f1_candidate_q;
    end
    if (load[3]) begin
      f3_row_q       <= f2_row_q;
      f3_mask_q      <= mask;
      f3_candidate_q <= f2_candidate_q;
    end
  end

  logic [Axes*(FilterFrac+2)-1:0] coarse;
  for (genvar a = 0; a < Axes; a++) begin : gen_coarse
    assign coarse[a*(FilterFrac+2) +: FilterFrac+2]
      = f1_candidate_q[a*(PositionFrac+2)+PositionFrac-FilterFrac +: FilterFrac+2];
  end

  for (genvar l = 0; l < FilterLanes; l++) begin : gen_lane
    localparam int Lane = l;
    logic [RowSlots-1:0] slot;
    logic                exists, itself;
    assign slot   = {{(RowSlots - RowBits) {1'b0}}, f0_row_q} * FilterLanes[RowSlots-1:0] + Lane[RowSlots-1:0];
    assign exists = (slot < {{(RowSlots - CountBits) {1'b0}}, own_count_i});
    assign itself = f0_own_q && (slot == {{(RowSlots - SlotBits) {1'b0}}, f0_slot_q});
    assign test[l] = exists && !itself;
    if (Bonds > 0) begin : gen_bonds
      logic [Bonds-1:0] met_d, met_q;
      for (genvar k = 0; k < Bonds; k++) begin : gen_place
        assign met_d[k] = (f1_row_data_q[l*LaneBits+k*IdBits +: IdBits] == f1_candidate_q[IdLsb +: IdBits]);
      end
      always_ff @(posedge clk_i) begin
        if (load[2]) met_q <= met_d;
      end
      assign mask[l]  = f2_test_q[l] && (met_q != '0);
      assign early[l] = valid_q[2];
      assign late[l]  = mask[l];
    end else begin : gen_planar
      localparam int Tests = (Axes == 3) ? 5 : 2;
      logic [Tests-1:0] near;  // the last one is of the longest sum
      assign mask[l]  = (near == '1);
      assign early[l] = valid_q[2] && (near[Tests-2:0] == '1);
      assign late[l]  = near[Tests-1];
      cuboct_filter_lane #(
        .Axes(Axes), .FilterFrac(FilterFrac), .PlanarOne(PlanarOne), .PlanarTwo(PlanarTwo), .PlanarThree(PlanarThree),
        .Registered(1)
      ) u_lane (
        .clk_i, .en_i(load[2]), .test_i(f2_test_q[l]), .own_i(f1_row_data_q[l*Axes*FilterFrac +: Axes*FilterFrac]),
        .candidate_i(coarse), .near_o(near)
      );
    end
  end

  if (Bonds > 0) begin : gen_no_coarse
    logic unused_coarse;
    assign unused_coarse = ^coarse;
  end
  assign candidate_o = f3_candidate_q;
  assign row_o       = f3_row_q;
  assign mask_o      = f3_mask_q;
  assign busy_o      = (valid_q != '0);
endmodule
