// SPDX-License-Identifier: MIT
// The node's own particles: one write port; read ports without latency for the main machine, the streamer, each force
// pipe and each pipe's fault; and the positions once more in one bank per filter lane, so that a row of FilterLanes
// neighbouring slots is read at once. What is written in cycle t is read from t+1 on.
module cuboct_slots #(
  parameter int Bits        = 128,  // width of a particle
  parameter int PosBits     = 60,   // of its position, which is least significant
  parameter int IdLsb       = 64,   // where its id starts
  parameter int IdBits      = 8,    // width of the id, >= 1
  parameter int Capacity    = 16,   // slots, >= 1
  parameter int SlotBits    = 4,    // of a slot's number, >= clog2(Capacity)
  parameter int FilterLanes = 8,    // >= 1
  parameter int RowBits     = 1,    // of a row's number, >= clog2(rows)
  parameter int ForcePipes  = 1     // >= 1
) (
  input  logic                           clk_i,
  input  logic                           write_i,
  input  logic [SlotBits-1:0]            write_slot_i,
  input  logic [Bits-1:0]                write_data_i,
  input  logic [SlotBits-1:0]            main_slot_i,
  output logic [Bits-1:0]                main_data_o,
  input  logic [SlotBits-1:0]            stream_slot_i,
  output logic [Bits-1:0]                stream_data_o,
  input  logic [ForcePipes*SlotBits-1:0] pipe_slot_i,
  output logic [ForcePipes*Bits-1:0]     pipe_data_o,
  input  logic [ForcePipes*SlotBits-1:0] fault_slot_i,
  output logic [ForcePipes*IdBits-1:0]   fault_id_o,
  input  logic [RowBits-1:0]             row_i,
  output logic [FilterLanes*PosBits-1:0] row_data_o
);
  localparam int IndexBits = (Capacity > 1) ? $clog2(Capacity) : 1;
  localparam int Rows      = (Capacity + FilterLanes - 1) / FilterLanes;

  logic [Bits-1:0] mem_q [0:Capacity-1];
  always_ff @(posedge clk_i) begin
    if (write_i) mem_q[write_slot_i[IndexBits-1:0]] <= write_data_i;
  end
  assign main_data_o   = mem_q[main_slot_i[IndexBits-1:0]];
  assign stream_data_o = mem_q[stream_slot_i[IndexBits-1:0]];

  logic [IdBits-1:0] id_q [0:Capacity-1];
  always_ff @(posedge clk_i) begin
    if (write_i) id_q[write_slot_i[IndexBits-1:0]] <= write_data_i[IdLsb +: IdBits];
  end
  for (genvar f = 0; f < ForcePipes; f++) begin : gen_pipe
    assign pipe_data_o[f*Bits +: Bits]    = mem_q[pipe_slot_i[f*SlotBits +: IndexBits]];
    assign fault_id_o[f*IdBits +: IdBits] = id_q[fault_slot_i[f*SlotBits +: IndexBits]];
  end

  for (genvar l = 0; l < FilterLanes; l++) begin : gen_bank
    // Slot s lies in bank s % FilterLanes, row s / FilterLanes.
    logic [PosBits-1:0] bank_q [0:Rows-1];
    for (genvar r = 0; r < Rows; r++) begin : gen_row
      localparam int Slot = r * FilterLanes + l;
      if (Slot < Capacity) begin : gen_slot
        always_ff @(posedge clk_i) begin
          if (write_i && write_slot_i == Slot[SlotBits-1:0]) bank_q[r] <= write_data_i[PosBits-1:0];
        end
      end else begin : gen_none
        always_ff @(posedge clk_i) bank_q[r] <= '0;
      end
    end
    if (Rows > 1) begin : gen_read
      assign row_data_o[l*PosBits +: PosBits] = bank_q[row_i[$clog2(Rows)-1:0]];
    end else begin : gen_only
      assign row_data_o[l*PosBits +: PosBits] = bank_q[0];
    end
  end

  logic unused_addr;
  assign unused_addr = ^{row_i, main_slot_i, stream_slot_i, pipe_slot_i, fault_slot_i};
endmodule
