// SPDX-License-Identifier: MIT
// cuboct_ring: the word of any cycle since the reset is at the output Depth cycles later, unchanged. A watched word,
// any of those that came, comes out in its turn: what came before it and behind it comes out before and behind it, as
// each word is one that may be watched. No place is read in the cycle in which it is written.
module ring_formal #(
  parameter int Bits  = 2,
  parameter int Depth = 3
) (
  input logic            clk_i,
  input logic [Bits-1:0] d_i,
  input logic            watch_i  // the word of this cycle is the one watched; any may be
);
  localparam int PlaceBits = (Depth > 2) ? $clog2(Depth) : 1;

  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;

  logic [Bits-1:0] q;
  cuboct_ring #(.Bits(Bits), .Depth(Depth)) u_dut (.clk_i, .rst_ni(running_q), .d_i, .q_o(q));

  // The watched word: its age in cycles, one bit each.
  logic            watched_q;
  logic [Depth:0]  age_q;  // bit 0 is unused: in the cycle itself it is at the input
  logic [Bits-1:0] value_q;
  always_ff @(posedge clk_i) begin
    if (!running_q) begin
      watched_q <= 1'b0;
      age_q     <= '0;
    end else begin
      age_q <= {age_q[Depth-1:1], 2'b00};
      if (watch_i && !watched_q) begin
        watched_q <= 1'b1;
        age_q[1]  <= 1'b1;
        value_q   <= d_i;
      end
    end
  end

  (* keep *) logic [PlaceBits-1:0] tap_write, tap_read;
  logic                            past_q;  // the watched word is out
  logic [PlaceBits-1:0]            place_q;  // where it was written
  always_ff @(posedge clk_i) begin
    past_q <= running_q && (past_q || age_q[Depth]);
    if (running_q && watch_i && !watched_q) place_q <= tap_write;
  end
  always_ff @(posedge clk_i) begin
    if (running_q) begin
      if (age_q[Depth]) a_value: assert (q == value_q);
      a_apart: assert (tap_read != tap_write);
      c_first:   cover (age_q[Depth] && value_q == '1);
      c_wrapped: cover (age_q[Depth-1] && tap_write < place_q && value_q == '1);
      c_past:    cover (past_q && q != value_q);
    end
  end
endmodule
