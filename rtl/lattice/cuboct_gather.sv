// SPDX-License-Identifier: MIT
// The or of what nodes show, over registers of which each hears at most eight others, or eight nodes. What is shown in
// cycle t comes in cycle t + Levels: the least number with Nodes <= 8^Levels. Of one node it is wires.
module cuboct_gather #(
  parameter int Nodes = 9,  // 1 to 262144
  parameter int Flags = 1,  // bits with a reset, of a node, >= 1
  parameter int Bits  = 8   // bits without, of a node, >= 1
) (
  input  logic                   clk_i,
  input  logic                   rst_ni,
  input  logic [Nodes*Flags-1:0] flags_i,  // by node
  input  logic [Nodes*Bits-1:0]  data_i,   // by node
  output logic [Flags-1:0]       flags_o,  // the or of all; zeros after a reset
  output logic [Bits-1:0]        data_o    // the or of all
);
  localparam int Levels = (Nodes <= 1) ? 0 : (Nodes <= 8) ? 1 : (Nodes <= 64) ? 2 : (Nodes <= 512) ? 3
                        : (Nodes <= 4096) ? 4 : (Nodes <= 32768) ? 5 : 6;
  // Level 0: the nodes. A register of level l has eight of level l-1 below it.
  for (genvar l = 0; l <= Levels; l++) begin : gen_level
    localparam int Below   = 1 << (3 * l);
    localparam int Sources = (Nodes + Below - 1) / Below;
    logic [Sources*Flags-1:0] flags;
    logic [Sources*Bits-1:0]  data;
  end
  assign gen_level[0].flags = flags_i;
  assign gen_level[0].data  = data_i;
  for (genvar l = 1; l <= Levels; l++) begin : gen_registers
    localparam int Above     = 1 << (3 * l), Below = 1 << (3 * l - 3);
    localparam int Registers = (Nodes + Above - 1) / Above;
    localparam int Sources   = (Nodes + Below - 1) / Below;
    for (genvar r = 0; r < Registers; r++) begin : gen_register
      localparam int First = 8 * r;
      localparam int Count = (Sources - First < 8) ? Sources - First : 8;
      logic [Flags-1:0]       flags;
      logic [Bits-1:0]        data;
      logic [Count*Flags-1:0] all_flags;
      logic [Count*Bits-1:0]  all_data;
      integer                 k;
      assign all_flags = gen_level[l-1].flags[First*Flags +: Count*Flags];
      assign all_data  = gen_level[l-1].data[First*Bits +: Count*Bits];
      always_comb begin
        flags = '0;
        data  = '0;
        for (k = 0; k < Count; k = k + 1) begin
          flags = flags | all_flags[k*Flags +: Flags];
          data  = data | all_data[k*Bits +: Bits];
        end
      end
      cuboct_stage #(.Flags(Flags), .Bits(Bits)) u_stage (
        .clk_i, .rst_ni, .flags_i(flags), .data_i(data),
        .flags_o(gen_level[l].flags[r*Flags +: Flags]), .data_o(gen_level[l].data[r*Bits +: Bits])
      );
    end
  end
  if (Levels == 0) begin : gen_wires
    logic unused_clock;
    assign unused_clock = clk_i ^ rst_ni;
  end
  assign flags_o = gen_level[Levels].flags;
  assign data_o  = gen_level[Levels].data;
endmodule
