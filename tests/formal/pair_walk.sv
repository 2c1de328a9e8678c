// SPDX-License-Identifier: MIT
// cuboct_pair_walk: over any number of force phases each pair of a record of a segment and an own slot, any of them,
// is issued once in a phase if the planar test, on the particles that memory and record register show, lets it
// through and the slot is not the candidate itself; else never. At an issue the register holds that record, the port
// asks for that own particle, and the last issue was Interval cycles ago or more. The phase's walk is over only when
// all pairs were met.
module pair_walk_formal #(
  parameter int Axes      = 2,
  parameter int Interval  = 1,
  parameter int HaloBeats = 2,
  parameter int SlotBits  = 1,
  parameter int CountBits = 2
) (
  input logic                            clk_i,
  input logic                            start_i,
  input logic                            restart_i,
  input logic [(2*Axes+1)*CountBits-1:0] counts_i,
  input logic [Axes*2-1:0]               any_own_i,       // what an answer about another slot is
  input logic [Axes*4-1:0]               any_candidate_i
);
  localparam int          Segments  = 2 * Axes + 1;
  localparam int          FirstWord = 3;
  localparam int          WordBits  = 6;
  localparam logic [63:0] One = 64'd1, Two = 64'd1, Three = 64'd2;

  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;

  // A phase lasts from a start to a restart, which comes when no candidate is left; counts do not change within one,
  // and there are no more own particles than slots.
  logic                            run, run_q, done;
  logic [(2*Axes+1)*CountBits-1:0] counts_q;
  assign run = running_q && (run_q || start_i);
  always_comb begin
    if (restart_i) assume (run && done);
    if (run_q) assume (counts_i == counts_q);
    assume (counts_i[0 +: CountBits] <= {{(CountBits - SlotBits - 1) {1'b0}}, 1'b1, {SlotBits {1'b0}}});
  end
  always_ff @(posedge clk_i) begin
    run_q    <= run && !restart_i;
    counts_q <= counts_i;
  end

  logic [WordBits-1:0] word;
  logic [2:0]          segment;
  logic                shift, set, hold, issue, present, stall;
  logic [SlotBits-1:0] slot, issue_slot;
  logic [Axes*2-1:0]   own;
  logic [Axes*4-1:0]   candidate;
  cuboct_pair_walk #(
    .Axes(Axes), .PositionFrac(2), .FilterFrac(1), .PlanarOne(One), .PlanarTwo(Two), .PlanarThree(Three),
    .Interval(Interval), .HaloBeats(HaloBeats), .SlotBits(SlotBits), .FirstWord(FirstWord), .WordBits(WordBits),
    .CountBits(CountBits)
  ) u_dut (
    .clk_i, .rst_ni(running_q), .run_i(run), .restart_i, .counts_i, .word_o(word), .segment_o(segment), .shift_o(shift),
    .set_o(set), .slot_o(slot), .hold_o(hold), .own_i(own), .candidate_i(candidate), .issue_o(issue),
    .issue_slot_o(issue_slot), .present_o(present), .stall_o(stall), .done_o(done)
  );

  // The watched pair, and its particles.
  (* anyconst *) logic [2:0]           watched;
  (* anyconst *) logic [CountBits-1:0] record;
  (* anyconst *) logic [SlotBits-1:0]  number;
  (* anyconst *) logic [Axes*2-1:0]    watched_own;
  (* anyconst *) logic [Axes*4-1:0]    watched_candidate;
  always_comb assume (watched < Segments[2:0]);

  // The memories: a slot, or a word of a segment, that was asked for is there a cycle later; a slot's answer stays on
  // hold. The record register has the watched record once all its words came one after the other.
  logic [SlotBits-1:0] shown_q;
  logic [WordBits-1:0] word_q, next_word;
  logic [2:0]          segment_q, beats_d, beats_q;
  logic                has_d, has_q;  // the watched record
  assign own       = (shown_q == number) ? watched_own : any_own_i;
  assign candidate = has_q ? watched_candidate : any_candidate_i;
  assign next_word = FirstWord[WordBits-1:0] + {{(WordBits - CountBits) {1'b0}}, record} * HaloBeats[WordBits-1:0]
                   + {{(WordBits - 3) {1'b0}}, beats_q};
  always_comb begin
    beats_d = beats_q;
    has_d   = has_q;
    if (shift) begin
      beats_d = '0;
      if (segment_q == watched && word_q == next_word) beats_d = beats_q + 1'b1;
      else if (segment_q == watched && word_q == next_word - {{(WordBits - 3) {1'b0}}, beats_q}) beats_d = 3'd1;
      has_d = (beats_d == HaloBeats[2:0]);
      if (has_d) beats_d = '0;
    end
    if (set) begin
      beats_d = '0;
      has_d   = (watched == 3'd0) && ({{(CountBits - SlotBits) {1'b0}}, shown_q} == record) && segment == 3'd0;
    end
  end
  always_ff @(posedge clk_i) begin
    if (!hold) shown_q <= slot;
    word_q    <= word;
    segment_q <= segment;
    beats_q   <= running_q ? beats_d : '0;
    has_q     <= running_q && has_d;
  end

  // What has to be issued.
  logic                 pass, exists, due, now, done_q;
  logic                 met_q, twice_q;
  logic [CountBits-1:0] count;
  logic [3:0]           since_q, stalled_q;
  logic [Axes-1:0]      unused_own;
  logic [Axes*3-1:0]    coarse;
  logic [Axes-1:0]      coarse_own;
  for (genvar a = 0; a < Axes; a++) begin : gen_axis
    assign coarse_own[a]      = watched_own[a*2+1];
    assign coarse[a*3 +: 3]   = watched_candidate[a*4+1 +: 3];
    assign unused_own[a]      = watched_own[a*2] ^ watched_candidate[a*4];
  end
  logic [((Axes == 3) ? 5 : 2)-1:0] tests;
  assign pass = (tests == '1);
  cuboct_filter_lane #(.Axes(Axes), .FilterFrac(1), .PlanarOne(One), .PlanarTwo(Two), .PlanarThree(Three)) u_test (
    .clk_i, .en_i(1'b0), .test_i(1'b1), .own_i(coarse_own), .candidate_i(coarse), .near_o(tests)
  );
  integer s;
  always_comb begin
    count = counts_i[0 +: CountBits];
    for (s = 1; s < Segments; s = s + 1) begin
      if (watched == s[2:0]) count = counts_i[s*CountBits +: CountBits];
    end
  end
  assign exists = (record < count) && ({{(CountBits - SlotBits) {1'b0}}, number} < counts_i[0 +: CountBits]);
  assign due    = exists && pass && !(watched == 3'd0 && record == {{(CountBits - SlotBits) {1'b0}}, number});
  assign now    = issue && segment == watched && has_q && issue_slot == number;
  always_ff @(posedge clk_i) begin
    if (!running_q || restart_i) begin
      met_q   <= 1'b0;
      twice_q <= 1'b0;
    end else begin
      if (now) met_q <= 1'b1;
      if (now && met_q) twice_q <= 1'b1;
    end
    since_q   <= !running_q ? 4'd15 : issue ? 4'd1 : (since_q == 4'd15) ? since_q : since_q + 1'b1;
    stalled_q <= (running_q && stall) ? stalled_q + 1'b1 : '0;
    done_q    <= running_q && done && !restart_i;
  end

  // In each cycle of a phase that is not stalled a rank rises: segment, record, words or slots asked for, what is
  // under way.
  (* keep *) logic                 tap_walk, tap_t_valid, tap_r_valid;
  (* keep *) logic                 tap_ready;
  (* keep *) logic [((Axes == 3) ? 5 : 2)-1:0] tap_r_near;
  (* keep *) logic [SlotBits-1:0]  tap_t_slot, tap_r_slot;
  (* keep *) logic [CountBits-1:0] tap_record, tap_next;
  (* keep *) logic [$clog2(HaloBeats+1)-1:0] tap_step;
  logic [2*CountBits+8:0]          rank, rank_q;
  logic                            moves_q;
  logic [1:0]                      under_way;
  assign under_way = {tap_t_valid, tap_r_valid && (tap_r_near == '1)};
  assign rank      = {segment, tap_record, tap_walk, tap_walk ? tap_next : {CountBits {1'b0}},
                      tap_walk ? {1'b0, ~under_way} : {{(3 - $clog2(HaloBeats + 1)) {1'b0}}, tap_step}};
  always_ff @(posedge clk_i) begin
    rank_q  <= rank;
    moves_q <= run && !stall && !done;
  end

  // Helpers: what the walk's registers are, by where it stands.
  localparam int       StepBits = $clog2(HaloBeats + 1);
  logic [CountBits-1:0] own_count, this_count, past_r;
  logic                 past, reads, is_watched, shown_t, passed;
  logic [StepBits-1:0]  most;
  logic [WordBits-1:0]  word_now;
  always_comb begin
    this_count = '0;
    for (s = 0; s < Segments; s = s + 1) begin
      if (segment == s[2:0]) this_count = counts_i[s*CountBits +: CountBits];
    end
  end
  assign own_count  = counts_i[0 +: CountBits];
  assign past       = (segment == Segments[2:0]);
  assign reads      = !tap_walk && tap_step != '0;
  assign most       = (segment == 3'd0) ? {{(StepBits - 1) {1'b0}}, 1'b1} : HaloBeats[StepBits-1:0];
  assign is_watched = (segment == watched) && (tap_record == record);
  assign past_r     = tap_next - {{(CountBits - 1) {1'b0}}, 1'b1} - {{(CountBits - 1) {1'b0}}, tap_t_valid};
  assign shown_t    = (shown_q == tap_t_slot) && ({{(CountBits - SlotBits) {1'b0}}, tap_t_slot} + 1'b1 == tap_next);
  assign passed     = (segment > watched) || (segment == watched && tap_record > record)
                   || (is_watched && tap_walk && {{(CountBits - SlotBits) {1'b0}}, number} < tap_next
                       && !(tap_t_valid && tap_t_slot == number) && !(tap_r_valid && tap_r_slot == number));
  assign word_now   = FirstWord[WordBits-1:0] + ((segment == 3'd0) ? '0 :
                      ({{(WordBits - CountBits) {1'b0}}, tap_record} + {{(WordBits - 1) {1'b0}}, tap_walk})
                       * HaloBeats[WordBits-1:0] + {{(WordBits - StepBits) {1'b0}}, tap_step});
  always_ff @(posedge clk_i) begin
    if (running_q) begin
      i_rest:  assert (run_q || (segment == 3'd0 && tap_record == '0 && !tap_walk && tap_step == '0));
      i_range: assert (segment <= Segments[2:0] && tap_step <= most && tap_next <= own_count);
      i_past:  assert (!past || (tap_record == '0 && !tap_walk && tap_step == '0));
      i_there: assert ((!tap_walk && tap_step == '0) || (run_q && own_count != '0 && tap_record < this_count));
      i_first: assert (tap_record == '0 || (own_count != '0 && tap_record < this_count));
      i_reads: assert (tap_walk ? tap_step == '0 && tap_next != '0
                                : tap_next == '0 && !tap_t_valid && !tap_r_valid);
      i_t:     assert (!tap_t_valid || shown_t);
      i_r:     assert (!tap_r_valid || (tap_next > {{(CountBits - 1) {1'b0}}, tap_t_valid}
                                        && {{(CountBits - SlotBits) {1'b0}}, tap_r_slot} == past_r));
      i_hit:   assert (!(tap_r_valid && is_watched && tap_r_slot == number) || (tap_r_near == '1) == due);
      i_word:  assert (word == word_now && (!reads || segment == 3'd0
                                            || (segment_q == segment && word_q == word - 1'b1)));
      i_own:   assert (!(reads && segment == 3'd0) || {{(CountBits - SlotBits) {1'b0}}, shown_q} == tap_record);
      i_beats: assert (beats_q == ((reads && is_watched && segment != 3'd0)
                                   ? {{(3 - StepBits) {1'b0}}, tap_step} - 1'b1 : 3'd0));
      i_has:   assert (!tap_walk || has_q == is_watched);
      i_met:   assert (!twice_q && met_q == (due && passed));
      i_ready: assert (tap_ready == (since_q >= Interval[3:0]));
      i_done:  assert (!done_q || (run_q && past));
      i_rank:  assert (!moves_q || (run_q && rank > rank_q));
    end
  end

  always_ff @(posedge clk_i) begin
    if (running_q) begin
      a_once:     assert (!twice_q && !(now && met_q));
      a_due:      assert (!now || due);
      a_all:      assert (!(run && done) || met_q == due);
      a_record:   assert (!issue || watched != segment || issue_slot != number || has_q || !exists
                          || !(tap_record == record));
      a_port:     assert (!issue || (slot == issue_slot && !hold));
      a_interval: assert (!issue || since_q >= Interval[3:0]);
      a_idle:     assert (run || (!issue && !shift && !set && !stall && !present && slot == '0));
      a_range:    assert (!issue || {{(CountBits - SlotBits) {1'b0}}, issue_slot} < counts_i[0 +: CountBits]);
      a_stall:    assert (stalled_q < Interval[3:0]);
      a_progress: assert (!moves_q || rank > rank_q);
      a_done:     assert (!done_q || done);
      c_met:      cover (run && done && due && watched == 3'd4 && record == count - 1'b1 && record != '0
                         && number == {SlotBits {1'b1}});
      c_own:      cover (run && done && due && watched == 3'd0);
      c_itself:   cover (run && done && exists && pass && watched == 3'd0 && !due);
      c_none:     cover (run && done && counts_i == '0);
      c_chain:    cover (now && since_q == Interval[3:0]);
      c_stall:    cover (Interval == 1 || (stall && segment == 3'd2));
      c_again:    cover (run_q && restart_i && met_q);
    end
  end
endmodule
