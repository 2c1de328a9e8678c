// SPDX-License-Identifier: MIT
// Between a node's link register and the wire: gives each beat a sequence number and a check, and waits for its
// acknowledgement. With Retry the last beats are kept, and sent again from the oldest unacknowledged one when nothing
// has come back for Patience cycles; without it that is told and nothing more. docs/reference/links.md.
module cuboct_link_send #(
  parameter int          LinkBits       = 66,            // payload, >= 1
  parameter int          SequenceBits   = 4,
  parameter int          Window         = 8,             // unacknowledged beats; a power of two below 2^SequenceBits
  parameter int          Patience       = 15,            // 1 to 15; more than an acknowledgement takes
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
  input  logic                has_link_i,  // constant
  // From the node's link register.
  input  logic                valid_i,     // a beat waits
  input  logic                end_i,       // an end beat
  input  logic [LinkBits-1:0] data_i,      // payload
  output logic                ready_o,     // depends on ready_i
  // The wire: {crc, sequence, payload}, end beside it.
  output logic                valid_o,     // a beat is on the wire
  output logic                end_o,       // an end beat
  output logic [WireBits-1:0] data_o,      // stays until ready_i
  input  logic                ready_i,     // it is taken in this cycle
  // What the receiver expects next: {crc, sequence}, in every cycle.
  input  logic [AckBits-1:0]  ack_i,
  // In the cycle that finds it.
  output logic                wrong_o,     // an acknowledgement whose check is wrong
  output logic                silent_o     // beats that are not acknowledged
);
  localparam int SlotBits  = $clog2(Window);
  localparam int EntryBits = CrcBits + 1 + LinkBits;

  // Sequence numbers: of the oldest unacknowledged beat, of the next one for the wire, of the next from the node.
  logic [SequenceBits-1:0] base_d, base_q, next_d, next_q, head_d, head_q, pending, acked, sent;
  logic [AckBits-1:0]      ack_q;
  logic [3:0]              timer_d, timer_q;
  logic                    valid_d, valid_q, end_q, accept, load, can_load, replay, full, progress, waiting, expired;
  logic [WireBits-1:0]     data_q;

  // Acknowledgements name a beat of the window; any other value is as good as none.
  logic [AckCrcBits-1:0]   ack_crc, ack_crc_of_zero;
  logic [SequenceBits-1:0] ack_sequence;
  logic                    ack_good;
  assign ack_sequence = ack_q[SequenceBits-1:0];
  cuboct_link_crc #(
    .Bits(SequenceBits), .Width(AckCrcBits), .Polynomial(AckPolynomial), .Start(AckStart)
  ) u_ack_crc (.data_i(ack_sequence), .crc_o(ack_crc));
  cuboct_link_crc #(
    .Bits(SequenceBits), .Width(AckCrcBits), .Polynomial(AckPolynomial), .Start(AckStart)
  ) u_zero_crc (.data_i({SequenceBits{1'b0}}), .crc_o(ack_crc_of_zero));
  assign ack_good = (ack_q[SequenceBits +: AckCrcBits] == ack_crc);
  assign wrong_o  = has_link_i && !ack_good;
  assign pending  = head_q - base_q;
  assign sent     = next_q - base_q;
  assign acked    = ack_sequence - base_q;
  assign progress = ack_good && (acked != '0) && (acked <= pending);

  // Silence: the wire is empty and what it carried is not acknowledged.
  assign waiting  = has_link_i && !valid_q && (sent != '0) && !progress;
  assign expired  = waiting && (timer_q == Patience[3:0]);
  assign timer_d  = (waiting && !expired) ? timer_q + 4'd1 : 4'd0;
  assign silent_o = expired;

  assign can_load = !valid_q || ready_i;
  assign full     = (pending == Window[SequenceBits-1:0]);
  assign replay   = (next_q != head_q);
  assign ready_o  = can_load && !replay && !full;
  assign accept   = valid_i && ready_o;
  assign load     = accept || (can_load && replay);
  assign valid_d  = load || (valid_q && !ready_i);

  always_comb begin
    head_d = head_q;
    next_d = next_q;
    base_d = base_q;
    if (accept) head_d = head_q + 1'b1;
    if (load) next_d = next_q + 1'b1;
    if (progress) begin
      base_d = ack_sequence;
      if (acked > sent) next_d = ack_sequence;
    end
    if (expired && Retry != 0) next_d = base_q;
  end

  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      base_q  <= '0;
      next_q  <= '0;
      head_q  <= '0;
      timer_q <= '0;
      valid_q <= 1'b0;
      ack_q   <= {ack_crc_of_zero, {SequenceBits{1'b0}}};
    end else begin
      base_q  <= base_d;
      next_q  <= next_d;
      head_q  <= head_d;
      timer_q <= timer_d;
      valid_q <= valid_d;
      ack_q   <= ack_i;
    end
  end

  logic [CrcBits-1:0]   crc;
  logic [EntryBits-1:0] fresh, entry;
  cuboct_link_crc #(
    .Bits(LinkBits + 1 + SequenceBits), .Width(CrcBits), .Polynomial(CrcPolynomial), .Start(CrcStart)
  ) u_crc (.data_i({head_q, end_i, data_i}), .crc_o(crc));
  assign fresh = {crc, end_i, data_i};
  if (Retry != 0) begin : gen_retry
    logic [EntryBits-1:0] kept_q [0:Window-1];
    always_ff @(posedge clk_i) begin
      if (accept) kept_q[head_q[SlotBits-1:0]] <= fresh;
    end
    assign entry = replay ? kept_q[next_q[SlotBits-1:0]] : fresh;
  end else begin : gen_detect
    assign entry = fresh;
  end
  always_ff @(posedge clk_i) begin
    if (load) begin
      end_q  <= entry[LinkBits];
      data_q <= {entry[LinkBits+1 +: CrcBits], next_q, entry[LinkBits-1:0]};
    end
  end

  assign valid_o = valid_q;
  assign end_o   = end_q;
  assign data_o  = data_q;
endmodule
