// SPDX-License-Identifier: MIT
// A memory with one write port and one read port, both synchronous: what FPGAs have as blocks. A word that is written
// in cycle t can be asked for from t+1 on; no one asks for a word in the cycle in which it is written.
module cuboct_ram #(
  parameter int Bits     = 66,  // >= 1
  parameter int Depth    = 16,  // words, >= 1
  parameter int AddrBits = 4    // >= clog2(Depth), >= 1
) (
  input  logic                clk_i,
  input  logic                write_i,      // a word is written
  input  logic [AddrBits-1:0] write_addr_i, // with write_i
  input  logic [Bits-1:0]     write_data_i, // with write_i
  input  logic                read_i,       // without it the answer stays
  input  logic                clear_i,      // with read_i: the answer is 0
  input  logic [AddrBits-1:0] read_addr_i,  // with read_i
  output logic [Bits-1:0]     read_data_o   // from the next cycle on
);
  localparam int IndexBits = (Depth > 1) ? $clog2(Depth) : 1;

  // Small ones may lie in distributed memory; the tools' own limit between the two spares blocks, not logic.
  if (Depth > 16) begin : gen_block
    (* no_rw_check, ram_style = "block" *) logic [Bits-1:0] mem_q [0:Depth-1];
    logic [Bits-1:0] read_q;
    always_ff @(posedge clk_i) begin
      if (write_i) mem_q[write_addr_i[IndexBits-1:0]] <= write_data_i;
    end
    always_ff @(posedge clk_i) begin
      if (read_i) begin
        if (clear_i) read_q <= '0;
        else read_q <= mem_q[read_addr_i[IndexBits-1:0]];
      end
    end
    assign read_data_o = read_q;
  end else begin : gen_any
    (* no_rw_check *) logic [Bits-1:0] mem_q [0:Depth-1];
    logic [Bits-1:0] read_q;
    always_ff @(posedge clk_i) begin
      if (write_i) mem_q[write_addr_i[IndexBits-1:0]] <= write_data_i;
    end
    always_ff @(posedge clk_i) begin
      if (read_i) begin
        if (clear_i) read_q <= '0;
        else read_q <= mem_q[read_addr_i[IndexBits-1:0]];
      end
    end
    assign read_data_o = read_q;
  end

  logic unused_addr;
  assign unused_addr = ^{write_addr_i, read_addr_i};
endmodule
