// SPDX-License-Identifier: MIT
// Kick, constraints and drift: one particle per cycle. Per axis
//   dv   = sum, which must fit SumBits                        not where the type imposes the velocity
//   dv   = round_odd(dv * weight, WeightFrac)                 masses differ only (Weighted)
//   dv  -= round_odd(kp * u + kd * (v - V), GainFrac)         types held by force only (Pd)
//   v   += dv + g, which must fit VelocityBits; or v = V      where imposed
//   u   += v - V, which must fit DisplacementBits             types held by force only
//   x   += v, exactly: x and its residue, the Guard bits below, are one number
// A particle accepted in cycle t is at the outputs in cycle t + Latency - 1, Latency = 3, with Weighted 5, with Pd 6:
// it is written back at the edge of that cycle. With Held the inputs stay until that cycle, and the next particle
// comes after it: nothing of them has to be kept here.
module cuboct_update #(
  parameter int Axes             = 3,   // 2 or 3
  parameter int PositionFrac     = 20,
  parameter int Guard            = 8,
  parameter int VelocityBits     = 29,
  parameter int TotalBits        = 30,  // of the exact sum over all pipes
  parameter int SumBits          = 29,  // that it must fit
  parameter int TypeBits         = 1,   // >= 1
  parameter int Weighted         = 0,   // 0, 1
  parameter int WeightBits       = 18,  // of a weight, signed
  parameter int WeightFrac       = 16,  // its fractional bits
  parameter int Pd               = 0,   // 0, 1
  parameter int Held             = 0,   // 0, 1
  parameter int DisplacementBits = 29,
  parameter int GainBits         = 18,
  parameter int GainFrac         = 16,
  parameter int ConstantBits     = 29,  // of V and g
  parameter int MovedTypes       = 0,   // types with V from velocity_i; 0: not read
  parameter int SlotBits         = 4,
  parameter int IdBits           = 8,
  // Derived; do not set.
  localparam int HostBits        = (MovedTypes > 0) ? MovedTypes * Axes * ConstantBits : 1
) (
  input  logic                          clk_i,
  input  logic                          rst_ni,
  input  logic [HostBits-1:0]           velocity_i,    // V by moved type and axis; constant in a run
  input  logic                          valid_i,       // a particle is taken
  input  logic [SlotBits-1:0]           slot_i,        // its slot
  input  logic [Axes*TotalBits-1:0]     sum_i,         // its sum over all pipes, signed
  input  logic [Axes*PositionFrac-1:0]  x_i,           // unsigned
  input  logic [Axes*Guard-1:0]         residue_i,     // unsigned; of x, below x_i
  input  logic [Axes*VelocityBits-1:0]  v_i,           // signed
  input  logic [TypeBits-1:0]           type_i,        // 0 with one type
  input  logic [IdBits-1:0]             id_i,          // of the particle
  input  logic [Axes*DisplacementBits-1:0] u_i,        // Pd only
  output logic                          valid_o,       // a particle is written back
  output logic [SlotBits-1:0]           slot_o,        // its slot
  output logic [Axes*PositionFrac-1:0]  x_o,           // in the node that away_o says
  output logic [Axes*Guard-1:0]         residue_o,     // of x, below x_o
  output logic [2*Axes-1:0]             away_o,        // per axis 2 bits, -1, 0, +1: the node that x is in
  output logic [Axes*VelocityBits-1:0]  v_o,           // signed
  output logic [TypeBits-1:0]           type_o,        // as it came
  output logic [IdBits-1:0]             id_o,          // as it came
  output logic [Axes*DisplacementBits-1:0] u_o,        // signed; 0 without Pd
  // With valid_o, with Pd a cycle later.
  output logic                          fault_o,       // a value does not fit
  output logic [3:0]                    fault_code_o,  // 3 sum, 4 displacement, 5 velocity
  output logic [IdBits-1:0]             fault_id_o,    // of the particle
  output logic signed [63:0]            fault_number_o // that value
);
  // Stage 1: operands. Stage VStage-1 holds what v is made of; v at VStage; the outputs are made in stage VStage.
  localparam int VStage   = (Pd != 0) ? 5 : (Weighted != 0) ? 4 : 2;
  localparam int Kick     = (Weighted != 0) ? 3 : 1;  // the stage that has dv: a product and its rounding take one each
  // Wide enough for every sum below: four terms, none wider than PullBits after its rounding.
  localparam int PullBits = (Pd != 0) ? GainBits + DisplacementBits + 2 : 1;
  localparam int MaxVs    = (VelocityBits > SumBits) ? VelocityBits : SumBits;
  localparam int MaxCp    = (ConstantBits > PullBits) ? ConstantBits : PullBits;
  localparam int WideBits = ((MaxVs > MaxCp) ? MaxVs : MaxCp) + 4;
  localparam int LongBits = (WideBits > TotalBits) ? WideBits : TotalBits;
  localparam int NumberBits = (LongBits < 64) ? LongBits : 64;  // of a fault's number

  localparam int Told = VStage + Pd;  // a displacement's check and the choice among faults have a cycle each
  logic [Told:1] valid_d, valid_q;
  assign valid_d = {valid_q[Told-1:1], valid_i};
  always_ff @(posedge clk_i) begin
    if (!rst_ni) valid_q <= '0;
    else valid_q <= valid_d;
  end
  assign valid_o = valid_q[VStage];
  logic [Told:0] at;  // [k]: a particle taken k cycles ago is there
  assign at = {valid_q, valid_i};

  logic [Axes*PositionFrac-1:0] x_last;
  logic [Axes*Guard-1:0]     residue_last;
  logic [TypeBits-1:0]       type_1;
  localparam int Delay = (Held != 0) ? 0 : 1;  // of what only waits
  cuboct_hold #(.Bits(SlotBits), .Depth(Delay * VStage), .Interval(1)) u_slot (
    .clk_i, .valid_i(at[Delay * VStage:0]), .d_i(slot_i), .q_o(slot_o)
  );
  cuboct_hold #(.Bits(IdBits), .Depth(Delay * VStage), .Interval(1)) u_id (
    .clk_i, .valid_i(at[Delay * VStage:0]), .d_i(id_i), .q_o(id_o)
  );
  cuboct_hold #(.Bits(Axes*PositionFrac), .Depth(Delay * VStage), .Interval(1)) u_x (
    .clk_i, .valid_i(at[Delay * VStage:0]), .d_i(x_i), .q_o(x_last)
  );
  cuboct_hold #(.Bits(Axes*Guard), .Depth(Delay * VStage), .Interval(1)) u_residue (
    .clk_i, .valid_i(at[Delay * VStage:0]), .d_i(residue_i), .q_o(residue_last)
  );
  cuboct_hold #(.Bits(TypeBits), .Depth(Delay), .Interval(1)) u_type (
    .clk_i, .valid_i(at[Delay:0]), .d_i(type_i), .q_o(type_1)
  );
  cuboct_hold #(.Bits(TypeBits), .Depth(Delay * (VStage - 1)), .Interval(1)) u_type_late (
    .clk_i, .valid_i(at[Delay * (VStage - 1) + 1:1]), .d_i(type_1), .q_o(type_o)
  );

  logic [Axes-1:0]              imposed;  // of type_1
  logic [Axes*ConstantBits-1:0] to_go, gravity;
  logic                      held;
  logic [GainBits-1:0]       kp, kd;
  logic [WeightBits-1:0]     weight;
  cuboct_type_rom u_type_rom (
    .velocity_i, .type_i(type_1), .imposed_o(imposed), .velocity_o(to_go), .gravity_o(gravity), .pd_o(held), .kp_o(kp),
    .kd_o(kd), .weight_o(weight)
  );

  logic [Axes-1:0]    bad_sum, bad_u, bad_v;                       // with the outputs
  logic [Axes*NumberBits-1:0] sum_number, u_number, v_number;
  logic signed [NumberBits-1:0] number;

  for (genvar a = 0; a < Axes; a++) begin : gen_axis
    // Check of the sum.
    logic signed [TotalBits-1:0] sum_1, sum_again;
    logic signed [SumBits-1:0]   dv_1;
    logic                        imposed_1, bad_1;
    logic signed [WideBits-1:0]  dv_wide, g_wide, to_go_wide, v_wide_1;
    logic signed [VelocityBits-1:0] v_1;
    cuboct_hold #(.Bits(TotalBits), .Depth(Delay), .Interval(1)) u_sum (
      .clk_i, .valid_i(at[Delay:0]), .d_i(sum_i[a*TotalBits +: TotalBits]), .q_o(sum_1)
    );
    cuboct_hold #(.Bits(VelocityBits), .Depth(Delay), .Interval(1)) u_v (
      .clk_i, .valid_i(at[Delay:0]), .d_i(v_i[a*VelocityBits +: VelocityBits]), .q_o(v_1)
    );
    cuboct_resize #(.InBits(TotalBits), .OutBits(SumBits)) u_dv (.a_i(sum_1), .y_o(dv_1));
    cuboct_resize #(.InBits(SumBits), .OutBits(TotalBits)) u_again (.a_i(dv_1), .y_o(sum_again));
    assign imposed_1 = imposed[a];
    assign bad_1     = !imposed_1 && (TotalBits > SumBits) && (sum_again != sum_1);
    cuboct_resize #(.InBits(SumBits), .OutBits(WideBits)) u_dv_wide (.a_i(dv_1), .y_o(dv_wide));
    cuboct_resize #(.InBits(ConstantBits), .OutBits(WideBits)) u_g_wide (
      .a_i($signed(gravity[a*ConstantBits +: ConstantBits])), .y_o(g_wide)
    );
    cuboct_resize #(.InBits(ConstantBits), .OutBits(WideBits)) u_to_go_wide (
      .a_i($signed(to_go[a*ConstantBits +: ConstantBits])), .y_o(to_go_wide)
    );
    cuboct_resize #(.InBits(VelocityBits), .OutBits(WideBits)) u_v_wide (.a_i(v_1), .y_o(v_wide_1));

    // What v becomes, before its check, and what the check needs; stage VStage-1.
    logic signed [WideBits-1:0] plain, v_free, v_imposed;
    logic                       imposed_v, bad_sum_v;
    logic signed [TotalBits-1:0] sum_v;
    if (Weighted != 0) begin : gen_weighted
      localparam int ProductBits = SumBits + WeightBits;
      logic signed [WeightBits-1:0]  weight_1;
      logic signed [ProductBits-1:0] product;
      logic signed [SumBits-1:0]     dv_2, dv_3;
      logic signed [WideBits-1:0]    rest_3, dv_3_wide;
      assign weight_1 = $signed(weight);
      cuboct_mult #(.ABits(SumBits), .BBits(WeightBits)) u_weigh (
        .clk_i, .rst_ni, .en_i(valid_q[1]), .a_i(dv_1), .b_i(weight_1), .p_o(product)
      );
      cuboct_round_odd #(.InBits(ProductBits), .Shift(WeightFrac), .OutBits(SumBits)) u_round (
        .a_i(product), .y_o(dv_2)
      );
      cuboct_hold #(.Bits(SumBits), .Depth(1), .Interval(1)) u_dv3 (.clk_i, .valid_i(at[3:2]), .d_i(dv_2), .q_o(dv_3));
      cuboct_hold #(.Bits(WideBits), .Depth(Delay * 2), .Interval(1)) u_rest3 (
        .clk_i, .valid_i(at[Delay * 2 + 1:1]), .d_i(v_wide_1 + g_wide), .q_o(rest_3)
      );
      cuboct_resize #(.InBits(SumBits), .OutBits(WideBits)) u_dv3_wide (.a_i(dv_3), .y_o(dv_3_wide));
      assign plain = rest_3 + dv_3_wide;
      logic unused_dv;
      assign unused_dv = ^dv_wide;
    end else begin : gen_alike
      assign plain = v_wide_1 + dv_wide + g_wide;
      logic unused_weight;
      assign unused_weight = ^weight;
    end
    cuboct_hold #(.Bits(TotalBits + WideBits + 2), .Depth(Delay * (VStage - 2)), .Interval(1)) u_rest (
      .clk_i, .valid_i(at[Delay * (VStage - 2) + 1:1]), .d_i({imposed_1, bad_1, sum_1, to_go_wide}),
      .q_o({imposed_v, bad_sum_v, sum_v, v_imposed})
    );

    if (Pd != 0) begin : gen_pd
      localparam int ErrorBits = ((VelocityBits > ConstantBits) ? VelocityBits : ConstantBits) + 1;
      localparam int KpBits    = GainBits + DisplacementBits;
      localparam int KdBits    = GainBits + ErrorBits;
      localparam int SpringBits = ((KpBits > KdBits) ? KpBits : KdBits) + 1;
      localparam int MaxVu     = (VelocityBits > DisplacementBits) ? VelocityBits : DisplacementBits;
      localparam int UBits     = ((MaxVu > ConstantBits) ? MaxVu : ConstantBits) + 2;  // three terms

      // Stage 2: the error of the velocity. 3: products. 4: their sum; rounded, it is subtracted before the check of v.
      logic signed [DisplacementBits-1:0] u_2, u_last;
      logic signed [ErrorBits-1:0] error_d, error_2;
      logic signed [KpBits-1:0]    spring;
      logic signed [KdBits-1:0]    drag;
      logic signed [SpringBits-1:0]  pull_sum_d, pull_sum_q;
      localparam int HighBits = SpringBits - GainFrac;
      logic signed [HighBits-1:0]  high;   // of the pull, rounded: high + carry
      logic signed [WideBits-1:0]  high_wide;
      logic                        carry;
      logic signed [WideBits:0]    both;
      logic signed [GainBits-1:0]  kp_2, kd_2;
      logic                        held_4;
      logic signed [WideBits-1:0]  plain_4;
      logic                        held_last;
      cuboct_hold #(.Bits(DisplacementBits), .Depth(Delay * 2), .Interval(1)) u_u2 (
        .clk_i, .valid_i(at[Delay * 2:0]), .d_i(u_i[a*DisplacementBits +: DisplacementBits]), .q_o(u_2)
      );
      cuboct_hold #(.Bits(DisplacementBits), .Depth(Delay * 3), .Interval(1)) u_u_last (
        .clk_i, .valid_i(at[Delay * 3 + 2:2]), .d_i(u_2), .q_o(u_last)
      );
      cuboct_resize #(.InBits(WideBits), .OutBits(ErrorBits)) u_error (.a_i(v_wide_1 - to_go_wide), .y_o(error_d));
      cuboct_hold #(.Bits(ErrorBits), .Depth(1), .Interval(1)) u_error2 (
        .clk_i, .valid_i(at[2:1]), .d_i(error_d), .q_o(error_2)
      );
      cuboct_hold #(.Bits(2 * GainBits), .Depth(1), .Interval(1)) u_gain2 (
        .clk_i, .valid_i(at[2:1]), .d_i({kd, kp}), .q_o({kd_2, kp_2})
      );
      cuboct_mult #(.ABits(GainBits), .BBits(DisplacementBits)) u_spring (
        .clk_i, .rst_ni, .en_i(valid_q[2]), .a_i(kp_2), .b_i(u_2), .p_o(spring)
      );
      cuboct_mult #(.ABits(GainBits), .BBits(ErrorBits)) u_drag (
        .clk_i, .rst_ni, .en_i(valid_q[2]), .a_i(kd_2), .b_i(error_2), .p_o(drag)
      );
      assign pull_sum_d = $signed({{(SpringBits - KpBits) {spring[KpBits-1]}}, spring})
                      + $signed({{(SpringBits - KdBits) {drag[KdBits-1]}}, drag});
      always_ff @(posedge clk_i) begin
        if (valid_q[3]) pull_sum_q <= pull_sum_d;
      end
      // round_odd and the subtraction in one adder: v - (high + carry) = v + ~high + !carry, as cuboct_round_odd has
      // it; nothing is subtracted where no force holds.
      assign high  = pull_sum_q[SpringBits-1:GainFrac];
      assign carry = pull_sum_q[GainFrac-1] && (!pull_sum_q[SpringBits-1] || pull_sum_q[GainFrac-2:0] != '0);
      cuboct_resize #(.InBits(HighBits), .OutBits(WideBits)) u_high (.a_i(high), .y_o(high_wide));
      cuboct_hold #(.Bits(1), .Depth(Delay * 3), .Interval(1)) u_held4 (
        .clk_i, .valid_i(at[Delay * 3 + 1:1]), .d_i(held), .q_o(held_4)
      );
      cuboct_hold #(.Bits(WideBits), .Depth(Delay * (VStage - 1 - Kick)), .Interval(1)) u_plain4 (
        .clk_i, .valid_i(at[Delay * (VStage - 1 - Kick) + Kick:Kick]), .d_i(plain), .q_o(plain_4)
      );
      assign both   = $signed({plain_4, 1'b1}) + $signed({held_4 ? ~high_wide : '0, held_4 && !carry});
      assign v_free = both[WideBits:1];
      logic unused_carry;
      assign unused_carry = both[0];

      // The displacement, with the outputs.
      logic signed [UBits-1:0]            u_wide, u_full, u_back, v_last, to_go_4, to_go_last;
      logic signed [DisplacementBits-1:0] u_new;
      cuboct_resize #(.InBits(WideBits), .OutBits(UBits)) u_to_go4 (.a_i(v_imposed), .y_o(to_go_4));
      cuboct_hold #(.Bits(UBits + 1), .Depth(Delay), .Interval(1)) u_held_last (
        .clk_i, .valid_i(at[Delay + VStage - 1:VStage - 1]), .d_i({held_4, to_go_4}), .q_o({held_last, to_go_last})
      );
      cuboct_resize #(.InBits(DisplacementBits), .OutBits(UBits)) u_u_wide (.a_i(u_last), .y_o(u_wide));
      cuboct_resize #(.InBits(VelocityBits), .OutBits(UBits)) u_v_last (
        .a_i($signed(v_o[a*VelocityBits +: VelocityBits])), .y_o(v_last)
      );
      assign u_full = u_wide + v_last - to_go_last;
      cuboct_resize #(.InBits(UBits), .OutBits(DisplacementBits)) u_u_new (.a_i(u_full), .y_o(u_new));
      cuboct_resize #(.InBits(DisplacementBits), .OutBits(UBits)) u_u_back (.a_i(u_new), .y_o(u_back));
      assign u_o[a*DisplacementBits +: DisplacementBits] = held_last ? u_new : u_last;
      assign bad_u[a] = held_last && (u_back != u_full);
      cuboct_resize #(.InBits(UBits), .OutBits(NumberBits)) u_u_number (
        .a_i(u_full), .y_o(u_number[a*NumberBits +: NumberBits])
      );
    end else begin : gen_free
      assign v_free    = plain;
      assign bad_u[a]  = 1'b0;
      assign u_number[a*NumberBits +: NumberBits] = '0;
      assign u_o[a*DisplacementBits +: DisplacementBits] = '0;
      logic unused_pd;
      assign unused_pd = ^{u_i[a*DisplacementBits +: DisplacementBits], held, kp, kd};
    end

    // Stage VStage: v, checked; then the drift.
    logic signed [WideBits-1:0]     v_new_wide, v_back, v_wide_q;
    logic signed [VelocityBits-1:0] v_new, v_q;
    logic                           checked_q, bad_sum_q;
    logic signed [TotalBits-1:0]    sum_last;
    localparam int MovedBits = PositionFrac + Guard + 2;
    logic signed [MovedBits-1:0]    drift, moved;
    cuboct_hold #(.Bits(TotalBits), .Depth(Delay), .Interval(1)) u_sum_last (
      .clk_i, .valid_i(at[Delay + VStage - 1:VStage - 1]), .d_i(sum_v), .q_o(sum_last)
    );
    assign v_new_wide = imposed_v ? v_imposed : v_free;
    cuboct_resize #(.InBits(WideBits), .OutBits(VelocityBits)) u_v_new (.a_i(v_new_wide), .y_o(v_new));
    // The check waits for the register: with the sums before it it would be too much for a cycle.
    cuboct_resize #(.InBits(VelocityBits), .OutBits(WideBits)) u_v_back (.a_i(v_q), .y_o(v_back));
    always_ff @(posedge clk_i) begin
      if (valid_q[VStage-1]) begin
        v_q       <= v_new;
        v_wide_q  <= v_new_wide;
        checked_q <= !imposed_v;
        bad_sum_q <= bad_sum_v;
      end
    end
    assign bad_sum[a] = bad_sum_q;
    assign bad_v[a]   = checked_q && (v_back != v_wide_q);
    cuboct_resize #(.InBits(TotalBits), .OutBits(NumberBits)) u_sum_number (
      .a_i(sum_last), .y_o(sum_number[a*NumberBits +: NumberBits])
    );
    cuboct_resize #(.InBits(WideBits), .OutBits(NumberBits)) u_v_number (
      .a_i(v_wide_q), .y_o(v_number[a*NumberBits +: NumberBits])
    );

    cuboct_resize #(.InBits(VelocityBits), .OutBits(MovedBits)) u_drift (.a_i(v_q), .y_o(drift));
    assign moved = $signed({2'b00, x_last[a*PositionFrac +: PositionFrac], residue_last[a*Guard +: Guard]}) + drift;
    assign residue_o[a*Guard +: Guard]         = moved[Guard-1:0];
    assign x_o[a*PositionFrac +: PositionFrac] = moved[Guard +: PositionFrac];
    assign away_o[a*2 +: 2]                    = moved[MovedBits-1 -: 2];
    assign v_o[a*VelocityBits +: VelocityBits] = v_q;
  end

  // The least fault; of one kind, that of the first axis.
  logic [3*Axes-1:0]            bad, bad_told;
  logic [3*Axes*NumberBits-1:0] numbers, numbers_told;
  integer                       b;
  assign bad     = {bad_v, bad_u, bad_sum};
  assign numbers = {v_number, u_number, sum_number};
  cuboct_hold #(.Bits(IdBits), .Depth(Pd), .Interval(1)) u_id_told (
    .clk_i, .valid_i(at[Pd + VStage:VStage]), .d_i(id_o), .q_o(fault_id_o)
  );
  cuboct_hold #(.Bits(3 * Axes), .Depth(Pd), .Interval(1)) u_bad (
    .clk_i, .valid_i(at[Pd + VStage:VStage]), .d_i(bad), .q_o(bad_told)
  );
  cuboct_hold #(.Bits(3 * Axes * NumberBits), .Depth(Pd), .Interval(1)) u_numbers (
    .clk_i, .valid_i(at[Pd + VStage:VStage]), .d_i(numbers), .q_o(numbers_told)
  );
  assign fault_o = valid_q[Told] && (bad_told != '0);
  always_comb begin
    fault_code_o = (bad_told[0 +: Axes] != '0) ? 4'd3 : (bad_told[Axes +: Axes] != '0) ? 4'd4 : 4'd5;
    number       = '0;
    for (b = 3 * Axes - 1; b >= 0; b = b - 1) begin
      if (bad_told[b]) number = numbers_told[b*NumberBits +: NumberBits];
    end
  end
  cuboct_resize #(.InBits(NumberBits), .OutBits(64)) u_told (.a_i(number), .y_o(fault_number_o));
endmodule
