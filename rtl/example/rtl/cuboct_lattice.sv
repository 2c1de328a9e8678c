// SPDX-License-Identifier: MIT
// Made by cuboct emit from plan 5290aa12107ad825; do not edit.
// All nodes and their links. Node n's part of a vector over nodes has n times the part's width below it.
// load_valid_i appends load_data_i to node load_node_i; start_i starts all nodes.
module cuboct_lattice #(
  localparam int Nodes = 2
) (
  input  logic                                      clk_i,
  input  logic                                      rst_ni,
  input  logic                                      start_i,
  input  logic [31:0]                               steps_i,
  input  logic                                      load_valid_i,
  input  logic [31:0]                               load_node_i,
  input  logic [cuboct_pkg::ParticleBits-1:0]       load_data_i,
  output logic [Nodes*8-1:0]                        phase_start_o,
  output logic [Nodes*8-1:0]                        phase_end_o,
  output logic [Nodes-1:0]                          observe_valid_o,
  output logic [Nodes*cuboct_pkg::ParticleBits-1:0] observe_data_o,
  output logic [Nodes-1:0]                          fault_valid_o,
  output logic [Nodes*4-1:0]                        fault_code_o,
  output logic [Nodes*cuboct_pkg::IdBits-1:0]       fault_id_o,
  output logic [Nodes*64-1:0]                       fault_number_o,
  output logic [Nodes-1:0]                          idle_o
);
  localparam int LinkBits = cuboct_pkg::LinkBits;

  logic [5:0] valid_0, end_0, ready_0;
  logic [6*LinkBits-1:0] data_0;
  logic [5:0] valid_1, end_1, ready_1;
  logic [6*LinkBits-1:0] data_1;
  logic [3:0] event_0, event_1;
  logic unused_events;
  assign unused_events = ^{event_0, event_1};

  // Cell (0, 0, 0).
  cuboct_node u_node_0 (
    .clk_i,
    .rst_ni,
    .start_i,
    .steps_i,
    .has_link_i(6'b000010),
    .load_valid_i(load_valid_i && load_node_i == 32'd0),
    .load_data_i,
    .link_valid_o(valid_0),
    .link_end_o(end_0),
    .link_data_o(data_0),
    .link_ready_i({1'b0, 1'b0, 1'b0, 1'b0, ready_1[0], 1'b0}),
    .link_valid_i({1'b0, 1'b0, 1'b0, 1'b0, valid_1[0], 1'b0}),
    .link_end_i({1'b0, 1'b0, 1'b0, 1'b0, end_1[0], 1'b0}),
    .link_data_i({{LinkBits{1'b0}}, {LinkBits{1'b0}}, {LinkBits{1'b0}}, {LinkBits{1'b0}}, data_1[0*LinkBits +: LinkBits], {LinkBits{1'b0}}}),
    .link_ready_o(ready_0),
    .phase_start_o(phase_start_o[0*8 +: 8]),
    .phase_end_o(phase_end_o[0*8 +: 8]),
    .force_event_o(event_0),
    .observe_valid_o(observe_valid_o[0]),
    .observe_data_o(observe_data_o[0*cuboct_pkg::ParticleBits +: cuboct_pkg::ParticleBits]),
    .fault_valid_o(fault_valid_o[0]),
    .fault_code_o(fault_code_o[0*4 +: 4]),
    .fault_id_o(fault_id_o[0*cuboct_pkg::IdBits +: cuboct_pkg::IdBits]),
    .fault_number_o(fault_number_o[0*64 +: 64]),
    .idle_o(idle_o[0])
  );

  // Cell (1, 0, 0).
  cuboct_node u_node_1 (
    .clk_i,
    .rst_ni,
    .start_i,
    .steps_i,
    .has_link_i(6'b000001),
    .load_valid_i(load_valid_i && load_node_i == 32'd1),
    .load_data_i,
    .link_valid_o(valid_1),
    .link_end_o(end_1),
    .link_data_o(data_1),
    .link_ready_i({1'b0, 1'b0, 1'b0, 1'b0, 1'b0, ready_0[1]}),
    .link_valid_i({1'b0, 1'b0, 1'b0, 1'b0, 1'b0, valid_0[1]}),
    .link_end_i({1'b0, 1'b0, 1'b0, 1'b0, 1'b0, end_0[1]}),
    .link_data_i({{LinkBits{1'b0}}, {LinkBits{1'b0}}, {LinkBits{1'b0}}, {LinkBits{1'b0}}, {LinkBits{1'b0}}, data_0[1*LinkBits +: LinkBits]}),
    .link_ready_o(ready_1),
    .phase_start_o(phase_start_o[1*8 +: 8]),
    .phase_end_o(phase_end_o[1*8 +: 8]),
    .force_event_o(event_1),
    .observe_valid_o(observe_valid_o[1]),
    .observe_data_o(observe_data_o[1*cuboct_pkg::ParticleBits +: cuboct_pkg::ParticleBits]),
    .fault_valid_o(fault_valid_o[1]),
    .fault_code_o(fault_code_o[1*4 +: 4]),
    .fault_id_o(fault_id_o[1*cuboct_pkg::IdBits +: cuboct_pkg::IdBits]),
    .fault_number_o(fault_number_o[1*64 +: 64]),
    .idle_o(idle_o[1])
  );

  logic unused_faces;
  assign unused_faces = ^{
    valid_0[5], end_0[5], ready_0[5], ^data_0[5*LinkBits +: LinkBits],
    valid_0[4], end_0[4], ready_0[4], ^data_0[4*LinkBits +: LinkBits],
    valid_0[3], end_0[3], ready_0[3], ^data_0[3*LinkBits +: LinkBits],
    valid_0[2], end_0[2], ready_0[2], ^data_0[2*LinkBits +: LinkBits],
    valid_0[0], end_0[0], ready_0[0], ^data_0[0*LinkBits +: LinkBits],
    valid_1[5], end_1[5], ready_1[5], ^data_1[5*LinkBits +: LinkBits],
    valid_1[4], end_1[4], ready_1[4], ^data_1[4*LinkBits +: LinkBits],
    valid_1[3], end_1[3], ready_1[3], ^data_1[3*LinkBits +: LinkBits],
    valid_1[2], end_1[2], ready_1[2], ^data_1[2*LinkBits +: LinkBits],
    valid_1[1], end_1[1], ready_1[1], ^data_1[1*LinkBits +: LinkBits]
  };
endmodule
