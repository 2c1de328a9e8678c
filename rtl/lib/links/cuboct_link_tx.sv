// SPDX-License-Identifier: MIT
// The output register of one link. It may load when it is empty or its beat is taken in this cycle; where there is no
// link it is always empty: what is loaded vanishes.
module cuboct_link_tx #(
  parameter int LinkBits = 32  // payload of a beat, >= 1
) (
  input  logic                clk_i,
  input  logic                rst_ni,
  input  logic                has_link_i,  // constant
  // From the senders; load_i only in a cycle with can_load_o.
  input  logic                load_i,      // loads a beat
  input  logic                end_i,       // an end beat
  input  logic [LinkBits-1:0] data_i,      // payload, 0 of an end beat
  output logic                can_load_o,  // depends on ready_i
  // To the neighbour.
  output logic                valid_o,     // a beat waits
  output logic                end_o,       // an end beat
  output logic [LinkBits-1:0] data_o,      // payload; stays until ready_i
  input  logic                ready_i      // it is taken in this cycle
);
  logic                valid_d, valid_q, take, end_q;
  logic [LinkBits-1:0] data_q;

  assign can_load_o = !valid_q || ready_i;
  assign take       = load_i && has_link_i;
  assign valid_d    = take || (valid_q && !ready_i);

  always_ff @(posedge clk_i) begin
    if (!rst_ni) valid_q <= 1'b0;
    else valid_q <= valid_d;
  end
  always_ff @(posedge clk_i) begin
    if (load_i) begin
      end_q  <= end_i;
      data_q <= data_i;
    end
  end

  assign valid_o = valid_q;
  assign end_o   = end_q;
  assign data_o  = data_q;
endmodule
