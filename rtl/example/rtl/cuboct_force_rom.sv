// SPDX-License-Identifier: MIT
// Made by cuboct emit from plan 5290aa12107ad825; do not edit.
// 16 entries of {c1, c0}, 21 bits each. Synchronous read.
module cuboct_force_rom (
  input  logic                clk_i,
  input  logic [3:0] index_i,
  output logic signed [20:0] c0_o,
  output logic signed [20:0] c1_o,
  output logic signed [20:0] c2_o
);
  (* rom_style = "block", ram_style = "block" *) logic [41:0] mem [0:15];
  logic [41:0] data_q;
  always_ff @(posedge clk_i) data_q <= mem[index_i];
  assign c0_o = data_q[20:0];
  assign c1_o = data_q[41:21];
  assign c2_o = '0;
  initial begin
    mem[0] = {21'h0, 21'h9613f};
    mem[1] = {21'h1be918, 21'h9613f};
    mem[2] = {21'h1c773e, 21'h54a57};
    mem[3] = {21'h1ee06b, 21'h1c195};
    mem[4] = {21'h1f916a, 21'ha200};
    mem[5] = {21'h1fd2c6, 21'h336a};
    mem[6] = {21'h1fee57, 21'h630};
    mem[7] = {21'h1ffac0, 21'h1ff487};
    mem[8] = {21'h64, 21'h1fef47};
    mem[9] = {21'h2c3, 21'h1fefab};
    mem[10] = {21'h37f, 21'h1ff26e};
    mem[11] = {21'h365, 21'h1ff5ed};
    mem[12] = {21'h2dc, 21'h1ff952};
    mem[13] = {21'h21d, 21'h1ffc2e};
    mem[14] = {21'h148, 21'h1ffe4b};
    mem[15] = {21'h6d, 21'h1fff93};
  end
endmodule
