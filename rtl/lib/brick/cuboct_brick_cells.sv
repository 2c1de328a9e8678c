// SPDX-License-Identifier: MIT
// Walks the own cells, x first, again and again: the present cell and the one after it, both out of registers, so that
// nothing but multiplexers waits for advance_i. Numbers are those of cuboct_brick_place. The coordinates are
// those of the cell after these two.
module cuboct_brick_cells #(
  parameter int BrickX   = 2,
  parameter int BrickY   = 2,
  parameter int GridBits = 2,  // of a coordinate: cuboct_brick_walk
  parameter int CellBits = 3,  // of an own cell's number
  parameter int TagBits  = 4   // of a number in a face
) (
  input  logic                  clk_i,
  input  logic                  rst_ni,
  input  logic [3*GridBits-1:0] extent_i,      // constant, in the reset too
  input  logic                  advance_i,     // the next cycle has the cell after the present one
  output logic [CellBits-1:0]   own_o,         // the present cell: its number,
  output logic [3*TagBits-1:0]  face_o,        // those in the faces over x, y, z,
  output logic [2:0]            low_o,         // whether it is the lowest along x, y, z
  output logic [2:0]            high_o,        // whether it is the highest: with all three, the last cell
  output logic [CellBits-1:0]   after_own_o,   // the same of the cell after it, the first one after the last
  output logic [3*TagBits-1:0]  after_face_o,  // its numbers in the faces
  output logic [2:0]            after_low_o,   // whether it is the lowest
  output logic [2:0]            after_high_o   // whether it is the highest
);
  localparam int CoordBits = 3 * GridBits;
  localparam int Bits      = CellBits + 3 * TagBits + 6;
  localparam logic [GridBits-1:0] One = 1;

  function automatic logic [CoordBits-1:0] step(input logic [CoordBits-1:0] from, input logic [CoordBits-1:0] extent);
    integer a;
    logic   carry;
    begin
      step  = from;
      carry = 1'b1;
      for (a = 0; a < 3; a = a + 1) begin
        if (carry) begin
          carry                        = (from[a*GridBits +: GridBits] == extent[a*GridBits +: GridBits]);
          step[a*GridBits +: GridBits] = carry ? One : from[a*GridBits +: GridBits] + 1'b1;
        end
      end
    end
  endfunction

  // In the reset the walk comes to its first two cells.
  logic [CoordBits-1:0] at, coming_d, coming_q;
  logic [Bits-1:0]      here_d, here_q, after_d, after_q, coming;
  logic [3*TagBits-1:0] layer, face;
  logic [CellBits-1:0]  own;
  logic [2:0]           low, high, alone;  // alone: the first cell is the only one along the axis
  integer               b;
  assign at = rst_ni ? coming_q : step({3{One}}, extent_i);
  always_comb begin
    for (b = 0; b < 3; b = b + 1) begin
      low[b]   = (at[b*GridBits +: GridBits] == One);
      high[b]  = (at[b*GridBits +: GridBits] == extent_i[b*GridBits +: GridBits]);
      alone[b] = (extent_i[b*GridBits +: GridBits] == One);
    end
  end
  cuboct_brick_place #(
    .BrickX(BrickX), .BrickY(BrickY), .GridBits(GridBits), .CellBits(CellBits), .TagBits(TagBits)
  ) u_place (.cell_i(at), .own_o(own), .layer_o(layer), .face_o(face));
  assign coming = {own, face, low, high};
  always_comb begin
    here_d   = here_q;
    after_d  = after_q;
    coming_d = coming_q;
    if (advance_i || !rst_ni) begin
      here_d   = after_q;
      after_d  = coming;
      coming_d = step(at, extent_i);
    end
    if (!rst_ni) here_d = {{(CellBits + 3 * TagBits) {1'b0}}, 3'b111, alone};
  end
  always_ff @(posedge clk_i) begin
    here_q   <= here_d;
    after_q  <= after_d;
    coming_q <= coming_d;
  end
  assign {own_o, face_o, low_o, high_o}                         = here_q;
  assign {after_own_o, after_face_o, after_low_o, after_high_o} = after_q;
  logic unused_layer;
  assign unused_layer = ^layer;
endmodule
