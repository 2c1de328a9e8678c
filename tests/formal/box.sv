// SPDX-License-Identifier: MIT
// cuboct_box through any adds and clears: empty exactly when nothing was added since the clear; else no added
// coordinate lies outside of the bounds (a watched one, any), and each bound is a coordinate that was added. An add
// shows after two cycles. No one adds in the cycle before a clear or with it.
module box_formal #(
  parameter int Axes       = 2,
  parameter int FilterFrac = 3
) (
  input logic                       clk_i,
  input logic                       clear_i,
  input logic                       add_i,
  input logic [Axes*FilterFrac-1:0] x_i
);
  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;

  logic                       empty;
  logic [Axes*FilterFrac-1:0] low, high;
  cuboct_box #(.Axes(Axes), .FilterFrac(FilterFrac)) u_dut (
    .clk_i, .rst_ni(running_q), .clear_i, .add_i, .x_i, .empty_o(empty), .low_o(low), .high_o(high)
  );

  (* anyconst *) logic [FilterFrac-1:0] watched;
  (* anyconst *) logic                  last;  // axis watched: the first or the last
  localparam int Last = (Axes - 1) * FilterFrac;
  logic [FilterFrac-1:0] x, x_q, low_w, high_w;
  logic                  add_q, some_q, is_q, cleared_q;
  assign x      = last ? x_i[Last +: FilterFrac] : x_i[0 +: FilterFrac];
  assign low_w  = last ? low[Last +: FilterFrac] : low[0 +: FilterFrac];
  assign high_w = last ? high[Last +: FilterFrac] : high[0 +: FilterFrac];
  always_comb if (clear_i) assume (running_q && !add_i && !add_q);
  always_ff @(posedge clk_i) begin
    add_q <= running_q && add_i;
    x_q   <= x;
    if (!running_q) begin
      some_q    <= 1'b0;
      is_q      <= 1'b0;
      cleared_q <= 1'b0;
    end else begin
      some_q    <= !clear_i && (some_q || add_q);
      is_q      <= !clear_i && (is_q || (add_q && x_q == watched));  // a particle of that coordinate was added
      cleared_q <= cleared_q || (clear_i && some_q);
    end
  end
  always_ff @(posedge clk_i) begin
    if (running_q) begin
      a_empty: assert (empty == !some_q);
      if (is_q) a_inside: assert (!empty && low_w <= watched && watched <= high_w);
      if (!empty && (low_w == watched || high_w == watched)) a_tight: assert (is_q);
      c_wide:  cover (!empty && is_q && last && low_w == '0 && high_w == '1
                      && watched == {1'b1, {(FilterFrac - 1) {1'b0}}});
      c_again: cover (cleared_q && !empty && low_w == high_w && low_w == watched);
    end
  end
endmodule
