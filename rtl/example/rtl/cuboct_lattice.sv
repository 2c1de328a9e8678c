// SPDX-License-Identifier: MIT
// Made by cuboct emit from plan 5290aa12107ad825; do not edit.
// All nodes, their links, and the host's way to them (cuboct_tree). The host's side is one node wide; README.md
// of the project tells when what happens.
module cuboct_lattice #(
  parameter  int Probe      = 0,  // 1: probe_* show all nodes, node 0 lowest, for benches; 0: they are zeros
  localparam int Nodes      = 2,
  localparam int ProbeNodes = (Probe != 0) ? Nodes : 1
) (
  input  logic                                           clk_i,
  input  logic                                           rst_ni,
  input  logic                                           start_i,
  input  logic [31:0]                                    steps_i,
  input  logic                                           load_valid_i,
  input  logic [cuboct_pkg::ParticleBits-1:0]            load_data_i,
  input  logic                                           select_i,
  input  logic [31:0]                                    node_i,
  output logic                                           idle_o,
  output logic                                           busy_o,
  output logic                                           settled_o,
  output logic                                           faulty_o,
  output logic                                           observe_valid_o,
  output logic [cuboct_pkg::ParticleBits-1:0]            observe_data_o,
  output logic                                           fault_valid_o,
  output logic [3:0]                                     fault_code_o,
  output logic [cuboct_pkg::IdBits-1:0]                  fault_id_o,
  output logic [63:0]                                    fault_number_o,
  output logic [ProbeNodes*8-1:0]                        probe_phase_start_o,
  output logic [ProbeNodes*8-1:0]                        probe_phase_end_o,
  output logic [ProbeNodes-1:0]                          probe_observe_valid_o,
  output logic [ProbeNodes*cuboct_pkg::ParticleBits-1:0] probe_observe_data_o,
  output logic [ProbeNodes-1:0]                          probe_fault_valid_o,
  output logic [ProbeNodes*4-1:0]                        probe_fault_code_o,
  output logic [ProbeNodes*cuboct_pkg::IdBits-1:0]       probe_fault_id_o,
  output logic [ProbeNodes*64-1:0]                       probe_fault_number_o,
  output logic [ProbeNodes-1:0]                          probe_idle_o
);
  localparam int LinkBits    = cuboct_pkg::LinkBits;
  localparam int NodeBits    = 2;
  localparam int WordBits    = cuboct_pkg::ParticleBits;
  localparam int FaultBits   = 4 + cuboct_pkg::IdBits + 64;
  localparam int CommandBits = 32 + WordBits;
  localparam int Groups      = (Nodes + 7) / 8;
  // By node and face (-x, +x, -y, +y, -z, +z), -x of node 0 in the lowest place: the neighbour; Nodes where there is none.
  localparam logic [12*Nodes-1:0] Neighbours = {
    12'haa8, 12'haa6  // node 0: cell (0, 0, 0)
  };

  logic [Groups-1:0] node_start;
  logic [Nodes-1:0] node_load, node_observed;
  logic [Groups*CommandBits-1:0] node_command;
  logic [Nodes*4-1:0] node_flags;
  logic [Nodes*(FaultBits+WordBits)-1:0] node_data;
  cuboct_tree #(
    .Nodes(Nodes), .CommandBits(CommandBits), .ParticleBits(WordBits), .FaultBits(FaultBits)
  ) u_tree (
    .clk_i, .rst_ni, .start_i, .load_valid_i, .select_i, .node_i,
    .command_i({steps_i, load_data_i}),
    .settled_o, .busy_o, .idle_o, .faulty_o, .fault_valid_o,
    .fault_o({fault_number_o, fault_id_o, fault_code_o}), .observe_valid_o,
    .observe_data_o(observe_data_o),
    .node_start_o(node_start), .node_load_o(node_load), .node_observed_o(node_observed),
    .node_command_o(node_command), .node_flags_i(node_flags), .node_data_i(node_data)
  );

  for (genvar n = 0; n < Nodes; n++) begin : gen_node
    logic [5:0] has_link;
    logic [5:0] valid, valid_in;
    logic [5:0] last, last_in;
    logic [5:0] ready, ready_in;
    logic [6*LinkBits-1:0] data, data_in;
    for (genvar f = 0; f < 6; f++) begin : gen_face
      localparam int To   = {{(32-NodeBits){1'b0}}, Neighbours[(6*n+f)*NodeBits +: NodeBits]};
      localparam int Back = (f % 2 == 0) ? f + 1 : f - 1;  // the face of the neighbour that looks here
      if (To < Nodes) begin : gen_link
        assign has_link[f] = 1'b1;
        assign valid_in[f] = gen_node[To].valid[Back];
        assign last_in[f] = gen_node[To].last[Back];
        assign ready_in[f] = gen_node[To].ready[Back];
        assign data_in[f*LinkBits +: LinkBits] = gen_node[To].data[Back*LinkBits +: LinkBits];
      end else begin : gen_end
        logic unused_end;
        assign unused_end = ^{valid[f], last[f], ready[f], data[f*LinkBits +: LinkBits]};
        assign has_link[f] = 1'b0;
        assign valid_in[f] = '0;
        assign last_in[f] = '0;
        assign ready_in[f] = '0;
        assign data_in[f*LinkBits +: LinkBits] = '0;
      end
    end
    logic [7:0] phase_start;
    logic [7:0] phase_end;
    logic [4:0] force_event;
    logic observe_valid;
    logic [cuboct_pkg::ParticleBits-1:0] observe_data;
    logic fault_valid;
    logic [3:0] fault_code;
    logic [cuboct_pkg::IdBits-1:0] fault_id;
    logic [63:0] fault_number;
    logic idle;
    logic unused_event;
    assign unused_event = ^force_event;
    logic [31:0] steps;
    logic [cuboct_pkg::ParticleBits-1:0] load_data;
    assign {steps, load_data} = node_command[n/8*CommandBits +: CommandBits];
    cuboct_node u_node (
      .clk_i(clk_i),
      .rst_ni(rst_ni),
      .start_i(node_start[n/8]),
      .steps_i(steps),
      .has_link_i(has_link),
      .load_valid_i(node_load[n]),
      .load_data_i(load_data),
      .link_valid_o(valid),
      .link_end_o(last),
      .link_data_o(data),
      .link_ready_i(ready_in),
      .link_valid_i(valid_in),
      .link_end_i(last_in),
      .link_data_i(data_in),
      .link_ready_o(ready),
      .phase_start_o(phase_start),
      .phase_end_o(phase_end),
      .force_event_o(force_event),
      .observe_valid_o(observe_valid),
      .observe_data_o(observe_data),
      .fault_valid_o(fault_valid),
      .fault_code_o(fault_code),
      .fault_id_o(fault_id),
      .fault_number_o(fault_number),
      .idle_o(idle)
    );
    cuboct_watch #(.ParticleBits(WordBits), .FaultBits(FaultBits), .Delay((Nodes > 1) ? 1 : 0)) u_watch (
      .clk_i, .rst_ni, .observed_i(node_observed[n]), .idle_i(idle), .observe_valid_i(observe_valid),
      .observe_data_i(observe_data), .fault_valid_i(fault_valid), .fault_i({fault_number, fault_id, fault_code}),
      .flags_o(node_flags[4*n +: 4]), .data_o(node_data[n*(FaultBits+WordBits) +: FaultBits+WordBits])
    );
    if (Probe != 0) begin : gen_probe
      assign probe_phase_start_o[n*8 +: 8] = phase_start;
      assign probe_phase_end_o[n*8 +: 8] = phase_end;
      assign probe_observe_valid_o[n] = observe_valid;
      assign probe_observe_data_o[n*cuboct_pkg::ParticleBits +: cuboct_pkg::ParticleBits] = observe_data;
      assign probe_fault_valid_o[n] = fault_valid;
      assign probe_fault_code_o[n*4 +: 4] = fault_code;
      assign probe_fault_id_o[n*cuboct_pkg::IdBits +: cuboct_pkg::IdBits] = fault_id;
      assign probe_fault_number_o[n*64 +: 64] = fault_number;
      assign probe_idle_o[n] = idle;
    end else begin : gen_no_probe
      logic unused_phases;
      assign unused_phases = ^{phase_start, phase_end};
    end
  end
  if (Probe == 0) begin : gen_no_probes
    assign probe_phase_start_o = '0;
    assign probe_phase_end_o = '0;
    assign probe_observe_valid_o = '0;
    assign probe_observe_data_o = '0;
    assign probe_fault_valid_o = '0;
    assign probe_fault_code_o = '0;
    assign probe_fault_id_o = '0;
    assign probe_fault_number_o = '0;
    assign probe_idle_o = '0;
  end
endmodule
