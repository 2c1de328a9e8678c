// SPDX-License-Identifier: MIT
// First in, first out. What is pushed in cycle t is at the head, or counts as full, from t+1 on. The head is read
// without latency. No bypass: push_i only when not full, pop_i only when not empty.
module cuboct_fifo #(
  parameter int Bits  = 32,  // width of an entry, >= 1
  parameter int Depth = 16   // entries, >= 1
) (
  input  logic            clk_i,
  input  logic            rst_ni,
  input  logic            push_i,  // only in a cycle without full_o
  input  logic [Bits-1:0] data_i,  // with push_i
  output logic            full_o,  // Depth entries are held
  input  logic            pop_i,   // only in a cycle without empty_o
  output logic [Bits-1:0] data_o,  // the head, in a cycle without empty_o
  output logic            empty_o  // no entry is held
);
  localparam int PtrBits   = (Depth > 1) ? $clog2(Depth) : 1;
  localparam int CountBits = $clog2(Depth + 1);
  localparam int Last      = Depth - 1;
  localparam logic [CountBits-1:0] One = 1;

  logic [Bits-1:0]      mem_q [0:Depth-1];
  logic [PtrBits-1:0]   write_d, write_q, read_d, read_q;
  logic [CountBits-1:0] count_d, count_q;
  logic                 full_d, full_q, empty_d, empty_q;  // count_q is Depth, is 0

  always_comb begin
    write_d = write_q;
    read_d  = read_q;
    count_d = count_q;
    full_d  = full_q;
    empty_d = empty_q;
    if (push_i) write_d = (write_q == Last[PtrBits-1:0]) ? '0 : write_q + 1'b1;
    if (pop_i) read_d = (read_q == Last[PtrBits-1:0]) ? '0 : read_q + 1'b1;
    if (push_i && !pop_i) begin
      count_d = count_q + 1'b1;
      full_d  = (count_q == Last[CountBits-1:0]);
      empty_d = 1'b0;
    end
    if (pop_i && !push_i) begin
      count_d = count_q - 1'b1;
      full_d  = 1'b0;
      empty_d = (count_q == One);
    end
  end

  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      write_q <= '0;
      read_q  <= '0;
      count_q <= '0;
      full_q  <= 1'b0;
      empty_q <= 1'b1;
    end else begin
      write_q <= write_d;
      read_q  <= read_d;
      count_q <= count_d;
      full_q  <= full_d;
      empty_q <= empty_d;
    end
  end
  always_ff @(posedge clk_i) begin
    if (push_i) mem_q[write_q] <= data_i;
  end

  assign data_o  = mem_q[read_q];
  assign full_o  = full_q;
  assign empty_o = empty_q;
endmodule
