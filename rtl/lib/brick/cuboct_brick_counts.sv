// SPDX-License-Identifier: MIT
// A number for each of some cells, zero after a reset and after clear_i. What is written in cycle t is read from t+1
// on, without latency. A cell that there is not reads as nothing known.
module cuboct_brick_counts #(
  parameter int Cells    = 8,  // >= 1
  parameter int AddrBits = 3,  // of a cell's number, >= clog2(Cells), >= 1
  parameter int Bits     = 5,  // of a number
  parameter int Reads    = 2   // read ports
) (
  input  logic                      clk_i,
  input  logic                      rst_ni,
  input  logic                      clear_i,   // not in a cycle with write_i
  input  logic                      write_i,   // a cell gets a number
  input  logic [AddrBits-1:0]       write_addr_i,  // which cell
  input  logic [Bits-1:0]           count_i,   // which number
  input  logic [Reads*AddrBits-1:0] addr_i,    // per port, a cell
  output logic [Reads*Bits-1:0]     count_o,   // per port, its number
  output logic                      any_o      // some number is not zero
);
  localparam int IndexBits = (Cells > 1) ? $clog2(Cells) : 1;

  logic [Cells-1:0] held_d, held_q;  // cells whose number is not zero
  integer           c;
  always_comb begin
    held_d = held_q;
    for (c = 0; c < Cells; c = c + 1) begin
      if (write_i && write_addr_i[IndexBits-1:0] == c[IndexBits-1:0]) held_d[c] = (count_i != '0);
    end
    if (clear_i) held_d = '0;
  end
  always_ff @(posedge clk_i) begin
    if (!rst_ni) held_q <= '0;
    else held_q <= held_d;
  end
  logic [Bits-1:0] mem_q [0:Cells-1];
  always_ff @(posedge clk_i) begin
    if (write_i) mem_q[write_addr_i[IndexBits-1:0]] <= count_i;
  end
  for (genvar r = 0; r < Reads; r++) begin : gen_read
    logic [IndexBits-1:0] index;
    assign index = addr_i[r*AddrBits +: IndexBits];
    assign count_o[r*Bits +: Bits] = mem_q[index] & {Bits{held_q[index]}};
  end
  assign any_o = (held_q != '0);
  logic unused_addr;
  assign unused_addr = ^{addr_i, write_addr_i};
endmodule
