// SPDX-License-Identifier: MIT
// cuboct_brick_slots: of a watched slot of a watched cell, any, every read port answers in the cycle after the question
// with what was written last before it, the main port also if that was in the question's cycle; the lane that has the
// slot shows the leading bits of its position where its row is asked for. Answers of the streamer and of the lanes stay
// until the next question. Where its particle goes is told of a slot from the question on until the next one, as it is
// written then. The others' answer to who asks for a slot in the cycle in which it is written is left open.
`include "torn_ram.svh"
module brick_slots_formal #(
  parameter int Cells       = 2,
  parameter int Capacity    = 3,
  parameter int FilterLanes = 2,
  parameter int ForcePipes  = 1
) (
  input logic       clk_i,
  input logic       write_i,
  input logic [2:0] cell_i,
  input logic [3:0] slot_i,
  input logic [7:0] data_i,     // x[2] y[2] seen[1] id[2] rest[1]
  input logic       stream_read_i,
  input logic [5:0] main_i, stream_i, away_i,
  input logic       away_read_i,
  input logic [5:0] pipe_i,     // read by the last pipe
  input logic [5:0] fault_i,    // and for its faults
  input logic [5:0] row_i
);
  localparam int CellBits    = $clog2(Cells);
  localparam int SlotBits    = (Capacity > 1) ? $clog2(Capacity) : 1;
  localparam int AddrBits    = CellBits + SlotBits;
  localparam int Rows        = (Capacity + FilterLanes - 1) / FilterLanes;
  localparam int RowAddrBits = CellBits + ((Rows > 1) ? $clog2(Rows) : 1);
  localparam int Depth       = Cells * Capacity;

  (* anyconst *) logic [2:0] watched_cell;
  (* anyconst *) logic [3:0] watched_slot, watched_row, watched_lane;
  logic [5:0] address, watched, watched_at, away_next, asked_q;
  assign away_next  = away_read_i ? away_i : asked_q;
  assign address    = {3'd0, cell_i} * Capacity[5:0] + {2'd0, slot_i};
  assign watched    = {3'd0, watched_cell} * Capacity[5:0] + {2'd0, watched_slot};
  assign watched_at = {3'd0, watched_cell} * Rows[5:0] + {2'd0, watched_row};
  always_comb begin
    assume (watched_cell < Cells && watched_slot < Capacity && watched_lane < FilterLanes);
    assume ({4'd0, watched_slot} == {4'd0, watched_row} * FilterLanes[7:0] + {4'd0, watched_lane});
    if (write_i) assume (cell_i < Cells && slot_i < Capacity);
    assume (away_i < Depth && main_i < Depth && stream_i < Depth && pipe_i < Depth && fault_i < Depth
            && row_i < Cells * Rows);
  end

  logic [7:0]                     main_data;
  logic [3:0]                     away;
  logic [4:0]                     stream_data;
  logic [ForcePipes*AddrBits-1:0] pipe_addr, fault_addr;
  logic [ForcePipes*5-1:0]        pipe_data;
  logic [ForcePipes*2-1:0]        fault_id;
  logic [FilterLanes*2-1:0]       row_data;
  integer                         l;
  always_comb begin
    pipe_addr  = '0;
    fault_addr = '0;
    pipe_addr[(ForcePipes-1)*AddrBits +: AddrBits]  = pipe_i[AddrBits-1:0];
    fault_addr[(ForcePipes-1)*AddrBits +: AddrBits] = fault_i[AddrBits-1:0];
  end
  cuboct_brick_slots #(
    .Axes(2), .Bits(8), .SeenBits(5), .PositionFrac(2), .FilterFrac(1), .IdLsb(5), .IdBits(2), .Cells(Cells),
    .CellBits(CellBits), .Capacity(Capacity), .SlotBits(SlotBits), .AddrBits(AddrBits), .FilterLanes(FilterLanes),
    .RowAddrBits(RowAddrBits), .ForcePipes(ForcePipes)
  ) u_dut (
    .clk_i, .write_i, .write_cell_i(cell_i[CellBits-1:0]), .write_slot_i(slot_i[SlotBits-1:0]),
    .write_addr_i(address[AddrBits-1:0]), .write_data_i(data_i), .main_addr_i(main_i[AddrBits-1:0]),
    .main_written_i(write_i && address == main_i), .main_data_o(main_data), .away_read_i,
    .away_addr_i(away_i[AddrBits-1:0]), .away_written_i(write_i && address == away_next), .away_o(away), .stream_read_i,
    .stream_addr_i(stream_i[AddrBits-1:0]), .stream_data_o(stream_data),
    .row_i(row_i[RowAddrBits-1:0]), .row_data_o(row_data), .pipe_addr_i(pipe_addr), .pipe_data_o(pipe_data),
    .fault_addr_i(fault_addr), .fault_id_o(fault_id)
  );

  // What the watched slot holds, and what was answered about it: known, and the value.
  logic       written_q = 1'b0;
  logic       writes, main_q = 1'b0, pipe_q = 1'b0, fault_q = 1'b0, stream_q = 1'b0, lane_q = 1'b0, later_q = 1'b0;
  logic       late_q = 1'b0, away_q = 1'b0, kept_q = 1'b0;
  logic [7:0] value_q, main_value_q, answer_q;
  logic [4:0] stream_value_q;
  logic [1:0] lane_value_q;
  assign writes = write_i && cell_i == watched_cell && slot_i == watched_slot;
  always_ff @(posedge clk_i) begin
    if (writes) begin
      written_q <= 1'b1;
      value_q   <= data_i;
    end
    main_value_q <= writes ? data_i : value_q;
    answer_q     <= value_q;
    main_q       <= (written_q || writes) && main_i == watched;
    late_q       <= writes && main_i == watched;
    pipe_q       <= written_q && !writes && pipe_i == watched;
    fault_q      <= written_q && !writes && fault_i == watched;
    if (stream_read_i) begin
      stream_q       <= written_q && !writes && stream_i == watched;
      stream_value_q <= value_q[4:0];
      lane_q         <= written_q && !writes && row_i == watched_at;
      lane_value_q   <= {value_q[3], value_q[1]};
    end
    away_q  <= away_next == watched && (writes || (away_read_i ? written_q : away_q));
    kept_q  <= away_q && !away_read_i && writes;
    asked_q <= away_next;
    later_q <= stream_q && !stream_read_i && writes;  // an answer stays
  end
  logic [1:0] lane_data;
  always_comb begin
    lane_data = '0;
    for (l = 0; l < FilterLanes; l = l + 1) begin
      if (watched_lane == l[3:0]) lane_data = row_data[l*2 +: 2];
    end
  end
  always_ff @(posedge clk_i) begin
    if (main_q) a_main: assert (main_data == main_value_q);
    if (away_q) a_away: assert (away == {value_q[5:4], value_q[7:6]});
    if (stream_q) a_stream: assert (stream_data == stream_value_q);
    if (pipe_q) a_pipe: assert (pipe_data[(ForcePipes-1)*5 +: 5] == answer_q[4:0]);
    if (fault_q) a_fault: assert (fault_id[(ForcePipes-1)*2 +: 2] == answer_q[6:5]);
    if (lane_q) a_lane: assert (lane_data == lane_value_q);
    c_last:  cover (watched == Depth - 1 && main_q && pipe_q && fault_q && stream_q && lane_q && answer_q == '1);
    c_late:  cover (late_q && main_value_q == '1 && answer_q == '0);
    c_kept:  cover (kept_q && away == '1);
    c_later: cover (later_q && stream_q && lane_q && stream_value_q == '1);
  end
endmodule
