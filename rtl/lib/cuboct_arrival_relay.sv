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
  input  logic [(2*Axes-1)*CountBits-1:0] counts_i,  // records that have come
  input  logic [2*Axes-2:0]      complete_i,  // no other will come
  output logic                   read_o,      // asks for what comes next; without it the answers stay
  output logic [2*Axes-2:0]      clear_o,     // by segment: its memory's answer becomes 0, as it is not asked
  output logic [AddrBits-1:0]    addr_o,      // with read_o: of the record
  output logic [SlotBits-1:0]    slot_o,      // addr_o, for the own particles; 0 where none is asked for
  input  logic [HaloBits-1:0]    own_i,       // the answer of the own particles
  input  logic [HaloBits-1:0]    halo_i,      // that of the halos; 0 if none was asked for
  // To the link registers.
  input  logic [2*Axes-1:0]      can_load_i,  // by face
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
  localparam logic [Segments-1:0] FirstSegment = 1;
  localparam logic [Axes-1:0] FirstAxis = 1;

  // What is asked for.
  logic [Segments-1:0]  pick_d, pick_q;      // segment
  logic [Axes-1:0]      axis_d, axis_q;      // of the segment, and of the next end beat; none: all is sent
  logic                 ending_d, ending_q;  // the end beat comes next
  logic [CountBits-1:0] record_d, record_q, next_d, next_q;  // its number, and 1
  logic [CountBits-1:0] count;
  logic                 complete, there, last, closes, ask, leave, group_end, advance, held;
  // What the memories answer, and what the links load.
  logic                 answer_d, answer_q, answer_end_q, answer_own_q, valid_d, valid_q, end_q, some_load;
  logic [Axes-1:0]      answer_axes_q, axes_q, sent_d, sent_q;
  logic [HaloBits-1:0]  record_bits_q;
  logic [BeatBits-1:0]  beat_d, beat_q;
  logic                 last_beat, can_load;

  integer s;
  always_comb begin
    count     = '0;
    complete  = 1'b0;
    group_end = 1'b0;
    for (s = 0; s < Segments; s = s + 1) begin
      count    = count | (counts_i[s*CountBits +: CountBits] & {CountBits{pick_q[s]}});
      complete = complete || (complete_i[s] && pick_q[s]);
      if (s % 2 == 0) group_end = group_end || pick_q[s];
    end
  end
  assign there   = (record_q != count);
  assign last    = complete && (next_q == count);
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
      pick_d   = FirstSegment;
      axis_d   = FirstAxis;
      ending_d = 1'b0;
      record_d = '0;
      next_d   = One;
    end
  end

  // A record goes over the links of its axis and those behind it.
  logic [Axes-1:0] behind;
  for (genvar b = 0; b < Axes; b++) begin : gen_behind
    assign behind[b] = (axis_q[b:0] != '0);
  end

  integer a;
  always_comb begin
    can_load = 1'b1;
    for (a = 0; a < Axes; a = a + 1) begin
      if (axes_q[a] && can_load_i[2*a +: 2] != 2'b11) can_load = 1'b0;
    end
  end
  assign last_beat = end_q || (beat_q == LastBeat[BeatBits-1:0]);
  assign some_load = valid_q && can_load;
  assign held      = valid_q && !(can_load && last_beat);
  assign answer_d  = held ? answer_q : (ask || closes);
  assign valid_d   = held ? valid_q : answer_q;
  assign beat_d    = !some_load ? beat_q : last_beat ? '0 : beat_q + 1'b1;
  assign sent_d    = active_i ? sent_q | (axes_q & {Axes{some_load && end_q}}) : '0;
  for (genvar f = 0; f < 2 * Axes; f++) begin : gen_face
    assign load_o[f] = some_load && axes_q[f/2];
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
      beat_q   <= beat_d;
      sent_q   <= sent_d;
    end
  end
  always_ff @(posedge clk_i) begin
    if (!held) begin
      answer_end_q  <= ending_q;
      answer_own_q  <= pick_q[0] && !ending_q;
      answer_axes_q <= ending_q ? axis_q : behind;
      end_q         <= answer_end_q;
      axes_q        <= answer_axes_q;
      record_bits_q <= (own_i & {HaloBits{answer_own_q}}) | halo_i;
    end
  end

  assign read_o    = !held;
  assign clear_o   = (ending_q ? '1 : ~pick_q) & {Segments{!held}};
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
