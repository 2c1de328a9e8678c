// SPDX-License-Identifier: MIT
// cuboct_brick_streamer through any number of steps, for bricks of any extent, with any links, any counts, halos that
// come when they like and any stalls: each (segment, own cell, cell around it, record, row) that may meet is presented
// once, in that order, with the numbers of both cells; `past` comes after the last one and only when every halo was
// there. A watched one, any, tells that none is left out; what is presented is always later than what was before.
module brick_streamer_formal #(
  parameter int Axes        = 2,
  parameter int BrickX      = 2,
  parameter int BrickY      = 1,
  parameter int BrickZ      = 1,
  parameter int FilterLanes = 1,
  parameter int SlotBits    = 1   // a cell holds up to 2^SlotBits particles or records
) (
  input logic              clk_i,
  input logic              stall_i,
  input logic              begin_i,
  input logic              over_i,
  input logic [Axes:0]     come_i,   // the halos of an axis are complete
  input logic [SlotBits:0] own_i, near_i, stray_i  // counts: of the next own cell, of the next one around, of others
);
  localparam int Faces     = 2 * Axes;
  localparam int Segments  = Faces + 1;
  localparam int Longest   = (BrickX > BrickY) ? ((BrickX > BrickZ) ? BrickX : BrickZ)
                                               : ((BrickY > BrickZ) ? BrickY : BrickZ);
  localparam int GridBits  = $clog2(Longest + 2);
  localparam int Cells     = BrickX * BrickY * BrickZ;
  localparam int CellBits  = $clog2(Cells);
  localparam int LayerX    = BrickY * BrickZ;
  localparam int LayerY    = (BrickX + 2) * BrickZ;
  localparam int LayerZ    = (Axes == 3) ? (BrickX + 2) * (BrickY + 2) : 1;
  localparam int LayerXY   = (LayerX > LayerY) ? LayerX : LayerY;
  localparam int TagBits   = $clog2((LayerXY > LayerZ) ? LayerXY : LayerZ);
  localparam int CountBits = SlotBits + 1;
  localparam int Most      = 1 << SlotBits;
  localparam int Rows      = (Most + FilterLanes - 1) / FilterLanes;
  localparam int RowBits   = (Rows > 1) ? $clog2(Rows) : 1;
  localparam int ItemBits  = 3 + CellBits + 2 * Axes;

  localparam logic [GridBits-1:0] FullX = BrickX, FullY = BrickY, FullZ = BrickZ;

  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;
  (* anyconst *) logic [Faces-1:0]      has_link;
  (* anyconst *) logic [3*GridBits-1:0] extent;
  always_comb begin
    assume (extent[0 +: GridBits] >= 1 && extent[0 +: GridBits] <= BrickX);
    assume (extent[GridBits +: GridBits] >= 1 && extent[GridBits +: GridBits] <= BrickY);
    assume (extent[2*GridBits +: GridBits] >= 1 && extent[2*GridBits +: GridBits] <= BrickZ);
  end

  // A step: the engine runs from begin to the restart in its last cycle, which comes after `past`.
  logic          run_q, past, restart;
  logic [Axes:0] available_q;
  assign restart = run_q && past && over_i;
  always_ff @(posedge clk_i) begin
    if (!running_q) run_q <= 1'b0;
    else run_q <= run_q ? (!restart || begin_i) : begin_i;
    if (!running_q || restart) available_q <= {{Axes{1'b0}}, 1'b1};
    else if (run_q) available_q <= available_q | come_i;
  end

  logic [2:0]                 segment;
  logic [SlotBits-1:0]        record;
  logic [RowBits-1:0]         row;
  logic [2*Axes-1:0]          offset;
  logic                       same, present, nobody;
  logic [CellBits-1:0]        own_cell, near_cell;
  logic [3*TagBits-1:0]       near_layer;
  logic [CountBits-1:0]       own, near, own_q, near_q;
  logic [Faces*CountBits-1:0] layer;
  cuboct_brick_streamer #(
    .Axes(Axes), .BrickX(BrickX), .BrickY(BrickY), .GridBits(GridBits), .CellBits(CellBits), .TagBits(TagBits),
    .FilterLanes(FilterLanes), .RowBits(RowBits), .SlotBits(SlotBits), .CountBits(CountBits)
  ) u_dut (
    .clk_i, .rst_ni(running_q), .run_i(run_q), .restart_i(restart), .stall_i, .available_i(available_q),
    .has_link_i(has_link), .extent_i(extent), .own_cell_o(own_cell), .own_count_i(own), .near_cell_o(near_cell),
    .near_count_i((segment == 3'd0) ? near : stray_i), .near_layer_o(near_layer), .layer_count_i(layer),
    .segment_o(segment), .record_o(record), .row_o(row), .offset_o(offset), .same_o(same), .present_o(present),
    .nobody_o(nobody), .past_o(past)
  );

  // Counts are any, but of one cell one: as long as the streamer is at it, once its segment is there.
  logic [2:0]              half;  // which axis the segment belongs to, 0 for own
  logic [ItemBits-1:0]     item, item_q;
  logic                    new_own, new_near;
  integer                  f;
  assign half     = (segment + 3'd1) >> 1;
  assign item     = {segment, own_cell, offset};
  assign new_own  = (item_q[2*Axes +: CellBits+3] != item[2*Axes +: CellBits+3]) || !run_q;
  assign new_near = (item_q != item) || !run_q || !available_q[half];
  assign own      = new_own ? own_i : own_q;
  assign near     = new_near ? near_i : near_q;
  always_comb begin
    for (f = 0; f < Faces; f = f + 1) layer[f*CountBits +: CountBits] = ({29'd0, segment} == f + 1) ? near : stray_i;
    assume (own <= Most && near <= Most && own_q <= Most && near_q <= Most);
  end
  always_ff @(posedge clk_i) begin
    item_q <= running_q ? item : '0;
    own_q  <= own;
    near_q <= near;
  end

  // What may meet: coordinates from 1, of own cells, and of cells around by their offset.
  function automatic logic meets(input logic [2:0] part, input logic [3*GridBits-1:0] at, input logic [2*Axes-1:0] off,
                                 input logic [3*GridBits-1:0] most, input logic [Faces-1:0] links);
    integer              b;
    logic [GridBits-1:0] x, e, n;
    logic [1:0]          o;
    begin
      meets = (part == 3'd0) || (part <= Faces && links[part-1]);
      for (b = 0; b < 3; b = b + 1) begin
        x = at[b*GridBits +: GridBits];
        e = most[b*GridBits +: GridBits];
        meets = meets && x != '0 && x <= e;
        if (b < Axes) begin
          o = off[2*b +: 2];
          n = x + {{(GridBits - 1) {o[1]}}, o[0]};
          if (o == 2'b10) meets = 1'b0;
          if ({29'd0, part} == 2 * b + 1) meets = meets && o == 2'b11 && n == '0;
          else if ({29'd0, part} == 2 * b + 2) meets = meets && o == 2'b01 && n == e + 1'b1;
          else if ({29'd0, part} > 2 * b + 2) begin
            meets = meets && (n != '0 || links[2*b]) && (n <= e || (n == e + 1'b1 && links[2*b+1]));
          end else meets = meets && n != '0 && n <= e;
        end
      end
    end
  endfunction
  logic [3*GridBits-1:0] here;
  logic [7:0]            nx, ny, nz;    // of the cell around
  logic [CountBits:0]    rows;
  integer                c, r;
  always_comb begin
    here = '0;
    for (c = 0; c < Cells; c = c + 1) begin
      if (own_cell == c[CellBits-1:0]) begin
        here[0 +: GridBits]          = c % BrickX + 1;
        here[GridBits +: GridBits]   = (c / BrickX) % BrickY + 1;
        here[2*GridBits +: GridBits] = c / (BrickX * BrickY) + 1;
      end
    end
    rows = '0;
    for (r = 0; r < Rows; r = r + 1) if (own > r * FilterLanes) rows = rows + 1'b1;
  end
  assign nx = {{(8 - GridBits) {1'b0}}, here[0 +: GridBits]} + {{7{offset[1]}}, offset[0]};
  assign ny = {{(8 - GridBits) {1'b0}}, here[GridBits +: GridBits]} + {{7{offset[3]}}, offset[2]};
  if (Axes == 3) begin : gen_third
    assign nz = {{(8 - GridBits) {1'b0}}, here[2*GridBits +: GridBits]} + {{7{offset[2*Axes-1]}}, offset[2*Axes-2]};
  end else begin : gen_flat
    assign nz = 8'd1;
  end
  // Their numbers in the brick and in the layers.
  localparam logic [7:0] X = BrickX, Y = BrickY;
  logic [7:0] number, along_x, along_y, along_z;
  assign along_x = (ny - 8'd1) + Y * (nz - 8'd1);
  assign number  = (nx - 8'd1) + X * along_x;
  assign along_y = nx + (X + 8'd2) * (nz - 8'd1);
  assign along_z = nx + (X + 8'd2) * ny;

  // The watched one.
  (* anyconst *) logic [2:0]            w_segment;
  (* anyconst *) logic [3*GridBits-1:0] w_at;
  (* anyconst *) logic [2*Axes-1:0]     w_offset;
  (* anyconst *) logic [CountBits-1:0]  w_own, w_near;
  (* anyconst *) logic [SlotBits-1:0]   w_record;
  (* anyconst *) logic [RowBits-1:0]    w_row;
  logic                                 at_watched, seen_q;
  always_comb begin
    at_watched = here == w_at && segment == w_segment && offset == w_offset;
    assume (w_own <= Most && w_near <= Most && {1'b0, w_record} < w_near);
    assume (w_row * FilterLanes < w_own);
    if (here == w_at) assume (own == w_own);
    if (at_watched) assume (near == w_near || !available_q[half]);
  end

  // Order: by axis -1 comes before 0 and 1.
  logic [ItemBits+SlotBits+RowBits-1:0] rank, rank_q, last_q;
  logic                                 moves_q, some_q, met_q, again_q;
  logic [2*Axes-1:0]                    sorted;
  integer                               a;
  always_comb begin
    for (a = 0; a < Axes; a = a + 1) sorted[2*a +: 2] = offset[2*a +: 2] + 2'd1;
    rank = {segment, own_cell, sorted, record, row};
  end
  always_ff @(posedge clk_i) begin
    rank_q  <= rank;
    moves_q <= running_q && run_q && !stall_i && !past && available_q[half];
    again_q <= running_q && (again_q || restart);
    if (!running_q || !run_q || restart) begin
      some_q <= 1'b0;
      seen_q <= 1'b0;
      met_q  <= 1'b0;
    end else if (present) begin
      some_q <= 1'b1;
      last_q <= rank;
      met_q  <= met_q || !nobody;
      if (at_watched && record == w_record && row == w_row) seen_q <= !nobody;
    end
  end

  logic watch;
  assign watch = meets(w_segment, w_at, w_offset, extent, has_link);
  always_ff @(posedge clk_i) begin
    if (running_q) begin
      a_may:    assert (!present || (run_q && !stall_i && available_q[half] && !past));
      a_meets:  assert (!present || meets(segment, here, offset, extent, has_link));
      a_inside: assert (!present || nobody || ({1'b0, record} < near && row < rows));
      a_nobody: assert (!present || nobody == (own == '0 || near == '0));
      a_order:  assert (!present || !some_q || rank > last_q);
      a_all:    assert (!past || !watch || seen_q);
      a_past:   assert (!past || (run_q && available_q == '1) || !run_q);
      a_same:   assert (same == (segment == 3'd0 && offset == '0));
      a_near:   assert (!present || segment != 3'd0 || near_cell == number);
      a_layer_x: assert (!present || (segment != 3'd1 && segment != 3'd2) || near_layer[0 +: TagBits] == along_x);
      a_layer_y: assert (!present || (segment != 3'd3 && segment != 3'd4)
                         || near_layer[TagBits +: TagBits] == along_y);
      a_layer_z: assert (!present || segment < 3'd5 || near_layer[2*TagBits +: TagBits] == along_z);
      a_progress: assert (!moves_q || rank > rank_q);
      c_corner: cover (present && !nobody && segment == Segments - 1 && at_watched && record == Most - 1
                       && row == Rows - 1 && offset[1:0] == 2'b11 && own_cell == '0);
      c_ragged: cover (past && again_q && some_q && extent != {FullZ, FullY, FullX} && seen_q && watch);
      c_empty:  cover (past && !met_q && has_link == '1);
      c_across: cover (present && !nobody && segment == 3'd0 && !same && at_watched && row == Rows - 1);
    end
  end
endmodule
