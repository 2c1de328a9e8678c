// SPDX-License-Identifier: MIT
// From a host to all nodes, over registers of which each drives at most eight others, or eight nodes. All nodes get
// what comes in cycle t in cycle t + Levels: the least number with Nodes <= 8^Levels. For one node it is wires.
//
// A node's number travels along. At each register three of its bits say which of the next ones is meant, so no
// comparison is wider.
module cuboct_spread #(
  parameter  int Nodes  = 9,  // 1 to 262144
  parameter  int Bits   = 8,  // of data_i, >= 1
  localparam int Groups = (Nodes + 7) / 8  // of eight nodes; the last one may have fewer
) (
  input  logic                   clk_i,
  input  logic                   rst_ni,
  input  logic                   start_i,       // for all nodes
  input  logic                   load_valid_i,  // for node node_i
  input  logic                   select_i,      // from now on node_i is the one observed
  input  logic [31:0]            node_i,        // with load_valid_i or select_i; from Nodes on it is no node's
  input  logic [Bits-1:0]        data_i,        // for all nodes
  output logic [Groups-1:0]      start_o,       // by group
  output logic [Nodes-1:0]       load_valid_o,  // by node
  output logic [Nodes-1:0]       observed_o,    // by node: selected last; after a reset node 0
  output logic [Groups*Bits-1:0] data_o         // by group
);
  localparam int Levels = (Nodes <= 1) ? 0 : (Nodes <= 8) ? 1 : (Nodes <= 64) ? 2 : (Nodes <= 512) ? 3
                        : (Nodes <= 4096) ? 4 : (Nodes <= 32768) ? 5 : 6;
  if (Levels == 0) begin : gen_wires
    logic unused_host;
    assign unused_host  = ^{clk_i, rst_ni, select_i};
    assign start_o      = start_i;
    assign load_valid_o = load_valid_i && (node_i == 32'd0);
    assign observed_o   = 1'b1;
    assign data_o       = data_i;
  end else begin : gen_tree
    // A register of level l >= 1 is over 8^(l+1) nodes, level Levels is the host. `among`: the number is that of one
    // of these.
    for (genvar l = 1; l <= Levels; l++) begin : gen_level
      localparam int Below      = 1 << (3 * l + 3);
      localparam int Registers  = (l == Levels) ? 1 : (Nodes + Below - 1) / Below;
      localparam int NumberBits = 3 * l + 3;
      logic [Registers-1:0]            start, load, select, among;
      logic [Registers*NumberBits-1:0] number;
      logic [Registers*Bits-1:0]       data;
    end
    assign gen_level[Levels].start  = start_i;
    assign gen_level[Levels].load   = load_valid_i;
    assign gen_level[Levels].select = select_i;
    assign gen_level[Levels].among = (node_i[31:3*Levels+3] == '0);
    assign gen_level[Levels].number = node_i[3*Levels+2:0];
    assign gen_level[Levels].data   = data_i;
    for (genvar l = 1; l < Levels; l++) begin : gen_registers
      localparam int Below      = 1 << (3 * l + 3);
      localparam int Registers  = (Nodes + Below - 1) / Below;
      localparam int NumberBits = 3 * l + 3;
      for (genvar r = 0; r < Registers; r++) begin : gen_register
        localparam int From  = r / 8;  // the register above
        localparam int Place = r;      // the three lowest bits: which of the eight that this one drives
        logic [NumberBits+2:0] number;
        logic                  among;
        assign number = gen_level[l+1].number[From*(NumberBits+3) +: NumberBits+3];
        assign among = gen_level[l+1].among[From] && (number[NumberBits +: 3] == Place[2:0]);
        cuboct_stage #(.Flags(3), .Bits(1 + NumberBits + Bits)) u_stage (
          .clk_i, .rst_ni,
          .flags_i({gen_level[l+1].start[From], gen_level[l+1].load[From], gen_level[l+1].select[From]}),
          .data_i({among, number[NumberBits-1:0], gen_level[l+1].data[From*Bits +: Bits]}),
          .flags_o({gen_level[l].start[r], gen_level[l].load[r], gen_level[l].select[r]}),
          .data_o({gen_level[l].among[r], gen_level[l].number[r*NumberBits +: NumberBits],
                   gen_level[l].data[r*Bits +: Bits]})
        );
      end
    end
    // The last registers: of groups, and a bit of its own for each node.
    for (genvar g = 0; g < Groups; g++) begin : gen_group
      cuboct_stage #(.Flags(1), .Bits(Bits)) u_stage (
        .clk_i, .rst_ni, .flags_i(gen_level[1].start[g/8]), .data_i(gen_level[1].data[g/8*Bits +: Bits]),
        .flags_o(start_o[g]), .data_o(data_o[g*Bits +: Bits])
      );
    end
    for (genvar n = 0; n < Nodes; n++) begin : gen_node
      localparam int From  = n / 64;
      localparam int Place = n;
      logic hit, observed_d, load_q, observed_q;
      assign hit        = gen_level[1].among[From] && (gen_level[1].number[6*From +: 6] == Place[5:0]);
      assign observed_d = gen_level[1].select[From] ? hit : observed_q;
      always_ff @(posedge clk_i) begin
        if (!rst_ni) begin
          load_q     <= 1'b0;
          observed_q <= (n == 0);
        end else begin
          load_q     <= gen_level[1].load[From] && hit;
          observed_q <= observed_d;
        end
      end
      assign load_valid_o[n] = load_q;
      assign observed_o[n]   = observed_q;
    end
  end
endmodule
