// SPDX-License-Identifier: MIT
// From the cells of a brick to pairs, as cuboct_pair_finder does it for one cell. A candidate is what the filter, the
// queue and the pipes carry: position in the own cell's frame, what the rule needs of type and v, the own cell's
// number.
module cuboct_brick_finder #(
  parameter int          Axes            = 3,   // 2 or 3
  parameter int          BrickX          = 2,
  parameter int          BrickY          = 2,
  parameter int          GridBits        = 2,
  parameter int          CellBits        = 3,
  parameter int          TagBits         = 4,
  parameter int          Capacity        = 16,
  parameter int          PositionFrac    = 20,
  parameter int          FilterFrac      = 8,
  parameter logic [63:0] PlanarOne       = 64'd0,
  parameter logic [63:0] PlanarTwo       = 64'd0,
  parameter logic [63:0] PlanarThree     = 64'd0,
  parameter int          HaloBits        = 60,  // of a record: x, y, z and the rest
  parameter int          FilterLanes     = 8,
  parameter int          ForcePipes      = 1,
  parameter int          Interval        = 1,   // cycles from one issue to the next
  parameter int          QueueDepth      = 16,
  parameter int          RowBits         = 1,   // of a row's number in a cell
  parameter int          RowAddrBits     = 4,
  parameter int          SlotBits        = 4,
  parameter int          OwnAddrBits     = 7,   // cell * Capacity + slot
  parameter int          HaloAddrBits    = 8,   // cell of a layer * Capacity + record
  parameter int          CountBits       = 5,
  localparam int         Faces           = 2 * Axes,
  localparam int         CandidateBits   = HaloBits + 2 * Axes  // with signs, but without the own cell
) (
  input  logic                                  clk_i,
  input  logic                                  rst_ni,
  input  logic                                  run_i,
  input  logic                                  restart_i,
  input  logic [Axes:0]                         available_i,
  input  logic [Faces-1:0]                      has_link_i,
  input  logic [3*GridBits-1:0]                 extent_i,
  // Counts, without latency.
  output logic [CellBits-1:0]                   own_cell_o,   // own cell
  input  logic [CountBits-1:0]                  own_count_i,  // its particles
  output logic [CellBits-1:0]                   near_cell_o,  // cell around, if an own one
  input  logic [CountBits-1:0]                  near_count_i, // its particles
  output logic [3*TagBits-1:0]                  near_layer_o, // the same in the layers over x, y, z
  input  logic [Faces*CountBits-1:0]            layer_count_i,  // by face, its records
  // Where the record is read: own ones, halos by axis; and a row of own positions. The memories answer in the next
  // cycle, and keep the answer until the next read.
  output logic                                  read_o,       // a record and a row are asked for
  output logic [OwnAddrBits-1:0]                own_addr_o,   // with read_o
  output logic [3*HaloAddrBits-1:0]             halo_addr_o,  // by axis, with read_o
  input  logic [HaloBits-1:0]                   own_i,        // an own particle
  input  logic [Faces*HaloBits-1:0]             halos_i,      // by face
  output logic [RowAddrBits-1:0]                row_o,        // with read_o
  input  logic [FilterLanes*Axes*FilterFrac-1:0] row_data_i,  // by lane, x lowest
  // Pairs.
  output logic [CandidateBits-1:0]              candidate_o,  // with issue_o
  output logic [CellBits-1:0]                   cell_o,       // the own cell
  output logic [ForcePipes-1:0]                 issue_o,      // per pipe: a pair
  output logic [ForcePipes*SlotBits-1:0]        issue_slot_o, // per pipe, with issue_o: its own slot
  output logic                                  meet_o,       // a candidate is presented
  output logic                                  stall_o,      // a full queue holds the filter
  output logic                                  done_o        // no candidate is left anywhere
);
  localparam int Rows     = (Capacity + FilterLanes - 1) / FilterLanes;
  localparam int Axis     = PositionFrac + 2;
  localparam int AllBits  = CandidateBits + CellBits;
  localparam int RestBits = HaloBits - Axes * PositionFrac;

  logic [2:0]               segment;
  logic [SlotBits-1:0]      record;
  logic [2*Axes-1:0]        offset, offset_q;
  logic [Faces:0]           answer_q;  // which memory's answer is the candidate, one bit each
  logic [CellBits-1:0]      cell_q;
  logic [CountBits-1:0]     count_q;   // of the own cell; 0 where nobody meets
  logic [RowBits-1:0]       row, row_out, row_head;
  logic                     present, nobody, same, past, stall, filter_busy, issue_busy;
  logic [HaloBits-1:0]      record_word;
  logic [AllBits-1:0]       candidate, candidate_out, candidate_head, candidate_now;
  logic [FilterLanes-1:0]   mask_out, rest_out, rest_head;
  logic [ForcePipes-1:0]    valid_out, valid_head;  // first pairs of the mask
  logic [ForcePipes*SlotBits-1:0] lane_out, lane_head;
  logic                     push, pop, full, empty;

  cuboct_brick_streamer #(
    .Axes(Axes), .BrickX(BrickX), .BrickY(BrickY), .GridBits(GridBits), .CellBits(CellBits),
    .TagBits(TagBits), .FilterLanes(FilterLanes), .RowBits(RowBits), .SlotBits(SlotBits), .CountBits(CountBits)
  ) u_streamer (
    .clk_i, .rst_ni, .run_i, .restart_i, .stall_i(stall), .available_i, .has_link_i, .extent_i, .own_cell_o,
    .own_count_i, .near_cell_o, .near_count_i, .near_layer_o, .layer_count_i, .segment_o(segment), .record_o(record),
    .row_o(row), .offset_o(offset), .same_o(same), .present_o(present), .nobody_o(nobody), .past_o(past)
  );

  cuboct_brick_addr #(
    .Factor(Capacity), .CellBits(CellBits), .SlotBits(SlotBits), .AddrBits(OwnAddrBits)
  ) u_own_addr (.cell_i(near_cell_o), .slot_i(record), .addr_o(own_addr_o));
  for (genvar a = 0; a < 3; a++) begin : gen_addr
    cuboct_brick_addr #(
      .Factor(Capacity), .CellBits(TagBits), .SlotBits(SlotBits), .AddrBits(HaloAddrBits)
    ) u_halo_addr (
      .cell_i(near_layer_o[a*TagBits +: TagBits]), .slot_i(record), .addr_o(halo_addr_o[a*HaloAddrBits +: HaloAddrBits])
    );
  end
  cuboct_brick_addr #(
    .Factor(Rows), .CellBits(CellBits), .SlotBits(RowBits), .AddrBits(RowAddrBits)
  ) u_row_addr (.cell_i(own_cell_o), .slot_i(row), .addr_o(row_o));
  always_ff @(posedge clk_i) begin
    if (present) begin
      answer_q <= {{Faces{1'b0}}, 1'b1} << segment;
      offset_q <= offset;
      cell_q   <= own_cell_o;
      count_q  <= nobody ? '0 : own_count_i;
    end
  end
  integer f;
  always_comb begin
    record_word = own_i & {HaloBits{answer_q[0]}};
    for (f = 0; f < Faces; f = f + 1) begin
      record_word = record_word | (halos_i[f*HaloBits +: HaloBits] & {HaloBits{answer_q[f+1]}});
    end
  end
  // 2^P further along an axis: the offset stands above the P bits in the record's own cell.
  for (genvar a = 0; a < Axes; a++) begin : gen_axis
    assign candidate[a*Axis +: Axis] = {offset_q[2*a +: 2], record_word[a*PositionFrac +: PositionFrac]};
  end
  if (RestBits > 0) begin : gen_rest
    assign candidate[Axes*Axis +: RestBits] = record_word[HaloBits-1 -: RestBits];
  end
  assign candidate[CandidateBits +: CellBits] = cell_q;

  cuboct_filter #(
    .Axes(Axes), .PositionFrac(PositionFrac), .FilterFrac(FilterFrac), .PlanarOne(PlanarOne),
    .PlanarTwo(PlanarTwo), .PlanarThree(PlanarThree), .CandidateBits(AllBits), .FilterLanes(FilterLanes),
    .RowBits(RowBits), .SlotBits(SlotBits), .CountBits(CountBits)
  ) u_filter (
    .clk_i, .rst_ni, .present_i(present), .row_i(row), .row_new_i(1'b1), .own_i(same), .slot_i(record),
    .own_count_i(count_q), .candidate_i(candidate), .row_data_i, .full_i(full), .stall_o(stall), .push_o(push),
    .candidate_o(candidate_out), .row_o(row_out), .mask_o(mask_out), .busy_o(filter_busy)
  );

  cuboct_split #(.FilterLanes(FilterLanes), .ForcePipes(ForcePipes), .SlotBits(SlotBits)) u_split (
    .mask_i(mask_out), .valid_o(valid_out), .lane_o(lane_out), .rest_o(rest_out)
  );
  cuboct_fifo #(
    .Bits(AllBits + RowBits + ForcePipes * (1 + SlotBits) + FilterLanes), .Depth(QueueDepth)
  ) u_queue (
    .clk_i, .rst_ni, .push_i(push), .data_i({candidate_out, row_out, valid_out, lane_out, rest_out}),
    .full_o(full),
    .pop_i(pop), .data_o({candidate_head, row_head, valid_head, lane_head, rest_head}), .empty_o(empty)
  );

  cuboct_issue #(
    .CandidateBits(AllBits), .FilterLanes(FilterLanes), .RowBits(RowBits), .SlotBits(SlotBits),
    .ForcePipes(ForcePipes), .Interval(Interval)
  ) u_issue (
    .clk_i, .rst_ni, .empty_i(empty), .candidate_i(candidate_head), .row_i(row_head), .valid_i(valid_head),
    .lane_i(lane_head), .rest_i(rest_head), .pop_o(pop), .candidate_o(candidate_now), .valid_o(issue_o),
    .slot_o(issue_slot_o), .busy_o(issue_busy)
  );

  assign candidate_o = candidate_now[CandidateBits-1:0];
  assign cell_o      = candidate_now[CandidateBits +: CellBits];
  assign meet_o      = present && !nobody;
  assign stall_o     = stall;
  assign read_o      = present;
  assign done_o      = past && !filter_busy && empty && !issue_busy;
endmodule
