// SPDX-License-Identifier: MIT
// cuboct_mailbox before any bus, machine and order of reads and writes: each byte that is written with room, or that
// the machine gives, comes out once, in its turn, unchanged; what the registers show, when a write is refused and when
// the interrupt is high is what the header says.
module mailbox_formal #(
  parameter int Depth = 3  // bytes of each queue
) (
  input logic        clk_i,
  input logic        write_i,
  input logic [1:0]  write_register_i,
  input logic [31:0] write_data_i,
  input logic [3:0]  write_strobe_i,
  input logic        read_i,
  input logic [1:0]  read_register_i,
  input logic        rx_ready_i,
  input logic        tx_valid_i,
  input logic [7:0]  tx_data_i,
  input logic        busy_i,
  input logic        fault_i,
  input logic        watch_in_i,  // the byte that enters now is the one that is watched, in either direction
  input logic        watch_out_i
);
  localparam logic [1:0]  Data = 2'd0, Status = 2'd1, Enable = 2'd2, Ident = 2'd3;
  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;

  logic        write_error, interrupt, rx_valid, tx_ready;
  logic [31:0] read_data;
  logic [7:0]  rx_data;
  cuboct_mailbox #(.Depth(Depth)) u_dut (
    .clk_i, .rst_ni(running_q), .write_i(write_i && running_q), .write_register_i, .write_data_i, .write_strobe_i,
    .write_error_o(write_error), .read_i(read_i && running_q), .read_register_i, .read_data_o(read_data),
    .interrupt_o(interrupt), .rx_valid_o(rx_valid), .rx_data_o(rx_data), .rx_ready_i(rx_ready_i && running_q),
    .tx_valid_i(tx_valid_i && running_q), .tx_data_i, .tx_ready_o(tx_ready), .busy_i, .fault_i
  );

  // Bytes each way: how many are held, whether one is watched, how many are before it, what it is.
  logic       goes_in, comes_in, goes_out, comes_out, data_written;
  logic [7:0] ins_q, outs_q, in_ahead_q, out_ahead_q, in_value_q, out_value_q;
  logic       in_watched_q, out_watched_q;
  assign data_written = write_i && write_register_i == Data && write_strobe_i[0];
  assign goes_in   = data_written && ins_q != Depth[7:0];     // from the bus
  assign comes_in  = rx_ready_i && ins_q != 8'd0;             // to the machine
  assign goes_out  = tx_valid_i && outs_q != Depth[7:0];      // from the machine
  assign comes_out = read_i && read_register_i == Data && outs_q != 8'd0;  // to the bus
  // What ENABLE holds, and the events of the cycle before.
  logic [3:0] enable_q, events, raised_q;
  assign events = {fault_i, !busy_i, ins_q != Depth[7:0], outs_q != 8'd0};
  always_ff @(posedge clk_i) begin
    if (!running_q) begin
      {ins_q, outs_q, in_ahead_q, out_ahead_q, in_watched_q, out_watched_q, enable_q, raised_q} <= '0;
    end else begin
      ins_q    <= ins_q + {7'd0, goes_in} - {7'd0, comes_in};
      outs_q   <= outs_q + {7'd0, goes_out} - {7'd0, comes_out};
      raised_q <= events & enable_q;
      if (write_i && write_register_i == Enable && write_strobe_i[0]) enable_q <= write_data_i[3:0];
      if (in_watched_q && comes_in) begin
        in_ahead_q   <= in_ahead_q - 8'd1;
        in_watched_q <= (in_ahead_q != 8'd0);
      end
      if (!in_watched_q && goes_in && watch_in_i) begin
        in_watched_q <= 1'b1;
        in_value_q   <= write_data_i[7:0];
        in_ahead_q   <= ins_q - {7'd0, comes_in};
      end
      if (out_watched_q && comes_out) begin
        out_ahead_q   <= out_ahead_q - 8'd1;
        out_watched_q <= (out_ahead_q != 8'd0);
      end
      if (!out_watched_q && goes_out && watch_out_i) begin
        out_watched_q <= 1'b1;
        out_value_q   <= tx_data_i;
        out_ahead_q   <= outs_q - {7'd0, comes_out};
      end
    end
  end

  always_ff @(posedge clk_i) begin
    if (running_q) begin
      a_rx_valid: assert (rx_valid == (ins_q != 8'd0));
      a_tx_ready: assert (tx_ready == (outs_q != Depth[7:0]));
      if (in_watched_q && in_ahead_q == 8'd0) a_in: assert (rx_data == in_value_q);
      if (out_watched_q && out_ahead_q == 8'd0 && read_register_i == Data)
        a_out: assert (read_data == {24'd1, out_value_q});
      if (outs_q == 8'd0 && read_register_i == Data) a_none: assert (read_data == 32'd0);
      if (read_register_i == Status)
        a_status: assert (read_data == {8'd0, Depth[7:0] - ins_q, outs_q, 4'd0, events});
      if (read_register_i == Enable) a_enable: assert (read_data == {28'd0, enable_q});
      if (read_register_i == Ident) a_ident: assert (read_data == 32'h43554201);
      a_refused:   assert (write_error == ((data_written && ins_q == Depth[7:0])
                                           || (write_i && (write_register_i == Status || write_register_i == Ident))));
      a_interrupt: assert (interrupt == (raised_q != 4'd0));
      c_full_in:   cover (ins_q == Depth[7:0] && write_error && in_watched_q && comes_in);
      c_full_out:  cover (outs_q == Depth[7:0] && out_watched_q && comes_out && tx_valid_i);
      c_interrupt: cover (interrupt && enable_q == 4'b0001);
    end
  end
endmodule
