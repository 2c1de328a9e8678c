// SPDX-License-Identifier: MIT
// cuboct_least_fault: what is shown is the least of all faults since the clear, by code, id and signed
// number.
module least_fault_formal #(
  parameter int Sources = 2,
  parameter int IdBits  = 3,
  parameter int NumberBits = 64,
  parameter int Late = 0
) (
  input logic                      clk_i,
  input logic                      clear_i,
  input logic [Sources-1:0]        valid_i,
  input logic [Sources*4-1:0]      code_i,
  input logic [Sources*IdBits-1:0] id_i,
  input logic [Sources*64-1:0]     number_i
);
  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;
  always_comb begin
    if (clear_i || !running_q) assume (valid_i == '0);
  end
  // Every number fits NumberBits.
  integer n, m;
  always_comb begin
    for (n = 0; n < Sources; n = n + 1) begin
      for (m = NumberBits; m < 64; m = m + 1) assume (number_i[n*64+m] == number_i[n*64+63]);
      assume (number_i[n*64+NumberBits-1] == number_i[n*64+63]);
    end
  end

  logic               valid;
  logic [3:0]         code;
  logic [IdBits-1:0]  id;
  logic signed [63:0] number;
  cuboct_least_fault #(.Sources(Sources), .IdBits(IdBits), .NumberBits(NumberBits), .Late(Late)) u_dut (
    .clk_i, .rst_ni(running_q), .clear_i, .valid_i, .code_i, .id_i, .number_i,
    .valid_o(valid), .code_o(code), .id_o(id), .number_o(number)
  );

  logic               some_d, some_q, less;
  logic [3:0]         code_d, code_q, new_code;
  logic [IdBits-1:0]  id_d, id_q, new_id;
  logic signed [63:0] number_d, number_q, new_number;
  integer             s;
  always_comb begin
    some_d     = some_q;
    code_d     = code_q;
    id_d       = id_q;
    number_d   = number_q;
    less       = 1'b0;
    new_code   = '0;
    new_id     = '0;
    new_number = '0;
    for (s = 0; s < Sources; s = s + 1) begin
      new_code   = code_i[s*4 +: 4];
      new_id     = id_i[s*IdBits +: IdBits];
      new_number = $signed(number_i[s*64 +: 64]);
      less       = (new_code < code_d)
                || (new_code == code_d && (new_id < id_d || (new_id == id_d && new_number < number_d)));
      if (valid_i[s] && (!some_d || less)) begin
        code_d   = new_code;
        id_d     = new_id;
        number_d = new_number;
      end
      some_d = some_d || valid_i[s];
    end
    if (clear_i) some_d = 1'b0;
  end
  always_ff @(posedge clk_i) begin
    some_q   <= running_q && some_d;
    code_q   <= code_d;
    id_q     <= id_d;
    number_q <= number_d;
  end

  logic cleared_q;  // a fault was shown before the clear
  always_ff @(posedge clk_i) cleared_q <= running_q && (cleared_q || (clear_i && valid));
  always_ff @(posedge clk_i) begin
    if (running_q) begin
      a_valid: assert (valid == some_q);
      if (some_q) a_least: assert (code == code_q && id == id_q && number == number_q);
      if (!some_q) a_none: assert (code == '0 && id == '0 && number == '0);
      c_negative: cover (cleared_q && valid && number < 64'sd0);
      c_all:      cover (valid_i == '1 && valid);
    end
  end
endmodule
