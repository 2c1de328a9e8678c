// SPDX-License-Identifier: MIT
// From candidates to pairs: streamer, filter lanes, queue, issue. Every own particle meets every candidate that the
// planar test lets pass, once. Where halos are used on arrival their memories answer a cycle later, and so does all
// that is read beside them.
module cuboct_pair_finder #(
  parameter int          Axes            = 3,   // 2 or 3
  parameter int          Halos           = 6,   // segments behind the own particles', >= 1
  parameter int          Own             = 1,   // 1: own particles are a segment, the first
  parameter int          Arrival         = 0,   // 1: records may be read before their segment is complete
  parameter int          Rounds          = 1,   // above 1 a step's records may be walked again
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
  parameter int          CountBits       = 9,
  parameter int          Bonds           = 0,   // above 0 pairs are those whose candidate is a partner of the slot
  parameter int          IdBits          = 1,   // Bonds only
  parameter int          IdLsb           = 0,   // of the id in a candidate; Bonds only
  localparam int         LaneBits        = (Bonds > 0) ? Bonds * IdBits : Axes * FilterFrac,
  localparam int         Segments        = Halos + Own,
  localparam int         Most            = (Halos > 3) ? 6 : 3
) (
  input  logic                                  clk_i,
  input  logic                                  rst_ni,
  input  logic                                  run_i,
  input  logic                                  restart_i,
  input  logic [CountBits-1:0]                  own_count_i,  // own particles
  input  logic [Segments-1:0]                   complete_next_i,  // by segment: in the next cycle all records are
                                                              // there; not with restart_i, but for the first one
  input  logic [Halos-1:0]                      came_i,       // by segment behind the own ones: a record comes
  input  logic                                  again_i,      // with restart_i: the records are walked again
  input  logic [Halos*CountBits-1:0]            counts_i,     // with again_i: of records
  // Where the candidate is read: own slot, and record of the faces' halos, and a row of own positions. The memories
  // answer in the next cycle, and keep the answer until the next read.
  output logic [Segments-1:0]                   read_o,       // by segment: its memory is asked
  output logic [Segments-1:0]                   next_o,       // by segment, Arrival: what it answers is shown from the
                                                              // next cycle on
  output logic [SlotBits-1:0]                   slot_o,       // own, with read_o
  output logic [AddrBits-1:0]                   addr_o,       // of halos, with read_o
  input  logic [CandidateBits-1:0]              own_i,        // an own particle as a candidate
  input  logic [Halos*CandidateBits-1:0]        halos_i,      // by segment behind the own ones
  output logic                                  row_read_o,   // the row is asked for, unless it is the one before
  output logic [RowBits-1:0]                    row_o,        // row of own slots, with row_read_o
  input  logic [FilterLanes*LaneBits-1:0]       row_data_i,   // by lane, x lowest, or the partners' ids
  // Pairs.
  output logic [CandidateBits-1:0]              candidate_o,  // with issue_o
  output logic [ForcePipes-1:0]                 issue_o,      // per pipe: a pair
  output logic [ForcePipes*SlotBits-1:0]        issue_slot_o, // per pipe, with issue_o: its own slot
  output logic                                  present_o,    // a candidate and a row are asked for
  output logic                                  stall_o,      // a full queue holds the filter
  output logic                                  done_o        // no candidate is left anywhere
);
  logic [Segments-1:0]      pick;
  logic [Segments-1:0]      answer_q;  // which memory's answer is the candidate, one bit each
  logic [RowBits-1:0]       row, row_out, row_head;
  logic                     present, past, stall, filter_busy, issue_busy;
  // As the memories' answers come.
  logic [Segments-1:0]      read_pick;
  logic                     row_new, read_present, read_busy, read_row_new, read_goes_on;
  logic [RowBits-1:0]       read_row;
  logic [SlotBits-1:0]      read_slot;
  logic [CandidateBits-1:0] read_own;
  logic [FilterLanes*LaneBits-1:0] read_row_data;
  logic [CandidateBits-1:0] candidate, candidate_out, candidate_head;
  logic [FilterLanes-1:0]   mask_out, rest_out, rest_head;
  logic [ForcePipes-1:0]    valid_out, valid_head;  // first pairs of the mask
  logic [ForcePipes*SlotBits-1:0] lane_out, lane_head;
  logic                     push, pop, full, empty;

  cuboct_streamer #(
    .Segments(Segments), .Own(Own), .Arrival(Arrival), .Rounds(Rounds), .FilterLanes(FilterLanes), .RowBits(RowBits),
    .SlotBits(SlotBits), .AddrBits(AddrBits), .CountBits(CountBits)
  ) u_streamer (
    .clk_i, .rst_ni, .run_i, .restart_i, .stall_i(stall), .own_i(own_count_i), .complete_next_i, .came_i,
    .again_i, .counts_i, .pick_o(pick), .addr_o, .slot_o, .row_o(row), .present_o(present), .row_new_o(row_new),
    .past_o(past)
  );

  if (Arrival != 0) begin : gen_later
    logic                     present_q, row_new_q;
    logic [Segments-1:0]      pick_q;
    logic [RowBits-1:0]       row_q;
    logic [SlotBits-1:0]      slot_q;
    logic [CandidateBits-1:0] own_q;
    logic [FilterLanes*LaneBits-1:0] row_data_q;
    always_ff @(posedge clk_i) begin
      if (!rst_ni) present_q <= 1'b0;
      else if (!stall) present_q <= present;
    end
    always_ff @(posedge clk_i) begin
      if (present) begin
        pick_q    <= pick;
        row_q     <= row;
        row_new_q <= row_new;
        slot_q    <= slot_o;
      end
      if (next_o[0]) own_q <= own_i;
      if (read_goes_on && row_new_q) row_data_q <= row_data_i;
    end
    assign next_o        = pick_q & {Segments{read_goes_on}};
    assign read_row_new  = row_new_q;
    assign read_goes_on  = present_q && !stall;
    assign read_present  = present_q;
    assign read_busy     = present_q;
    assign read_pick     = pick_q;
    assign read_row      = row_q;
    assign read_slot     = slot_q;
    assign read_own      = own_q;
    assign read_row_data = row_data_q;
  end else begin : gen_at_once
    assign next_o        = '0;
    assign read_row_new  = row_new;
    assign read_goes_on  = present;
    assign read_present  = present;
    assign read_busy     = 1'b0;
    assign read_pick     = pick;
    assign read_row      = row;
    assign read_slot     = slot_o;
    assign read_own      = own_i;
    assign read_row_data = row_data_i;
  end
  always_ff @(posedge clk_i) begin
    if (read_goes_on) answer_q <= read_pick;
  end
  // By axis; records of x lie in small memories, of the others, but on arrival, in blocks that answer late.
  logic [3*CandidateBits-1:0] of_axis;
  integer f;
  always_comb begin
    of_axis = '0;
    if (Own != 0) of_axis[0 +: CandidateBits] = read_own & {CandidateBits{answer_q[0]}};
    for (f = 0; f < Halos; f = f + 1) begin
      of_axis[(f*3/Most)*CandidateBits +: CandidateBits] = of_axis[(f*3/Most)*CandidateBits +: CandidateBits]
        | (halos_i[f*CandidateBits +: CandidateBits] & {CandidateBits{answer_q[f+Own]}});
    end
  end
  if (Arrival == 0) begin : gen_late
    cuboct_late #(.Bits(CandidateBits)) u_late (
      .early_i(of_axis[0 +: CandidateBits]), .late_i(of_axis[CandidateBits +: CandidateBits]),
      .other_i(of_axis[2*CandidateBits +: CandidateBits]), .or_o(candidate)
    );
  end else begin : gen_registered
    assign candidate = of_axis[0 +: CandidateBits] | of_axis[CandidateBits +: CandidateBits]
                     | of_axis[2*CandidateBits +: CandidateBits];
  end

  cuboct_filter #(
    .Axes(Axes), .PositionFrac(PositionFrac), .FilterFrac(FilterFrac), .PlanarOne(PlanarOne),
    .PlanarTwo(PlanarTwo), .PlanarThree(PlanarThree), .CandidateBits(CandidateBits), .FilterLanes(FilterLanes),
    .RowBits(RowBits), .SlotBits(SlotBits), .CountBits(CountBits), .Bonds(Bonds), .IdBits(IdBits), .IdLsb(IdLsb)
  ) u_filter (
    .clk_i, .rst_ni, .present_i(read_present), .row_i(read_row), .row_new_i(read_row_new),
    .own_i((Own != 0) && read_pick[0]), .slot_i(read_slot), .own_count_i, .candidate_i(candidate),
    .row_data_i(read_row_data), .full_i(full), .stall_o(stall), .push_o(push), .candidate_o(candidate_out),
    .row_o(row_out), .mask_o(mask_out), .busy_o(filter_busy)
  );

  cuboct_split #(.FilterLanes(FilterLanes), .ForcePipes(ForcePipes), .SlotBits(SlotBits)) u_split (
    .mask_i(mask_out), .valid_o(valid_out), .lane_o(lane_out), .rest_o(rest_out)
  );
  cuboct_fifo #(
    .Bits(CandidateBits + RowBits + ForcePipes * (1 + SlotBits) + FilterLanes), .Depth(QueueDepth)
  ) u_queue (
    .clk_i, .rst_ni, .push_i(push), .data_i({candidate_out, row_out, valid_out, lane_out, rest_out}),
    .full_o(full),
    .pop_i(pop), .data_o({candidate_head, row_head, valid_head, lane_head, rest_head}), .empty_o(empty)
  );

  cuboct_issue #(
    .CandidateBits(CandidateBits), .FilterLanes(FilterLanes), .RowBits(RowBits), .SlotBits(SlotBits),
    .ForcePipes(ForcePipes), .Interval(Interval)
  ) u_issue (
    .clk_i, .rst_ni, .empty_i(empty), .candidate_i(candidate_head), .row_i(row_head), .valid_i(valid_head),
    .lane_i(lane_head), .rest_i(rest_head), .pop_o(pop), .candidate_o, .valid_o(issue_o),
    .slot_o(issue_slot_o), .busy_o(issue_busy)
  );

  assign stall_o   = stall;
  assign present_o = present;
  assign read_o     = pick & {Segments{present}};
  assign row_read_o = present && row_new;
  assign row_o      = row;
  assign done_o = past && !read_busy && !filter_busy && empty && !issue_busy;
  logic unused_own;
  assign unused_own = ^read_own;
endmodule
