// SPDX-License-Identifier: MIT
// Made by cuboct emit from plan 5290aa12107ad825; do not edit.
// The ports of cuboct_node and nothing behind them, for the lint of the lattice: the node is linted once.
module cuboct_node (
  input  logic                                clk_i,
  input  logic                                rst_ni,
  input  logic                                start_i,
  input  logic [31:0]                         steps_i,
  input  logic [5:0]                          has_link_i,
  input  logic                                load_valid_i,
  input  logic [cuboct_pkg::ParticleBits-1:0] load_data_i,
  output logic [5:0]                          link_valid_o,
  output logic [5:0]                          link_end_o,
  output logic [6*cuboct_pkg::LinkBits-1:0]   link_data_o,
  input  logic [5:0]                          link_ready_i,
  input  logic [5:0]                          link_valid_i,
  input  logic [5:0]                          link_end_i,
  input  logic [6*cuboct_pkg::LinkBits-1:0]   link_data_i,
  output logic [5:0]                          link_ready_o,
  output logic [7:0]                          phase_start_o,
  output logic [7:0]                          phase_end_o,
  output logic [4:0]                          force_event_o,
  output logic                                observe_valid_o,
  output logic [cuboct_pkg::ParticleBits-1:0] observe_data_o,
  output logic                                fault_valid_o,
  output logic [3:0]                          fault_code_o,
  output logic [cuboct_pkg::IdBits-1:0]       fault_id_o,
  output logic [63:0]                         fault_number_o,
  output logic                                idle_o
);
  logic unused_inputs;
  assign unused_inputs = ^{clk_i, rst_ni, start_i, steps_i, has_link_i, load_valid_i, load_data_i, link_ready_i, link_valid_i, link_end_i, link_data_i};
  assign link_valid_o = '0;
  assign link_end_o = '0;
  assign link_data_o = '0;
  assign link_ready_o = '0;
  assign phase_start_o = '0;
  assign phase_end_o = '0;
  assign force_event_o = '0;
  assign observe_valid_o = '0;
  assign observe_data_o = '0;
  assign fault_valid_o = '0;
  assign fault_code_o = '0;
  assign fault_id_o = '0;
  assign fault_number_o = '0;
  assign idle_o = '0;
endmodule
