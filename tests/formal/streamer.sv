// SPDX-License-Identifier: MIT
// cuboct_streamer through any number of steps, with any counts, records that come one by one, when they like, and any
// stalls: each record of each segment is presented once with each row of own slots, in order; `past` comes
// after the last one and only when every segment was there. Arrival: a segment's records come one by one, in
// any cycle, and each is presented only after it came. Rounds: the same records are walked again, as often as one
// likes, when their segments are available once more.
module streamer_formal #(
  parameter int Axes        = 2,
  parameter int FilterLanes = 2,
  parameter int AddrBits    = 1,  // a segment holds up to 2^AddrBits records, a node as many particles
  parameter int Arrival     = 0,  // 0, 1
  parameter int Rounds      = 1   // 1, 2: another round may follow
) (
  input logic          clk_i,
  input logic          stall_i,
  input logic          begin_i,
  input logic          over_i,
  input logic          again_i,  // the records that came are met once more
  input logic [2*Axes:0] come_i,   // a record of the segment comes, or its end
  input logic [(2*Axes+1)*(AddrBits+1)-1:0] counts_i
);
  localparam int CountBits = AddrBits + 1;
  localparam int Segments  = 2 * Axes + 1;
  localparam int Most      = 1 << AddrBits;
  localparam int Rows      = (Most + FilterLanes - 1) / FilterLanes;
  localparam int RowBits   = (Rows > 1) ? $clog2(Rows) : 1;

  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;

  // A step: the engine runs from begin to the restart in its last cycle, which comes after `past`. Own
  // particles are there at once; a segment's count is final when it is available.
  logic                          run_q, past, restart, again;
  logic [Segments*CountBits-1:0] counts_q;
  assign restart = run_q && past && over_i;
  assign again   = (Rounds > 1) && again_i;
  always_ff @(posedge clk_i) begin
    if (!running_q) run_q <= 1'b0;
    else run_q <= run_q ? !restart : begin_i;
    if (!running_q || (restart && !again)) counts_q <= counts_i;
    else if (!run_q && !begin_i) counts_q[0 +: CountBits] <= counts_i[0 +: CountBits];
  end
  integer a;
  always_comb begin
    for (a = 0; a < Segments; a = a + 1) begin
      assume (counts_i[a*CountBits +: CountBits] <= Most[CountBits-1:0]);
      assume (counts_q[a*CountBits +: CountBits] <= Most[CountBits-1:0]);
    end
  end

  // What the streamer is told.
  logic [Segments-1:0]           complete, complete_next, complete_q, come;
  logic [Segments*CountBits-1:0] counts, came_q;
  integer                        t;
  // Records come one by one, also between two steps; without Arrival each before its segment is available.
  always_comb begin
    come = '0;
    for (t = 1; t < Segments; t = t + 1) begin
      come[t] = running_q && !restart && come_i[t]
             && came_q[t*CountBits +: CountBits] != counts_q[t*CountBits +: CountBits];
    end
  end
  always_ff @(posedge clk_i) begin
    for (t = 1; t < Segments; t = t + 1) begin
      if (!running_q || restart) begin
        if (!running_q || !again) came_q[t*CountBits +: CountBits] <= '0;
      end else if (come[t]) begin
        came_q[t*CountBits +: CountBits] <= came_q[t*CountBits +: CountBits] + 1'b1;
      end
      complete_q[t] <= complete_next[t];
    end
  end
  always_comb begin
    complete_next = 1;
    for (t = 1; t < Segments; t = t + 1) begin
      complete_next[t] = running_q && !restart
                      && (complete_q[t] || (come_i[t] && came_q[t*CountBits +: CountBits]
                                                     == counts_q[t*CountBits +: CountBits]));
    end
  end
  always_comb begin
    counts   = counts_q;
    complete = '0;
    for (t = 0; t < Segments; t = t + 1) begin
      if (t == 0) complete[t] = 1'b1;
      else begin
        complete[t]                      = complete_q[t];
        counts[t*CountBits +: CountBits] = came_q[t*CountBits +: CountBits];
      end
    end
  end

  logic [Segments-1:0] pick;
  logic [2:0]          segment;  // picked; beyond all if none is
  integer              p;
  always_comb begin
    segment = (pick == '0) ? '1 : '0;
    for (p = 0; p < Segments; p = p + 1) begin
      if (pick[p]) segment = segment | p[2:0];
    end
  end
  logic [AddrBits-1:0] addr, slot;
  logic [RowBits-1:0]  row;
  logic                present, row_new;
  cuboct_streamer #(
    .Segments(Segments), .Arrival(Arrival), .Rounds(Rounds), .FilterLanes(FilterLanes), .RowBits(RowBits),
    .SlotBits(AddrBits), .AddrBits(AddrBits), .CountBits(CountBits)
  ) u_dut (
    .clk_i, .rst_ni(running_q), .run_i(run_q), .restart_i(restart), .stall_i, .own_i(counts_q[0 +: CountBits]),
    .complete_next_i(complete_next), .came_i(come[Segments-1:1]), .again_i(again),
    .counts_i(came_q[Segments*CountBits-1:CountBits]),
    .pick_o(pick), .addr_o(addr), .slot_o(slot), .row_o(row), .present_o(present), .row_new_o(row_new),
    .past_o(past)
  );

  // Of the picked segment.
  (* keep *) logic [CountBits-1:0] tap_record;  // its next record, which may be one behind the last
  logic                            here, waits;  // it may be read: its next record is there; nothing is to be done yet
  integer                          q;
  always_comb begin
    here  = 1'b0;
    waits = 1'b1;
    for (q = 0; q < Segments; q = q + 1) begin
      if (pick[q]) begin
        waits = !complete[q];
        here  = complete[q];
        if (Arrival != 0) here = ({1'b0, addr} < counts[q*CountBits +: CountBits]);
        if (Arrival != 0 && counts_q[0 +: CountBits] != '0 && tap_record < counts[q*CountBits +: CountBits])
          waits = 1'b0;
      end
    end
  end

  // The least (segment, record, row) not yet presented.
  logic [2:0]           due_segment_q, next_segment;
  logic [CountBits-1:0] due_record_q, next_record, own;
  logic [CountBits:0]   due_row_q, next_row, rows;
  logic                 all;
  integer               s, r;
  always_comb begin
    own  = counts_q[0 +: CountBits];
    rows = '0;
    for (r = 0; r < Rows; r = r + 1) begin
      if ({{(32 - CountBits) {1'b0}}, own} > r * FilterLanes) rows = rows + 1'b1;
    end
    next_segment = due_segment_q;
    all          = 1'b1;
    for (s = Segments - 1; s >= 0; s = s - 1) begin
      if (own != '0 && s[2:0] >= due_segment_q && counts_q[s*CountBits +: CountBits] != '0
          && !(s[2:0] == due_segment_q && due_record_q == counts_q[s*CountBits +: CountBits])) begin
        next_segment = s[2:0];
        all          = 1'b0;
      end
    end
    next_record = (next_segment == due_segment_q) ? due_record_q : '0;
    next_row    = (next_segment == due_segment_q) ? due_row_q : '0;
  end
  always_ff @(posedge clk_i) begin
    if (!running_q || !run_q || restart) begin
      due_segment_q <= '0;
      due_record_q  <= '0;
      due_row_q     <= '0;
    end else if (present) begin
      due_segment_q <= next_segment;
      due_record_q  <= (next_row + 1'b1 == rows) ? next_record + 1'b1 : next_record;
      due_row_q     <= (next_row + 1'b1 == rows) ? '0 : next_row + 1'b1;
    end
  end

  // Progress: a cycle that is not stalled and whose segment is there moves (segment, record, row) upwards.
  logic [CountBits+RowBits+2:0] rank, rank_q;
  logic                        moves_q;
  assign rank = {segment, (Arrival != 0) ? tap_record : {1'b0, addr}, row};
  always_ff @(posedge clk_i) begin
    rank_q  <= rank;
    moves_q <= running_q && run_q && !stall_i && !past && !waits;
  end

  // The row that was presented last since the engine runs.
  logic               shown_q;
  logic [RowBits-1:0] last_row_q;
  always_ff @(posedge clk_i) begin
    if (!running_q || !run_q || restart) shown_q <= 1'b0;
    else if (present) shown_q <= 1'b1;
    if (present) last_row_q <= row;
  end

  logic again_q, round_q, rounds_q;  // a second step; a second round; a step with two of them was
  always_ff @(posedge clk_i) begin
    again_q  <= running_q && (again_q || restart);
    round_q  <= running_q && (restart ? again : round_q);
    rounds_q <= running_q && (rounds_q || (restart && !again && round_q && due_segment_q == Segments[2:0] - 3'd1));
  end

  always_ff @(posedge clk_i) begin
    if (running_q) begin
      if (present) begin
        a_may:  assert (run_q && !stall_i && here);
        a_next: assert (!all && segment == next_segment && {1'b0, addr} == next_record
                        && {{(CountBits + 1 - RowBits) {1'b0}}, row} == next_row && slot == addr);
      end
      if (present) a_row: assert (row_new == !(shown_q && row == last_row_q));
      if (past) a_past: assert (all && complete == '1);
      if (moves_q) a_progress: assert (rank > rank_q);
      c_empty: cover (restart && counts_q == '0);
      c_full:  cover (past && counts_q[(Segments-1)*CountBits +: CountBits] == Most[CountBits-1:0]
          && due_segment_q == Segments[2:0] - 3'd1);
      c_rows:  cover (present && next_row != '0 && next_record != '0);
      c_again: cover (restart && again_q && due_segment_q != '0);
      c_round: cover (Rounds == 1 || (rounds_q && round_q && present && segment == Segments[2:0] - 3'd1
                                      && counts_q[(Segments-1)*CountBits +: CountBits] == Most[CountBits-1:0]));
    end
  end
endmodule
