// SPDX-License-Identifier: MIT
// cuboct_hold: what came in with a pair, any of them, is at the output Depth cycles later; and, where registers stand
// between, from the cycle in which the last one takes it until the next pair's is taken there.
module hold_formal #(
  parameter int Depth    = 5,
  parameter int Interval = 2
) (
  input logic       clk_i,
  input logic       pair_i,
  input logic [1:0] d_i,
  input logic       watch_i  // the pair that comes in this cycle is the one watched; any may be
);
  localparam int Registers = Depth / Interval;
  localparam int Taken     = Registers * Interval;  // cycles until the last register shows it

  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;

  // Pairs come Interval cycles after one another, or later; a pair's input stays for as long.
  logic [Depth:0] valid;
  logic [Depth:1] valid_q;
  logic [3:0]     since_q;
  logic [1:0]     before_q;
  assign valid = {valid_q, pair_i};
  always_comb begin
    if (pair_i) assume (running_q && since_q >= Interval[3:0]);
    if (since_q < Interval[3:0]) assume (d_i == before_q);
  end
  always_ff @(posedge clk_i) begin
    valid_q  <= running_q ? valid[Depth-1:0] : '0;
    before_q <= d_i;
    since_q  <= !running_q ? 4'd15 : pair_i ? 4'd1 : (since_q == 4'd15) ? since_q : since_q + 1'b1;
  end

  logic [1:0] q;
  cuboct_hold #(.Bits(2), .Depth(Depth), .Interval(Interval)) u_dut (.clk_i, .valid_i(valid), .d_i, .q_o(q));

  logic       watched_q, next_q;  // next: another pair came after it
  logic [4:0] age_q, next_age_q, age, next_age;
  logic [1:0] value_q, value;
  logic       starts, here, next_here;
  assign starts    = pair_i && watch_i && !watched_q;
  assign here      = watched_q || starts;
  assign age       = watched_q ? age_q : '0;
  assign value     = watched_q ? value_q : d_i;
  assign next_here = watched_q && (next_q || pair_i);
  assign next_age  = next_q ? next_age_q : '0;
  always_ff @(posedge clk_i) begin
    if (!running_q) begin
      watched_q <= 1'b0;
      next_q    <= 1'b0;
    end else begin
      watched_q <= here;
      next_q    <= next_here;
    end
    value_q    <= value;
    age_q      <= (age == 5'd31) ? age : age + 1'b1;
    next_age_q <= (next_age == 5'd31) ? next_age : next_age + 1'b1;
  end

  always_ff @(posedge clk_i) begin
    if (running_q) begin
      if (here && age == Depth[4:0]) a_value: assert (valid[Depth] && q == value);
      if (Interval > 1 && Registers > 0 && here && age >= Taken[4:0] && (!next_here || next_age < Taken[4:0])) begin
        a_stays: assert (q == value);
      end
      c_next:  cover (here && age == Depth[4:0] && (Registers == 0 || (next_here && d_i != value)));
      c_alone: cover (here && age == 5'd20 && !next_here && d_i != value);
      c_close: cover (here && age == Depth[4:0] && ((Registers == 0 && value == 2'b11)
                       || (next_here && next_age + Interval[4:0] == Depth[4:0])));
    end
  end
endmodule
