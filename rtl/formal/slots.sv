// SPDX-License-Identifier: MIT
// cuboct_slots: every read port shows what was written last; the position that a filter lane reads in its row
// is that of the particle that the other ports show in the same slot.
module slots_formal #(
  parameter int Capacity    = 3,
  parameter int FilterLanes = 2,
  parameter int ForcePipes  = 1
) (
  input logic       clk_i,
  input logic       write_i,
  input logic [3:0] slot_i,
  input logic [4:0] data_i,     // x[2] id[2] rest[1]
  input logic [3:0] pipe_i,     // read by the last pipe
  input logic [3:0] row_i
);
  localparam int SlotBits = (Capacity > 1) ? $clog2(Capacity) : 1;
  localparam int Rows     = (Capacity + FilterLanes - 1) / FilterLanes;
  localparam int RowBits  = (Rows > 1) ? $clog2(Rows) : 1;

  (* anyconst *) logic [3:0] watched;
  (* anyconst *) logic [3:0] watched_row, watched_lane;
  always_comb begin
    assume (watched < Capacity[3:0]);
    assume ({4'd0, watched} == {4'd0, watched_row} * FilterLanes[7:0] + {4'd0, watched_lane});
    assume (watched_lane < FilterLanes[3:0]);
    if (write_i) assume (slot_i < Capacity[3:0]);
    assume (pipe_i < Capacity[3:0] && row_i < Rows[3:0]);
  end

  logic [4:0]                     main_data, stream_data;
  logic [ForcePipes*SlotBits-1:0] pipe_slot, fault_slot;
  logic [ForcePipes*5-1:0]        pipe_data;
  logic [ForcePipes*2-1:0]        fault_id;
  logic [FilterLanes*2-1:0]       row_data;
  integer                         f, l;
  always_comb begin
    pipe_slot  = '0;
    fault_slot = '0;
    pipe_slot[(ForcePipes-1)*SlotBits +: SlotBits]  = pipe_i[SlotBits-1:0];
    fault_slot[(ForcePipes-1)*SlotBits +: SlotBits] = pipe_i[SlotBits-1:0];
  end
  cuboct_slots #(
    .Bits(5), .PosBits(2), .IdLsb(2), .IdBits(2), .Capacity(Capacity), .SlotBits(SlotBits),
        .FilterLanes(FilterLanes),
    .RowBits(RowBits), .ForcePipes(ForcePipes)
  ) u_dut (
    .clk_i, .write_i, .write_slot_i(slot_i[SlotBits-1:0]), .write_data_i(data_i),
        .main_slot_i(watched[SlotBits-1:0]),
    .main_data_o(main_data), .stream_slot_i(watched[SlotBits-1:0]), .stream_data_o(stream_data),
    .pipe_slot_i(pipe_slot), .pipe_data_o(pipe_data), .fault_slot_i(fault_slot), .fault_id_o(fault_id),
    .row_i(row_i[RowBits-1:0]), .row_data_o(row_data)
  );

  logic       written_q = 1'b0;
  logic [4:0] value_q;
  always_ff @(posedge clk_i) begin
    if (write_i && slot_i == watched) begin
      written_q <= 1'b1;
      value_q   <= data_i;
    end
  end
  logic [1:0] lane_data;
  always_comb begin
    lane_data = '0;
    for (l = 0; l < FilterLanes; l = l + 1) begin
      if (watched_lane == l[3:0]) lane_data = row_data[l*2 +: 2];
    end
  end
  always_ff @(posedge clk_i) begin
    if (written_q) begin
      a_main:   assert (main_data == value_q);
      a_stream: assert (stream_data == value_q);
      if (pipe_i == watched) begin
        a_pipe:  assert (pipe_data[(ForcePipes-1)*5 +: 5] == value_q);
        a_fault: assert (fault_id[(ForcePipes-1)*2 +: 2] == value_q[3:2]);
      end
      if (row_i == watched_row) a_lane: assert (lane_data == value_q[1:0]);
      c_last: cover (watched == Capacity[3:0] - 4'd1 && row_i == watched_row && value_q == '1);
    end
  end
endmodule
