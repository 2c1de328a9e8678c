// SPDX-License-Identifier: MIT
// The bounding box of the own particles, in leading bits of their positions: the least and the greatest coordinate of
// each axis. A particle that is added in cycle t is in the box from t+2 on.
module cuboct_box #(
  parameter int Axes       = 3,  // 2 or 3
  parameter int FilterFrac = 8   // leading bits of a position
) (
  input  logic                       clk_i,
  input  logic                       rst_ni,
  input  logic                       clear_i,  // the box becomes empty
  input  logic                       add_i,    // a particle is added
  input  logic [Axes*FilterFrac-1:0] x_i,      // with add_i: x, y, z
  output logic                       empty_o,  // nothing was added since the clear
  output logic [Axes*FilterFrac-1:0] low_o,    // without empty_o
  output logic [Axes*FilterFrac-1:0] high_o    // without empty_o
);
  logic                       add_q, empty_d, empty_q;
  logic [Axes*FilterFrac-1:0] x_q;
  assign empty_d = clear_i || (empty_q && !add_q);
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      add_q   <= 1'b0;
      empty_q <= 1'b1;
    end else begin
      add_q   <= add_i;
      empty_q <= empty_d;
    end
  end
  always_ff @(posedge clk_i) x_q <= x_i;
  assign empty_o = empty_q;
  for (genvar a = 0; a < Axes; a++) begin : gen_axis
    logic [FilterFrac-1:0] x, low_q, high_q;
    assign x = x_q[a*FilterFrac +: FilterFrac];
    always_ff @(posedge clk_i) begin
      if (add_q && (empty_q || x < low_q)) low_q <= x;
      if (add_q && (empty_q || x > high_q)) high_q <= x;
    end
    assign low_o[a*FilterFrac +: FilterFrac]  = low_q;
    assign high_o[a*FilterFrac +: FilterFrac] = high_q;
  end
endmodule
