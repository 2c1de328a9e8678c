// SPDX-License-Identifier: MIT
// For proofs of the control of cuboct_rule_core: what is generated of a rule gives any value in any cycle. The ports
// are as wide as the widest node's that is proven; narrower signals take their low bits.
module cuboct_rule_candidate (
  input  logic [15:0] own_i,
  output logic [31:0] candidate_o
);
  (* anyseq *) logic [31:0] any;
  assign candidate_o = any;
  logic unused_own;
  assign unused_own = ^own_i;
endmodule

module cuboct_rule_datapath (
  input  logic        clk_i,
  input  logic        rst_ni,
  input  logic [2:0]  round_i,
  input  logic        issue_i,
  input  logic [1:0]  issue_slot_i,
  input  logic [31:0] candidate_i,
  input  logic [15:0] own_i,
  output logic        busy_o,
  output logic [1:0]  kick_slot_o,
  input  logic        kick_id_i,
  input  logic [1:0]  look_slot_i,
  input  logic        take_i,
  input  logic [1:0]  take_slot_i,
  input  logic [15:0] slot_i,
  output logic        written_o,
  output logic [1:0]  slot_number_o,
  output logic [15:0] slot_o,
  output logic [1:0]  leaving_o,
  input  logic        step_end_i,
  input  logic        move_fault_i,
  input  logic [1:0]  move_axis_i,
  input  logic        move_full_i,
  input  logic        move_id_i,
  output logic        fault_o,
  output logic [7:0]  fault_code_o,
  output logic        fault_id_o,
  output logic [63:0] fault_number_o
);
  (* anyseq *) logic        busy, written, fault, id;
  (* anyseq *) logic [1:0]  kick_slot, number, leaving;
  (* anyseq *) logic [15:0] slot;
  (* anyseq *) logic [7:0]  code;
  (* anyseq *) logic [63:0] fault_number;
  assign busy_o         = busy;
  assign kick_slot_o    = kick_slot;
  assign written_o      = written;
  assign slot_number_o  = number;
  assign slot_o         = slot;
  assign leaving_o      = leaving;
  assign fault_o        = fault;
  assign fault_code_o   = code;
  assign fault_id_o     = id;
  assign fault_number_o = fault_number;
  logic unused_inputs;
  assign unused_inputs = ^{clk_i, rst_ni, round_i, issue_i, issue_slot_i, candidate_i, own_i, kick_id_i, look_slot_i,
                           take_i, take_slot_i, slot_i, step_end_i, move_fault_i, move_axis_i, move_full_i, move_id_i};
endmodule
