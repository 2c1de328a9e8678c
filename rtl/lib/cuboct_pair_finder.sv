// SPDX-License-Identifier: MIT
// From candidates to pairs: streamer, filter lanes, queue, issue. Every own particle meets every candidate that the
// planar test lets pass, once.
module cuboct_pair_finder #(
  parameter int          Axes            = 3,   // 2 or 3
  parameter int          PositionFrac    = 20,
  parameter int          FilterFrac      = 8,
  parameter logic [63:0] PlanarOne       = 64'd0,
  parameter logic [63:0] PlanarTwo       = 64'd0,
  parameter logic [63:0] PlanarThree     = 64'd0,
  parameter int          CandidateBits   = 66,  // its position is least significant
  parameter int          FilterLanes     = 8,
  parameter int          ForcePipes      = 1,
  parameter int          Interval        = 1,   // cycles from one issue to the next
  parameter int          QueueDepth      = 16,
  parameter int          RowBits         = 1,
  parameter int          SlotBits        = 4,
  parameter int          AddrBits        = 8,
  parameter int          CountBits       = 9
) (
  input  logic                                  clk_i,
  input  logic                                  rst_ni,
  input  logic                                  run_i,
  input  logic                                  restart_i,
  input  logic [Axes:0]                         available_i,
  input  logic [(2*Axes+1)*CountBits-1:0]       counts_i,
  // Where the candidate is read: own slot, and record of the faces' halos, and a row of own positions. The memories
  // answer in the next cycle, and keep the answer until the next read.
  output logic                                  read_o,       // the memories are asked
  output logic [SlotBits-1:0]                   slot_o,       // own, with read_o
  output logic [AddrBits-1:0]                   addr_o,       // of halos, with read_o
  input  logic [CandidateBits-1:0]              own_i,        // an own particle as a candidate
  input  logic [2*Axes*CandidateBits-1:0]       halos_i,      // by face
  output logic [RowBits-1:0]                    row_o,        // row of own slots, with read_o
  input  logic [FilterLanes*Axes*FilterFrac-1:0] row_data_i,  // by lane, x lowest
  // Pairs.
  output logic [CandidateBits-1:0]              candidate_o,  // with issue_o
  output logic [ForcePipes-1:0]                 issue_o,      // per pipe: a pair
  output logic [ForcePipes*SlotBits-1:0]        issue_slot_o, // per pipe, with issue_o: its own slot
  output logic                                  present_o,    // a candidate and a row are asked for
  output logic                                  stall_o,      // a full queue holds the filter
  output logic                                  done_o        // no candidate is left anywhere
);
  logic [2*Axes:0]          pick;
  logic [2*Axes:0]          answer_q;  // which memory's answer is the candidate, one bit each
  logic [RowBits-1:0]       row, row_out, row_head;
  logic                     present, past, stall, filter_busy, issue_busy;
  logic [CandidateBits-1:0] candidate, candidate_out, candidate_head;
  logic [FilterLanes-1:0]   mask_out, mask_head;
  logic                     push, pop, full, empty;

  cuboct_streamer #(
    .Axes(Axes), .FilterLanes(FilterLanes), .RowBits(RowBits), .SlotBits(SlotBits), .AddrBits(AddrBits),
    .CountBits(CountBits)
  ) u_streamer (
    .clk_i, .rst_ni, .run_i, .restart_i, .stall_i(stall), .available_i, .counts_i,
    .pick_o(pick), .addr_o, .slot_o, .row_o(row), .present_o(present), .past_o(past)
  );

  always_ff @(posedge clk_i) begin
    if (read_o) answer_q <= pick;
  end
  integer f;
  always_comb begin
    candidate = own_i & {CandidateBits{answer_q[0]}};
    for (f = 0; f < 2 * Axes; f = f + 1) begin
      candidate = candidate | (halos_i[f*CandidateBits +: CandidateBits] & {CandidateBits{answer_q[f+1]}});
    end
  end

  cuboct_filter #(
    .Axes(Axes), .PositionFrac(PositionFrac), .FilterFrac(FilterFrac), .PlanarOne(PlanarOne),
    .PlanarTwo(PlanarTwo), .PlanarThree(PlanarThree), .CandidateBits(CandidateBits), .FilterLanes(FilterLanes),
    .RowBits(RowBits), .SlotBits(SlotBits), .CountBits(CountBits)
  ) u_filter (
    .clk_i, .rst_ni, .present_i(present), .row_i(row), .own_i(pick[0]),
    .slot_i(slot_o), .own_count_i(counts_i[0 +: CountBits]), .candidate_i(candidate), .row_data_i,
    .full_i(full), .stall_o(stall), .push_o(push), .candidate_o(candidate_out), .row_o(row_out),
    .mask_o(mask_out), .busy_o(filter_busy)
  );

  cuboct_fifo #(.Bits(CandidateBits + RowBits + FilterLanes), .Depth(QueueDepth)) u_queue (
    .clk_i, .rst_ni, .push_i(push), .data_i({candidate_out, row_out, mask_out}), .full_o(full),
    .pop_i(pop), .data_o({candidate_head, row_head, mask_head}), .empty_o(empty)
  );

  cuboct_issue #(
    .CandidateBits(CandidateBits), .FilterLanes(FilterLanes), .RowBits(RowBits), .SlotBits(SlotBits),
    .ForcePipes(ForcePipes), .Interval(Interval)
  ) u_issue (
    .clk_i, .rst_ni, .empty_i(empty), .candidate_i(candidate_head), .row_i(row_head), .mask_i(mask_head),
    .pop_o(pop), .candidate_o, .valid_o(issue_o), .slot_o(issue_slot_o), .busy_o(issue_busy)
  );

  assign stall_o   = stall;
  assign present_o = present;
  // Whatever they answer where no candidate is asked for, the filter does not take it; a stall is known earlier.
  assign read_o    = run_i && !stall;
  assign row_o     = row;
  assign done_o = past && !filter_busy && empty && !issue_busy;
endmodule
