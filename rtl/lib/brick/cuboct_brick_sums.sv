// SPDX-License-Identifier: MIT
// The summed kicks of a brick's particles, of one pipe, in a memory whose word is asked for a cycle ahead; a sum that
// was written in the cycle before is handed on. Exact: a sum holds every kick that a node can see. A kick accepted in
// cycle t counts from t+1 on. A slot's sum is set to zero as its particle comes, and as it is taken.
module cuboct_brick_sums #(
  parameter int Axes     = 3,   // 2 or 3
  parameter int KickBits = 18,  // of one axis of a kick
  parameter int SumBits  = 28,  // of one axis of a sum, >= KickBits + clog2(3^Axes * capacity)
  parameter int Depth    = 128, // slots
  parameter int AddrBits = 7    // >= clog2(Depth)
) (
  input  logic                     clk_i,
  input  logic                     kick_valid_i, // a kick is added to the sum that the cycle before asked for
  input  logic [Axes*KickBits-1:0] push_i,       // minus the kick
  input  logic                     zero_i,       // never in a cycle with a kick
  input  logic [AddrBits-1:0]      zero_addr_i,  // with zero_i
  input  logic                     busy_i,       // the pipe holds a kick; in every cycle with one
  input  logic [AddrBits-1:0]      kick_addr_i,  // of the next cycle's kick
  input  logic [AddrBits-1:0]      look_addr_i,  // without busy_i: of what is to be seen in the next cycle
  output logic [Axes*SumBits-1:0]  sum_o         // of the slot that the cycle before asked for
);
  logic [Axes*SumBits-1:0] word, old, added, written_q;
  logic                    same_q, write;
  logic [AddrBits-1:0]     addr_q, next_addr, write_addr;
  for (genvar a = 0; a < Axes; a++) begin : gen_axis
    logic signed [SumBits-1:0] push;
    cuboct_resize #(.InBits(KickBits), .OutBits(SumBits)) u_push (
      .a_i($signed(push_i[a*KickBits +: KickBits])), .y_o(push)
    );
    assign added[a*SumBits +: SumBits] = old[a*SumBits +: SumBits] - push;
  end
  assign next_addr  = busy_i ? kick_addr_i : look_addr_i;
  assign write      = kick_valid_i || zero_i;
  assign write_addr = zero_i ? zero_addr_i : addr_q;
  always_ff @(posedge clk_i) begin
    addr_q <= next_addr;
    same_q <= kick_valid_i && (addr_q == kick_addr_i);
    if (kick_valid_i) written_q <= added;
  end
  cuboct_ram #(.Bits(Axes * SumBits), .Depth(Depth), .AddrBits(AddrBits)) u_words (
    .clk_i, .write_i(write), .write_addr_i(write_addr), .write_data_i(zero_i ? '0 : added), .read_i(1'b1),
    .clear_i(1'b0), .read_addr_i(next_addr), .read_data_o(word)
  );
  assign old   = same_q ? written_q : word;
  assign sum_o = old;
endmodule
