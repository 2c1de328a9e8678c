// SPDX-License-Identifier: MIT
// Signed product with an output register. A module of its own, kept in the hierarchy: synthesis tools that fold the
// adder behind a product into a DSP block get it wrong otherwise. With Cycles = 1 a multiplier of latency 1; with 2
// there are registers before it too, of its own, so that they lie beside it. With more a bit of b_i per cycle is added
// up, of logic alone: the product is there Cycles cycles after en_i, a_i stays until then, and the next en_i comes no
// sooner.
(* keep_hierarchy *)
module cuboct_mult #(
  parameter int ABits  = 18,  // >= 1
  parameter int BBits  = 18,  // >= 1; >= 2 if Cycles > 2
  parameter int Cycles = 1    // 1, 2, or > BBits
) (
  input  logic                          clk_i,
  input  logic                          rst_ni,  // used if Cycles > 2
  input  logic                          en_i,    // p_o keeps its value in a cycle without
  input  logic signed [ABits-1:0]       a_i,     // stays while a serial product is made
  input  logic signed [BBits-1:0]       b_i,     // with en_i
  output logic signed [ABits+BBits-1:0] p_o      // the product
);
  if (Cycles == 1) begin : gen_parallel
    logic signed [ABits+BBits-1:0] p_d, p_q;
    assign p_d = a_i * b_i;
    always_ff @(posedge clk_i) begin
      if (en_i) p_q <= p_d;
    end
    assign p_o = p_q;
    logic unused_reset;
    assign unused_reset = rst_ni;
  end else if (Cycles == 2) begin : gen_registered
    logic                          en_q;
    logic signed [ABits-1:0]       a_q;
    logic signed [BBits-1:0]       b_q;
    logic signed [ABits+BBits-1:0] p_d, p_q;
    assign p_d = a_q * b_q;
    always_ff @(posedge clk_i) begin
      en_q <= en_i;
      if (en_i) begin
        a_q <= a_i;
        b_q <= b_i;
      end
      if (en_q) p_q <= p_d;
    end
    assign p_o = p_q;
    logic unused_reset;
    assign unused_reset = rst_ni;
  end else begin : gen_serial
    // The lower part holds what is left of b, and takes the product's bits in its place. b's sign counts -2^(BBits-1).
    localparam int CountBits = $clog2(BBits + 1);
    localparam int Most      = BBits;
    logic [CountBits-1:0] left_d, left_q;  // bits to add
    logic [ABits-1:0]     high_d, high_q;
    logic [BBits-1:0]     low_d, low_q;
    logic signed [ABits:0] sum, term;
    logic                 last, running;
    assign last    = (left_q == {{(CountBits - 1) {1'b0}}, 1'b1});
    assign running = (left_q != '0);
    assign term    = $signed({a_i[ABits-1], a_i} & {(ABits + 1) {low_q[0]}});
    assign sum     = $signed({high_q[ABits-1], high_q}) + (term ^ $signed({(ABits + 1) {last}}))
                   + $signed({{ABits {1'b0}}, last});
    always_comb begin
      left_d = left_q;
      high_d = high_q;
      low_d  = low_q;
      if (en_i) begin
        left_d = Most[CountBits-1:0];
        high_d = '0;
        low_d  = b_i;
      end else if (running) begin
        left_d = left_q - 1'b1;
        high_d = sum[ABits:1];
        low_d  = {sum[0], low_q[BBits-1:1]};
      end
    end
    always_ff @(posedge clk_i) begin
      if (!rst_ni) left_q <= '0;
      else left_q <= left_d;
    end
    always_ff @(posedge clk_i) begin
      high_q <= high_d;
      low_q  <= low_d;
    end
    assign p_o = $signed({high_q, low_q});
  end
endmodule
