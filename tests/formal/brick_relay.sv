// SPDX-License-Identifier: MIT
// cuboct_brick_relay with its walk and its numbers of cells, through any number of steps of exchange phases, for bricks
// of any extent, with any links, any counts and any pauses of the links: over each face that has a link each record of
// each cell of the layer is sent once, cells and records in order, with the cell's number in the layer, from the memory
// in which it lies; then one end beat, then nothing until the phase is over. A record's content is its own name,
// (memory, cell, number), so what is sent tells where it was read. A count holds while the walk stays in its cell.
module brick_relay_formal #(
  parameter int Axes     = 2,
  parameter int BrickX   = 2,
  parameter int BrickY   = 1,
  parameter int BrickZ   = 1,
  parameter int SlotBits = 1,   // a cell holds up to 2^SlotBits records
  parameter int LinkBits = 8
) (
  input logic              clk_i,
  input logic [1:0]        can_load_i,
  input logic              over_i,   // the phase ends, if all was sent
  input logic              begin_i,  // a phase begins
  input logic [SlotBits:0] count_i,  // of the next cell
  input logic [SlotBits:0] stray_i   // of cells that the walk is not in
);
  localparam int Faces     = 2 * Axes;
  localparam int Longest   = (BrickX > BrickY) ? ((BrickX > BrickZ) ? BrickX : BrickZ)
                                               : ((BrickY > BrickZ) ? BrickY : BrickZ);
  localparam int GridBits  = $clog2(Longest + 2);
  localparam int PlaceBits = 3 * GridBits;
  localparam int Cells     = BrickX * BrickY * BrickZ;
  localparam int CellBits  = $clog2(Cells);
  localparam int LayerX    = BrickY * BrickZ;
  localparam int LayerY    = (BrickX + 2) * BrickZ;
  localparam int LayerZ    = (Axes == 3) ? (BrickX + 2) * (BrickY + 2) : 1;
  localparam int LayerXY   = (LayerX > LayerY) ? LayerX : LayerY;
  localparam int TagBits   = $clog2((LayerXY > LayerZ) ? LayerXY : LayerZ);
  localparam int CountBits = SlotBits + 1;
  localparam int Most      = 1 << SlotBits;
  localparam int HaloBits  = 3 + PlaceBits + SlotBits;
  localparam int Bits      = HaloBits + TagBits;
  localparam int Beats     = (Bits + LinkBits - 1) / LinkBits;
  localparam int LastBeat  = Beats - 1;
  localparam int BeatBits  = (Beats > 1) ? $clog2(Beats) : 1;
  localparam logic [GridBits-1:0] One = 1;
  localparam logic [2:0]          Own = 3'd7;
  localparam logic [GridBits-1:0] FullX = BrickX, FullY = BrickY, FullZ = BrickZ;

  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;
  (* anyconst *) logic [Faces-1:0]     has_link;
  (* anyconst *) logic [PlaceBits-1:0] extent;
  always_comb begin
    assume (extent[0 +: GridBits] >= 1 && extent[0 +: GridBits] <= BrickX);
    assume (extent[GridBits +: GridBits] >= 1 && extent[GridBits +: GridBits] <= BrickY);
    assume (extent[2*GridBits +: GridBits] >= 1 && extent[2*GridBits +: GridBits] <= BrickZ);
  end

  // The phases of a step, one axis after the other; one ends only when all was sent (cuboct_brick_core: exchange_done).
  logic       active_q, done, sent;
  logic [1:0] axis_q;
  assign done = active_q && sent && over_i;
  always_ff @(posedge clk_i) begin
    if (!running_q) begin
      active_q <= 1'b0;
      axis_q   <= 2'd0;
    end else begin
      active_q <= active_q ? (!done || begin_i) : begin_i;
      if (done) axis_q <= (axis_q == Axes - 1) ? 2'd0 : axis_q + 1'b1;
    end
  end

  logic [PlaceBits-1:0]     low, high, first, at, after, next, asked_q;
  logic                     advance, restart, step, last, is_end;
  logic [CellBits-1:0]      own, own_asked;
  logic [3*TagBits-1:0]     layer, face;
  logic [SlotBits-1:0]      record_q;          // asked for in the cycle before
  logic [1:0]               load;
  logic [LinkBits-1:0]      data;
  logic [2:0]               source;            // of the cell that the walk is in
  logic [CountBits-1:0]     count_q;
  logic [(Faces-2)*CountBits-1:0] halo_count;
  logic [(Faces-2)*HaloBits-1:0]  halos;
  cuboct_brick_walk #(.GridBits(GridBits)) u_walk (
    .clk_i, .rst_ni(running_q), .low_i(active_q ? low : {3{One}}), .high_i(active_q ? high : extent),
    .advance_i(advance),
    .restart_i(restart), .first_i(active_q ? first : {3{One}}), .cell_o(at), .after_o(after), .next_o(next),
    .last_o(last)
  );
  cuboct_brick_place #(
    .BrickX(BrickX), .BrickY(BrickY), .GridBits(GridBits), .CellBits(CellBits), .TagBits(TagBits)
  ) u_place (.cell_i(at), .own_o(own), .layer_o(layer), .face_o(face));
  cuboct_brick_relay #(
    .Axes(Axes), .BrickX(BrickX), .BrickY(BrickY), .BrickZ(BrickZ), .GridBits(GridBits), .TagBits(TagBits),
    .LinkBits(LinkBits), .HaloBits(HaloBits), .SlotBits(SlotBits), .CountBits(CountBits)
  ) u_dut (
    .clk_i, .rst_ni(running_q), .active_i(active_q), .axis_i(axis_q), .done_i(done), .has_link_i(has_link),
    .extent_i(extent), .low_o(low), .high_o(high), .advance_o(advance), .restart_o(restart), .first_o(first),
    .cell_i(at), .last_i(last), .layer_i(layer), .own_count_i((source == Own) ? count_q : stray_i),
    .halo_count_i(halo_count), .step_o(step), .own_i({Own, asked_q, record_q}), .halo_i(halos), .can_load_i,
    .load_o(load), .end_o(is_end), .data_o(data), .sent_o(sent)
  );
  always_ff @(posedge clk_i) begin
    asked_q  <= next;
    if (!running_q || advance || restart) record_q <= '0;
    else if (step) record_q <= record_q + 1'b1;
  end
  integer f;
  always_comb begin
    for (f = 0; f < Faces - 2; f = f + 1) begin
      halo_count[f*CountBits +: CountBits] = (source == f[2:0]) ? count_q : stray_i;
      halos[f*HaloBits +: HaloBits]        = {f[2:0], asked_q, record_q};
    end
  end

  // Where a cell of the box lies: beyond the brick along the last axis along which it is, else within.
  integer s;
  always_comb begin
    source = Own;
    for (s = 0; s < Axes - 1; s = s + 1) begin
      if (s[1:0] < axis_q && at[s*GridBits +: GridBits] == '0) source = {1'b0, s[1:0]} << 1;
      if (s[1:0] < axis_q && at[s*GridBits +: GridBits] > extent[s*GridBits +: GridBits])
        source = ({1'b0, s[1:0]} << 1) | 3'd1;
    end
  end
  function automatic logic in_layer(input logic [PlaceBits-1:0] place, input logic [1:0] axis, input logic up,
                                    input logic [PlaceBits-1:0] most, input logic [Faces-1:0] links);
    integer               b;
    logic [GridBits-1:0] x, e;
    begin
      in_layer = 1'b1;
      for (b = 0; b < 3; b = b + 1) begin
        x = place[b*GridBits +: GridBits];
        e = most[b*GridBits +: GridBits];
        if (b < Axes && axis == b[1:0]) in_layer = in_layer && x == (up ? e : One);
        else if (b < Axes && axis > b[1:0]) begin
          in_layer = in_layer && (x != '0 || links[2*b]) && (x <= e || (x == e + 1'b1 && links[2*b+1]));
        end else in_layer = in_layer && x != '0 && x <= e;
      end
    end
  endfunction

  // The watched record; the counts of the other cells are any.
  (* anyconst *) logic [PlaceBits-1:0] watched;
  (* anyconst *) logic [CountBits-1:0] watched_count;
  (* anyconst *) logic [SlotBits-1:0]  watched_record;
  always_comb begin
    assume (watched_count <= Most && {1'b0, watched_record} < watched_count);
    assume (count_q <= Most && stray_i <= Most);
    if (active_q && at == watched) assume (count_q == watched_count);
  end
  always_ff @(posedge clk_i) if (!active_q || advance || restart) count_q <= count_i;

  // What was sent over either face in this phase.
  logic [1:0]                linked, whole_now, ended_q, some_q, watched_q, want;
  logic                      thin;
  logic [Beats*LinkBits-1:0] parts_q, whole;
  logic [3:0]                beat_q;
  logic [2*(PlaceBits+SlotBits)-1:0] last_q;
  logic [PlaceBits-1:0]      sent_cell;
  logic [SlotBits-1:0]       sent_record;
  logic [2:0]                sent_source;
  logic [TagBits-1:0]        sent_tag, tag;
  logic [7:0]                x, y, z;
  localparam logic [7:0]     X = BrickX, Y = BrickY;
  integer                    b, l, e;
  assign {sent_tag, sent_source, sent_cell, sent_record} = whole[Bits-1:0];
  assign x = {{(8 - GridBits) {1'b0}}, sent_cell[0 +: GridBits]};
  assign y = {{(8 - GridBits) {1'b0}}, sent_cell[GridBits +: GridBits]};
  assign z = {{(8 - GridBits) {1'b0}}, sent_cell[2*GridBits +: GridBits]};
  always_comb begin
    whole = parts_q;
    for (b = 0; b < Beats; b = b + 1) if (beat_q == b[3:0]) whole[b*LinkBits +: LinkBits] = data;
    linked = 2'b00;
    thin   = 1'b0;
    for (l = 0; l < Axes; l = l + 1) if (axis_q == l[1:0]) linked = has_link[2*l +: 2];
    if (axis_q == 2'd0) thin = (BrickX == 1);
    if (axis_q == 2'd1) thin = (BrickY == 1);
    if (axis_q == 2'd2) thin = (BrickZ == 1);
    tag = y - 8'd1 + Y * (z - 8'd1);
    if (axis_q == 2'd1) tag = x + (X + 8'd2) * (z - 8'd1);
    if (axis_q == 2'd2) tag = x + (X + 8'd2) * y;
    want[0]   = linked[0] && in_layer(watched, axis_q, 1'b0, extent, has_link);
    want[1]   = linked[1] && in_layer(watched, axis_q, 1'b1, extent, has_link);
    whole_now = (!is_end && beat_q == LastBeat) ? load : 2'b00;
  end
  always_ff @(posedge clk_i) begin
    parts_q <= whole;
    if (!running_q || !active_q || done) begin
      beat_q    <= '0;
      ended_q   <= '0;
      some_q    <= '0;
      watched_q <= '0;
    end else begin
      if (load != 2'b00 && !is_end) beat_q <= (beat_q == LastBeat) ? '0 : beat_q + 1'b1;
      for (e = 0; e < 2; e = e + 1) begin
        if (whole_now[e]) begin
          some_q[e] <= 1'b1;
          last_q[e*(PlaceBits+SlotBits) +: PlaceBits+SlotBits] <= {sent_cell, sent_record};
          if (sent_cell == watched && sent_record == watched_record) watched_q[e] <= 1'b1;
        end
        if (load[e] && is_end) ended_q[e] <= 1'b1;
      end
    end
  end

  // Progress: a cycle in which the links can load moves (sent, pass, past, cell, record, beat) upwards.
  (* keep *) logic                tap_pass, tap_past;
  (* keep *) logic [BeatBits-1:0] tap_beat;
  logic [2+PlaceBits+SlotBits+BeatBits:0] rank, rank_q;
  logic                                   moves_q, again_q;
  assign rank = {sent, tap_pass, tap_past, at, record_q, tap_beat};
  always_ff @(posedge clk_i) begin
    rank_q  <= rank;
    moves_q <= running_q && active_q && can_load_i == 2'b11 && !sent;
    again_q <= running_q && (again_q || (done && axis_q == Axes - 1));
  end

  logic [PlaceBits+SlotBits-1:0] name;
  assign name = {sent_cell, sent_record};
  always_ff @(posedge clk_i) begin
    if (running_q) begin
      a_may:     assert ((load & ~can_load_i) == 2'b00 && (load == 2'b00 || (active_q && !sent)));
      a_links:   assert ((load & ~linked) == 2'b00 && (load & ended_q) == 2'b00);
      a_turn:    assert (thin ? load == 2'b00 || load == linked
                              : load != 2'b11 && (!load[1] || !linked[0] || ended_q[0]));
      a_read:    assert (whole_now == 2'b00 || (asked_q == at && sent_cell == at && sent_source == source
                                                && {1'b0, sent_record} < count_q));
      a_tag:     assert (whole_now == 2'b00 || sent_tag == tag);
      a_layer:   assert ((!whole_now[0] || in_layer(sent_cell, axis_q, 1'b0, extent, has_link))
                         && (!whole_now[1] || in_layer(sent_cell, axis_q, 1'b1, extent, has_link)));
      a_order:   assert ((!whole_now[0] || !some_q[0] || name > last_q[0 +: PlaceBits+SlotBits])
                         && (!whole_now[1] || !some_q[1] || name > last_q[PlaceBits+SlotBits +: PlaceBits+SlotBits]));
      a_all:     assert (!is_end || (load != 2'b00 && data == '0 && beat_q == '0
                                     && (load & want & ~watched_q) == 2'b00));
      a_sent:    assert (!sent || (active_q && ended_q == linked));
      a_home:    assert (!(axis_q == 2'd0 && !active_q) || at == {3{One}});
      a_progress: assert (!moves_q || rank > rank_q);
      c_corner:  cover (whole_now == 2'b10 && watched_q == 2'b00 && axis_q == Axes - 1 && sent_source == 3'd0
                        && sent_cell == watched && sent_record == Most - 1);
      c_ragged:  cover (sent && again_q && axis_q == 2'd0 && some_q != 2'b00 && extent != {FullZ, FullY, FullX});
      c_nothing: cover (sent && axis_q == Axes - 1 && linked == 2'b11 && some_q == 2'b00);
      c_all:     cover (is_end && axis_q == Axes - 1 && has_link == '1 && want[1] && watched_q[1]);
    end
  end
endmodule
