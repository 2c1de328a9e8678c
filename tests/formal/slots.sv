// SPDX-License-Identifier: MIT
// cuboct_slots: every read port answers in the cycle after the question, with what was written last before
// it; the position that a filter lane reads in its row has the leading bits of that of the particle which the
// other ports show in the same slot. What is answered to a question for a slot in the cycle in which it is
// written is left open. Answers of the streamer and of the lanes stay until the next question; those of the
// lanes, where there is only one row, until their slot is written. Bonds: a lane reads the partners' ids of the row of
// bonds that the main port, the streamer and the pipes show with the particle, so each row is in its particle's slot.
module slots_formal #(
  parameter int Capacity    = 3,
  parameter int FilterLanes = 2,
  parameter int ForcePipes  = 1,
  parameter int Streamers   = 1,  // the last one's rows are watched
  parameter int Bonds       = 0   // places of a row of bonds
) (
  input logic       clk_i,
  input logic       write_i,
  input logic [4:0] slot_i,
  input logic [7+3*Bonds:0] data_i,  // x[2] y[2] seen[1] id[2], by place partner[2] kind[1], rest[1]
  input logic       stream_read_i,
  input logic       row_read_i,
  input logic       first_read_i,   // of two streamers the first, which reads another row
  input logic [4:0] first_row_i,
  input logic [4:0] main_i, stream_i,
  input logic [4:0] pipe_i,     // read by the last pipe
  input logic [4:0] fault_i,    // and for its faults
  input logic [4:0] row_i
);
  localparam int Bits     = 8 + 3 * Bonds;
  localparam int Seen     = (Bonds > 0) ? 7 + 3 * Bonds : 5;  // bits that the streamer and the pipes show
  localparam int Lane     = (Bonds > 0) ? 2 * Bonds : 2;      // that a lane shows
  localparam int SlotBits = (Capacity > 1) ? $clog2(Capacity) : 1;
  localparam int Rows     = (Capacity + FilterLanes - 1) / FilterLanes;
  localparam int RowBits  = (Rows > 1) ? $clog2(Rows) : 1;

  (* anyconst *) logic [4:0] watched;
  (* anyconst *) logic [4:0] watched_row, watched_lane;
  always_comb begin
    assume (watched < Capacity[4:0]);
    assume ({5'd0, watched} == {5'd0, watched_row} * FilterLanes[9:0] + {5'd0, watched_lane});
    assume (watched_lane < FilterLanes[4:0]);
    if (write_i) assume (slot_i < Capacity[4:0]);
    assume (main_i < Capacity[4:0] && stream_i < Capacity[4:0]);
    assume (pipe_i < Capacity[4:0] && fault_i < Capacity[4:0] && row_i < Rows[4:0] && first_row_i < Rows[4:0]);
  end

  logic [Bits-1:0]                main_data;
  logic [Seen-1:0]                stream_data;
  logic [ForcePipes*SlotBits-1:0] pipe_slot, fault_slot;
  logic [ForcePipes*Seen-1:0]     pipe_data;
  logic [ForcePipes*2-1:0]        fault_id;
  logic [Streamers*FilterLanes*Lane-1:0] row_data;
  logic [Streamers-1:0]               row_read;
  logic [Streamers*RowBits-1:0]       row;
  integer                         l;
  always_comb begin
    row_read                 = {Streamers{first_read_i}};
    row                      = {Streamers{first_row_i[RowBits-1:0]}};
    row_read[Streamers-1]    = row_read_i;
    row[(Streamers-1)*RowBits +: RowBits] = row_i[RowBits-1:0];
    pipe_slot  = '0;
    fault_slot = '0;
    pipe_slot[(ForcePipes-1)*SlotBits +: SlotBits]  = pipe_i[SlotBits-1:0];
    fault_slot[(ForcePipes-1)*SlotBits +: SlotBits] = fault_i[SlotBits-1:0];
  end
  cuboct_slots #(
    .Axes(2), .Bits(Bits), .SeenBits(Seen), .PositionFrac(2), .FilterFrac(1), .IdLsb(5), .IdBits(2),
    .Capacity(Capacity), .SlotBits(SlotBits), .FilterLanes(FilterLanes), .RowBits(RowBits),
    .ForcePipes(ForcePipes), .Streamers(Streamers),
    .Bonds(Bonds), .BondLsb(7), .BondBits(3)
  ) u_dut (
    .clk_i, .write_i, .write_slot_i(slot_i[SlotBits-1:0]), .write_data_i(data_i),
    .main_read_i(1'b1), .main_slot_i(main_i[SlotBits-1:0]), .main_data_o(main_data), .stream_read_i,
    .stream_slot_i(stream_i[SlotBits-1:0]), .stream_data_o(stream_data), .row_read_i(row_read), .row_i(row),
    .row_data_o(row_data), .pipe_slot_i(pipe_slot), .pipe_data_o(pipe_data), .fault_slot_i(fault_slot),
    .fault_id_o(fault_id)
  );

  // What the watched slot holds, and what was answered about it: known, and the value.
  logic       written_q = 1'b0;
  logic       writes, ask_q = 1'b0, pipe_q = 1'b0, fault_q = 1'b0, stream_q = 1'b0;
  logic       lane_q = 1'b0, later_q = 1'b0;
  logic [Bits-1:0] value_q, answer_q;
  logic [Seen-1:0] stream_value_q;
  logic [Lane-1:0] lane_value, lane_value_q;
  integer          b;
  always_comb begin
    lane_value = {value_q[3], value_q[1]};
    for (b = 0; b < Bonds; b = b + 1) lane_value[2*b +: 2] = value_q[7+3*b +: 2];
  end
  assign writes = write_i && slot_i == watched;
  always_ff @(posedge clk_i) begin
    if (writes) begin
      written_q <= 1'b1;
      value_q   <= data_i;
    end
    answer_q <= value_q;
    ask_q    <= written_q && !writes && main_i == watched;
    pipe_q   <= written_q && !writes && pipe_i == watched;
    fault_q  <= written_q && !writes && fault_i == watched;
    if (stream_read_i) begin
      stream_q       <= written_q && !writes && stream_i == watched;
      stream_value_q <= value_q[Seen-1:0];
    end
    if (row_read_i) begin
      lane_q         <= written_q && !writes && row_i == watched_row;
      lane_value_q   <= lane_value;
    end else if (Rows == 1 && writes) begin
      lane_q <= 1'b0;
    end
    later_q <= stream_q && !stream_read_i && !row_read_i && (Rows == 1 || writes);  // an answer stays
  end
  logic [Lane-1:0] lane_data;
  always_comb begin
    lane_data = '0;
    for (l = 0; l < FilterLanes; l = l + 1) begin
      if (watched_lane == l[4:0]) lane_data = row_data[((Streamers-1)*FilterLanes+l)*Lane +: Lane];
    end
  end
  always_ff @(posedge clk_i) begin
    if (ask_q) a_main: assert (main_data == answer_q);
    if (stream_q) a_stream: assert (stream_data == stream_value_q);
    if (pipe_q) a_pipe: assert (pipe_data[(ForcePipes-1)*Seen +: Seen] == answer_q[Seen-1:0]);
    if (fault_q) a_fault: assert (fault_id[(ForcePipes-1)*2 +: 2] == answer_q[6:5]);
    if (lane_q) a_lane: assert (lane_data == lane_value_q);
    c_last: cover (watched == Capacity[4:0] - 5'd1 && ask_q && pipe_q && fault_q && stream_q && lane_q
                   && answer_q == '1);
    c_later: cover (later_q && stream_q && lane_q && stream_value_q == '1);
  end
endmodule
