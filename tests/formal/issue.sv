// SPDX-License-Identifier: MIT
// cuboct_split and cuboct_issue behind any queue: each bit of each entry's mask is issued once, with its candidate
// and its slot, lowest first, within ceil(FilterLanes / ForcePipes) intervals; no other pair is. It issues in the
// first cycle of each interval, and goes on to the next entry in the last.
module issue_formal #(
  parameter int FilterLanes = 4,
  parameter int ForcePipes  = 1,
  parameter int RowBits     = 1,
  parameter int SlotBits    = 3,
  parameter int Interval    = 1
) (
  input logic                   clk_i,
  input logic                   empty_i,
  input logic [1:0]             candidate_i,
  input logic [RowBits-1:0]     row_i,
  input logic [FilterLanes-1:0] mask_i
);
  localparam int Longest = (FilterLanes + ForcePipes - 1) / ForcePipes * Interval;
  localparam int Last    = Interval - 1;

  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;
  always_comb begin
    if (!empty_i) assume (running_q && mask_i != '0);
  end
  (* anyconst *) logic [3:0] lane;  // the watched one
  always_comb assume (lane < FilterLanes[3:0]);

  logic                           pop, busy;
  logic [1:0]                     candidate;
  logic [ForcePipes-1:0]          valid;
  logic [ForcePipes*SlotBits-1:0] slot;
  logic [ForcePipes-1:0]          head_valid;
  logic [ForcePipes*SlotBits-1:0] head_lane;
  logic [FilterLanes-1:0]         head_rest;
  cuboct_split #(.FilterLanes(FilterLanes), .ForcePipes(ForcePipes), .SlotBits(SlotBits)) u_split (
    .mask_i, .valid_o(head_valid), .lane_o(head_lane), .rest_o(head_rest)
  );
  cuboct_issue #(
    .CandidateBits(2), .FilterLanes(FilterLanes), .RowBits(RowBits), .SlotBits(SlotBits),
        .ForcePipes(ForcePipes), .Interval(Interval)
  ) u_dut (
    .clk_i, .rst_ni(running_q), .empty_i, .candidate_i, .row_i, .valid_i(head_valid), .lane_i(head_lane),
    .rest_i(head_rest), .pop_o(pop), .candidate_o(candidate),
    .valid_o(valid), .slot_o(slot), .busy_o(busy)
  );

  // The entry, the pairs of it that are still to come, and the watched one among them.
  logic                due_q;
  logic [1:0]          candidate_q;
  logic [SlotBits-1:0] slot_q;
  logic [3:0]          left_q, issued, times;
  logic [5:0]          cycles_q;
  logic [1:0]          phase_q;  // cycle of an interval, as long as there is something to issue
  logic                works, last;
  logic [SlotBits-1:0] mask_slot;
  logic [3:0]          bits;
  integer              f, l;
  always_comb begin
    issued = '0;
    times  = '0;
    for (f = 0; f < ForcePipes; f = f + 1) begin
      if (valid[f]) issued = issued + 1'b1;
      if (valid[f] && slot[f*SlotBits +: SlotBits] == slot_q) times = times + 1'b1;
    end
    bits      = '0;
    mask_slot = '0;
    for (l = 0; l < FilterLanes; l = l + 1) begin
      if (mask_i[l]) bits = bits + 1'b1;
      if (lane == l[3:0]) mask_slot = {{(SlotBits - RowBits) {1'b0}},
          row_i} * FilterLanes[SlotBits-1:0] + l[SlotBits-1:0];
    end
  end
  assign works = (left_q != '0) || (phase_q != '0);
  assign last  = !works || (phase_q == Last[1:0]);
  always_ff @(posedge clk_i) begin
    if (!running_q) begin
      phase_q  <= '0;
      due_q    <= 1'b0;
      left_q   <= '0;
      cycles_q <= '0;
    end else begin
      if (pop) begin
        due_q       <= mask_i[lane[$clog2(FilterLanes)-1:0]];
        slot_q      <= mask_slot;
        candidate_q <= candidate_i;
        left_q      <= bits;
      end else begin
        if (times != '0) due_q <= 1'b0;
        left_q <= left_q - issued;
      end
      phase_q  <= last ? '0 : phase_q + 1'b1;
      cycles_q <= (pop || !busy) ? '0 : cycles_q + 1'b1;
    end
  end

  always_ff @(posedge clk_i) begin
    if (running_q) begin
      a_some:  assert (issued <= left_q && (issued != '0) == (left_q != '0 && phase_q == '0));
      a_busy:  assert (busy == works);
      a_once:  assert (times <= (due_q ? 4'd1 : 4'd0));
      if (pop) a_all: assert (!empty_i && (!due_q || times == 4'd1) && left_q == issued && last);
      if (works) a_candidate: assert (candidate == candidate_q);
      if (ForcePipes > 1 && valid[ForcePipes-1]) a_ascending: assert (valid == '1
          && slot[0 +: SlotBits] < slot[(ForcePipes-1)*SlotBits +: SlotBits]);
      if (busy) a_progress: assert (cycles_q < Longest[5:0]);
      if (left_q == issued && last && !empty_i) a_no_gap: assert (pop);
      c_all:   cover (left_q == FilterLanes[3:0] && due_q);
      c_chain: cover (pop && works && (Interval > 1 || due_q));
      c_empty: cover (left_q == '0 && cycles_q == '0 && candidate_q == 2'd3);
    end
  end
endmodule
