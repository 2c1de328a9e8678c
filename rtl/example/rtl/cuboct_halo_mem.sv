// SPDX-License-Identifier: MIT
// The records that came over one face in this step: one write port, two read ports without latency (streamer, relay).
// A record appended in cycle t can be read and counts from t+1 on.
module cuboct_halo_mem #(
  parameter int Bits     = 66,  // width of a record, >= 1
  parameter int Depth    = 16,  // records, >= 1
  parameter int AddrBits = 4,   // of the read addresses, >= clog2(Depth)
  parameter int CountBits = 5   // of the count, >= clog2(Depth+1)
) (
  input  logic                 clk_i,
  input  logic                 rst_ni,
  input  logic                 clear_i,
  input  logic                 append_i,
  input  logic [Bits-1:0]      data_i,
  output logic [CountBits-1:0] count_o,
  input  logic [AddrBits-1:0]  addr_a_i,
  output logic [Bits-1:0]      data_a_o,
  input  logic [AddrBits-1:0]  addr_b_i,
  output logic [Bits-1:0]      data_b_o
);
  localparam int IndexBits = (Depth > 1) ? $clog2(Depth) : 1;

  logic [Bits-1:0]      mem_q [0:Depth-1];
  logic [CountBits-1:0] count_d, count_q;

  always_comb begin
    count_d = count_q;
    if (append_i) count_d = count_q + 1'b1;
    if (clear_i) count_d = '0;
  end
  always_ff @(posedge clk_i) begin
    if (!rst_ni) count_q <= '0;
    else count_q <= count_d;
  end
  always_ff @(posedge clk_i) begin
    if (append_i) mem_q[count_q[IndexBits-1:0]] <= data_i;
  end

  assign count_o  = count_q;
  assign data_a_o = mem_q[addr_a_i[IndexBits-1:0]];
  assign data_b_o = mem_q[addr_b_i[IndexBits-1:0]];

  logic unused_addr;
  assign unused_addr = ^{addr_a_i, addr_b_i};
endmodule
