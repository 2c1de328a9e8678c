// SPDX-License-Identifier: MIT
// The sender of the exchange phases where halos are used on arrival: one walk over own records, the halos of -x, +x
// and, with three axes, of -y, +y. A record goes over the links of all axes behind its own in lock step, as soon as it
// has come; behind an axis's last record its end beat follows. What is asked for in one cycle stands in the memories'
// answers in the next, and in the register that the links load in the one after; all wait for the links.
module cuboct_arrival_relay #(
  parameter int Axes      = 3,   // 2 or 3
  parameter int LinkBits  = 32,  // payload of a beat
  parameter int HaloBits  = 32,  // bits of a record
  parameter int SlotBits  = 4,   // of an own slot's number
  parameter int AddrBits  = 8,   // of a record's number in any segment
  parameter int CountBits = 8    // of a segment's count
) (
  input  logic                   clk_i,
  input  logic                   rst_ni,
  input  logic                   active_i,    // the machine is in an exchange phase
  // Segments: 0 own, then the halos of -x, +x and, with three axes, -y, +y.
  input  logic [CountBits-1:0]   own_count_i, // own records; they stay from the cycle before an exchange on
  input  logic [2*Axes-3:0]      came_i,      // by segment behind the own one: a record comes, also before an exchange;
                                              // it may be asked for from the next cycle on
  input  logic [2*Axes-2:0]      complete_i,  // no other will come
  output logic                   read_o,      // asks for what comes next; without it the answers stay
  output logic [2*Axes-2:0]      clear_o,     // with read_o, by segment: its memory is not asked, its answer is 0
  output logic [AddrBits-1:0]    addr_o,      // with read_o: of the record
  output logic [SlotBits-1:0]    slot_o,      // addr_o, for the own particles; 0 where none is asked for
  input  logic [HaloBits-1:0]    own_i,       // the answer of the own particles
  input  logic [HaloBits-1:0]    halo_i,      // that of the halos; 0 if none was asked for
  // To the link registers.
  input  logic [2*Axes-1:0]      has_link_i,  // constant, by face
  input  logic [2*Axes-1:0]      valid_i,     // by face: the register holds a beat; not where there is no link
  input  logic [2*Axes-1:0]      ready_i,     // by face: what it holds is taken in this cycle
  output logic [2*Axes-1:0]      load_o,      // these load a beat
  output logic                   end_o,       // with load_o: an end beat
  output logic [LinkBits-1:0]    data_o,      // with load_o: payload; 0 outside of a phase
  output logic                   observe_o,   // own_i answers for a record that is sent
  output logic [Axes-1:0]        sent_o       // the axis's end beats were loaded
);
  localparam int Beats    = (HaloBits + LinkBits - 1) / LinkBits;
  localparam int BeatBits = (Beats > 1) ? $clog2(Beats) : 1;
  localparam int LastBeat = Beats - 1;
  localparam int Segments = 2 * Axes - 1;
  localparam logic [CountBits-1:0] One = 1;
  localparam logic [CountBits-1:0] Two = 2;
  localparam logic [Segments-1:0] FirstSegment = 1;
  localparam logic [Axes-1:0] FirstAxis = 1;

  // What is asked for.
  logic [Segments-1:0]  pick_d, pick_q;      // segment
  logic [Axes-1:0]      axis_d, axis_q;      // of the segment, and of the next end beat; none: all is sent
  logic                 ending_d, ending_q;  // the end beat comes next
  logic [CountBits-1:0] record_d, record_q, next_d, next_q;  // its number, and 1
  logic [Segments-1:0]  came, some, one;     // by segment: records that were not asked for yet: any, one
  logic                 complete, there, only, last, closes, ask, leave, group_end, advance, held;
  // What the memories answer, and what the links load.
  logic                 answer_d, answer_q, answer_end_q, answer_own_q, valid_d, valid_q, end_q, some_load;
  logic [Axes-1:0]      answer_axes_q, axes_q, sent_d, sent_q;
  logic [HaloBits-1:0]  record_bits_q;
  logic [BeatBits-1:0]  beat_d, beat_q;
  logic                 last_beat, can_load;
  logic                 end_d, more_d, more_q;  // more: behind the beat to be loaded comes another of the record
  logic [Axes-1:0]      axes_d;
  logic [2*Axes-1:0]    stays;               // links' beats that are not taken
  logic [2*Axes-1:0]    waits_d, waits_q;    // links that must be taken from before they load what is to be loaded

  // What is there to be asked for, counted as it comes and as it is asked for: it needs no comparison of two numbers.
  // An exchange leaves nothing of it.
  assign came = {came_i, 1'b0};
  for (genvar g = 0; g < Segments; g++) begin : gen_left
    logic [CountBits-1:0] left_d, left_q;
    logic                 some_d, some_q, one_d, one_q, asks;
    assign asks = ask && pick_q[g];
    always_comb begin
      left_d = left_q;
      some_d = some_q;
      one_d  = one_q;
      if (came[g] && !asks) begin
        left_d = left_q + 1'b1;
        some_d = 1'b1;
        one_d  = !some_q;
      end else if (asks && !came[g]) begin
        left_d = left_q - 1'b1;
        some_d = !one_q;
        one_d  = (left_q == Two);
      end
      if (g == 0 && !active_i) begin
        left_d = own_count_i;
        some_d = (own_count_i != '0);
        one_d  = (own_count_i == One);
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
    assign some[g] = some_q;
    assign one[g]  = one_q;
  end

  integer s;
  always_comb begin
    group_end = 1'b0;
    for (s = 0; s < Segments; s = s + 1) begin
      if (s % 2 == 0) group_end = group_end || pick_q[s];
    end
  end
  assign complete = ((pick_q & complete_i) != '0);
  assign there    = ((pick_q & some) != '0);
  assign only     = ((pick_q & one) != '0);
  assign last     = complete && only;
  assign advance = active_i && !held && (axis_q != '0);
  assign closes  = advance && ending_q;
  assign ask     = advance && !ending_q && there;
  assign leave   = advance && !ending_q && (there ? last : complete);

  always_comb begin
    pick_d   = pick_q;
    axis_d   = axis_q;
    ending_d = ending_q;
    record_d = record_q;
    next_d   = next_q;
    if (ask) begin
      record_d = next_q;
      next_d   = next_q + 1'b1;
    end
    if (leave) begin
      record_d = '0;
      next_d   = One;
      if (group_end) ending_d = 1'b1;
      else pick_d = pick_q << 1;
    end
    if (closes) begin
      ending_d = 1'b0;
      pick_d   = pick_q << 1;
      axis_d   = axis_q << 1;
    end
    if (!active_i) begin
      pick_d = FirstSegment;  // the others are at rest behind the last end beat
      axis_d = FirstAxis;
    end
  end

  // A record goes over the links of its axis and those behind it.
  logic [Axes-1:0] behind;
  for (genvar b = 0; b < Axes; b++) begin : gen_behind
    assign behind[b] = (axis_q[b:0] != '0);
  end

  // Everything waits for the links, and they say late whether a beat is taken: what else there is to know is known
  // from registers.
  assign axes_d   = held ? axes_q : answer_axes_q;
  assign end_d    = held ? end_q : answer_end_q;
  assign more_d   = valid_d && !end_d && (beat_d != LastBeat[BeatBits-1:0]);
  assign can_load = ((waits_q & ~ready_i) == '0);
  assign last_beat = end_q || (beat_q == LastBeat[BeatBits-1:0]);
  assign some_load = valid_q && can_load;
  assign held      = more_q || !can_load;
  assign answer_d  = held ? answer_q : (ask || closes);
  assign valid_d   = held ? valid_q : answer_q;
  assign beat_d    = !some_load ? beat_q : last_beat ? '0 : beat_q + 1'b1;
  assign sent_d    = active_i ? sent_q | (axes_q & {Axes{some_load && end_q}}) : '0;
  for (genvar f = 0; f < 2 * Axes; f++) begin : gen_face
    assign load_o[f]  = some_load && axes_q[f/2];
    // What was loaded waits there, and what was not taken.
    assign stays[f]   = valid_i[f] && !ready_i[f];
    assign waits_d[f] = !can_load ? waits_q[f] && stays[f]
                      : (more_q ? valid_q && axes_q[f/2] : answer_q && answer_axes_q[f/2])
                        && ((valid_q && axes_q[f/2] && has_link_i[f]) || stays[f]);
  end

  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      pick_q   <= FirstSegment;
      axis_q   <= FirstAxis;
      ending_q <= 1'b0;
      record_q <= '0;
      next_q   <= One;
      answer_q <= 1'b0;
      valid_q  <= 1'b0;
      waits_q  <= '0;
      more_q   <= 1'b0;
      beat_q   <= '0;
      sent_q   <= '0;
    end else begin
      pick_q   <= pick_d;
      axis_q   <= axis_d;
      ending_q <= ending_d;
      record_q <= record_d;
      next_q   <= next_d;
      answer_q <= answer_d;
      valid_q  <= valid_d;
      waits_q  <= waits_d;
      more_q   <= more_d;
      beat_q   <= beat_d;
      sent_q   <= sent_d;
    end
  end
  always_ff @(posedge clk_i) begin
    end_q  <= end_d;
    axes_q <= axes_d;
    if (!held) begin
      answer_end_q  <= ending_q;
      answer_own_q  <= pick_q[0] && !ending_q;
      answer_axes_q <= ending_q ? axis_q : behind;
      record_bits_q <= (own_i & {HaloBits{answer_own_q}}) | halo_i;
    end
  end

  assign read_o    = !held;
  assign clear_o   = ending_q ? '1 : ~pick_q;
  assign addr_o    = record_q[AddrBits-1:0];
  assign slot_o    = (active_i && pick_q[0] && !ending_q) ? record_q[SlotBits-1:0] : '0;
  assign end_o     = end_q;
  assign observe_o = answer_q && answer_own_q && !held;
  assign sent_o    = sent_q;

  logic [LinkBits-1:0] beat;
  cuboct_beat #(.Bits(HaloBits), .LinkBits(LinkBits), .BeatBits(BeatBits)) u_beat (
    .word_i(record_bits_q), .beat_i(beat_q), .data_o(beat)
  );
  assign data_o = (valid_q && !end_q) ? beat : '0;
endmodule
