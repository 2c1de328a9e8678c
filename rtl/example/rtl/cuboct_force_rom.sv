// SPDX-License-Identifier: MIT
// Made by cuboct emit from plan 9b84c320cd1649dc; do not edit.
// 16 entries of {c1, c0}, 22 bits each. Synchronous read.
module cuboct_force_rom (
  input  logic                clk_i,
  input  logic [3:0] index_i,
  output logic signed [21:0] c0_o,
  output logic signed [21:0] c1_o,
  output logic signed [21:0] c2_o
);
  (* rom_style = "block", ram_style = "block" *) logic [43:0] mem [0:15];
  logic [43:0] data_q;
  always_ff @(posedge clk_i) data_q <= mem[index_i];
  assign c0_o = data_q[21:0];
  assign c1_o = data_q[43:22];
  assign c2_o = '0;
  initial begin
    mem[0] = {22'h0, 22'h12c27d};
    mem[1] = {22'h37d232, 22'h12c27d};
    mem[2] = {22'h38ee7b, 22'ha94af};
    mem[3] = {22'h3dc0d6, 22'h3832a};
    mem[4] = {22'h3f22d5, 22'h14400};
    mem[5] = {22'h3fa58a, 22'h66d5};
    mem[6] = {22'h3fdcae, 22'hc5f};
    mem[7] = {22'h3ff582, 22'h3fe90d};
    mem[8] = {22'hc6, 22'h3fde8f};
    mem[9] = {22'h587, 22'h3fdf55};
    mem[10] = {22'h6ff, 22'h3fe4dc};
    mem[11] = {22'h6c9, 22'h3febdb};
    mem[12] = {22'h5b8, 22'h3ff2a4};
    mem[13] = {22'h43a, 22'h3ff85c};
    mem[14] = {22'h290, 22'h3ffc96};
    mem[15] = {22'hda, 22'h3fff26};
  end
endmodule
