// SPDX-License-Identifier: MIT
// The force pipe: from operands to the kick on the own particle. It takes one pair every Interval cycles: 1; Axes or
// more with Shared, where one multiplier serves the axes in turn; Product + 1 or more where a product takes Product
// cycles. It never stalls.
//   d = round_odd(x_j - x_i), r2 = d.d, s = force(r2), with LawBits that of law[type_i][type_j]
//   s -= round_odd(damp(r2) * round_odd(w.d))    with Damped; w = round_odd(v_j - v_i)
//   s = round_odd(s * scale[type_i][type_j])     with Scaled
//   push = round_odd(s * d), the kick's negative  nothing where r2 >= Cutoff2, or Contact2
// The kick of a pair accepted in cycle t is at the outputs in cycle t + Stages: 7 (+1 octaves, +1 degree 2, +1 damped,
// +1 scaled) and Product for each product after one another: 3 (+1 degree 2, +1 damped, +1 scaled); +2 (Axes-1) shared.
module cuboct_pipe #(
  parameter int          Axes                 = 3,      // 2 or 3
  parameter int          PositionFrac         = 20,     // P
  parameter int          DifferenceShift      = 4,      // P - D
  parameter logic [63:0] Cutoff2              = 64'd0,  // 2D fractional bits, <= 2^(2D)
  parameter logic [63:0] Contact2             = 64'd0,  // as Cutoff2, of types that only touch; 0: no two do
  parameter int          EntryBits            = 18,     // of a table entry
  parameter int          IndexBits            = 9,      // of the force table
  parameter int          Octaves              = 0,      // force table: 0 uniform, 1 octaves
  parameter int          Degree               = 1,
  parameter int          BinBits              = 0,
  parameter int          FirstOctave          = 0,
  parameter int          FractionBits         = 17,
  parameter int          ForceBits            = 18,     // of any value of the force table
  parameter int          Damped               = 0,      // 0, 1
  parameter int          VelocityBits         = 29,
  parameter int          RelativeVelocityBits = 18,
  parameter int          WShift               = 8,
  parameter int          QShift               = 17,
  parameter int          DampShift            = 17,
  parameter int          DampIndexBits        = 9,
  parameter int          DampOctaves          = 0,      // as Octaves, of the damping table
  parameter int          DampDegree           = 1,
  parameter int          DampBinBits          = 0,
  parameter int          DampFirstOctave      = 0,
  parameter int          DampFractionBits     = 17,
  parameter int          DampBits             = 18,     // of any value of the damping table
  parameter int          StrengthBits         = 18,     // of s after damping, checked; only if Damped
  parameter int          Scaled               = 0,      // 0, 1
  parameter int          LawBits              = 0,      // of the law of a pair of types; 0: all have one, or not Scaled
  parameter int          TypeBits             = 1,      // >= 1; used if Scaled
  parameter int          ScaleBits            = 18,
  parameter int          ScaleFrac            = 16,
  parameter int          KickShift            = 4,
  parameter int          KickBits             = 18,     // of one axis of a kick
  parameter int          SlotBits             = 4,      // of a slot's number
  parameter int          Shared               = 0,      // 0, 1
  parameter int          Product              = 1,      // cycles of a multiplier; 1 if Shared
  parameter int          Interval             = 1       // cycles from one pair to the next
) (
  input  logic                            clk_i,
  input  logic                            rst_ni,
  input  logic                            valid_i,      // a pair is taken
  input  logic [SlotBits-1:0]             slot_i,       // the own particle
  // The own particle, in the cycle after valid_i: a memory's answer.
  input  logic [Axes*PositionFrac-1:0]    own_x_i,      // unsigned
  input  logic [Axes*VelocityBits-1:0]    own_v_i,      // signed; Damped
  input  logic [TypeBits-1:0]             own_type_i,   // Scaled
  // The other one, with valid_i.
  input  logic [Axes*(PositionFrac+2)-1:0] other_x_i,    // signed, in the own frame
  input  logic [Axes*VelocityBits-1:0]    other_v_i,    // signed; Damped
  input  logic [TypeBits-1:0]             other_type_i, // Scaled
  output logic                            valid_o,      // a pair inside the cutoff
  output logic [SlotBits-1:0]             slot_next_o,  // slot_o of the next cycle
  output logic [SlotBits-1:0]             slot_o,       // with valid_o: its own slot
  output logic [Axes*KickBits-1:0]        push_o,       // signed, P+G fractional bits: minus the kick
  output logic                            fault_o,      // that pair does not fit:
  output logic                            fault_strength_o,  // s, else w
  output logic signed [63:0]              fault_number_o,
  output logic                            busy_o        // a pair is on its way
);
  // Every tool ends with an error where a module is missing: the parameters are out of their ranges.
  if (Axes < 2 || Axes > 3 || Degree < 1 || Degree > 2 || DampDegree < 1 || DampDegree > 2 || TypeBits < 1
      || DifferenceShift >= PositionFrac || Interval < 1 || Product < 1 || (Shared != 0 && Product != 1)
      || (Shared != 0 && Interval < Axes) || (Product > 2 && Interval <= Product)
      || (LawBits != 0 && Scaled == 0)) begin : gen_range
    cuboct_parameter_out_of_range u_error ();
  end
  localparam int D            = PositionFrac - DifferenceShift;
  localparam int DBits        = D + 1;
  localparam int R2Bits       = 2 * D + Axes - 1;  // so many squares of at most 2^(2D)
  localparam int OctaveStage  = ((Octaves != 0) || (DampOctaves != 0 && Damped != 0)) ? 1 : 0;
  localparam int SquareStages = (Degree == 2 || (DampDegree == 2 && Damped != 0)) ? 1 : 0;
  localparam int DampStages   = (Damped != 0) ? 1 + Product : 0;
  localparam int ScaleStages  = (Scaled != 0) ? 1 + Product : 0;
  localparam int AxisProduct  = (Shared != 0) ? Axes : Product;      // of the axes' products
  localparam int StageR2      = 3 + AxisProduct;
  localparam int TableStages  = 3 + Product + OctaveStage + (1 + Product) * SquareStages;
  localparam int StageValue   = StageR2 + TableStages;               // the tables' values
  localparam int StageDamped  = StageValue + DampStages;             // s after damping
  localparam int StageS       = StageDamped + ScaleStages;           // s
  localparam int Stages       = StageS + 1 + AxisProduct;            // the kick
  localparam int LawWidth     = (LawBits != 0) ? LawBits : 1;
  localparam int SBits        = (Damped != 0) ? StrengthBits : ForceBits;

  // valid[k]: stage k holds a pair; hit[k], from the stage after r2 on: one inside the cutoff.
  logic [Stages:1] valid_d, valid_q;
  logic [Stages:StageR2+1] hit_d, hit_q;
  logic            near;
  assign valid_d = {valid_q[Stages-1:1], valid_i};
  assign hit_d   = {hit_q[Stages-1:StageR2+1], valid_q[StageR2] && near};
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      valid_q <= '0;
      hit_q   <= '0;
    end else begin
      valid_q <= valid_d;
      hit_q   <= hit_d;
    end
  end
  logic busy_q;  // valid_q is not 0
  always_ff @(posedge clk_i) begin
    if (!rst_ni) busy_q <= 1'b0;
    else busy_q <= (valid_d != '0);
  end
  assign busy_o  = busy_q;
  assign valid_o = hit_q[Stages];
  logic [SlotBits-1:0] slot_q;  // stage 1
  always_ff @(posedge clk_i) begin
    if (valid_i) slot_q <= slot_i;
  end
  cuboct_hold #(.Bits(SlotBits), .Depth(Stages - 2), .Interval(Interval)) u_slot (
    .clk_i, .valid_i(valid_q[Stages-1:1]), .d_i(slot_q), .q_o(slot_next_o)
  );
  cuboct_delay #(.Bits(SlotBits), .Depth(1)) u_slot_last (.clk_i, .d_i(slot_next_o), .q_o(slot_o));

  // Stages 1 ... StageR2: operands, d, its squares, r2.
  logic [Axes*DBits-1:0] d_q;         // stage 2
  logic [Axes*DBits-1:0] d_s;         // stage StageS
  logic [Axes-1:0]       outside;     // stage 2; d has more bits: the planar test is coarse
  logic                  outside_r2;  // stage StageR2
  logic [R2Bits-1:0]     square [0:Axes-1];
  logic [R2Bits-1:0]     r2_d, r2_q;  // stage StageR2
  logic [Axes*2*DBits-1:0] products;
  for (genvar a = 0; a < Axes; a++) begin : gen_d
    logic [PositionFrac+1:0]        other_q;
    logic signed [PositionFrac+2:0] difference;
    logic signed [DBits+1:0]        d_full;
    logic [1:0]                     d_high_q;
    logic signed [2*DBits-1:0]      product;
    always_ff @(posedge clk_i) begin
      if (valid_i) begin
        other_q <= other_x_i[a*(PositionFrac+2) +: PositionFrac+2];
      end
      if (valid_q[1]) {d_high_q, d_q[a*DBits +: DBits]} <= d_full;
    end
    assign difference = $signed({other_q[PositionFrac+1], other_q})
                      - $signed({3'b000, own_x_i[a*PositionFrac +: PositionFrac]});
    cuboct_round_odd #(.InBits(PositionFrac + 3), .Shift(DifferenceShift), .OutBits(DBits + 2)) u_round (
      .a_i(difference), .y_o(d_full)
    );
    assign outside[a] = (d_high_q != {2{d_q[a*DBits+DBits-1]}});
    assign product   = $signed(products[a*2*DBits +: 2*DBits]);
    assign square[a] = product[R2Bits-1:0];
    logic unused_high;
    assign unused_high = ^product;
  end
  cuboct_axis_mults #(
    .Axes(Axes), .Shared(Shared), .ABits(DBits), .BBits(DBits), .Product(Product), .Held(Shared)
  ) u_squares (
    .clk_i, .rst_ni, .en_i(valid_q[2]), .a_i(d_q), .b_i(d_q), .p_o(products)
  );
  if (Axes == 3) begin : gen_space
    assign r2_d = square[0] + square[1] + square[2];
  end else begin : gen_plane
    assign r2_d = square[0] + square[1];
  end
  always_ff @(posedge clk_i) begin
    if (valid_q[StageR2-1]) r2_q <= r2_d;
  end
  cuboct_hold #(.Bits(1), .Depth(StageR2 - 2), .Interval(Interval)) u_outside (
    .clk_i, .valid_i(valid_q[StageR2:2]), .d_i(outside != '0), .q_o(outside_r2)
  );
  logic [R2Bits-1:0] reach2;  // stage StageR2: from here on the pair does nothing
  assign near = (r2_q < reach2) && !outside_r2;
  cuboct_hold #(.Bits(Axes * DBits), .Depth(StageS - 2), .Interval(Interval)) u_d (
    .clk_i, .valid_i(valid_q[StageS:2]), .d_i(d_q), .q_o(d_s)
  );

  // The stages up to StageValue: the force table.
  logic [IndexBits-1:0]        index;
  logic signed [EntryBits-1:0] c0, c1, c2;
  logic signed [ForceBits-1:0] force_value;
  cuboct_pair_table #(
    .DifferenceFrac(D), .Octaves(Octaves), .Degree(Degree), .IndexBits(IndexBits), .BinBits(BinBits),
    .FirstOctave(FirstOctave), .FractionBits(FractionBits), .EntryBits(EntryBits), .ValueBits(ForceBits),
    .OctaveStage(OctaveStage), .SquareStages(SquareStages), .Product(Product), .Interval(Interval)
  ) u_force (
    .clk_i, .rst_ni, .valid_i(valid_q[StageValue:StageR2]), .r2_i(r2_q[2*D-1:0]), .index_o(index), .c0_i(c0), .c1_i(c1),
    .c2_i(c2), .value_o(force_value)
  );
  logic [LawWidth-1:0]          law;      // with the index
  logic [LawBits+IndexBits-1:0] address;  // the tables of all laws, one after another
  if (LawBits != 0) begin : gen_laws
    assign address = {law, index};
  end else begin : gen_one_law
    assign address = index;
    logic unused_law;
    assign unused_law = ^law;
  end
  cuboct_force_rom u_force_rom (.clk_i, .index_i(address), .c0_o(c0), .c1_o(c1), .c2_o(c2));

  // Two stages: minus damp * q.
  logic signed [SBits-1:0] s_damped;  // stage StageDamped
  logic                    w_fault, s_fault;
  logic signed [63:0]      w_number, s_number;
  if (Damped != 0) begin : gen_damp
    localparam int WFullBits   = VelocityBits + 2;
    localparam int WdBits      = RelativeVelocityBits + DBits;  // of one product
    localparam int ProductBits = DampBits + RelativeVelocityBits;
    localparam int DampedBits  = ((ProductBits > ForceBits) ? ProductBits : ForceBits) + 2;

    logic [Axes-1:0]                        misfit;
    logic [Axes*WFullBits-1:0]              w_full;
    logic [Axes*(WdBits+2)-1:0]             wd;
    logic signed [WdBits+1:0]               wd_d, wd_q;    // stage StageR2
    logic [Axes*WdBits-1:0]                 wd_products;
    logic [Axes*RelativeVelocityBits-1:0]   w_all;
    logic signed [RelativeVelocityBits-1:0] q_d, q_q, q;   // the one after, stage StageValue
    for (genvar a = 0; a < Axes; a++) begin : gen_w
      logic [VelocityBits-1:0]                own, other_q;
      logic signed [VelocityBits:0]           difference;
      logic signed [WFullBits-1:0]            w_d, w_q;     // stage 2
      logic signed [RelativeVelocityBits-1:0] w_used;
      logic signed [WFullBits-1:0]            w_again;
      logic signed [WdBits-1:0]               product;
      always_ff @(posedge clk_i) begin
        if (valid_i) begin
          other_q <= other_v_i[a*VelocityBits +: VelocityBits];
        end
        if (valid_q[1]) w_q <= w_d;
      end
      assign own        = own_v_i[a*VelocityBits +: VelocityBits];
      assign difference = $signed({other_q[VelocityBits-1], other_q}) - $signed({own[VelocityBits-1], own});
      cuboct_round_odd #(.InBits(VelocityBits + 1), .Shift(WShift), .OutBits(WFullBits)) u_round (
        .a_i(difference), .y_o(w_d)
      );
      cuboct_resize #(.InBits(WFullBits), .OutBits(RelativeVelocityBits)) u_wrap (.a_i(w_q), .y_o(w_used));
      cuboct_resize #(.InBits(RelativeVelocityBits), .OutBits(WFullBits)) u_again (.a_i(w_used), .y_o(w_again));
      assign misfit[a] = (w_again != w_q);
      assign w_full[a*WFullBits +: WFullBits] = w_q;
      assign w_all[a*RelativeVelocityBits +: RelativeVelocityBits] = w_used;
      assign product = $signed(wd_products[a*WdBits +: WdBits]);
      assign wd[a*(WdBits+2) +: WdBits+2] = {{2{product[WdBits-1]}}, product};
    end
    cuboct_axis_mults #(
      .Axes(Axes), .Shared(Shared), .ABits(RelativeVelocityBits), .BBits(DBits), .Product(Product), .Held(Shared)
    ) u_wd (
      .clk_i, .rst_ni, .en_i(valid_q[2]), .a_i(w_all), .b_i(d_q), .p_o(wd_products)
    );
    if (Axes == 3) begin : gen_space_wd
      assign wd_d = wd[0 +: WdBits+2] + wd[WdBits+2 +: WdBits+2] + wd[2*(WdBits+2) +: WdBits+2];
    end else begin : gen_plane_wd
      assign wd_d = wd[0 +: WdBits+2] + wd[WdBits+2 +: WdBits+2];
    end
    // Inside the cutoff |w.d| <= |w| |d| < sqrt(3) 2^(bits-1) 2^D, so q fits its width.
    cuboct_round_odd #(.InBits(WdBits + 2), .Shift(QShift), .OutBits(RelativeVelocityBits)) u_q (
      .a_i(wd_q), .y_o(q_d)
    );
    always_ff @(posedge clk_i) begin
      if (valid_q[StageR2-1]) wd_q <= wd_d;
      if (valid_q[StageR2]) q_q <= q_d;
    end
    cuboct_hold #(.Bits(RelativeVelocityBits), .Depth(StageValue - StageR2 - 1), .Interval(Interval)) u_q_late (
      .clk_i, .valid_i(valid_q[StageValue:StageR2+1]), .d_i(q_q), .q_o(q)
    );

    // A w that does not fit: known at stage 2, told with the kick. The first axis gives the number.
    logic signed [WFullBits-1:0] w_first, w_late;
    integer first;
    always_comb begin
      w_first = w_full[(Axes-1)*WFullBits +: WFullBits];
      for (first = Axes - 2; first >= 0; first = first - 1) begin
        if (misfit[first]) w_first = w_full[first*WFullBits +: WFullBits];
      end
    end
    cuboct_hold #(.Bits(WFullBits + 1), .Depth(Stages - 2), .Interval(Interval)) u_w_late (
      .clk_i, .valid_i(valid_q[Stages:2]), .d_i({misfit != '0, w_first}), .q_o({w_fault, w_late})
    );
    cuboct_resize #(.InBits(WFullBits), .OutBits(64)) u_w_number (.a_i(w_late), .y_o(w_number));

    logic [DampIndexBits-1:0]          damp_index;
    logic signed [EntryBits-1:0]       e0, e1, e2;
    logic signed [DampBits-1:0]        damp_value;
    logic signed [ProductBits-1:0]     product;
    logic signed [ForceBits-1:0]       force_late;
    logic signed [DampedBits-1:0]      friction, s_full, s_again, s_last;
    logic signed [StrengthBits-1:0]    s_wrapped, s_q;
    logic                              s_misfit_q;
    logic signed [DampedBits-1:0]      s_full_q;
    cuboct_pair_table #(
      .DifferenceFrac(D), .Octaves(DampOctaves), .Degree(DampDegree), .IndexBits(DampIndexBits),
      .BinBits(DampBinBits), .FirstOctave(DampFirstOctave), .FractionBits(DampFractionBits),
      .EntryBits(EntryBits), .ValueBits(DampBits), .OctaveStage(OctaveStage), .SquareStages(SquareStages),
      .Product(Product), .Interval(Interval)
    ) u_damp (
      .clk_i, .rst_ni, .valid_i(valid_q[StageValue:StageR2]), .r2_i(r2_q[2*D-1:0]), .index_o(damp_index), .c0_i(e0),
      .c1_i(e1), .c2_i(e2), .value_o(damp_value)
    );
    cuboct_damp_rom u_damp_rom (.clk_i, .index_i(damp_index), .c0_o(e0), .c1_o(e1), .c2_o(e2));
    cuboct_mult #(.ABits(DampBits), .BBits(RelativeVelocityBits), .Cycles(Product)) u_friction (
      .clk_i, .rst_ni, .en_i(hit_q[StageValue]), .a_i(damp_value), .b_i(q), .p_o(product)
    );
    cuboct_hold #(.Bits(ForceBits), .Depth(Product), .Interval(Interval)) u_force_late (
      .clk_i, .valid_i(valid_q[StageValue+Product:StageValue]), .d_i(force_value), .q_o(force_late)
    );
    cuboct_round_odd #(.InBits(ProductBits), .Shift(DampShift), .OutBits(DampedBits)) u_round (
      .a_i(product), .y_o(friction)
    );
    assign s_full = $signed({{(DampedBits - ForceBits) {force_late[ForceBits-1]}}, force_late}) - friction;
    cuboct_resize #(.InBits(DampedBits), .OutBits(StrengthBits)) u_wrap (.a_i(s_full), .y_o(s_wrapped));
    cuboct_resize #(.InBits(StrengthBits), .OutBits(DampedBits)) u_again (.a_i(s_wrapped), .y_o(s_again));
    always_ff @(posedge clk_i) begin
      if (hit_q[StageValue+Product]) begin
        s_q        <= s_wrapped;
        s_full_q   <= s_full;
        s_misfit_q <= (s_again != s_full);
      end
    end
    assign s_damped = s_q;
    cuboct_hold #(.Bits(DampedBits + 1), .Depth(Stages - StageDamped), .Interval(Interval)) u_s_late (
      .clk_i, .valid_i(valid_q[Stages:StageDamped]), .d_i({s_misfit_q, s_full_q}), .q_o({s_fault, s_last})
    );
    cuboct_resize #(.InBits(DampedBits), .OutBits(64)) u_s_number (.a_i(s_last), .y_o(s_number));
  end else begin : gen_undamped
    logic unused_velocity;
    assign unused_velocity = ^{own_v_i, other_v_i};
    assign s_damped = force_value;
    assign w_fault  = 1'b0;
    assign s_fault  = 1'b0;
    assign w_number = '0;
    assign s_number = '0;
  end
  assign fault_o          = valid_o && (w_fault || s_fault);
  assign fault_strength_o = !w_fault;
  assign fault_number_o   = w_fault ? w_number : s_number;

  // Two stages: times the pair's scale, which is at most 1.
  logic signed [SBits-1:0] s;  // stage StageS
  if (Scaled != 0) begin : gen_scale
    logic [2*TypeBits-1:0]            types;
    logic [TypeBits-1:0]              other_type;
    logic signed [ScaleBits-1:0]      scale;
    logic signed [SBits+ScaleBits-1:0] product;
    logic signed [SBits-1:0]          s_d, s_q;
    logic [2*TypeBits-1:0]            types_q;  // stage 2
    cuboct_delay #(.Bits(TypeBits), .Depth(1)) u_other_type (.clk_i, .d_i(other_type_i), .q_o(other_type));
    always_ff @(posedge clk_i) begin
      if (valid_q[1]) types_q <= {other_type, own_type_i};
    end
    cuboct_hold #(.Bits(2 * TypeBits), .Depth(StageDamped - 2), .Interval(Interval)) u_types (
      .clk_i, .valid_i(valid_q[StageDamped:2]), .d_i(types_q), .q_o(types)
    );
    logic                unused_touch;
    logic [LawWidth-1:0] unused_law;
    cuboct_scale_rom u_scale_rom (
      .own_type_i(types[TypeBits-1:0]), .other_type_i(types[2*TypeBits-1:TypeBits]), .scale_o(scale),
      .touch_o(unused_touch), .law_o(unused_law)
    );
    logic                        touch_d;  // stage 2
    logic [LawWidth-1:0]         law_d;    // stage 2
    if (Contact2 != 64'd0 || LawBits != 0) begin : gen_early
      logic signed [ScaleBits-1:0] early_scale;
      logic                        unused_scale;
      cuboct_scale_rom u_early_rom (
        .own_type_i(types_q[TypeBits-1:0]), .other_type_i(types_q[2*TypeBits-1:TypeBits]), .scale_o(early_scale),
        .touch_o(touch_d), .law_o(law_d)
      );
      assign unused_scale = ^early_scale;
    end else begin : gen_late
      assign touch_d = 1'b0;
      assign law_d   = '0;
    end
    if (Contact2 != 64'd0) begin : gen_touch
      logic touch;  // stage StageR2
      cuboct_hold #(.Bits(1), .Depth(StageR2 - 2), .Interval(Interval)) u_touch (
        .clk_i, .valid_i(valid_q[StageR2:2]), .d_i(touch_d), .q_o(touch)
      );
      assign reach2 = touch ? Contact2[R2Bits-1:0] : Cutoff2[R2Bits-1:0];
    end else begin : gen_one_reach
      assign reach2 = Cutoff2[R2Bits-1:0];
      logic unused_touch_d;
      assign unused_touch_d = touch_d;
    end
    if (LawBits != 0) begin : gen_law
      logic [LawWidth-1:0] law_r2;  // when r2 is at the table's address
      cuboct_hold #(.Bits(LawWidth), .Depth(StageR2 + OctaveStage - 2), .Interval(Interval)) u_law (
        .clk_i, .valid_i(valid_q[StageR2+OctaveStage:2]), .d_i(law_d), .q_o(law_r2)
      );
      if (Interval == 1) begin : gen_direct
        assign law = law_r2;
      end else begin : gen_kept  // as long as the index of cuboct_pair_table, a cycle later
        logic [LawWidth-1:0] law_q;
        always_ff @(posedge clk_i) begin
          if (valid_q[StageR2+OctaveStage]) law_q <= law_r2;
        end
        assign law = law_q;
      end
    end else begin : gen_any_law
      assign law = '0;
      logic unused_law_d;
      assign unused_law_d = ^law_d;
    end
    cuboct_mult #(.ABits(SBits), .BBits(ScaleBits), .Cycles(Product)) u_mult (
      .clk_i, .rst_ni, .en_i(hit_q[StageDamped]), .a_i(s_damped), .b_i(scale), .p_o(product)
    );
    cuboct_round_odd #(.InBits(SBits + ScaleBits), .Shift(ScaleFrac), .OutBits(SBits)) u_round (
      .a_i(product), .y_o(s_d)
    );
    always_ff @(posedge clk_i) begin
      if (hit_q[StageDamped+Product]) s_q <= s_d;
    end
    assign s = s_q;
  end else begin : gen_unscaled
    logic unused_types;
    assign unused_types = ^{own_type_i, other_type_i};
    assign s      = s_damped;
    assign reach2 = Cutoff2[R2Bits-1:0];
    assign law    = '0;
  end

  // The last stages: times d, rounded once.
  logic [Axes*(SBits+DBits)-1:0] kick_products;
  cuboct_axis_mults #(
    .Axes(Axes), .Shared(Shared), .ABits(SBits), .BBits(DBits), .Product(Product),
    .Held((Shared != 0 && (StageS - 2) % Interval + Axes <= Interval) ? 1 : 0)
  ) u_kicks (
    .clk_i, .rst_ni, .en_i(hit_q[StageS]), .a_i({Axes{s}}), .b_i(d_s), .p_o(kick_products)
  );
  for (genvar a = 0; a < Axes; a++) begin : gen_kick
    logic signed [SBits+DBits-1:0] product;
    logic signed [KickBits-1:0]    push_d, push_q;
    assign product = $signed(kick_products[a*(SBits+DBits) +: SBits+DBits]);
    cuboct_round_odd #(.InBits(SBits + DBits), .Shift(KickShift), .OutBits(KickBits)) u_round (
      .a_i(product), .y_o(push_d)
    );
    always_ff @(posedge clk_i) begin
      if (hit_q[Stages-1]) push_q <= push_d;
    end
    assign push_o[a*KickBits +: KickBits] = push_q;
  end
endmodule
