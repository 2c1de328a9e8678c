// SPDX-License-Identifier: MIT
// One signed product per axis. With Shared one multiplier serves the axes in turn: operands are taken in the cycle
// with en_i, the products are there Axes cycles later, and stay up to the next en_i, which comes no sooner than Axes
// cycles after this one. Without, each axis has its own, of latency Product.
module cuboct_axis_mults #(
  parameter int Axes   = 3,   // 2 or 3
  parameter int Shared = 0,   // 0, 1
  parameter int ABits  = 18,  // >= 1
  parameter int BBits  = 18,  // >= 1
  parameter int Product = 1,  // cycles of a multiplier; 1 if Shared
  parameter int Held   = 0    // 0, 1: Shared, and operands stay for Axes cycles from en_i on
) (
  input  logic                            clk_i,
  input  logic                            rst_ni,
  input  logic                            en_i,  // takes operands
  input  logic [Axes*ABits-1:0]           a_i,   // signed
  input  logic [Axes*BBits-1:0]           b_i,   // signed
  output logic [Axes*(ABits+BBits)-1:0]   p_o    // signed
);
  localparam int Bits = ABits + BBits;

  if (Shared == 0) begin : gen_parallel
    for (genvar a = 0; a < Axes; a++) begin : gen_axis
      cuboct_mult #(.ABits(ABits), .BBits(BBits), .Cycles(Product)) u_mult (
        .clk_i, .rst_ni, .en_i, .a_i($signed(a_i[a*ABits +: ABits])), .b_i($signed(b_i[a*BBits +: BBits])),
        .p_o(p_o[a*Bits +: Bits])
      );
    end
  end else begin : gen_shared
    // Products move down by one axis per cycle; the last one is the multiplier's own register.
    logic [(Axes-1)*Bits-1:0]  p_d, p_q;
    logic [Axes-1:1]           turn_d, turn_q;  // [k]: the cycle k after en_i
    logic signed [ABits-1:0]   a;
    logic signed [BBits-1:0]   b;
    logic [Bits-1:0]           p;
    if (Axes == 3) begin : gen_three
      assign turn_d = {turn_q[1], en_i};
      assign p_d = {p, p_q[(Axes-1)*Bits-1:Bits]};
    end else begin : gen_two
      assign turn_d = en_i;
      assign p_d = p;
    end
    if (Held != 0) begin : gen_held
      assign a = turn_q[Axes-1] ? a_i[(Axes-1)*ABits +: ABits] : (Axes == 3 && turn_q[1]) ? a_i[ABits +: ABits]
                                                                                             : a_i[0 +: ABits];
      assign b = turn_q[Axes-1] ? b_i[(Axes-1)*BBits +: BBits] : (Axes == 3 && turn_q[1]) ? b_i[BBits +: BBits]
                                                                                             : b_i[0 +: BBits];
    end else begin : gen_kept
      // Operands move down with them.
      logic [(Axes-1)*ABits-1:0] a_d, a_q;
      logic [(Axes-1)*BBits-1:0] b_d, b_q;
      assign a = en_i ? a_i[ABits-1:0] : a_q[ABits-1:0];
      assign b = en_i ? b_i[BBits-1:0] : b_q[BBits-1:0];
      if (Axes == 3) begin : gen_move
        assign a_d = en_i ? a_i[Axes*ABits-1:ABits] : {a_q[ABits-1:0], a_q[(Axes-1)*ABits-1:ABits]};
        assign b_d = en_i ? b_i[Axes*BBits-1:BBits] : {b_q[BBits-1:0], b_q[(Axes-1)*BBits-1:BBits]};
      end else begin : gen_stay
        assign a_d = en_i ? a_i[Axes*ABits-1:ABits] : a_q;
        assign b_d = en_i ? b_i[Axes*BBits-1:BBits] : b_q;
      end
      always_ff @(posedge clk_i) begin
        a_q <= a_d;
        b_q <= b_d;
      end
    end
    always_ff @(posedge clk_i) begin
      if (!rst_ni) turn_q <= '0;
      else turn_q <= turn_d;
    end
    always_ff @(posedge clk_i) begin
      if (turn_q != '0) p_q <= p_d;
    end
    cuboct_mult #(.ABits(ABits), .BBits(BBits)) u_mult (
      .clk_i, .rst_ni, .en_i(en_i || (turn_q != '0)), .a_i(a), .b_i(b), .p_o(p)
    );
    assign p_o = {p, p_q};
  end
endmodule
