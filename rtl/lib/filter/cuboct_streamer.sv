// SPDX-License-Identifier: MIT
// Walks the candidates of a step, segment by segment: own particles, halos by face; every record once for each row of
// own slots. One (record, row) per cycle, or one segment left without a record.
module cuboct_streamer #(
  parameter int Segments    = 7,  // >= 1
  parameter int Own         = 1,  // 1: the first segment are the own particles
  parameter int Arrival     = 0,  // 1: a record may be read before its segment is complete
  parameter int Rounds      = 1,  // above 1 a step's records may be walked again
  parameter int FilterLanes = 8,  // own slots per row
  parameter int RowBits     = 1,  // of a row's number
  parameter int SlotBits    = 4,  // of an own slot's number
  parameter int AddrBits    = 8,  // of a record's number in any segment
  parameter int CountBits   = 8,  // of a segment's count
  localparam int Halos      = Segments - Own
) (
  input  logic                   clk_i,
  input  logic                   rst_ni,
  input  logic                   run_i,        // the force engine's phase
  input  logic                   restart_i,    // its last cycle
  input  logic                   stall_i,      // nothing moves
  input  logic [CountBits-1:0]   own_i,        // own particles; they stay from the cycle before run_i on
  input  logic [Segments-1:0]    complete_next_i,  // by segment: in the next cycle all records are there; not with
                                               // restart_i, but for the first segment
  input  logic [Halos-1:0]       came_i,       // by segment behind the own one: a record comes, also before run_i, not
                                               // with restart_i; it may be read from the next cycle on
  input  logic                   again_i,      // with restart_i: the same records once more; Rounds above 1
  input  logic [Halos*CountBits-1:0] counts_i,  // with again_i: by segment behind the own one
  output logic [Segments-1:0]    pick_o,       // segment, a bit each; none if past_o
  output logic [AddrBits-1:0]    addr_o,       // the record's number in its segment
  output logic [SlotBits-1:0]    slot_o,       // addr_o, for the own particles
  output logic [RowBits-1:0]     row_o,        // of own slots
  output logic                   present_o,    // (pick, addr, row) goes to the filter
  output logic                   row_new_o,    // with present_o: the row is not that of the candidate before
  output logic                   past_o        // all segments are done
);
  localparam logic [CountBits-1:0] One = 1;
  localparam logic [CountBits-1:0] Two = 2;
  localparam logic [Segments-1:0] First = 1;
  localparam int RowSlots = CountBits + $clog2(FilterLanes + 1);  // bits of a slot number beyond the last row

  logic [Segments-1:0]  pick_d, pick_q;
  logic [CountBits-1:0] record_d, record_q;
  logic [CountBits-1:0] next_d, next_q;            // record_q and 1
  logic [RowBits-1:0]   row_d, row_q;
  logic [RowSlots-1:0]  next_slot_d, next_slot_q;  // first slot of the next row
  logic                 last_row_d, last_row_q;    // next_slot_q >= own_i
  logic                 few_q;                     // own particles: no more than one row
  logic [Segments-1:0]  came;                      // by segment: a record comes
  logic                 skip, go, shift, done, last_record;
  // Of the picked segment: all records are there; one is that is not done with; no other is. Registers, as all that
  // the streamer does begins with them.
  logic                 complete_d, complete_q, there_d, there_q, only_d, only_q;
  logic [Segments-1:0]  some_kept, one_kept, two, follows;  // in the next cycle, if none is done with; the next segment
  logic                 some_again, one_again, came_here;

  // Records that wait, by segment: one more on arrival, one less when it is consumed. No two numbers are compared, and
  // the counts are registers.
  if (Own != 0) begin : gen_own
    assign came = {came_i, 1'b0};
  end else begin : gen_no_own
    assign came = came_i;
  end
  for (genvar g = 0; g < Segments; g++) begin : gen_left
    localparam int IsOwn = (Own != 0 && g == 0) ? 1 : 0;
    logic [CountBits-1:0] left_d, left_q;
    logic                 some_d, some_q, one_d, one_q, meets;
    logic [CountBits-1:0] all;  // that are walked again
    if (Rounds > 1 && IsOwn == 0) begin : gen_again
      assign all = counts_i[(g-Own)*CountBits +: CountBits] & {CountBits{again_i}};
    end else begin : gen_once
      assign all = '0;
    end
    assign meets = done && pick_q[g];
    always_comb begin
      left_d = left_q;
      some_d = some_q;
      one_d  = one_q;
      if (came[g] && !meets) begin
        left_d = left_q + 1'b1;
        some_d = 1'b1;
        one_d  = !some_q;
      end else if (meets && !came[g]) begin
        left_d = left_q - 1'b1;
        some_d = !one_q;
        one_d  = (left_q == Two);
      end
      if (restart_i) begin
        left_d = all;
        some_d = (all != '0);
        one_d  = (all == One);
      end
      if (IsOwn != 0 && !run_i) begin
        left_d = own_i;
        some_d = (own_i != '0);
        one_d  = (own_i == One);
      end
    end
    always_ff @(posedge clk_i) begin
      if (!rst_ni) begin
        left_q <= '0;
        some_q <= 1'b0;
        one_q  <= 1'b0;
      end else begin
        left_q <= left_d;
        some_q <= some_d;
        one_q  <= one_d;
      end
    end
    assign two[g] = (left_q == Two);
    if (IsOwn != 0) begin : gen_constant
      assign some_kept[g] = run_i ? some_q : (own_i != '0);
      assign one_kept[g]  = run_i ? one_q : (own_i == One);
    end else begin : gen_counted
      assign some_kept[g] = some_q || came[g];
      assign one_kept[g]  = came[g] ? !some_q : one_q;
    end
    if (g == 0) begin : gen_first
      assign some_again = (all != '0);
      assign one_again  = (all == One);
    end
  end
  assign follows   = pick_q << 1;
  assign came_here = ((pick_q & came) != '0);
  always_comb begin
    complete_d = ((pick_q & complete_next_i) != '0);
    there_d    = ((pick_q & some_kept) != '0);
    only_d     = ((pick_q & one_kept) != '0);
    if (shift) begin
      complete_d = ((follows & complete_next_i) != '0);
      there_d    = ((follows & some_kept) != '0);
      only_d     = ((follows & one_kept) != '0);
    end else if (done) begin
      there_d = came_here || !only_q;
      only_d  = came_here ? only_q : ((pick_q & two) != '0);
    end
    if (restart_i) begin
      complete_d = complete_next_i[0];
      there_d    = some_again;
      only_d     = one_again;
    end
  end
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      complete_q <= (Own != 0);
      there_q    <= 1'b0;
      only_q     <= 1'b0;
    end else begin
      complete_q <= complete_d;
      there_q    <= there_d && (own_i != '0);
      only_q     <= only_d;
    end
  end

  always_ff @(posedge clk_i) begin
    few_q <= ({{(RowSlots - CountBits) {1'b0}}, own_i} <= FilterLanes[RowSlots-1:0]);
  end
  logic row_new_d, row_new_q;
  assign row_new_d = !run_i || (present_o ? !few_q : row_new_q);
  always_ff @(posedge clk_i) begin
    if (!rst_ni) row_new_q <= 1'b1;
    else row_new_q <= row_new_d;
  end
  assign row_new_o   = row_new_q;
  assign go          = run_i && !stall_i && (complete_q || (Arrival != 0 && there_q));
  assign skip        = !there_q;
  assign done        = go && !skip && last_row_q;  // with the record
  assign last_record = complete_q && only_q;
  assign shift       = (go && skip) || (done && last_record);
  assign present_o   = go && !skip;

  always_comb begin
    pick_d      = pick_q;
    record_d    = record_q;
    next_d      = next_q;
    row_d       = row_q;
    next_slot_d = next_slot_q;
    if (go && skip) begin
      pick_d = pick_q << 1;
      if (Arrival != 0) begin  // behind the last record: elsewhere both are what they become
        record_d = '0;
        next_d   = One;
      end
    end else if (go && !last_row_q) begin
      row_d       = row_q + 1'b1;
      next_slot_d = next_slot_q + FilterLanes[RowSlots-1:0];
    end else if (go) begin
      row_d       = '0;
      next_slot_d = FilterLanes[RowSlots-1:0];
      record_d    = next_q;
      next_d      = next_q + 1'b1;
      if (last_record) begin
        record_d  = '0;
        next_d    = One;
        pick_d    = pick_q << 1;
      end
    end
    if (restart_i) pick_d = First;
    last_row_d = last_row_q;
    if (!run_i) last_row_d = ({{(RowSlots - CountBits) {1'b0}}, own_i} <= FilterLanes[RowSlots-1:0]);
    else if (done) last_row_d = few_q;
    else if (go && !skip)
      last_row_d = (next_slot_q + FilterLanes[RowSlots-1:0] >= {{(RowSlots - CountBits) {1'b0}}, own_i});
  end
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      pick_q      <= First;
      record_q    <= '0;
      next_q      <= One;
      row_q       <= '0;
      next_slot_q <= FilterLanes[RowSlots-1:0];
      last_row_q  <= 1'b0;
    end else begin
      pick_q      <= pick_d;
      record_q    <= record_d;
      next_q      <= next_d;
      row_q       <= row_d;
      next_slot_q <= next_slot_d;
      last_row_q  <= last_row_d;
    end
  end

  assign pick_o    = pick_q;
  assign addr_o    = record_q[AddrBits-1:0];
  assign slot_o    = record_q[SlotBits-1:0];
  assign row_o     = row_q;
  assign past_o    = (pick_q == '0);
  logic unused_again;
  assign unused_again = ^{again_i, counts_i};
endmodule
