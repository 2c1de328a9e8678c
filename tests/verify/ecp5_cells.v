// SPDX-License-Identifier: MIT
// Cells of Lattice ECP5 that yosys has no simulation model of, as far as its synth_ecp5 uses them: after the ports in its
// cells_bb.v and the way in which its brams_map.v and dsp_map.v connect them. What they do not model is an
// instance of a module that is not there. For tests/verify/netlist.

// The product of two words of 18 bits, without registers.
module MULT18X18D (
  input A17, A16, A15, A14, A13, A12, A11, A10, A9, A8, A7, A6, A5, A4, A3, A2, A1, A0,
  input B17, B16, B15, B14, B13, B12, B11, B10, B9, B8, B7, B6, B5, B4, B3, B2, B1, B0,
  input C17, C16, C15, C14, C13, C12, C11, C10, C9, C8, C7, C6, C5, C4, C3, C2, C1, C0,
  input SIGNEDA, SIGNEDB, SOURCEA, SOURCEB, CLK0, CLK1, CLK2, CLK3, CE0, CE1, CE2, CE3, RST0, RST1, RST2, RST3,
  output P35, P34, P33, P32, P31, P30, P29, P28, P27, P26, P25, P24, P23, P22, P21, P20, P19, P18, P17, P16, P15,
  P14, P13, P12, P11, P10, P9, P8, P7, P6, P5, P4, P3, P2, P1, P0
);
  parameter REG_INPUTA_CLK = "NONE";
  parameter REG_INPUTB_CLK = "NONE";
  parameter REG_PIPELINE_CLK = "NONE";
  parameter REG_OUTPUT_CLK = "NONE";
  generate if (REG_INPUTA_CLK != "NONE" || REG_INPUTB_CLK != "NONE" || REG_PIPELINE_CLK != "NONE"
               || REG_OUTPUT_CLK != "NONE") begin : gen_bad
    mult18x18d_register_not_modelled u_bad ();
  end endgenerate
  wire [17:0] a = {A17, A16, A15, A14, A13, A12, A11, A10, A9, A8, A7, A6, A5, A4, A3, A2, A1, A0};
  wire [17:0] b = {B17, B16, B15, B14, B13, B12, B11, B10, B9, B8, B7, B6, B5, B4, B3, B2, B1, B0};
  wire signed [35:0] wide_a = {{18{SIGNEDA && a[17]}}, a};
  wire signed [35:0] wide_b = {{18{SIGNEDB && b[17]}}, b};
  wire [35:0] product = wide_a * wide_b;
  assign {P35, P34, P33, P32, P31, P30, P29, P28, P27, P26, P25, P24, P23, P22, P21, P20, P19, P18, P17, P16, P15,
  P14, P13, P12, P11, P10, P9, P8, P7, P6, P5, P4, P3, P2, P1, P0} = product;
endmodule

