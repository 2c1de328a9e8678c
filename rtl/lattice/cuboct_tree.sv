// SPDX-License-Identifier: MIT
// Between a host and its nodes: cuboct_spread to them, cuboct_gather from their cuboct_watch. No wire between two
// registers is for more than eight nodes. Commands come to all nodes in the same cycle; between a command and what it
// changes in the outputs lie 2 Levels + 1 cycles, Levels as in cuboct_spread; for one node none.
module cuboct_tree #(
  parameter  int Nodes        = 9,    // 1 to 262144
  parameter  int CommandBits  = 32,   // of command_i
  parameter  int ParticleBits = 154,  // of a particle, with its cell in the node
  parameter  int FaultBits    = 76,   // of a fault
  localparam int Groups       = (Nodes + 7) / 8,  // of eight nodes; the last one may have fewer
  localparam int WatchBits    = FaultBits + ParticleBits
) (
  input  logic                          clk_i,
  input  logic                          rst_ni,
  // The host.
  input  logic                          start_i,           // for all nodes
  input  logic                          load_valid_i,      // for node node_i
  input  logic                          select_i,          // from now on node_i is the one observed
  input  logic [31:0]                   node_i,            // with load_valid_i or select_i
  input  logic [CommandBits-1:0]        command_i,         // for all nodes
  output logic                          settled_o,         // start_i and select_i show in the outputs
  output logic                          busy_o,            // some node is not idle
  output logic                          idle_o,            // settled and not busy
  output logic                          faulty_o,          // some node had a fault since the reset
  output logic                          fault_valid_o,     // the node observed had
  output logic [FaultBits-1:0]          fault_o,           // with fault_valid_o: its first
  output logic                          observe_valid_o,   // the node observed shows a particle
  output logic [ParticleBits-1:0]       observe_data_o,    // with observe_valid_o: the particle
  // The nodes.
  output logic [Groups-1:0]             node_start_o,      // by group
  output logic [Nodes-1:0]              node_load_o,       // by node
  output logic [Nodes-1:0]              node_observed_o,   // by node
  output logic [Groups*CommandBits-1:0] node_command_o,    // by group
  input  logic [Nodes*4-1:0]            node_flags_i,      // by node, of cuboct_watch
  input  logic [Nodes*WatchBits-1:0]    node_data_i        // by node, of cuboct_watch
);
  localparam int Levels = (Nodes <= 1) ? 0 : (Nodes <= 8) ? 1 : (Nodes <= 64) ? 2 : (Nodes <= 512) ? 3
                        : (Nodes <= 4096) ? 4 : (Nodes <= 32768) ? 5 : 6;
  cuboct_spread #(.Nodes(Nodes), .Bits(CommandBits)) u_spread (
    .clk_i, .rst_ni, .start_i, .load_valid_i, .select_i, .node_i, .data_i(command_i), .start_o(node_start_o),
    .load_valid_o(node_load_o), .observed_o(node_observed_o), .data_o(node_command_o)
  );
  cuboct_gather #(.Nodes(Nodes), .Flags(4), .Bits(WatchBits)) u_gather (
    .clk_i, .rst_ni, .flags_i(node_flags_i), .data_i(node_data_i),
    .flags_o({busy_o, faulty_o, fault_valid_o, observe_valid_o}), .data_o({fault_o, observe_data_o})
  );
  // A start in cycle t is a node's in t + Levels, makes it busy in the next cycle, and that comes Levels + 1 later.
  if (Levels == 0) begin : gen_at_once
    assign settled_o = 1'b1;
  end else begin : gen_later
    logic [2*Levels:0] wait_d, wait_q;  // a bit per cycle
    assign wait_d    = (start_i || select_i) ? '1 : {1'b0, wait_q[2*Levels:1]};
    assign settled_o = !wait_q[0];
    always_ff @(posedge clk_i) begin
      if (!rst_ni) wait_q <= '0;
      else wait_q <= wait_d;
    end
  end
  assign idle_o = settled_o && !busy_o;
endmodule
