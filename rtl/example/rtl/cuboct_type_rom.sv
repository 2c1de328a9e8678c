// SPDX-License-Identifier: MIT
// Made by cuboct emit from plan 5290aa12107ad825; do not edit.
// What sets the types apart, axis 0 in the least significant place: imposed axes, velocity (imposed, or of the
// anchor), gravity, whether held by force, gains, weight of the sum. Combinational.
module cuboct_type_rom (
  input  logic [0:0] velocity_i,  // by type that is moved from outside
  input  logic [0:0] type_i,
  output logic [2:0] imposed_o,
  output logic [86:0] velocity_o,
  output logic [86:0] gravity_o,
  output logic pd_o,
  output logic [17:0] kp_o,
  output logic [17:0] kd_o,
  output logic [17:0] weight_o
);
  logic unused_velocity;
  assign unused_velocity = velocity_i;
  logic unused_type;
  assign unused_type = ^type_i;
  assign imposed_o  = 3'b000;
  assign velocity_o = {29'h0, 29'h0, 29'h0};
  assign gravity_o  = {29'h0, 29'h0, 29'h0};
  assign pd_o       = 1'b0;
  assign kp_o       = 18'h0;
  assign kd_o       = 18'h0;
  assign weight_o   = 18'h10000;
endmodule
