// SPDX-License-Identifier: MIT
// Between queue and pipes: the register `current` holds one queue entry; each cycle the ForcePipes lowest bits of its
// mask are issued, the lowest to pipe 0. When no bit remains the oldest entry of the queue follows without a gap.
module cuboct_issue #(
  parameter int CandidateBits = 66,
  parameter int FilterLanes   = 8,  // bits of the mask
  parameter int RowBits       = 1,
  parameter int SlotBits      = 4,
  parameter int ForcePipes    = 1
) (
  input  logic                           clk_i,
  input  logic                           rst_ni,
  // The head of the queue.
  input  logic                           empty_i,
  input  logic [CandidateBits-1:0]       candidate_i,
  input  logic [RowBits-1:0]             row_i,
  input  logic [FilterLanes-1:0]         mask_i,
  output logic                           pop_o,
  // To the pipes: the candidate, and per pipe the own slot that it meets.
  output logic [CandidateBits-1:0]       candidate_o,
  output logic [ForcePipes-1:0]          valid_o,
  output logic [ForcePipes*SlotBits-1:0] slot_o,
  output logic                           busy_o
);
  logic [CandidateBits-1:0] candidate_q;
  logic [RowBits-1:0]       row_q;
  logic [FilterLanes-1:0]   mask_d, mask_q;
  logic [FilterLanes-1:0]   rest [0:ForcePipes];  // what the pipes before this one left

  assign rest[0] = mask_q;
  for (genvar f = 0; f < ForcePipes; f++) begin : gen_pipe
    localparam int LaneBits = $clog2(FilterLanes + 1);
    logic [FilterLanes-1:0] lowest;
    logic [LaneBits-1:0]    lane [0:FilterLanes];
    logic [SlotBits-1:0]    row_base, lane_slot;
    assign lowest    = rest[f] & (~rest[f] + 1'b1);
    assign rest[f+1] = rest[f] & ~lowest;
    assign lane[0]   = '0;
    for (genvar l = 0; l < FilterLanes; l++) begin : gen_lane
      localparam int Lane = l;
      assign lane[l+1] = lane[l] | (lowest[l] ? Lane[LaneBits-1:0] : '0);
    end
    if (RowBits > SlotBits) begin : gen_narrow
      assign row_base = row_q[SlotBits-1:0] * FilterLanes[SlotBits-1:0];
    end else begin : gen_wide
      assign row_base = {{(SlotBits - RowBits) {1'b0}}, row_q} * FilterLanes[SlotBits-1:0];
    end
    if (LaneBits > SlotBits) begin : gen_lane_cut
      logic unused_lane;
      assign lane_slot   = lane[FilterLanes][SlotBits-1:0];
      assign unused_lane = ^lane[FilterLanes];
    end else begin : gen_lane_pad
      assign lane_slot = {{(SlotBits - LaneBits) {1'b0}}, lane[FilterLanes]};
    end
    assign valid_o[f]                       = (rest[f] != '0);
    assign slot_o[f*SlotBits +: SlotBits] = row_base + lane_slot;
  end

  assign pop_o  = (rest[ForcePipes] == '0) && !empty_i;
  assign mask_d = pop_o ? mask_i : rest[ForcePipes];
  always_ff @(posedge clk_i) begin
    if (!rst_ni) mask_q <= '0;
    else mask_q <= mask_d;
  end
  always_ff @(posedge clk_i) begin
    if (pop_o) begin
      candidate_q <= candidate_i;
      row_q       <= row_i;
    end
  end

  assign candidate_o = candidate_q;
  assign busy_o      = (mask_q != '0);
endmodule
