// SPDX-License-Identifier: MIT
// Between queue and pipes: the register `current` holds one queue entry; every Interval cycles the ForcePipes lowest
// bits of its mask are issued, the lowest to pipe 0. When no bit remains the oldest entry of the queue follows without
// a gap.
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
  input  logic [FilterLanes-1:0]         mask_i,                            // without empty_i; not 0
  output logic                           pop_o,                             // it is taken
  // To the pipes: the candidate, and per pipe the own slot that it meets.
  output logic [CandidateBits-1:0]       candidate_o,                       // with valid_o
  output logic [ForcePipes-1:0]          valid_o,                           // per pipe: a pair
  output logic [ForcePipes*SlotBits-1:0] slot_o,                            // with valid_o
  output logic                           busy_o                             // current holds an entry
);
  logic [CandidateBits-1:0] candidate_q;
  logic [RowBits-1:0]       row_q;
  logic [FilterLanes-1:0]   mask_d, mask_q;
  logic [FilterLanes-1:0]   rest, below, lowest;  // what the pipes before leave; bits above its lowest; that
  logic [SlotBits-1:0]      row_base;
  logic                     first, last;   // cycle of an interval

  // The lane whose bit is set. A slot's number needs no more bits: lanes beyond the last slot never pass.
  function automatic logic [SlotBits-1:0] lane_of(input logic [FilterLanes-1:0] onehot);
    integer l;
    begin
      lane_of = '0;
      for (l = 0; l < FilterLanes; l = l + 1) begin
        if (onehot[l]) lane_of = l[SlotBits-1:0];
      end
    end
  endfunction

  assign row_base = {{(SlotBits - RowBits) {1'b0}}, row_q} * FilterLanes[SlotBits-1:0];
  integer f, k;
  always_comb begin
    rest    = mask_q;
    lowest  = '0;
    below   = '0;
    valid_o = '0;
    slot_o  = '0;
    for (f = 0; f < ForcePipes; f = f + 1) begin
      for (k = 1; k < FilterLanes; k = k + 1) below[k] = below[k-1] || rest[k-1];
      lowest                          = rest & ~below;
      valid_o[f]                      = first && (rest != '0);
      slot_o[f*SlotBits +: SlotBits] = row_base + lane_of(lowest);
      rest                            = rest & below;
    end
  end

  if (Interval == 1) begin : gen_every_cycle
    assign first = 1'b1;
    assign last  = 1'b1;
  end else begin : gen_interval
    localparam int PhaseBits = $clog2(Interval);
    localparam int Last      = Interval - 1;
    logic [PhaseBits-1:0] phase_d, phase_q;
    assign first   = (phase_q == '0);
    assign last    = (phase_q == Last[PhaseBits-1:0]) || (mask_q == '0);
    assign phase_d = last ? '0 : phase_q + 1'b1;
    always_ff @(posedge clk_i) begin
      if (!rst_ni) phase_q <= '0;
      else phase_q <= phase_d;
    end
  end

  assign pop_o  = last && (rest == '0) && !empty_i;
  assign mask_d = pop_o ? mask_i : last ? rest : mask_q;
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
