// SPDX-License-Identifier: MIT
// A function of r2 as a piecewise polynomial. The memory stands outside (generated); this is its address, and the
// interpolation of what it answers one cycle after that. Latency 3 + Product cycles, +1 with OctaveStage, +1 + Product
// with SquareStages.
//   uniform: index = the top IndexBits of r2, t = the next FractionBits.
//   octaves: with o = floor(log2 r2): index = (o - FirstOctave) * 2^BinBits + the BinBits below the leading one,
//            t = the next FractionBits, zeros where r2 has no more; r2 < 2^FirstOctave has index 0, t 0.
//   value = c0 + round_odd(slope * t, FractionBits), slope = c1 or c1 + round_odd(c2 * t, FractionBits).
module cuboct_pair_table #(
  parameter int DifferenceFrac = 16,  // D; r2 has 2D fractional bits
  parameter int Octaves        = 0,   // 0 uniform, 1 octaves
  parameter int Degree         = 1,   // 1 or 2
  parameter int IndexBits      = 9,   // of the address, >= 1
  parameter int BinBits        = 0,   // octaves only; <= IndexBits
  parameter int FirstOctave    = 0,   // octaves only; < 2D
  parameter int FractionBits   = 17,  // of t, in 1 ... 24
  parameter int EntryBits      = 18,  // of c0, c1, c2, signed
  parameter int ValueBits      = 18,  // of the value; the generator proves that every value fits
  parameter int OctaveStage    = 0,   // 1 if this or another table of the pipe is by octaves
  parameter int SquareStages   = 0,   // 1 if this or another table of the pipe has degree 2
  parameter int Product        = 1,   // cycles of a multiplier
  parameter int Interval       = 1,   // cycles from one pair to the next, above Product unless 1
  localparam int Cycles        = OctaveStage + 3 + Product + SquareStages * (1 + Product)  // to the value
) (
  input  logic                        clk_i,
  input  logic                        rst_ni,
  input  logic [Cycles:0]             valid_i,  // [k]: the pair whose r2_i came k cycles ago is there
  input  logic [2*DifferenceFrac-1:0] r2_i,     // with valid_i[0]
  // The memory: synchronous read, c0, c1, c2 in the cycle after index_o.
  output logic [IndexBits-1:0]        index_o,  // address
  input  logic signed [EntryBits-1:0] c0_i,     // value at t = 0
  input  logic signed [EntryBits-1:0] c1_i,     // slope at t = 0
  input  logic signed [EntryBits-1:0] c2_i,  // of no use at degree 1
  output logic signed [ValueBits-1:0] value_o   // of the pair with valid_i[Cycles]
);
  localparam int R2Bits    = 2 * DifferenceFrac;
  localparam int SlopeBits = (Degree == 2) ? EntryBits + 1 : EntryBits;

  // Address.
  logic [IndexBits-1:0]    index_d;
  logic [FractionBits-1:0] t_d, t_q;
  if (Octaves != 0) begin : gen_octaves
    localparam int OctaveBits = $clog2(R2Bits + 1);
    localparam int BelowBits  = BinBits + FractionBits;  // taken below the leading one
    localparam int ShiftBits  = R2Bits + BelowBits;
    localparam int Top        = R2Bits - 1;

    function automatic logic [OctaveBits-1:0] leading_one(input logic [R2Bits-1:0] bits);
      integer b;
      begin
        leading_one = '0;
        for (b = 0; b < R2Bits; b = b + 1) begin
          if (bits[b]) leading_one = b[OctaveBits-1:0];
        end
      end
    endfunction

    logic [OctaveBits-1:0] octave_q;
    logic [R2Bits-1:0]     r2_q;
    logic                  below_q;
    always_ff @(posedge clk_i) begin
      if (valid_i[0]) begin
        octave_q <= leading_one(r2_i);
        r2_q     <= r2_i;
        below_q  <= (r2_i[R2Bits-1:FirstOctave] == '0);
      end
    end

    // The leading one goes to the top bit, so that index and t stand at fixed places below it.
    logic [ShiftBits-1:0]  aligned;
    logic [OctaveBits-1:0] row;
    logic [IndexBits-1:0]  row_index;
    localparam int First = FirstOctave;
    assign aligned = {r2_q, {BelowBits{1'b0}}} << (Top[OctaveBits-1:0] - octave_q);
    assign row     = octave_q - First[OctaveBits-1:0];
    if (BinBits == IndexBits) begin : gen_one_row
      assign row_index = aligned[ShiftBits-2 -: BinBits];
    end else if (BinBits > 0) begin : gen_bins
      assign row_index = {row[IndexBits-BinBits-1:0], aligned[ShiftBits-2 -: BinBits]};
    end else begin : gen_no_bins
      assign row_index = row[IndexBits-1:0];
    end
    assign index_d = below_q ? '0 : row_index;
    assign t_d     = below_q ? '0 : aligned[ShiftBits-2-BinBits -: FractionBits];
    logic unused_octaves;
    assign unused_octaves = ^{aligned, row};
  end else begin : gen_uniform
    logic [IndexBits+FractionBits-1:0] both_d, both_q;
    assign both_d = r2_i[R2Bits-1 -: IndexBits+FractionBits];
    cuboct_hold #(.Bits(IndexBits + FractionBits), .Depth(OctaveStage), .Interval(1)) u_align (
      .clk_i, .valid_i(valid_i[OctaveStage:0]), .d_i(both_d), .q_o(both_q)
    );
    assign index_d = both_q[FractionBits +: IndexBits];
    assign t_d     = both_q[FractionBits-1:0];
    logic unused_r2;
    assign unused_r2 = ^r2_i;
  end
  always_ff @(posedge clk_i) begin
    if (valid_i[OctaveStage]) t_q <= t_d;
  end
  // A pair in each cycle: the register stands behind the memory, as a product that waits for a block's read would be
  // the longest path. With pairs further apart the entry needs no register, and the index is shorter.
  logic signed [EntryBits-1:0] c0_read, c1_read, c2_read;
  if (Interval == 1) begin : gen_entry
    logic signed [EntryBits-1:0] c0_q, c1_q, c2_q;
    always_ff @(posedge clk_i) begin
      if (valid_i[OctaveStage+1]) begin
        c0_q <= c0_i;
        c1_q <= c1_i;
        c2_q <= c2_i;
      end
    end
    assign index_o = index_d;
    assign c0_read = c0_q;
    assign c1_read = c1_q;
    assign c2_read = c2_q;
  end else begin : gen_index
    logic [IndexBits-1:0] index_q;
    always_ff @(posedge clk_i) begin
      if (valid_i[OctaveStage]) index_q <= index_d;
    end
    assign index_o = index_q;
    assign c0_read = c0_i;
    assign c1_read = c1_i;
    assign c2_read = c2_i;
  end

  // While the memory answers t waits one cycle: stage Read.
  localparam int Read  = OctaveStage + 2;
  localparam int Slope = Read + SquareStages * (1 + Product);  // the slope's stage
  logic [FractionBits-1:0]     t_slope;
  logic signed [SlopeBits-1:0] slope;

  if (Degree == 2) begin : gen_square
    logic signed [EntryBits+FractionBits:0] product;
    logic signed [EntryBits-1:0]            c1;
    logic signed [SlopeBits-1:0]            rounded, slope_d, slope_q;
    logic [FractionBits-1:0] t_read;
    cuboct_hold #(.Bits(FractionBits), .Depth(1), .Interval(Interval)) u_t_read (
      .clk_i, .valid_i(valid_i[Read:Read-1]), .d_i(t_q), .q_o(t_read)
    );
    cuboct_mult #(.ABits(EntryBits), .BBits(FractionBits + 1), .Cycles(Product)) u_square (
      .clk_i, .rst_ni, .en_i(valid_i[Read]), .a_i(c2_read), .b_i($signed({1'b0, t_read})), .p_o(product)
    );
    cuboct_hold #(.Bits(EntryBits), .Depth(Product), .Interval(Interval)) u_c1 (
      .clk_i, .valid_i(valid_i[Read+Product:Read]), .d_i(c1_read), .q_o(c1)
    );
    cuboct_round_odd #(.InBits(EntryBits + FractionBits + 1), .Shift(FractionBits), .OutBits(SlopeBits)) u_round (
      .a_i(product), .y_o(rounded)
    );
    assign slope_d = $signed({c1[EntryBits-1], c1}) + rounded;
    always_ff @(posedge clk_i) begin
      if (valid_i[Slope-1]) slope_q <= slope_d;
    end
    assign slope = slope_q;
  end else begin : gen_line
    logic [EntryBits-1:0] late;
    cuboct_hold #(.Bits(EntryBits), .Depth(Slope - Read), .Interval(Interval)) u_c1 (
      .clk_i, .valid_i(valid_i[Slope:Read]), .d_i(c1_read), .q_o(late)
    );
    assign slope = $signed(late);
    logic unused_c2;
    assign unused_c2 = ^c2_read;
  end

  cuboct_hold #(.Bits(FractionBits), .Depth(Slope - Read + 1), .Interval(Interval)) u_t (
    .clk_i, .valid_i(valid_i[Slope:Read-1]), .d_i(t_q), .q_o(t_slope)
  );

  logic signed [SlopeBits+FractionBits:0] product;
  logic signed [EntryBits-1:0]            c0;
  logic signed [ValueBits-1:0]            rise, base, value_d, value_q;
  cuboct_mult #(.ABits(SlopeBits), .BBits(FractionBits + 1), .Cycles(Product)) u_slope (
    .clk_i, .rst_ni, .en_i(valid_i[Slope]), .a_i(slope), .b_i($signed({1'b0, t_slope})), .p_o(product)
  );
  cuboct_hold #(.Bits(EntryBits), .Depth(Slope - Read + Product), .Interval(Interval)) u_c0 (
    .clk_i, .valid_i(valid_i[Slope+Product:Read]), .d_i(c0_read), .q_o(c0)
  );
  cuboct_round_odd #(.InBits(SlopeBits + FractionBits + 1), .Shift(FractionBits), .OutBits(ValueBits)) u_round (
    .a_i(product), .y_o(rise)
  );
  // Modulo 2^ValueBits: rise alone may wrap, the sum is right because the value fits.
  cuboct_resize #(.InBits(EntryBits), .OutBits(ValueBits)) u_base (.a_i(c0), .y_o(base));
  assign value_d = base + rise;
  always_ff @(posedge clk_i) begin
    if (valid_i[Cycles-1]) value_q <= value_d;
  end
  assign value_o = value_q;
endmodule
