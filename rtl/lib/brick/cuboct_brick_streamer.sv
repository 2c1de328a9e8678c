// SPDX-License-Identifier: MIT
// Walks the pairs of cells that may interact: segment 0 within the brick, then one for each face -x, +x, -y, +y, -z,
// +z; in each the own cells, for each the segment's cells around it, their records, and every record once for each row
// of the own cell's slots. One (record, row) per cycle; an own cell without particles, or a cell around without
// records, takes a cycle in which nobody meets, a segment without a link one in which nothing is presented.
module cuboct_brick_streamer #(
  parameter int Axes        = 3,  // 2 or 3
  parameter int BrickX      = 2,
  parameter int BrickY      = 2,
  parameter int GridBits    = 2,  // of a coordinate: cuboct_brick_walk
  parameter int CellBits    = 3,  // of an own cell's number
  parameter int TagBits     = 4,  // of a number in a layer
  parameter int FilterLanes = 8,  // slots per row
  parameter int RowBits     = 1,  // of a row's number in a cell
  parameter int SlotBits    = 4,  // of a record's number in a cell
  parameter int CountBits   = 5,  // of a cell's count
  localparam int Faces      = 2 * Axes
) (
  input  logic                  clk_i,
  input  logic                  rst_ni,
  input  logic                  run_i,        // the force engine's phase
  input  logic                  restart_i,    // its last cycle
  input  logic                  stall_i,      // nothing moves
  input  logic [Axes:0]         available_i,  // own; x, y, z halos complete
  input  logic [Faces-1:0]      has_link_i,
  input  logic [3*GridBits-1:0] extent_i,
  // Counts of the cells that are asked for, without latency: own, around as an own one, around in the layers.
  output logic [CellBits-1:0]   own_cell_o,   // own cell
  input  logic [CountBits-1:0]  own_count_i,  // its particles
  output logic [CellBits-1:0]   near_cell_o,  // cell around, if an own one
  input  logic [CountBits-1:0]  near_count_i, // its particles
  output logic [3*TagBits-1:0]  near_layer_o, // the same in the layers over x, y, z
  input  logic [Faces*CountBits-1:0] layer_count_i,  // by face, its records
  // What goes to the filter.
  output logic [2:0]            segment_o,    // 0 the brick, then -x, +x, -y, +y, -z, +z
  output logic [SlotBits-1:0]   record_o,     // number in its cell
  output logic [RowBits-1:0]    row_o,        // of the own cell's slots
  output logic [2*Axes-1:0]     offset_o,     // of the record's cell from the own one, per axis -1, 0, 1
  output logic                  same_o,       // both are one
  output logic                  present_o,    // in this cycle
  output logic                  nobody_o,     // ... without anybody to meet
  output logic                  past_o        // all segments are done
);
  localparam int Segments = Faces + 1;
  localparam int RowSlots = CountBits + $clog2(FilterLanes + 1);  // bits of a slot number beyond the last row

  logic [2:0]            segment_d, segment_q, other_segment;
  logic [5:0]            offset_d, offset_q, first_offset, next_offset, high_offset, low_offset;
  logic [SlotBits-1:0]   record_d, record_q;
  logic [RowBits-1:0]    row_d, row_q;
  logic [RowSlots-1:0]   next_slot_d, next_slot_q;  // first slot of the next row
  logic [CountBits-1:0]  count;
  logic                  available, linked, go, last_row, last_record, last_near, last_cell;
  logic                  leave_near, leave_visit, turns, enter;
  logic [3*GridBits-1:0] here, after, next, low, high, first, other, near, other_near;
  localparam logic [GridBits-1:0] One = 1;

  integer s;
  always_comb begin
    count     = near_count_i;
    available = (segment_q == 3'd0) && available_i[0];
    linked    = 1'b1;
    for (s = 1; s < Segments; s = s + 1) begin
      if (segment_q == s[2:0]) begin
        count     = layer_count_i[(s-1)*CountBits +: CountBits];
        available = available_i[(s+1)/2];
        linked    = has_link_i[s-1];
      end
    end
  end

  assign go            = run_i && !stall_i && available;
  assign present_o     = go && linked;
  assign nobody_o      = (own_count_i == '0) || (count == '0);
  assign last_row      = (next_slot_q >= {{(RowSlots - CountBits) {1'b0}}, own_count_i});
  assign last_record   = (count == {{(CountBits - SlotBits) {1'b0}}, record_q} + 1'b1);
  assign last_near     = (offset_q == high_offset);
  assign leave_near    = present_o && (nobody_o || (last_row && last_record));
  assign leave_visit   = leave_near && (last_near || own_count_i == '0);
  // The other visit is that of the cell after this one, or the first one of the segment after this one. Which one it
  // is, and all that is known of it, is there before it is known whether this visit ends.
  assign turns         = past_o || last_cell || !linked;
  assign other_segment = past_o ? 3'd0 : turns ? segment_q + 3'd1 : segment_q;
  assign enter         = leave_visit || (go && !linked) || restart_i;
  assign segment_d     = enter ? other_segment : segment_q;

  // The own cells of a segment: all, or those at the face.
  integer a;
  always_comb begin
    low   = {3{One}};
    high  = extent_i;
    first = {3{One}};
    for (a = 0; a < Axes; a = a + 1) begin
      if ({29'd0, segment_q} == 2 * a + 1) high[a*GridBits +: GridBits] = One;
      if ({29'd0, segment_q} == 2 * a + 2) low[a*GridBits +: GridBits] = extent_i[a*GridBits +: GridBits];
      if ({29'd0, other_segment} == 2 * a + 2) first[a*GridBits +: GridBits] = extent_i[a*GridBits +: GridBits];
    end
  end
  cuboct_brick_walk #(.GridBits(GridBits)) u_walk (
    .clk_i, .rst_ni, .low_i(low), .high_i(high), .advance_i(enter), .restart_i(enter && turns), .first_i(first),
    .cell_o(here), .after_o(after), .next_o(next), .last_o(last_cell)
  );
  assign other = turns ? first : after;

  // The cells around: one step along each axis, where the brick, or a halo that the segment's axis has, goes on; over
  // the segment's face always one step.
  function automatic logic [5:0] reach(input logic [3*GridBits-1:0] cell_at, input logic [3*GridBits-1:0] extent,
                                       input logic [Faces-1:0] has_link, input logic [2:0] segment, input logic up);
    integer b;
    logic   beyond;  // the segment's axis comes after this one: halos lie there
    begin
      reach = '0;
      for (b = 0; b < Axes; b = b + 1) begin
        beyond = ({29'd0, segment} > 2 * b + 2) && (up ? has_link[2*b+1] : has_link[2*b]);
        if (beyond || cell_at[b*GridBits +: GridBits] != (up ? extent[b*GridBits +: GridBits] : One))
          reach[2*b +: 2] = up ? 2'b01 : 2'b11;
        if ({29'd0, segment} == 2 * b + 1) reach[2*b +: 2] = 2'b11;
        if ({29'd0, segment} == 2 * b + 2) reach[2*b +: 2] = 2'b01;
      end
    end
  endfunction
  assign first_offset = reach(other, extent_i, has_link_i, other_segment, 1'b0);
  assign low_offset   = reach(here, extent_i, has_link_i, segment_q, 1'b0);
  assign high_offset  = reach(here, extent_i, has_link_i, segment_q, 1'b1);
  logic   carry;
  integer n;
  always_comb begin
    next_offset = offset_q;
    carry       = 1'b1;
    for (n = 0; n < Axes; n = n + 1) begin
      if (carry) begin
        next_offset[2*n +: 2] = (offset_q[2*n +: 2] == high_offset[2*n +: 2]) ? low_offset[2*n +: 2]
                                                                            : offset_q[2*n +: 2] + 2'd1;
      end
      carry = carry && (offset_q[2*n +: 2] == high_offset[2*n +: 2]);
    end
    offset_d = offset_q;
    if (leave_near) offset_d = next_offset;
    if (enter) offset_d = first_offset;
  end

  always_comb begin
    record_d    = record_q;
    row_d       = row_q;
    next_slot_d = next_slot_q;
    if (leave_near) begin
      row_d       = '0;
      next_slot_d = FilterLanes[RowSlots-1:0];
      record_d    = '0;
    end else if (present_o && last_row) begin
      row_d       = '0;
      next_slot_d = FilterLanes[RowSlots-1:0];
      record_d    = record_q + 1'b1;
    end else if (present_o) begin
      row_d       = row_q + 1'b1;
      next_slot_d = next_slot_q + FilterLanes[RowSlots-1:0];
    end
  end
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      segment_q   <= 3'd0;
      offset_q    <= '0;
      record_q    <= '0;
      row_q       <= '0;
      next_slot_q <= FilterLanes[RowSlots-1:0];
    end else begin
      segment_q   <= segment_d;
      offset_q    <= offset_d;
      record_q    <= record_d;
      row_q       <= row_d;
      next_slot_q <= next_slot_d;
    end
  end

  // Numbers of the own cell and of the one around, in registers: of the next one around, of the other visit, or the
  // same.
  logic [CellBits-1:0]  own_d, own_q, near_d, near_q, other_own, next_near_own, other_near_own;
  logic [3*TagBits-1:0] layer_d, layer_q, next_layer, other_layer, own_layer, own_face, next_face, other_face;
  for (genvar b = 0; b < 3; b++) begin : gen_near
    assign near[b*GridBits +: GridBits] = here[b*GridBits +: GridBits]
                                        + {{(GridBits - 1) {next_offset[2*b+1]}}, next_offset[2*b]};
    assign other_near[b*GridBits +: GridBits] = other[b*GridBits +: GridBits]
                                              + {{(GridBits - 1) {first_offset[2*b+1]}}, first_offset[2*b]};
  end
  cuboct_brick_place #(
    .BrickX(BrickX), .BrickY(BrickY), .GridBits(GridBits), .CellBits(CellBits), .TagBits(TagBits)
  ) u_own (.cell_i(other), .own_o(other_own), .layer_o(own_layer), .face_o(own_face));
  cuboct_brick_place #(
    .BrickX(BrickX), .BrickY(BrickY), .GridBits(GridBits), .CellBits(CellBits), .TagBits(TagBits)
  ) u_near (.cell_i(near), .own_o(next_near_own), .layer_o(next_layer), .face_o(next_face));
  cuboct_brick_place #(
    .BrickX(BrickX), .BrickY(BrickY), .GridBits(GridBits), .CellBits(CellBits), .TagBits(TagBits)
  ) u_other (.cell_i(other_near), .own_o(other_near_own), .layer_o(other_layer), .face_o(other_face));
  always_comb begin
    own_d   = own_q;
    near_d  = near_q;
    layer_d = layer_q;
    if (leave_near) begin
      near_d  = next_near_own;
      layer_d = next_layer;
    end
    if (enter) begin
      own_d   = other_own;
      near_d  = other_near_own;
      layer_d = other_layer;
    end
  end
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      own_q   <= '0;
      near_q  <= '0;
      layer_q <= '0;  // of no use in the brick
    end else begin
      own_q   <= own_d;
      near_q  <= near_d;
      layer_q <= layer_d;
    end
  end
  assign own_cell_o   = own_q;
  assign near_cell_o  = near_q;
  assign near_layer_o = layer_q;

  assign segment_o = segment_q;
  assign record_o  = record_q;
  assign row_o     = row_q;
  assign offset_o  = offset_q[2*Axes-1:0];
  assign same_o    = (segment_q == 3'd0) && (offset_q == '0);
  assign past_o    = (segment_q == Segments[2:0]);
  logic unused_places;
  assign unused_places = ^{next, own_layer, own_face, next_face, other_face};
endmodule
