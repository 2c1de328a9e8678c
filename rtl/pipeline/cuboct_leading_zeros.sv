// SPDX-License-Identifier: MIT
// Number of zeros above the leading one. Combinational: a tree of pairs, each level of which is a LUT deep, as a
// pair's number is that of its upper half, or of its lower half and as many more as the upper half has bits.
module cuboct_leading_zeros #(
  parameter int CountBits = 3,  // of the result, >= 1
  localparam int Bits     = 1 << CountBits
) (
  input  logic [Bits-1:0]      a_i,     // any value
  output logic [CountBits-1:0] zeros_o  // all ones if a_i is 0
);
  for (genvar l = 1; l <= CountBits; l++) begin : gen_level
    localparam int Groups = Bits >> l;
    logic [Groups-1:0]   some;   // by group of 2^l bits: one of them is set
    logic [Groups*l-1:0] zeros;  // l bits for each group
    if (l == 1) begin : gen_pairs
      for (genvar g = 0; g < Groups; g++) begin : gen_pair
        assign some[g]  = a_i[2*g+1] || a_i[2*g];
        assign zeros[g] = !a_i[2*g+1];
      end
    end else begin : gen_groups
      for (genvar g = 0; g < Groups; g++) begin : gen_group
        assign some[g] = gen_level[l-1].some[2*g+1] || gen_level[l-1].some[2*g];
        assign zeros[g*l +: l] = gen_level[l-1].some[2*g+1]
                               ? {1'b0, gen_level[l-1].zeros[(2*g+1)*(l-1) +: l-1]}
                               : {1'b1, gen_level[l-1].zeros[2*g*(l-1) +: l-1]};
      end
    end
  end
  assign zeros_o = gen_level[CountBits].zeros;
  logic unused_some;
  assign unused_some = gen_level[CountBits].some;
endmodule
