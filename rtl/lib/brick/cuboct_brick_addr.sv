// SPDX-License-Identifier: MIT
// cell * Factor + slot, by adders: no multiplier is spent on an address. Combinational.
module cuboct_brick_addr #(
  parameter int Factor   = 16,  // >= 1
  parameter int CellBits = 3,   // of cell_i
  parameter int SlotBits = 4,   // of slot_i
  parameter int AddrBits = 7    // >= both
) (
  input  logic [CellBits-1:0] cell_i,  // at most (2^AddrBits - 1) / Factor
  input  logic [SlotBits-1:0] slot_i,  // added
  output logic [AddrBits-1:0] addr_o   // modulo 2^AddrBits
);
  logic [AddrBits+CellBits-1:0] wide;
  logic [AddrBits+SlotBits-1:0] sum;
  localparam logic [31:0] Ones = Factor;
  assign wide = {{AddrBits{1'b0}}, cell_i};
  integer k;
  always_comb begin
    sum = {{AddrBits{1'b0}}, slot_i};
    for (k = 0; k < AddrBits && k < 32; k = k + 1) begin
      if (Ones[k]) sum[AddrBits-1:0] = sum[AddrBits-1:0] + (wide[AddrBits-1:0] << k);
    end
  end
  assign addr_o = sum[AddrBits-1:0];
  logic unused_high;
  assign unused_high = ^{wide, sum};
endmodule
