// SPDX-License-Identifier: MIT
// Walks the cells of a box, x first. A coordinate is one more than in docs/reference/node.md: 0 is the cell below the
// brick. After the last cell comes the first one again.
module cuboct_brick_walk #(
  parameter int GridBits = 3  // of a coordinate
) (
  input  logic                  clk_i,
  input  logic                  rst_ni,
  input  logic [3*GridBits-1:0] low_i,      // of the box, which may change from walk to walk
  input  logic [3*GridBits-1:0] high_i,     // >= low_i
  input  logic                  advance_i,  // the next cycle has the cell after this one
  input  logic                  restart_i,  // the next cycle's cell is first_i, whatever advance_i says
  input  logic [3*GridBits-1:0] first_i,    // with restart_i
  output logic [3*GridBits-1:0] cell_o,     // where the walk is
  output logic [3*GridBits-1:0] after_o,    // the one after it
  output logic [3*GridBits-1:0] next_o,     // the next cycle's
  output logic                  last_o      // cell_o is high_i
);
  logic [3*GridBits-1:0] cell_d, cell_q, after;
  logic [2:0]            at_high;
  logic                  carry;
  integer                a;
  always_comb begin
    after = cell_q;
    carry = 1'b1;
    for (a = 0; a < 3; a = a + 1) begin
      at_high[a] = (cell_q[a*GridBits +: GridBits] == high_i[a*GridBits +: GridBits]);
      if (carry) begin
        after[a*GridBits +: GridBits] = at_high[a] ? low_i[a*GridBits +: GridBits]
                                                   : cell_q[a*GridBits +: GridBits] + 1'b1;
      end
      carry = carry && at_high[a];
    end
  end
  always_comb begin
    cell_d = cell_q;
    if (advance_i) cell_d = after;
    if (restart_i) cell_d = first_i;
  end
  localparam logic [GridBits-1:0] One = 1;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) cell_q <= {3{One}};
    else cell_q <= cell_d;
  end
  assign cell_o  = cell_q;
  assign after_o = after;
  assign next_o  = cell_d;
  assign last_o  = (at_high == 3'b111);
endmodule
