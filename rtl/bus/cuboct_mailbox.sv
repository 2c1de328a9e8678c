// SPDX-License-Identifier: MIT
// A host's stream of bytes as four registers of 32 bits, with a queue each way.
//
// DATA (0): written, the lowest byte goes to the machine; read, bit 8 tells that the lowest byte came from it, and the
// read takes it. STATUS (4): bit 0, a byte is there to read; 1, a byte can be written; 2, no run is under way; 3, some
// node met a fault since the host's RESET; 15 to 8, bytes to read; 23 to 16, bytes that can be written. ENABLE (8): the
// interrupt is high while a bit of STATUS and its bit here, 3 to 0, are. IDENT (12): 43554201, "CUB" and the layout's
// version.
module cuboct_mailbox #(
  parameter int Depth = 64  // bytes of each queue, 1 to 255
) (
  input  logic        clk_i,
  input  logic        rst_ni,
  // The bus, one write and one read in each cycle at most.
  input  logic        write_i,           // the register write_register_i is written
  input  logic [1:0]  write_register_i,  // bits 3 and 2 of the address
  input  logic [31:0] write_data_i,      // with write_i
  input  logic [3:0]  write_strobe_i,    // with write_i: which bytes of it count
  output logic        write_error_o,     // a register that cannot be written, or DATA without room: nothing happens
  input  logic        read_i,            // the register read_register_i is read; of DATA this takes the byte
  input  logic [1:0]  read_register_i,   // bits 3 and 2 of the address
  output logic [31:0] read_data_o,       // of read_register_i
  output logic        interrupt_o,       // a level
  // The machine.
  output logic        rx_valid_o,  // a byte for it
  output logic [7:0]  rx_data_o,   // with rx_valid_o
  input  logic        rx_ready_i,  // a byte is taken in a cycle with rx_valid_o and rx_ready_i
  input  logic        tx_valid_i,  // a byte from it
  input  logic [7:0]  tx_data_i,   // with tx_valid_i
  output logic        tx_ready_o,  // a byte is taken in a cycle with tx_valid_i and tx_ready_o
  input  logic        busy_i,      // a run is under way
  input  logic        fault_i      // some node met a fault
);
  // Every tool ends with an error where a module is missing: a queue's level has 8 bits in STATUS.
  if (Depth < 1 || Depth > 255) begin : gen_range
    cuboct_parameter_out_of_range u_error ();
  end
  localparam logic [1:0]  Data = 2'd0, Status = 2'd1, Enable = 2'd2;
  localparam logic [31:0] Ident = 32'h43554201;

  logic in_push, in_full, in_pop, in_empty, out_push, out_full, out_pop, out_empty;
  logic [7:0] out_data;
  cuboct_fifo #(.Bits(8), .Depth(Depth)) u_in (
    .clk_i, .rst_ni, .push_i(in_push), .data_i(write_data_i[7:0]), .full_o(in_full), .pop_i(in_pop),
    .data_o(rx_data_o), .empty_o(in_empty)
  );
  cuboct_fifo #(.Bits(8), .Depth(Depth)) u_out (
    .clk_i, .rst_ni, .push_i(out_push), .data_i(tx_data_i), .full_o(out_full), .pop_i(out_pop),
    .data_o(out_data), .empty_o(out_empty)
  );
  assign rx_valid_o = !in_empty;
  assign in_pop     = rx_ready_i && !in_empty;
  assign tx_ready_o = !out_full;
  assign out_push   = tx_valid_i && !out_full;

  logic        byte_written;
  logic [7:0]  room_d, room_q, waiting_d, waiting_q;
  logic [3:0]  enable_d, enable_q, events;
  logic        interrupt_q;
  logic        unused_data;
  assign unused_data   = ^{write_data_i[31:8], write_strobe_i[3:1]};
  assign byte_written  = write_i && write_register_i == Data && write_strobe_i[0];
  assign in_push       = byte_written && !in_full;
  assign out_pop       = read_i && read_register_i == Data && !out_empty;
  assign write_error_o = (byte_written && in_full)
                      || (write_i && write_register_i != Data && write_register_i != Enable);
  assign events        = {fault_i, !busy_i, !in_full, !out_empty};
  always_comb begin
    room_d    = room_q;
    waiting_d = waiting_q;
    enable_d  = enable_q;
    if (in_push && !in_pop) room_d = room_q - 8'd1;
    if (in_pop && !in_push) room_d = room_q + 8'd1;
    if (out_push && !out_pop) waiting_d = waiting_q + 8'd1;
    if (out_pop && !out_push) waiting_d = waiting_q - 8'd1;
    if (write_i && write_register_i == Enable && write_strobe_i[0]) enable_d = write_data_i[3:0];
  end
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      room_q      <= Depth[7:0];
      waiting_q   <= '0;
      enable_q    <= '0;
      interrupt_q <= 1'b0;
    end else begin
      room_q      <= room_d;
      waiting_q   <= waiting_d;
      enable_q    <= enable_d;
      interrupt_q <= ((events & enable_q) != '0);
    end
  end
  assign interrupt_o = interrupt_q;

  always_comb begin
    read_data_o = Ident;
    unique case (read_register_i)
      Data:    read_data_o = {23'd0, !out_empty, out_empty ? 8'd0 : out_data};
      Status:  read_data_o = {8'd0, room_q, waiting_q, 4'd0, events};
      Enable:  read_data_o = {28'd0, enable_q};
      default: ;
    endcase
  end
endmodule
