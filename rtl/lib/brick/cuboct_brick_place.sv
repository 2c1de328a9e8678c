// SPDX-License-Identifier: MIT
// Numbers of a cell: of an own one in the brick, of one around it in the layers that lie over the axes, of an own one
// in the brick's faces. Coordinates as in cuboct_brick_walk. Combinational; a number of a cell that is not there is of
// no use.
module cuboct_brick_place #(
  parameter int BrickX   = 2,
  parameter int BrickY   = 2,
  parameter int GridBits = 2,  // of a coordinate
  parameter int CellBits = 3,  // of an own cell's number
  parameter int TagBits  = 4   // of a number in a layer or face, <= CellBits + 4
) (
  input  logic [3*GridBits-1:0] cell_i,   // x, y, z
  output logic [CellBits-1:0]   own_o,    // in the brick, x first
  output logic [3*TagBits-1:0]  layer_o,  // by axis: along x y, z; along y x, z, x from below the brick; along z x, y
  output logic [3*TagBits-1:0]  face_o    // by axis
);
  localparam int Bits = CellBits + 5;
  localparam int RowX = BrickX + 2;
  // x, y, z counted from the brick's first cell, and from the one below it.
  logic [Bits-1:0] in   [0:2];
  logic [Bits-1:0] grid [0:2];
  for (genvar a = 0; a < 3; a++) begin : gen_axis
    assign grid[a] = {{(Bits - GridBits) {1'b0}}, cell_i[a*GridBits +: GridBits]};
    assign in[a]   = grid[a] - 1'b1;
  end
  logic [Bits-1:0] own, layer_x, layer_y, layer_z, face_y, face_z;
  cuboct_brick_addr #(.Factor(BrickY), .CellBits(Bits), .SlotBits(Bits), .AddrBits(Bits)) u_layer_x (
    .cell_i(in[2]), .slot_i(in[1]), .addr_o(layer_x)
  );
  cuboct_brick_addr #(.Factor(BrickX), .CellBits(Bits), .SlotBits(Bits), .AddrBits(Bits)) u_own (
    .cell_i(layer_x), .slot_i(in[0]), .addr_o(own)
  );
  cuboct_brick_addr #(.Factor(RowX), .CellBits(Bits), .SlotBits(Bits), .AddrBits(Bits)) u_layer_y (
    .cell_i(in[2]), .slot_i(grid[0]), .addr_o(layer_y)
  );
  cuboct_brick_addr #(.Factor(RowX), .CellBits(Bits), .SlotBits(Bits), .AddrBits(Bits)) u_layer_z (
    .cell_i(grid[1]), .slot_i(grid[0]), .addr_o(layer_z)
  );
  cuboct_brick_addr #(.Factor(BrickX), .CellBits(Bits), .SlotBits(Bits), .AddrBits(Bits)) u_face_y (
    .cell_i(in[2]), .slot_i(in[0]), .addr_o(face_y)
  );
  cuboct_brick_addr #(.Factor(BrickX), .CellBits(Bits), .SlotBits(Bits), .AddrBits(Bits)) u_face_z (
    .cell_i(in[1]), .slot_i(in[0]), .addr_o(face_z)
  );
  assign own_o   = own[CellBits-1:0];
  assign layer_o = {layer_z[TagBits-1:0], layer_y[TagBits-1:0], layer_x[TagBits-1:0]};
  assign face_o  = {face_z[TagBits-1:0], face_y[TagBits-1:0], layer_x[TagBits-1:0]};
  logic unused_bits;
  assign unused_bits = ^{own, layer_x, layer_y, layer_z, face_y, face_z};
endmodule
