// SPDX-License-Identifier: MIT
// From candidates to pairs with narrow memories: own particles, then the halos of -x, +x, -y, +y, -z, +z, one after the
// other. A candidate is read into the record register, then meets the own particles, one per cycle, on the port that
// the pipe reads them by too: T is the slot whose particle the memory shows, R one whose test is done.
module cuboct_pair_walk #(
  parameter int          Axes          = 3,   // 2 or 3
  parameter int          PositionFrac  = 20,
  parameter int          FilterFrac    = 8,   // leading bits of a position that are tested
  parameter logic [63:0] PlanarOne     = 64'd0,
  parameter logic [63:0] PlanarTwo     = 64'd0,
  parameter logic [63:0] PlanarThree   = 64'd0,
  parameter int          Interval      = 1,   // cycles from one issue to the next, >= 1
  parameter int          HaloBeats     = 1,   // words of a halo record, >= 1
  parameter int          SlotBits      = 4,   // of an own slot's number
  parameter int          FirstWord     = 0,   // of a face's halos
  parameter int          WordBits      = 10,  // of a word's number
  parameter int          CountBits     = 9    // of a segment's count
) (
  input  logic                            clk_i,
  input  logic                            rst_ni,
  input  logic                            run_i,        // the force engine's phase
  input  logic                            restart_i,    // its last cycle
  input  logic [(2*Axes+1)*CountBits-1:0] counts_i,     // by segment
  // Words of halos: the one asked for; its segment.
  output logic [WordBits-1:0]             word_o,       // in every cycle
  output logic [2:0]                      segment_o,    // 0 own, then -x, +x, -y, +y, -z, +z
  // The record register takes a halo's word, or the own particle that the memory shows.
  output logic                            shift_o,      // a word
  output logic                            set_o,        // the own particle
  // Own particles: the slot asked for, 0 at rest; unless the answer has to stay.
  output logic [SlotBits-1:0]             slot_o,       // in every cycle
  output logic                            hold_o,       // the answer stays
  input  logic [Axes*PositionFrac-1:0]    own_i,        // the memory's answer
  input  logic [Axes*(PositionFrac+2)-1:0] candidate_i, // the record's position
  // Pairs.
  output logic                            issue_o,      // a pair
  output logic [SlotBits-1:0]             issue_slot_o, // with issue_o: its own slot
  output logic                            present_o,    // a slot is asked for to be tested
  output logic                            stall_o,      // a pair waits for the pipe
  output logic                            done_o        // no candidate is left
);
  localparam int Segments = 2 * Axes + 1;
  localparam int StepBits = $clog2(HaloBeats + 1);
  localparam int Beats    = HaloBeats;
  localparam int Tests    = (Axes == 3) ? 5 : 2;

  logic                 walk_d, walk_q;        // reads a record, or walks
  logic [2:0]           segment_d, segment_q;
  logic [CountBits-1:0] record_d, record_q;    // of the segment
  logic [WordBits-1:0]  word_d, word_q;        // the next one to ask for
  logic [StepBits-1:0]  step_d, step_q;        // words asked for
  logic [CountBits-1:0] next_d, next_q;        // slots asked for
  logic                 t_valid_d, t_valid_q, r_valid_d, r_valid_q;
  logic [Tests-1:0]     r_near_d, r_near_q, near;  // the lane's tests
  logic [SlotBits-1:0]  t_slot_d, t_slot_q, r_slot_d, r_slot_q;
  logic [CountBits-1:0] count, own;
  logic                 past, empty, ready, hit, blocked, ask, read_done, last, more;

  integer s;
  always_comb begin
    count = counts_i[0 +: CountBits];
    for (s = 1; s < Segments; s = s + 1) begin
      if (segment_q == s[2:0]) count = counts_i[s*CountBits +: CountBits];
    end
  end
  assign own       = counts_i[0 +: CountBits];
  assign past      = (segment_q == Segments[2:0]);
  assign empty     = (own == '0) || (count == '0);
  assign more      = (next_q != own);
  assign read_done = !walk_q && ((segment_q == 3'd0) ? (step_q != '0) : (step_q == Beats[StepBits-1:0]));
  assign hit       = r_valid_q && (r_near_q == '1);
  assign blocked   = hit && !ready;
  assign issue_o   = hit && ready;
  assign ask       = read_done || (walk_q && !hit && more);
  assign last      = walk_q && !blocked && !t_valid_q && !more;  // R, or nothing, is what is left

  always_comb begin
    walk_d    = walk_q;
    segment_d = segment_q;
    record_d  = record_q;
    word_d    = word_q;
    step_d    = step_q;
    next_d    = next_q;
    t_valid_d = t_valid_q;
    t_slot_d  = t_slot_q;
    r_valid_d = r_valid_q;
    r_near_d  = r_near_q;
    r_slot_d  = r_slot_q;
    if (run_i && !past && !walk_q) begin
      if (step_q == '0 && empty) begin
        segment_d = segment_q + 3'd1;
      end else if (read_done) begin
        step_d = '0;
        walk_d = 1'b1;
      end else begin
        step_d = step_q + 1'b1;
        if (segment_q != 3'd0) word_d = word_q + 1'b1;
      end
    end
    if (ask) begin
      next_d    = next_q + 1'b1;
      t_valid_d = 1'b1;
      t_slot_d  = next_q[SlotBits-1:0];
    end
    if (walk_q && !blocked) begin
      r_valid_d = t_valid_q;
      r_near_d  = near;
      r_slot_d  = t_slot_q;
      if (!ask) t_valid_d = 1'b0;
    end
    if (last) begin
      walk_d   = 1'b0;
      next_d   = '0;
      record_d = record_q + 1'b1;
      if (record_d == count) begin
        segment_d = segment_q + 3'd1;
        record_d  = '0;
        word_d    = FirstWord[WordBits-1:0];
      end
    end
    if (restart_i) segment_d = 3'd0;
  end
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      walk_q    <= 1'b0;
      segment_q <= 3'd0;
      record_q  <= '0;
      word_q    <= FirstWord[WordBits-1:0];
      step_q    <= '0;
      next_q    <= '0;
      t_valid_q <= 1'b0;
      r_valid_q <= 1'b0;
    end else begin
      walk_q    <= walk_d;
      segment_q <= segment_d;
      record_q  <= record_d;
      word_q    <= word_d;
      step_q    <= step_d;
      next_q    <= next_d;
      t_valid_q <= t_valid_d;
      r_valid_q <= r_valid_d;
    end
  end
  always_ff @(posedge clk_i) begin
    t_slot_q <= t_slot_d;
    r_slot_q <= r_slot_d;
    r_near_q <= r_near_d;
  end

  if (Interval == 1) begin : gen_every_cycle
    assign ready = 1'b1;
  end else begin : gen_interval
    localparam int WaitBits = $clog2(Interval);
    localparam int Wait     = Interval - 1;
    logic [WaitBits-1:0] wait_d, wait_q;
    assign ready  = (wait_q == '0);
    assign wait_d = issue_o ? Wait[WaitBits-1:0] : ready ? '0 : wait_q - 1'b1;
    always_ff @(posedge clk_i) begin
      if (!rst_ni) wait_q <= '0;
      else wait_q <= wait_d;
    end
  end

  // The planar test of what the memory shows; not of the candidate itself.
  logic [Axes*FilterFrac-1:0]     coarse_own;
  logic [Axes*(FilterFrac+2)-1:0] coarse;
  for (genvar a = 0; a < Axes; a++) begin : gen_coarse
    assign coarse_own[a*FilterFrac +: FilterFrac] = own_i[a*PositionFrac+PositionFrac-FilterFrac +: FilterFrac];
    assign coarse[a*(FilterFrac+2) +: FilterFrac+2]
      = candidate_i[a*(PositionFrac+2)+PositionFrac-FilterFrac +: FilterFrac+2];
  end
  cuboct_filter_lane #(
    .Axes(Axes), .FilterFrac(FilterFrac), .PlanarOne(PlanarOne), .PlanarTwo(PlanarTwo), .PlanarThree(PlanarThree)
  ) u_lane (
    .clk_i, .en_i(1'b0), .test_i(segment_q != 3'd0 || t_slot_q != record_q[SlotBits-1:0]), .own_i(coarse_own),
    .candidate_i(coarse), .near_o(near)
  );

  assign word_o       = word_q;
  assign segment_o    = segment_q;
  assign shift_o      = !walk_q && step_q != '0 && segment_q != 3'd0;
  assign set_o        = !walk_q && step_q != '0 && segment_q == 3'd0;
  assign slot_o       = issue_o ? r_slot_q : (walk_q || step_q != '0) ? next_q[SlotBits-1:0] : record_q[SlotBits-1:0];
  assign hold_o       = blocked;
  assign issue_slot_o = r_slot_q;
  assign present_o    = ask;
  assign stall_o      = blocked;
  assign done_o       = past;
  logic unused_bits;
  assign unused_bits = ^{own_i, candidate_i};
endmodule
