// SPDX-License-Identifier: MIT
// Between the wire and a node's receiver: a beat goes on only if its check is right and its sequence number is the next
// one. Any other is dropped and told; with Retry the sender sends it again, without it the link is closed. The number
// that is expected goes back in every cycle. docs/reference/links.md.
module cuboct_link_take #(
  parameter int          LinkBits       = 66,            // payload, >= 1
  parameter int          SequenceBits   = 4,
  parameter int          Retry          = 1,             // 0, 1
  parameter int          CrcBits        = 16,
  parameter logic [31:0] CrcPolynomial  = 32'h00003d65,
  parameter logic [31:0] CrcStart       = 32'h0000ffff,
  parameter int          AckCrcBits     = 8,
  parameter logic [31:0] AckPolynomial  = 32'h00000037,
  parameter logic [31:0] AckStart       = 32'h000000ff,
  localparam int         WireBits       = LinkBits + SequenceBits + CrcBits,
  localparam int         AckBits        = SequenceBits + AckCrcBits
) (
  input  logic                clk_i,
  input  logic                rst_ni,
  // The wire. A node always has room, so ready is constant.
  input  logic                valid_i,  // a beat is on the wire
  input  logic                end_i,    // an end beat
  input  logic [WireBits-1:0] data_i,   // {crc, sequence, payload}
  output logic                ready_o,  // it is taken
  output logic [AckBits-1:0]  ack_o,    // {crc, sequence}: the number that is expected
  // To the node, one cycle later.
  output logic                valid_o,  // a good beat, once
  output logic                end_o,    // with valid_o: an end beat
  output logic [LinkBits-1:0] data_o,   // with valid_o: payload
  // In the cycle that finds it.
  output logic                wrong_o,  // a beat whose check is wrong
  output logic                order_o   // a beat that is not the next one
);
  logic [SequenceBits-1:0] expected_d, expected_q;
  logic [AckBits-1:0]      ack_q;
  logic                    valid_q, end_q, closed_d, closed_q, good, next, accept;
  logic [LinkBits-1:0]     data_q;

  logic [CrcBits-1:0] crc;
  cuboct_link_crc #(
    .Bits(LinkBits + 1 + SequenceBits), .Width(CrcBits), .Polynomial(CrcPolynomial), .Start(CrcStart)
  ) u_crc (.data_i({data_i[LinkBits +: SequenceBits], end_i, data_i[LinkBits-1:0]}), .crc_o(crc));
  assign good       = (data_i[LinkBits+SequenceBits +: CrcBits] == crc);
  assign next       = (data_i[LinkBits +: SequenceBits] == expected_q);
  assign wrong_o    = valid_i && !closed_q && !good;
  assign order_o    = valid_i && !closed_q && good && !next;
  assign accept     = valid_i && !closed_q && good && next;
  assign closed_d   = closed_q || ((Retry == 0) && (wrong_o || order_o));
  assign expected_d = accept ? expected_q + 1'b1 : expected_q;

  logic [AckCrcBits-1:0] ack_crc, ack_crc_of_zero;
  cuboct_link_crc #(
    .Bits(SequenceBits), .Width(AckCrcBits), .Polynomial(AckPolynomial), .Start(AckStart)
  ) u_ack_crc (.data_i(expected_q), .crc_o(ack_crc));
  cuboct_link_crc #(
    .Bits(SequenceBits), .Width(AckCrcBits), .Polynomial(AckPolynomial), .Start(AckStart)
  ) u_zero_crc (.data_i({SequenceBits{1'b0}}), .crc_o(ack_crc_of_zero));

  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      expected_q <= '0;
      closed_q   <= 1'b0;
      valid_q    <= 1'b0;
      ack_q      <= {ack_crc_of_zero, {SequenceBits{1'b0}}};
    end else begin
      expected_q <= expected_d;
      closed_q   <= closed_d;
      valid_q    <= accept;
      ack_q      <= {ack_crc, expected_q};
    end
  end
  always_ff @(posedge clk_i) begin
    if (accept) begin
      end_q  <= end_i;
      data_q <= data_i[LinkBits-1:0];
    end
  end

  assign ready_o = 1'b1;
  assign ack_o   = ack_q;
  assign valid_o = valid_q;
  assign end_o   = end_q;
  assign data_o  = data_q;
endmodule
