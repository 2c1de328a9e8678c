// SPDX-License-Identifier: MIT
// cuboct_update: where a particle is written back, x with its residue is what it was, plus the velocity that is
// written, exactly, in the node that away says. Whatever the velocity is: sums, constants and products are any values.
module cuboct_type_rom (
  input  logic       velocity_i,
  input  logic [0:0] type_i,
  output logic [1:0] imposed_o,
  output logic [5:0] velocity_o,
  output logic [5:0] gravity_o,
  output logic       pd_o,
  output logic [2:0] kp_o,
  output logic [2:0] kd_o,
  output logic [2:0] weight_o
);
  logic unused_inputs;
  assign unused_inputs = ^{velocity_i, type_i};
endmodule

module drift_formal #(
  parameter int PositionFrac = 3,
  parameter int Guard        = 2,
  parameter int VelocityBits = 6,
  parameter int Weighted     = 0,
  parameter int Pd           = 0,
  parameter int Held         = 0
) (
  input logic                      clk_i,
  input logic                      valid_i,
  input logic [2*PositionFrac-1:0] x_i,
  input logic [2*Guard-1:0]        residue_i,
  input logic [2*VelocityBits-1:0] v_i,
  input logic [11:0]               sum_i,
  input logic [11:0]               u_i
);
  localparam int Latency = (Pd != 0) ? 5 : (Weighted != 0) ? 4 : 2;  // cycles from valid_i to valid_o
  localparam int Bits    = PositionFrac + Guard + 2;

  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;

  logic                      valid;
  logic [2*PositionFrac-1:0] x;
  logic [2*Guard-1:0]        residue;
  logic [2*VelocityBits-1:0] v;
  logic [3:0]                away;
  logic [11:0]               unused_u;
  logic [1:0]                unused_slot, unused_id, unused_fault_id;
  logic                      unused_type, unused_fault;
  logic [3:0]                unused_code;
  logic signed [63:0]        unused_number;
  cuboct_update #(
    .Axes(2), .PositionFrac(PositionFrac), .Guard(Guard), .VelocityBits(VelocityBits), .TotalBits(6), .SumBits(5),
    .TypeBits(1), .Weighted(Weighted), .WeightBits(3), .WeightFrac(1), .Pd(Pd), .Held(Held), .DisplacementBits(6),
    .GainBits(3), .GainFrac(2), .ConstantBits(3), .SlotBits(2), .IdBits(2)
  ) u_dut (
    .clk_i, .rst_ni(running_q), .velocity_i(1'b0), .valid_i, .slot_i(2'd0), .sum_i, .x_i, .residue_i, .v_i,
    .type_i(1'b0), .id_i(2'd0), .u_i,
    .valid_o(valid), .slot_o(unused_slot), .x_o(x), .residue_o(residue), .away_o(away), .v_o(v), .type_o(unused_type),
    .id_o(unused_id), .u_o(unused_u), .fault_o(unused_fault), .fault_code_o(unused_code), .fault_id_o(unused_fault_id),
    .fault_number_o(unused_number)
  );

  // What was there of the particle whose turn it is. With Held it stays, and no other comes before it is written.
  localparam int WordBits = 2 * (PositionFrac + Guard);
  logic [Latency:1]          under_way_q;
  logic [Latency*WordBits-1:0] past_q;  // the newest lowest
  logic [WordBits-1:0]       word, before;
  assign word   = {residue_i, x_i};
  assign before = past_q[Latency*WordBits-1 -: WordBits];
  always_comb begin
    if (Held != 0 && under_way_q != '0) assume (!valid_i && word == past_q[WordBits-1:0]);
  end
  always_ff @(posedge clk_i) begin
    under_way_q <= running_q ? {under_way_q[Latency-1:1], valid_i} : '0;
    past_q      <= {past_q[(Latency-1)*WordBits-1:0], word};
  end

  logic [1:0] right, falls, rises, leaves;
  for (genvar a = 0; a < 2; a++) begin : gen_axis
    logic signed [Bits-1:0] from, by, to;
    assign from = {2'b00, before[a*PositionFrac +: PositionFrac], before[2*PositionFrac+a*Guard +: Guard]};
    assign by   = {{(Bits - VelocityBits) {v[(a+1)*VelocityBits-1]}}, v[a*VelocityBits +: VelocityBits]};
    assign to   = {away[2*a +: 2], x[a*PositionFrac +: PositionFrac], residue[a*Guard +: Guard]};
    assign right[a]  = (to == from + by);
    // By less than a unit of x, and x changes.
    assign falls[a]  = (by < 0) && (by > -(1 << Guard)) && (to >>> Guard) != (from >>> Guard);
    assign rises[a]  = (by > 0) && (by < (1 << Guard)) && (to >>> Guard) != (from >>> Guard);
    assign leaves[a] = (away[2*a +: 2] != 2'b00);
  end
  always_ff @(posedge clk_i) begin
    if (running_q) begin
      a_turn: assert (valid == under_way_q[Latency]);
      if (valid) begin
        a_drift: assert (right == '1);
      end
      c_falls:  cover (valid && falls == 2'b11);
      c_rises:  cover (valid && rises == 2'b01 && falls == 2'b10);
      c_leaves: cover (valid && leaves == 2'b11 && away[1] != away[3]);
    end
  end
endmodule
