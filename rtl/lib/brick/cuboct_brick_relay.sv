// SPDX-License-Identifier: MIT
// The sender of a brick's exchange phases: over each face of the axis the layer of cells at it, own ones and, along the
// axes before this one, halos; to both faces at once where the brick is one cell thick, else first to the low one. One
// thing per cycle: a cell without records is left, a beat is loaded, or it waits.
module cuboct_brick_relay #(
  parameter int Axes      = 3,   // 2 or 3
  parameter int BrickX    = 2,
  parameter int BrickY    = 2,
  parameter int BrickZ    = 2,
  parameter int GridBits  = 2,
  parameter int TagBits   = 4,
  parameter int LinkBits  = 32,  // payload of a beat
  parameter int HaloBits  = 60,  // of a record without its cell
  parameter int SlotBits  = 4,   // of a record's number in its cell
  parameter int CountBits = 5,
  localparam int Faces    = 2 * Axes
) (
  input  logic                  clk_i,
  input  logic                  rst_ni,
  input  logic                  active_i,    // the machine is in an exchange phase
  input  logic [1:0]            axis_i,      // below Axes
  input  logic                  done_i,      // last cycle of the phase
  input  logic [Faces-1:0]      has_link_i,
  input  logic [3*GridBits-1:0] extent_i,
  // The walk over the layer's cells: cuboct_brick_walk.
  output logic [3*GridBits-1:0] low_o,       // the box of this walk
  output logic [3*GridBits-1:0] high_o,      // the box of this walk
  output logic                  advance_o,   // to the next cell
  output logic                  restart_o,   // to first_o
  output logic [3*GridBits-1:0] first_o,     // of the walk after this one
  input  logic [3*GridBits-1:0] cell_i,      // where the walk is
  input  logic                  last_i,      // at its last cell
  input  logic [3*TagBits-1:0]  layer_i,     // the cell's numbers
  // The cell's records: of each face but those of the last axis, and own ones.
  input  logic [CountBits-1:0]  own_count_i, // own particles
  input  logic [(Faces-2)*CountBits-1:0] halo_count_i,  // by face
  output logic                  step_o,      // the next cycle's record is the cell's next; a cell's first comes first
  input  logic [HaloBits-1:0]   own_i,       // the record
  input  logic [(Faces-2)*HaloBits-1:0] halo_i,  // by face
  // To the link registers of the axis: below, above.
  input  logic [1:0]            can_load_i,  // whether each link register can take a beat in this cycle
  output logic [1:0]            load_o,      // which link registers take a beat
  output logic                  end_o,       // with load_o: an end beat
  output logic [LinkBits-1:0]   data_o,      // with load_o: payload
  output logic                  sent_o       // the end beats were loaded
);
  localparam int Bits     = HaloBits + TagBits;
  localparam int Beats    = (Bits + LinkBits - 1) / LinkBits;
  localparam int BeatBits = (Beats > 1) ? $clog2(Beats) : 1;
  localparam int LastBeat = Beats - 1;
  localparam logic [GridBits-1:0] One  = 1;
  localparam logic [2:0]          Thin = {BrickZ == 1, BrickY == 1, BrickX == 1};

  logic                 pass_d, pass_q;    // 1: to the high face
  logic                 past_d, past_q;    // no cell is left
  logic                 sent_d, sent_q;
  logic [SlotBits-1:0]  record_d, record_q;
  logic [BeatBits-1:0]  beat_d, beat_q;
  logic [CountBits-1:0] count;
  logic [HaloBits-1:0]  record;
  logic [1:0]           linked, faces;
  logic                 thin, working, can, empty, last_record, over, last_pass;

  // Bounds of this layer; the first cell of the next one, which is that of the own cells after the last axis.
  logic       next_pass;
  logic [1:0] next_axis;
  integer     a;
  assign next_pass = !last_pass;
  assign next_axis = last_pass ? axis_i + 2'd1 : axis_i;
  always_comb begin
    linked  = 2'b00;
    thin    = 1'b0;
    low_o   = {3{One}};
    high_o  = extent_i;
    first_o = {3{One}};
    for (a = 0; a < Axes; a = a + 1) begin
      if (axis_i == a[1:0]) begin
        linked = has_link_i[2*a +: 2];
        thin   = Thin[a];
        if (pass_q) low_o[a*GridBits +: GridBits] = extent_i[a*GridBits +: GridBits];
        else high_o[a*GridBits +: GridBits] = One;
      end else if (axis_i > a[1:0]) begin
        if (has_link_i[2*a]) low_o[a*GridBits +: GridBits] = '0;
        if (has_link_i[2*a+1]) high_o[a*GridBits +: GridBits] = extent_i[a*GridBits +: GridBits] + 1'b1;
      end
      if (next_axis == a[1:0]) begin
        if (next_pass) first_o[a*GridBits +: GridBits] = extent_i[a*GridBits +: GridBits];
      end else if (next_axis > a[1:0] && {30'd0, next_axis} != Axes) begin
        if (has_link_i[2*a]) first_o[a*GridBits +: GridBits] = '0;
      end
    end
  end

  // The cell's place: beyond the brick along the last axis along which it is, there at all; else an own one.
  integer b;
  always_comb begin
    count  = own_count_i;
    record = own_i;
    for (b = 0; b < Axes - 1; b = b + 1) begin
      if (cell_i[b*GridBits +: GridBits] == '0) begin
        count  = halo_count_i[2*b*CountBits +: CountBits];
        record = halo_i[2*b*HaloBits +: HaloBits];
      end else if (cell_i[b*GridBits +: GridBits] > extent_i[b*GridBits +: GridBits]) begin
        count  = halo_count_i[(2*b+1)*CountBits +: CountBits];
        record = halo_i[(2*b+1)*HaloBits +: HaloBits];
      end
    end
  end

  assign faces       = thin ? linked : (linked & {pass_q, !pass_q});
  assign last_pass   = thin || pass_q;
  assign working     = active_i && !sent_q;
  assign can         = ((faces & ~can_load_i) == 2'b00);
  assign empty       = (count == '0);
  assign last_record = (count == {{(CountBits - SlotBits) {1'b0}}, record_q} + 1'b1);
  assign end_o       = working && past_q && can && faces != 2'b00;
  assign over        = working && (faces == 2'b00 || end_o);  // the pass is
  assign load_o      = (working && can && (past_q || !empty)) ? faces : 2'b00;
  assign restart_o   = over;

  always_comb begin
    pass_d    = pass_q;
    past_d    = past_q;
    sent_d    = sent_q;
    record_d  = record_q;
    beat_d    = beat_q;
    advance_o = 1'b0;
    step_o    = 1'b0;
    if (over) begin
      past_d = 1'b0;
      pass_d = next_pass;
      sent_d = last_pass;
    end else if (working && !past_q && empty) begin
      advance_o = 1'b1;
    end else if (working && !past_q && can) begin
      beat_d = beat_q + 1'b1;
      if (beat_q == LastBeat[BeatBits-1:0]) begin
        beat_d    = '0;
        record_d  = last_record ? '0 : record_q + 1'b1;
        advance_o = last_record;
        step_o    = !last_record;
      end
    end
    if (advance_o && last_i) past_d = 1'b1;
    if (done_i) sent_d = 1'b0;
  end
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      pass_q   <= 1'b0;
      past_q   <= 1'b0;
      sent_q   <= 1'b0;
      record_q <= '0;
      beat_q   <= '0;
    end else begin
      pass_q   <= pass_d;
      past_q   <= past_d;
      sent_q   <= sent_d;
      record_q <= record_d;
      beat_q   <= beat_d;
    end
  end

  logic [TagBits-1:0] tag;
  integer             t;
  always_comb begin
    tag = layer_i[0 +: TagBits];
    for (t = 1; t < Axes; t = t + 1) if (axis_i == t[1:0]) tag = layer_i[t*TagBits +: TagBits];
  end
  logic [LinkBits-1:0] beat;
  cuboct_beat #(.Bits(Bits), .LinkBits(LinkBits), .BeatBits(BeatBits)) u_beat (
    .word_i({tag, record}), .beat_i(beat_q), .data_o(beat)
  );
  assign data_o   = end_o ? '0 : beat;
  assign sent_o   = sent_q;
endmodule
