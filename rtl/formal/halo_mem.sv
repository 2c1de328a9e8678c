// SPDX-License-Identifier: MIT
// cuboct_halo_mem: the k-th record since the clear, k any, is what both ports read at address k while it
// counts.
module halo_mem_formal #(
  parameter int Depth = 3,
  parameter int Bits  = 2
) (
  input logic            clk_i,
  input logic            clear_i,
  input logic            append_i,
  input logic [Bits-1:0] data_i,
  input logic [7:0]      other_i   // an address
);
  localparam int AddrBits  = $clog2(Depth + 1);  // one to spare, as where depths differ by face
  localparam int CountBits = AddrBits + 1;

  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;

  // Halos come only where there is room and never in the cycle of the clear: cuboct_halos asserts the one,
  // the proof `neighbours` shows both.
  logic [CountBits-1:0] count, count_q;
  always_comb begin
    if (append_i) assume (running_q && !clear_i && count_q != Depth[CountBits-1:0]);
  end

  // The watched record's number.
  (* anyconst *) logic [AddrBits-1:0] watched;
  logic                               aside;  // the port looks elsewhere
  logic [AddrBits-1:0]                addr_a, addr_b;
  logic [Bits-1:0]                    data_a, data_b, value_q;
  assign aside  = other_i[7];
  assign addr_a = aside ? other_i[AddrBits-1:0] : watched;
  assign addr_b = aside ? watched : other_i[AddrBits-1:0];
  cuboct_halo_mem #(.Bits(Bits), .Depth(Depth), .AddrBits(AddrBits), .CountBits(CountBits)) u_dut (
    .clk_i, .rst_ni(running_q), .clear_i, .append_i, .data_i, .count_o(count),
    .addr_a_i(addr_a), .data_a_o(data_a), .addr_b_i(addr_b), .data_b_o(data_b)
  );

  logic counts, cleared_q;
  assign counts = ({1'b0, watched} < count_q);
  always_ff @(posedge clk_i) begin
    if (!running_q) begin
      count_q   <= '0;
      cleared_q <= 1'b0;
    end else begin
      if (clear_i) count_q <= '0;
      else if (append_i) count_q <= count_q + 1'b1;
      cleared_q <= cleared_q || (clear_i && count_q == Depth[CountBits-1:0]);
    end
    if (append_i && count_q == {1'b0, watched}) value_q <= data_i;
  end

  always_ff @(posedge clk_i) begin
    if (running_q) begin
      a_count: assert (count == count_q && count_q <= Depth[CountBits-1:0]);
      if (counts && addr_a == watched) a_port_a: assert (data_a == value_q);
      if (counts && addr_b == watched) a_port_b: assert (data_b == value_q);
      c_full:    cover (count == Depth[CountBits-1:0]);
      c_cleared: cover (cleared_q && count == '0);
      c_again:   cover (cleared_q && counts && value_q == '1);
    end
  end

  // What makes it inductive: where the watched record lies.
  (* keep *) logic [Depth*Bits-1:0] tap_mem;
  logic [Bits-1:0]                  lies;
  integer                           e;
  always_comb begin
    lies = '0;
    for (e = 0; e < Depth; e = e + 1) begin
      if (watched == e[AddrBits-1:0]) lies = tap_mem[e*Bits +: Bits];
    end
  end
  always_ff @(posedge clk_i) begin
    if (running_q && counts) i_lies: assert (lies == value_q);
  end
endmodule
