// SPDX-License-Identifier: MIT
// cuboct_brick_addr is cell * Factor + slot. cuboct_brick_place gives each cell of a brick, of each of its layers and
// of each of its faces the number that docs/reference/node.md, "Bricks", says, below the number of cells there are;
// two cells never have the same.
module brick_place_formal #(
  parameter int Axes   = 3,
  parameter int BrickX = 2,
  parameter int BrickY = 3,
  parameter int BrickZ = 2,
  parameter int Factor = 3   // of the address alone
) (
  input logic [8:0] one_i, two_i,
  input logic [3:0] cell_i, slot_i
);
  localparam int GridBits = 3;
  localparam int Cells    = BrickX * BrickY * BrickZ;
  localparam int CellBits = (Cells > 1) ? $clog2(Cells) : 1;
  localparam int LayerX   = BrickY * BrickZ;
  localparam int LayerY   = (BrickX + 2) * BrickZ;
  localparam int LayerZ   = (BrickX + 2) * (BrickY + 2);
  localparam int LayerXY  = (LayerX > LayerY) ? LayerX : LayerY;
  localparam int TagBits  = $clog2((Axes == 3 && LayerZ > LayerXY) ? LayerZ : LayerXY);

  logic [CellBits-1:0]  own_one, own_two;
  logic [3*TagBits-1:0] layer_one, layer_two, face_one, face_two;
  cuboct_brick_place #(
    .BrickX(BrickX), .BrickY(BrickY), .GridBits(GridBits), .CellBits(CellBits), .TagBits(TagBits)
  ) u_one (.cell_i(one_i), .own_o(own_one), .layer_o(layer_one), .face_o(face_one));
  cuboct_brick_place #(
    .BrickX(BrickX), .BrickY(BrickY), .GridBits(GridBits), .CellBits(CellBits), .TagBits(TagBits)
  ) u_two (.cell_i(two_i), .own_o(own_two), .layer_o(layer_two), .face_o(face_two));
  logic [7:0] addr;
  cuboct_brick_addr #(.Factor(Factor), .CellBits(4), .SlotBits(4), .AddrBits(8)) u_addr (
    .cell_i, .slot_i, .addr_o(addr)
  );

  // Coordinates from 0, halo cells among them: one less than what the modules walk in.
  function automatic logic in_brick(input logic [8:0] at);
    in_brick = at[2:0] >= 1 && at[2:0] <= BrickX && at[5:3] >= 1 && at[5:3] <= BrickY && at[8:6] >= 1
        && at[8:6] <= BrickZ;
  endfunction
  function automatic logic in_layer_y(input logic [8:0] at);
    in_layer_y = at[2:0] <= BrickX + 1 && at[8:6] >= 1 && at[8:6] <= BrickZ;
  endfunction
  function automatic logic in_layer_z(input logic [8:0] at);
    in_layer_z = Axes == 3 && at[2:0] <= BrickX + 1 && at[5:3] <= BrickY + 1;
  endfunction
  logic [31:0] x, y, z;
  assign x = {29'd0, one_i[2:0]} - 32'd1;
  assign y = {29'd0, one_i[5:3]} - 32'd1;
  assign z = {29'd0, one_i[8:6]} - 32'd1;
  logic both, both_y, both_z;
  assign both   = in_brick(one_i) && in_brick(two_i);
  assign both_y = in_layer_y(one_i) && in_layer_y(two_i);
  assign both_z = in_layer_z(one_i) && in_layer_z(two_i);

  always_comb begin
    a_addr: assert ({24'd0, addr} == ({28'd0, cell_i} * Factor + {28'd0, slot_i}) % 256);
    if (in_brick(one_i)) begin
      a_own:   assert (own_one == x + BrickX * (y + BrickY * z) && own_one < Cells);
      a_x:     assert (layer_one[0 +: TagBits] == y + BrickY * z && layer_one[0 +: TagBits] < LayerX
                       && face_one[0 +: TagBits] == layer_one[0 +: TagBits]);
      a_face:  assert (face_one[TagBits +: TagBits] == x + BrickX * z
                       && face_one[TagBits +: TagBits] < BrickX * BrickZ);
      if (Axes == 3) a_face_z: assert (face_one[2*TagBits +: TagBits] == x + BrickX * y);
    end
    if (in_layer_y(one_i)) a_y: assert (layer_one[TagBits +: TagBits] == (x + 1) + (BrickX + 2) * z
                                        && layer_one[TagBits +: TagBits] < LayerY);
    if (in_layer_z(one_i)) a_z: assert (layer_one[2*TagBits +: TagBits] == (x + 1) + (BrickX + 2) * (y + 1)
                                        && layer_one[2*TagBits +: TagBits] < LayerZ);
    a_once:   assert (!both || one_i == two_i || own_one != own_two);
    a_once_x: assert (!both || one_i[8:3] == two_i[8:3] || layer_one[0 +: TagBits] != layer_two[0 +: TagBits]);
    a_once_y: assert (!both_y || {one_i[8:6], one_i[2:0]} == {two_i[8:6], two_i[2:0]}
                      || layer_one[TagBits +: TagBits] != layer_two[TagBits +: TagBits]);
    a_once_z: assert (!both_z || one_i[5:0] == two_i[5:0]
                      || layer_one[2*TagBits +: TagBits] != layer_two[2*TagBits +: TagBits]);
    a_once_f: assert (!both || {one_i[8:6], one_i[2:0]} == {two_i[8:6], two_i[2:0]}
                      || face_one[TagBits +: TagBits] != face_two[TagBits +: TagBits]);
    c_ends:   cover (both && own_one == Cells - 1 && own_two == '0 && both_y && layer_two[TagBits +: TagBits] == 1
                     && addr == Factor + 1);
  end
endmodule
