// SPDX-License-Identifier: MIT
// Between queue and pipes: the register `current` holds one queue entry; every Interval cycles the ForcePipes lowest
// bits of its mask are issued, the lowest to pipe 0. When no bit remains the oldest entry of the queue follows without
// a gap. What is issued comes from registers, as pipes read the slots' memories with it: an entry's first pairs are
// chosen before the queue, the others a cycle ahead.
module cuboct_issue #(
  parameter int CandidateBits = 66, // of a candidate
  parameter int FilterLanes   = 8,  // bits of the mask
  parameter int RowBits       = 1,
  parameter int SlotBits      = 4,
  parameter int ForcePipes    = 1,
  parameter int Interval      = 1   // cycles from one issue to the next, >= 1
) (
  input  logic                           clk_i,
  input  logic                           rst_ni,
  // The head of the queue.
  input  logic                           empty_i,                           // there is none
  input  logic [CandidateBits-1:0]       candidate_i,                       // without empty_i
  input  logic [RowBits-1:0]             row_i,                             // without empty_i
  // Its mask, as cuboct_split has it; without empty_i.
  input  logic [ForcePipes-1:0]          valid_i,                           // the first pairs, at least one
  input  logic [ForcePipes*SlotBits-1:0] lane_i,                            // with valid_i
  input  logic [FilterLanes-1:0]         rest_i,                            // the bits above
  output logic                           pop_o,                             // it is taken
  // To the pipes: the candidate, and per pipe the own slot that it meets.
  output logic [CandidateBits-1:0]       candidate_o,                       // with valid_o
  output logic [ForcePipes-1:0]          valid_o,                           // per pipe: a pair
  output logic [ForcePipes*SlotBits-1:0] slot_o,                            // with valid_o
  output logic                           busy_o                             // current holds an entry
);
  logic [CandidateBits-1:0]       candidate_q;
  logic [RowBits-1:0]             row_q;
  logic [ForcePipes-1:0]          valid_d, valid_q, rest_valid;
  logic [ForcePipes*SlotBits-1:0] slot_d, slot_q, lane, rest_lane;
  logic [FilterLanes-1:0]         rest_d, rest_q, rest_rest;  // behind the pairs of this cycle; of the next one
  logic                           none_d, none_q;             // rest_q is 0
  logic [RowBits-1:0]             row;
  logic [SlotBits-1:0]            row_base;
  logic                           first, last;                // cycle of an interval

  // Whatever follows is chosen a cycle ahead: from the queue's head, or from the rest of this entry.
  cuboct_split #(.FilterLanes(FilterLanes), .ForcePipes(ForcePipes), .SlotBits(SlotBits)) u_split (
    .mask_i(rest_q), .valid_o(rest_valid), .lane_o(rest_lane), .rest_o(rest_rest)
  );
  assign row      = pop_o ? row_i : row_q;
  assign lane     = pop_o ? lane_i : rest_lane;
  assign row_base = {{(SlotBits - RowBits) {1'b0}}, row} * FilterLanes[SlotBits-1:0];
  assign valid_d  = pop_o ? valid_i : rest_valid;
  assign rest_d   = pop_o ? rest_i : rest_rest;
  assign none_d   = (rest_d == '0);
  for (genvar f = 0; f < ForcePipes; f++) begin : gen_slot
    assign slot_d[f*SlotBits +: SlotBits] = row_base + lane[f*SlotBits +: SlotBits];
  end

  if (Interval == 1) begin : gen_every_cycle
    assign first = 1'b1;
    assign last  = 1'b1;
  end else begin : gen_interval
    localparam int PhaseBits = $clog2(Interval);
    localparam int Last      = Interval - 1;
    logic [PhaseBits-1:0] phase_d, phase_q;
    assign first   = (phase_q == '0);
    assign last    = (phase_q == Last[PhaseBits-1:0]) || !valid_q[0];
    assign phase_d = last ? '0 : phase_q + 1'b1;
    always_ff @(posedge clk_i) begin
      if (!rst_ni) phase_q <= '0;
      else phase_q <= phase_d;
    end
  end

  assign pop_o = last && none_q && !empty_i;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      valid_q <= '0;
      rest_q  <= '0;
      none_q  <= 1'b1;
    end else if (last) begin
      valid_q <= valid_d;
      rest_q  <= rest_d;
      none_q  <= none_d;
    end
  end
  always_ff @(posedge clk_i) begin
    if (last) slot_q <= slot_d;
    if (pop_o) begin
      candidate_q <= candidate_i;
      row_q       <= row_i;
    end
  end

  assign candidate_o = candidate_q;
  assign valid_o     = valid_q & {ForcePipes{first}};
  assign slot_o      = slot_q;
  assign busy_o      = valid_q[0];
endmodule
