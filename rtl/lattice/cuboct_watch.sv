// SPDX-License-Identifier: MIT
// What a host learns of a node: that it is busy, its first fault since the reset, and its particles. Fault and
// particles are shown of the node that the host observes; of the others they are zeros, so that an or over all nodes
// leaves that one's.
module cuboct_watch #(
  parameter int ParticleBits = 154,  // of a particle, with its cell in the node
  parameter int FaultBits    = 76,   // of a fault: code, id, cell, number
  parameter int Delay        = 1     // 1: outputs come a cycle later, from registers; 0: at once
) (
  input  logic                              clk_i,
  input  logic                              rst_ni,
  input  logic                              observed_i,       // the host observes this node
  input  logic                              idle_i,           // the node is in IDLE
  input  logic                              observe_valid_i,  // it shows a particle
  input  logic [ParticleBits-1:0]           observe_data_i,   // with observe_valid_i
  input  logic                              fault_valid_i,    // it tells a fault
  input  logic [FaultBits-1:0]              fault_i,          // with fault_valid_i
  output logic [3:0]                        flags_o,          // {busy, had a fault, that is shown, a particle is shown}
  output logic [FaultBits+ParticleBits-1:0] data_o            // {first fault, particle}: each counts with its flag
);
  logic                 faulty_d, faulty_q;
  logic [FaultBits-1:0] fault_d, fault_q;
  logic                 tells, shows;
  assign faulty_d = faulty_q || fault_valid_i;
  assign fault_d  = faulty_q ? fault_q : fault_i;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) faulty_q <= 1'b0;
    else faulty_q <= faulty_d;
  end
  always_ff @(posedge clk_i) fault_q <= fault_d;
  assign tells   = observed_i && faulty_q;
  assign shows   = observed_i && observe_valid_i;
  logic [3:0]                        flags;
  logic [FaultBits+ParticleBits-1:0] data;
  assign flags = {!idle_i, faulty_q, tells, shows};
  // By what is there early in the cycle alone: the valid of a particle is late.
  assign data  = {fault_q, observe_data_i} & {(FaultBits + ParticleBits){observed_i}};
  // A particle is late in the node's cycle: without a register here the path would go on into cuboct_gather.
  if (Delay == 0) begin : gen_at_once
    assign flags_o = flags;
    assign data_o  = data;
  end else begin : gen_later
    cuboct_stage #(.Flags(4), .Bits(FaultBits + ParticleBits)) u_stage (
      .clk_i, .rst_ni, .flags_i(flags), .data_i(data), .flags_o, .data_o
    );
  end
endmodule
