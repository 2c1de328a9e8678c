// SPDX-License-Identifier: MIT
// cuboct_ram for proofs: who asks for a word in the cycle in which it is written gets anything, as on FPGAs.
module cuboct_ram #(
  parameter int Bits     = 66,
  parameter int Depth    = 16,
  parameter int AddrBits = 4
) (
  input  logic                clk_i,
  input  logic                write_i,
  input  logic [AddrBits-1:0] write_addr_i,
  input  logic [Bits-1:0]     write_data_i,
  input  logic                read_i,
  input  logic                clear_i,
  input  logic [AddrBits-1:0] read_addr_i,
  output logic [Bits-1:0]     read_data_o
);
  (* anyseq *) logic [Bits-1:0] torn;
  logic [Bits-1:0]              word, read_q;
  logic [Depth*Bits-1:0]        mem_q;
  integer                       w, r;
  always_ff @(posedge clk_i) begin
    for (w = 0; w < Depth; w = w + 1) begin
      if (write_i && write_addr_i == w[AddrBits-1:0]) mem_q[w*Bits +: Bits] <= write_data_i;
    end
  end
  always_comb begin
    word = torn;  // there is no such word
    for (r = 0; r < Depth; r = r + 1) begin
      if (read_addr_i == r[AddrBits-1:0]) word = mem_q[r*Bits +: Bits];
    end
    if (write_i && write_addr_i == read_addr_i) word = torn;
  end
  always_ff @(posedge clk_i) begin
    if (read_i) read_q <= clear_i ? '0 : word;
  end
  assign read_data_o = read_q;
endmodule
