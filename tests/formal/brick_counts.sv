// SPDX-License-Identifier: MIT
// cuboct_brick_counts: each port reads of a watched cell, any, what was written last since the reset and the last
// clear, else zero; `any` says exactly whether some cell's number is not zero.
module brick_counts_formal #(
  parameter int Cells    = 3,
  parameter int AddrBits = 2,
  parameter int Bits     = 2
) (
  input logic                  clk_i,
  input logic                  clear_i, write_i,
  input logic [AddrBits-1:0]   write_addr_i,
  input logic [Bits-1:0]       count_i,
  input logic [2*AddrBits-1:0] addr_i
);
  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;
  (* anyconst *) logic [AddrBits-1:0] watched;
  always_comb begin
    assume (watched < Cells);
    if (write_i) assume (!clear_i && write_addr_i < Cells);
  end
  logic [2*Bits-1:0] count;
  logic              any;
  cuboct_brick_counts #(.Cells(Cells), .AddrBits(AddrBits), .Bits(Bits), .Reads(2)) u_dut (
    .clk_i, .rst_ni(running_q), .clear_i, .write_i, .write_addr_i, .count_i, .addr_i, .count_o(count), .any_o(any)
  );
  logic [Bits-1:0]  value_q;
  logic [Cells-1:0] some_q;  // by cell
  logic             cleared_q;
  integer           c;
  always_ff @(posedge clk_i) begin
    if (!running_q || clear_i) value_q <= '0;
    else if (write_i && write_addr_i == watched) value_q <= count_i;
    for (c = 0; c < Cells; c = c + 1) begin
      if (!running_q || clear_i) some_q[c] <= 1'b0;
      else if (write_i && write_addr_i == c[AddrBits-1:0]) some_q[c] <= (count_i != '0);
    end
    cleared_q <= running_q && (cleared_q || (clear_i && some_q == '1));
  end
  always_ff @(posedge clk_i) begin
    if (running_q) begin
      a_low:  assert (addr_i[0 +: AddrBits] != watched || count[0 +: Bits] == value_q);
      a_high: assert (addr_i[AddrBits +: AddrBits] != watched || count[Bits +: Bits] == value_q);
      a_any:  assert (any == (some_q != '0));
      c_all:  cover (some_q == '1 && value_q == '1 && watched == Cells - 1);
      c_zero: cover (cleared_q && (any || Cells == 1) && value_q == '0 && addr_i == {2{watched}});
      c_none: cover (cleared_q && !any && $past(write_i));
    end
  end
endmodule
