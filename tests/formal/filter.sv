// SPDX-License-Identifier: MIT
// cuboct_filter with its lanes: each presented candidate reaches the queue once, in order and unchanged, with
// the mask of the own slots of its row that exist, are not itself and pass the planar test; or not at all if
// there is none. A full queue stalls it and loses nothing. The memories answer a cycle after the presentation
// and keep the answer while it stalls. The test is told here by integers. Bonds: instead of the planar test, one of the
// partners of the slot's row of bonds is the candidate.
module filter_formal #(
  parameter int Axes            = 2,
  parameter int PositionFrac    = 3,
  parameter int FilterFrac      = 2,
  parameter int FilterLanes     = 2,
  parameter int PlanarOne       = 4,
  parameter int PlanarTwo       = 6,
  parameter int PlanarThree     = 7,
  parameter int Bonds           = 0   // places of a row of bonds
) (
  input logic                               clk_i,
  input logic                               present_i,
  input logic [Axes*(PositionFrac+2):0]     candidate_i,  // and one bit of the rest
  input logic                               row_i,
  input logic                               row_new_i,     // it may not be that of the candidate before
  input logic                               own_i,
  input logic [2:0]                         slot_i,
  input logic                               full_i,
  input logic                               watch_i       // the watched candidate is the one presented now
);
  localparam int IdBits        = 2;  // Bonds: of an id, which is least significant in a candidate
  localparam int CoarseBits    = (Bonds > 0) ? Bonds * IdBits : Axes * FilterFrac;  // of a slot, in a lane
  localparam int CandidateBits = Axes * (PositionFrac + 2) + 1;
  localparam int Slots         = 2 * FilterLanes;  // two rows
  localparam int Bits          = PositionFrac + 6;
  localparam int RowBits       = FilterLanes * CoarseBits;

  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;

  // Own particles do not change while candidates stream past; of their positions the leading bits are kept, of their
  // rows of bonds the partners' ids.
  (* anyconst *) logic [Slots*CoarseBits-1:0] own;
  (* anyconst *) logic [3:0]                  own_count;
  logic                                       stall, push, row, busy;
  logic [CandidateBits-1:0]                   candidate;
  logic [FilterLanes-1:0]                     mask;
  always_comb begin
    assume (own_count <= Slots[3:0]);
    if (present_i) assume (running_q && (row_new_i || (shown_q && row_i == last_row_q)));
  end
  // The memories' output registers. In a stalled cycle the streamer reads nothing (proof `streamer`).
  logic [CandidateBits-1:0] answer_q;
  logic [RowBits-1:0]       answer_row_q;
  logic                     shown_q, last_row_q;  // the row that was read last
  always_ff @(posedge clk_i) begin
    if (!running_q) shown_q <= 1'b0;
    else if (present_i && !stall) shown_q <= 1'b1;
    if (present_i && !stall) begin
      answer_q   <= candidate_i;
      last_row_q <= row_i;
      if (row_new_i) answer_row_q <= row_i ? own[RowBits +: RowBits] : own[0 +: RowBits];
    end
  end
  cuboct_filter #(
    .Axes(Axes), .PositionFrac(PositionFrac), .FilterFrac(FilterFrac), .PlanarOne(PlanarOne),
    .PlanarTwo(PlanarTwo), .PlanarThree(PlanarThree), .CandidateBits(CandidateBits),
    .FilterLanes(FilterLanes), .RowBits(1), .SlotBits(3), .CountBits(4), .Bonds(Bonds),
    .IdBits(IdBits), .IdLsb(0)
  ) u_dut (
    .clk_i, .rst_ni(running_q), .present_i, .row_i, .row_new_i, .own_i, .slot_i, .own_count_i(own_count),
    .candidate_i(answer_q), .row_data_i(answer_row_q), .full_i, .stall_o(stall), .push_o(push),
    .candidate_o(candidate), .row_o(row), .mask_o(mask), .busy_o(busy)
  );

  // The planar test of the candidate that is presented, against each slot of its row.
  logic signed [Bits-1:0] position, difference;
  logic [Bits-1:0]        sizes [0:2];
  logic [FilterLanes-1:0] passes;
  logic [2:0]             other;
  logic                   partner;
  integer                 l, a, b;
  always_comb begin
    passes     = '0;
    position   = '0;
    difference = '0;
    sizes[0]   = '0;
    sizes[1]   = '0;
    sizes[2]   = '0;
    other      = '0;
    partner    = 1'b0;
    for (l = 0; l < FilterLanes; l = l + 1) begin
      other = row_i ? FilterLanes[2:0] + l[2:0] : l[2:0];
      partner = 1'b0;
      for (b = 0; b < Bonds; b = b + 1) begin
        if (own[(row_i ? FilterLanes + l : l)*CoarseBits+b*IdBits +: IdBits] == candidate_i[IdBits-1:0]) partner = 1'b1;
      end
      for (a = 0; a < ((Bonds > 0) ? 0 : Axes); a = a + 1) begin
        // Leading bits: of 4 * 2^P + x, which is positive, what is left of the shift, less that of 4 * 2^P.
        position = $signed({{(Bits - PositionFrac - 2) {candidate_i[a*(PositionFrac+2)+PositionFrac+1]}},
                            candidate_i[a*(PositionFrac+2) +: PositionFrac+2]}) + (4 << PositionFrac);
        difference = (position >> (PositionFrac - FilterFrac)) - (4 << FilterFrac)
                   - $signed({{(Bits - FilterFrac) {1'b0}}, row_i
                       ? own[(FilterLanes+l)*CoarseBits+a*FilterFrac +: FilterFrac]
                       : own[l*CoarseBits+a*FilterFrac +: FilterFrac]});
        sizes[a] = (difference < 0) ? -difference - 1 : difference;
      end
      passes[l] = {1'b0, other} < own_count && !(own_i && other == slot_i)
                && sizes[0] <= PlanarOne && sizes[1] <= PlanarOne && sizes[2] <= PlanarOne
                && sizes[0] + sizes[1] <= PlanarTwo && sizes[1] + sizes[2] <= PlanarTwo
                    && sizes[2] + sizes[0] <= PlanarTwo
                && sizes[0] + sizes[1] + sizes[2] <= PlanarThree && (partner || Bonds == 0);
    end
  end

  // The watched candidate's register, the first ... the fourth, or gone. All move unless the queue stalls them.
  logic [2:0]               place_q;  // 0: not there
  logic                     watched_q, row_q, kept_q;  // kept: its row was that of the candidate before
  logic [CandidateBits-1:0] candidate_q;
  logic [FilterLanes-1:0]   passes_q;
  logic [3:0]               held_q;   // registers that hold something, watched or not
  always_ff @(posedge clk_i) begin
    if (!running_q) begin
      place_q   <= '0;
      watched_q <= 1'b0;
      held_q    <= '0;
    end else if (!stall) begin
      held_q  <= {held_q[2:0], present_i};
      place_q <= (place_q == 3'd0 || place_q == 3'd4) ? 3'd0 : place_q + 3'd1;
      if (present_i && watch_i && !watched_q) begin
        place_q     <= 3'd1;
        watched_q   <= 1'b1;
        candidate_q <= candidate_i;
        row_q       <= row_i;
        kept_q      <= !row_new_i;
        passes_q    <= passes;
      end
    end
  end
  always_ff @(posedge clk_i) begin
    if (running_q) begin
      a_busy: assert (busy == (held_q != '0));
      if (push) a_push: assert (held_q[3] && !full_i);
      if (stall) a_stall: assert (full_i && held_q[3]);
      if (place_q == 3'd4) begin
        a_once: assert (push == (passes_q != '0 && !full_i) && stall == (passes_q != '0 && full_i));
        if (push) a_same: assert (candidate == candidate_q && row == row_q);
        if (push) a_mask: assert (mask == passes_q);
      end
      c_all:   cover (push && place_q == 3'd4 && passes_q == '1);
      c_none:  cover (place_q == 3'd4 && passes_q == '0 && own_count == Slots[3:0]);
      c_kept:  cover (push && place_q == 3'd4 && kept_q && passes_q != '0);
      c_stall: cover (stall && place_q == 3'd3 && present_i);
    end
  end
endmodule
