// SPDX-License-Identifier: MIT
// The checks of a node's links, between the node's ports and the wires, and their faults beside the node's. Without
// Retry the first link that fails is told once, as soon as it does: code 12 for a wrong check, 13 for a beat lost or
// repeated, 14 for beats that are not acknowledged; the number is the face. docs/reference/links.md.
module cuboct_link_guard #(
  parameter int          Faces          = 6,             // 4 or 6
  parameter int          LinkBits       = 66,            // payload, >= 1
  parameter int          SequenceBits   = 4,
  parameter int          Window         = 8,
  parameter int          Patience       = 15,
  parameter int          Retry          = 1,             // 0, 1
  parameter int          CrcBits        = 16,
  parameter logic [31:0] CrcPolynomial  = 32'h00003d65,
  parameter logic [31:0] CrcStart       = 32'h0000ffff,
  parameter int          AckCrcBits     = 8,
  parameter logic [31:0] AckPolynomial  = 32'h00000037,
  parameter logic [31:0] AckStart       = 32'h000000ff,
  parameter int          IdBits         = 8,
  localparam int         WireBits       = LinkBits + SequenceBits + CrcBits,
  localparam int         AckBits        = SequenceBits + AckCrcBits
) (
  input  logic                      clk_i,
  input  logic                      rst_ni,
  input  logic [Faces-1:0]          has_link_i,
  // The node.
  input  logic [Faces-1:0]          node_valid_i,         // by face: from its link register
  input  logic [Faces-1:0]          node_end_i,           // by face: an end beat
  input  logic [Faces*LinkBits-1:0] node_data_i,          // by face: payload
  output logic [Faces-1:0]          node_ready_o,         // by face: it is taken
  output logic [Faces-1:0]          node_valid_o,         // by face: a good beat
  output logic [Faces-1:0]          node_end_o,           // by face: an end beat
  output logic [Faces*LinkBits-1:0] node_data_o,          // by face: payload
  input  logic                      node_fault_valid_i,   // the node's own fault
  input  logic [3:0]                node_fault_code_i,    // with node_fault_valid_i
  input  logic [IdBits-1:0]         node_fault_id_i,      // with node_fault_valid_i
  input  logic [63:0]               node_fault_number_i,  // with node_fault_valid_i
  // The wires.
  output logic [Faces-1:0]          link_valid_o,
  output logic [Faces-1:0]          link_end_o,
  output logic [Faces*WireBits-1:0] link_data_o,
  input  logic [Faces-1:0]          link_ready_i,
  input  logic [Faces*AckBits-1:0]  link_ack_i,           // by face: from the neighbour
  input  logic [Faces-1:0]          link_valid_i,
  input  logic [Faces-1:0]          link_end_i,
  input  logic [Faces*WireBits-1:0] link_data_i,
  output logic [Faces-1:0]          link_ready_o,
  output logic [Faces*AckBits-1:0]  link_ack_o,           // by face: to the neighbour
  // Faces at which something was found wrong, one cycle later, for counters: {acknowledgements, arriving beats}.
  output logic [2*Faces-1:0]        link_error_o,         // one bit per face each
  output logic                      fault_valid_o,        // a fault, once: of the node, or of a link
  output logic [3:0]                fault_code_o,
  output logic [IdBits-1:0]         fault_id_o,
  output logic [63:0]               fault_number_o
);
  logic [Faces-1:0]   beat_wrong, beat_order, ack_wrong, silent;
  logic [2*Faces-1:0] error_q;
  for (genvar f = 0; f < Faces; f++) begin : gen_face
    cuboct_link_send #(
      .LinkBits(LinkBits), .SequenceBits(SequenceBits), .Window(Window), .Patience(Patience), .Retry(Retry),
      .CrcBits(CrcBits), .CrcPolynomial(CrcPolynomial), .CrcStart(CrcStart), .AckCrcBits(AckCrcBits),
      .AckPolynomial(AckPolynomial), .AckStart(AckStart)
    ) u_send (
      .clk_i, .rst_ni, .has_link_i(has_link_i[f]), .valid_i(node_valid_i[f]), .end_i(node_end_i[f]),
      .data_i(node_data_i[f*LinkBits +: LinkBits]), .ready_o(node_ready_o[f]), .valid_o(link_valid_o[f]),
      .end_o(link_end_o[f]), .data_o(link_data_o[f*WireBits +: WireBits]), .ready_i(link_ready_i[f]),
      .ack_i(link_ack_i[f*AckBits +: AckBits]), .wrong_o(ack_wrong[f]), .silent_o(silent[f])
    );
    cuboct_link_take #(
      .LinkBits(LinkBits), .SequenceBits(SequenceBits), .Retry(Retry), .CrcBits(CrcBits),
      .CrcPolynomial(CrcPolynomial), .CrcStart(CrcStart), .AckCrcBits(AckCrcBits), .AckPolynomial(AckPolynomial),
      .AckStart(AckStart)
    ) u_take (
      .clk_i, .rst_ni, .valid_i(link_valid_i[f] && has_link_i[f]), .end_i(link_end_i[f]),
      .data_i(link_data_i[f*WireBits +: WireBits]), .ready_o(link_ready_o[f]),
      .ack_o(link_ack_o[f*AckBits +: AckBits]), .valid_o(node_valid_o[f]), .end_o(node_end_o[f]),
      .data_o(node_data_o[f*LinkBits +: LinkBits]), .wrong_o(beat_wrong[f]), .order_o(beat_order[f])
    );
  end
  always_ff @(posedge clk_i) begin
    if (!rst_ni) error_q <= '0;
    else error_q <= {ack_wrong | silent, beat_wrong | beat_order};
  end
  assign link_error_o = error_q;

  if (Retry == 0) begin : gen_fault
    // The lowest face of the first cycle with an error; a fault of the node's goes before it.
    logic       told_d, told_q, shown_d, shown_q;
    logic [3:0] code_d, code_q;
    logic [2:0] face_d, face_q;
    integer     f;
    always_comb begin
      told_d = told_q;
      code_d = code_q;
      face_d = face_q;
      for (f = Faces - 1; f >= 0; f = f - 1) begin
        if (!told_q && (beat_wrong[f] || beat_order[f] || ack_wrong[f] || silent[f])) begin
          told_d = 1'b1;
          face_d = f[2:0];
          code_d = 4'd12;
          if (!beat_wrong[f] && !ack_wrong[f]) code_d = beat_order[f] ? 4'd13 : 4'd14;
        end
      end
    end
    assign shown_d = told_q && (shown_q || !node_fault_valid_i);
    always_ff @(posedge clk_i) begin
      if (!rst_ni) begin
        told_q  <= 1'b0;
        shown_q <= 1'b0;
      end else begin
        told_q  <= told_d;
        shown_q <= shown_d;
      end
    end
    always_ff @(posedge clk_i) begin
      code_q <= code_d;
      face_q <= face_d;
    end
    assign fault_valid_o  = node_fault_valid_i || (told_q && !shown_q);
    assign fault_code_o   = node_fault_valid_i ? node_fault_code_i : code_q;
    assign fault_id_o     = node_fault_valid_i ? node_fault_id_i : '0;
    assign fault_number_o = node_fault_valid_i ? node_fault_number_i : {61'd0, face_q};
  end else begin : gen_no_fault
    assign fault_valid_o  = node_fault_valid_i;
    assign fault_code_o   = node_fault_code_i;
    assign fault_id_o     = node_fault_id_i;
    assign fault_number_o = node_fault_number_i;
  end
endmodule
