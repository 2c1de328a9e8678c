// SPDX-License-Identifier: MIT
// The velocities of held and moved types, one register per type and axis: axis 0 of type 0 in the least
// significant place.
module cuboct_velocities #(
  parameter int Types = 1,                            // >= 1
  parameter int Axes  = 3,                            // 2 or 3
  parameter int Bits  = 29,                           // of a velocity
  parameter logic [Types*Axes*Bits-1:0] Initial = '0  // after reset_i
) (
  input  logic                       clk_i,
  input  logic                       reset_i,  // to Initial
  input  logic                       valid_i,  // one is set
  input  logic [7:0]                 type_i,   // below Types
  input  logic [7:0]                 axis_i,   // below Axes
  input  logic [Bits-1:0]            data_i,   // its value
  output logic [Types*Axes*Bits-1:0] velocity_o  // all of them
);
  for (genvar t = 0; t < Types; t++) begin : gen_type
    localparam int Type = t;
    for (genvar a = 0; a < Axes; a++) begin : gen_axis
      localparam int Axis = a;
      localparam int At   = (t * Axes + a) * Bits;
      logic [Bits-1:0] velocity_d, velocity_q;
      always_comb begin
        velocity_d = velocity_q;
        if (valid_i && type_i == Type[7:0] && axis_i == Axis[7:0]) velocity_d = data_i;
        if (reset_i) velocity_d = Initial[At +: Bits];
      end
      always_ff @(posedge clk_i) velocity_q <= velocity_d;
      assign velocity_o[At +: Bits] = velocity_q;
    end
  end
endmodule