// 1,024 words of 18 bits. Port A writes, port B reads, both of 36, 18 or 9 bits; or two ports of 18 or 9 bits that do
// either, and where it says so answer a write with the word before it. In 36 bits port A's data go on to port B's pins.
module DP16KD (
  input DIA17, DIA16, DIA15, DIA14, DIA13, DIA12, DIA11, DIA10, DIA9, DIA8, DIA7, DIA6, DIA5, DIA4, DIA3, DIA2, DIA1,
  DIA0,
  input ADA13, ADA12, ADA11, ADA10, ADA9, ADA8, ADA7, ADA6, ADA5, ADA4, ADA3, ADA2, ADA1, ADA0,
  input CEA, OCEA, CLKA, WEA, RSTA, CSA2, CSA1, CSA0,
  output DOA17, DOA16, DOA15, DOA14, DOA13, DOA12, DOA11, DOA10, DOA9, DOA8, DOA7, DOA6, DOA5, DOA4, DOA3, DOA2,
  DOA1, DOA0,
  input DIB17, DIB16, DIB15, DIB14, DIB13, DIB12, DIB11, DIB10, DIB9, DIB8, DIB7, DIB6, DIB5, DIB4, DIB3, DIB2, DIB1,
  DIB0,
  input ADB13, ADB12, ADB11, ADB10, ADB9, ADB8, ADB7, ADB6, ADB5, ADB4, ADB3, ADB2, ADB1, ADB0,
  input CEB, OCEB, CLKB, WEB, RSTB, CSB2, CSB1, CSB0,
  output DOB17, DOB16, DOB15, DOB14, DOB13, DOB12, DOB11, DOB10, DOB9, DOB8, DOB7, DOB6, DOB5, DOB4, DOB3, DOB2,
  DOB1, DOB0
);
  parameter DATA_WIDTH_A = 18;
  parameter DATA_WIDTH_B = 18;
  parameter REGMODE_A = "NOREG";
  parameter REGMODE_B = "NOREG";
  parameter RESETMODE = "SYNC";
  parameter ASYNC_RESET_RELEASE = "SYNC";
  parameter CSDECODE_A = "0b000";
  parameter CSDECODE_B = "0b000";
  parameter WRITEMODE_A = "NORMAL";
  parameter WRITEMODE_B = "NORMAL";
  parameter CLKAMUX = "CLKA";
  parameter CLKBMUX = "CLKB";
  parameter GSR = "ENABLED";
  parameter INITVAL_00 = 320'd0;
  parameter INITVAL_01 = 320'd0;
  parameter INITVAL_02 = 320'd0;
  parameter INITVAL_03 = 320'd0;
  parameter INITVAL_04 = 320'd0;
  parameter INITVAL_05 = 320'd0;
  parameter INITVAL_06 = 320'd0;
  parameter INITVAL_07 = 320'd0;
  parameter INITVAL_08 = 320'd0;
  parameter INITVAL_09 = 320'd0;
  parameter INITVAL_0A = 320'd0;
  parameter INITVAL_0B = 320'd0;
  parameter INITVAL_0C = 320'd0;
  parameter INITVAL_0D = 320'd0;
  parameter INITVAL_0E = 320'd0;
  parameter INITVAL_0F = 320'd0;
  parameter INITVAL_10 = 320'd0;
  parameter INITVAL_11 = 320'd0;
  parameter INITVAL_12 = 320'd0;
  parameter INITVAL_13 = 320'd0;
  parameter INITVAL_14 = 320'd0;
  parameter INITVAL_15 = 320'd0;
  parameter INITVAL_16 = 320'd0;
  parameter INITVAL_17 = 320'd0;
  parameter INITVAL_18 = 320'd0;
  parameter INITVAL_19 = 320'd0;
  parameter INITVAL_1A = 320'd0;
  parameter INITVAL_1B = 320'd0;
  parameter INITVAL_1C = 320'd0;
  parameter INITVAL_1D = 320'd0;
  parameter INITVAL_1E = 320'd0;
  parameter INITVAL_1F = 320'd0;
  parameter INITVAL_20 = 320'd0;
  parameter INITVAL_21 = 320'd0;
  parameter INITVAL_22 = 320'd0;
  parameter INITVAL_23 = 320'd0;
  parameter INITVAL_24 = 320'd0;
  parameter INITVAL_25 = 320'd0;
  parameter INITVAL_26 = 320'd0;
  parameter INITVAL_27 = 320'd0;
  parameter INITVAL_28 = 320'd0;
  parameter INITVAL_29 = 320'd0;
  parameter INITVAL_2A = 320'd0;
  parameter INITVAL_2B = 320'd0;
  parameter INITVAL_2C = 320'd0;
  parameter INITVAL_2D = 320'd0;
  parameter INITVAL_2E = 320'd0;
  parameter INITVAL_2F = 320'd0;
  parameter INITVAL_30 = 320'd0;
  parameter INITVAL_31 = 320'd0;
  parameter INITVAL_32 = 320'd0;
  parameter INITVAL_33 = 320'd0;
  parameter INITVAL_34 = 320'd0;
  parameter INITVAL_35 = 320'd0;
  parameter INITVAL_36 = 320'd0;
  parameter INITVAL_37 = 320'd0;
  parameter INITVAL_38 = 320'd0;
  parameter INITVAL_39 = 320'd0;
  parameter INITVAL_3A = 320'd0;
  parameter INITVAL_3B = 320'd0;
  parameter INITVAL_3C = 320'd0;
  parameter INITVAL_3D = 320'd0;
  parameter INITVAL_3E = 320'd0;
  parameter INITVAL_3F = 320'd0;

  // Word w stands in INITVAL_(w / 16), 20 bits each.
  wire [64*320-1:0] initial_words = {INITVAL_3F, INITVAL_3E, INITVAL_3D, INITVAL_3C, INITVAL_3B, INITVAL_3A,
  INITVAL_39, INITVAL_38, INITVAL_37, INITVAL_36, INITVAL_35, INITVAL_34, INITVAL_33, INITVAL_32, INITVAL_31,
  INITVAL_30, INITVAL_2F, INITVAL_2E, INITVAL_2D, INITVAL_2C, INITVAL_2B, INITVAL_2A, INITVAL_29, INITVAL_28,
  INITVAL_27, INITVAL_26, INITVAL_25, INITVAL_24, INITVAL_23, INITVAL_22, INITVAL_21, INITVAL_20, INITVAL_1F,
  INITVAL_1E, INITVAL_1D, INITVAL_1C, INITVAL_1B, INITVAL_1A, INITVAL_19, INITVAL_18, INITVAL_17, INITVAL_16,
  INITVAL_15, INITVAL_14, INITVAL_13, INITVAL_12, INITVAL_11, INITVAL_10, INITVAL_0F, INITVAL_0E, INITVAL_0D,
  INITVAL_0C, INITVAL_0B, INITVAL_0A, INITVAL_09, INITVAL_08, INITVAL_07, INITVAL_06, INITVAL_05, INITVAL_04,
  INITVAL_03, INITVAL_02, INITVAL_01, INITVAL_00};
  reg [17:0] mem [0:1023];
  integer w;
  initial begin
    for (w = 0; w < 1024; w = w + 1) mem[w] = initial_words[20*w +: 18];
  end
  localparam before_a = (WRITEMODE_A == "READBEFOREWRITE");
  localparam before_b = (WRITEMODE_B == "READBEFOREWRITE");
  generate if (REGMODE_A != "NOREG" || REGMODE_B != "NOREG" || (WRITEMODE_A != "NORMAL" && !before_a)
               || (WRITEMODE_B != "NORMAL" && !before_b) || (before_a && DATA_WIDTH_A == 36)
               || (before_b && DATA_WIDTH_B == 36) || CLKAMUX != "CLKA" || CLKBMUX != "CLKB" || CSDECODE_A != "0b000" || CSDECODE_B != "0b000"
               || (DATA_WIDTH_A != 36 && DATA_WIDTH_A != 18 && DATA_WIDTH_A != 9)
               || (DATA_WIDTH_B != 36 && DATA_WIDTH_B != 18 && DATA_WIDTH_B != 9)) begin : gen_bad
    dp16kd_mode_not_modelled u_bad ();
  end endgenerate

  wire [17:0] dia = {DIA17, DIA16, DIA15, DIA14, DIA13, DIA12, DIA11, DIA10, DIA9, DIA8, DIA7, DIA6, DIA5, DIA4,
  DIA3, DIA2, DIA1, DIA0};
  wire [17:0] dib = {DIB17, DIB16, DIB15, DIB14, DIB13, DIB12, DIB11, DIB10, DIB9, DIB8, DIB7, DIB6, DIB5, DIB4,
  DIB3, DIB2, DIB1, DIB0};
  wire [13:0] ada = {ADA13, ADA12, ADA11, ADA10, ADA9, ADA8, ADA7, ADA6, ADA5, ADA4, ADA3, ADA2, ADA1, ADA0};
  wire [13:0] adb = {ADB13, ADB12, ADB11, ADB10, ADB9, ADB8, ADB7, ADB6, ADB5, ADB4, ADB3, ADB2, ADB1, ADB0};
  wire on_a = CEA && !CSA2 && !CSA1 && !CSA0;
  wire on_b = CEB && !CSB2 && !CSB1 && !CSB0;
  reg [17:0] out_a, out_b;
  always @(posedge CLKA) if (on_a && WEA) begin
    if (DATA_WIDTH_A == 36) begin
      if (ada[0]) mem[{ada[13:5], 1'b0}][8:0] <= dia[8:0];
      if (ada[1]) mem[{ada[13:5], 1'b0}][17:9] <= dia[17:9];
      if (ada[2]) mem[{ada[13:5], 1'b1}][8:0] <= dib[8:0];
      if (ada[3]) mem[{ada[13:5], 1'b1}][17:9] <= dib[17:9];
    end else if (DATA_WIDTH_A == 18) begin
      if (ada[0]) mem[ada[13:4]][8:0] <= dia[8:0];
      if (ada[1]) mem[ada[13:4]][17:9] <= dia[17:9];
    end else begin
      mem[ada[13:4]][9*ada[3] +: 9] <= dia[8:0];
    end
  end
  always @(posedge CLKB) if (on_b && WEB) begin
    if (DATA_WIDTH_B == 18) begin
      if (adb[0]) mem[adb[13:4]][8:0] <= dib[8:0];
      if (adb[1]) mem[adb[13:4]][17:9] <= dib[17:9];
    end else begin
      mem[adb[13:4]][9*adb[3] +: 9] <= dib[8:0];
    end
  end
  reg [17:0] low_b;  // of 36 bits
  always @(posedge CLKA) if (on_a && (RSTA || !WEA || before_a)) begin
    out_a <= RSTA ? 18'd0 : (DATA_WIDTH_A == 9) ? {9'd0, mem[ada[13:4]][9*ada[3] +: 9]} : mem[ada[13:4]];
  end
  always @(posedge CLKB) if (on_b && (RSTB || !WEB || before_b)) begin
    low_b <= RSTB ? 18'd0 : mem[{adb[13:5], 1'b0}];
    out_b <= RSTB ? 18'd0 : (DATA_WIDTH_B == 9) ? {9'd0, mem[adb[13:4]][9*adb[3] +: 9]}
                          : (DATA_WIDTH_B == 18) ? mem[adb[13:4]] : mem[{adb[13:5], 1'b1}];
  end
  assign {DOA17, DOA16, DOA15, DOA14, DOA13, DOA12, DOA11, DOA10, DOA9, DOA8, DOA7, DOA6, DOA5, DOA4, DOA3, DOA2,
  DOA1, DOA0} = (DATA_WIDTH_B == 36) ? low_b : out_a;
  assign {DOB17, DOB16, DOB15, DOB14, DOB13, DOB12, DOB11, DOB10, DOB9, DOB8, DOB7, DOB6, DOB5, DOB4, DOB3, DOB2,
  DOB1, DOB0} = out_b;
  wire unused_pins = &{OCEA, OCEB};
endmodule
