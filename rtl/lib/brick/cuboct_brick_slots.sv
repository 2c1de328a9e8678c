// SPDX-License-Identifier: MIT
// The particles of a brick, Capacity slots for each cell; ports as in cuboct_slots. An address is cell * Capacity +
// slot, that of a row of lanes cell * rows + row. All answer in the cycle after the question. What is written in cycle
// t can be asked for from t+1 on, but over the main port in t already, as main_written_i says.
module cuboct_brick_slots #(
  parameter int Axes         = 3,    // 2 or 3
  parameter int Bits         = 128,  // width of a particle
  parameter int SeenBits     = 128,  // of these, from the least significant, what the streamer and the pipes need
  parameter int PositionFrac = 20,   // of a position, per axis; positions are least significant
  parameter int FilterFrac   = 8,    // of these, the leading ones that the filter tests
  parameter int IdLsb        = 64,   // where its id starts
  parameter int IdBits       = 8,    // width of the id, >= 1
  parameter int Cells        = 8,    // >= 1
  parameter int CellBits     = 3,    // of a cell's number
  parameter int Capacity     = 16,   // slots of a cell
  parameter int SlotBits     = 4,    // of a slot's number in its cell
  parameter int AddrBits     = 7,    // >= clog2(Cells * Capacity)
  parameter int FilterLanes  = 8,
  parameter int RowAddrBits  = 4,    // >= clog2(Cells * rows)
  parameter int ForcePipes   = 1,
  localparam int CoarseBits  = Axes * FilterFrac
) (
  input  logic                           clk_i,
  input  logic                           write_i,        // a slot is written
  input  logic [CellBits-1:0]            write_cell_i,   // which cell
  input  logic [SlotBits-1:0]            write_slot_i,   // which slot of it
  input  logic [AddrBits-1:0]            write_addr_i,   // of these two
  input  logic [Bits-1:0]                write_data_i,   // the particle
  input  logic [AddrBits-1:0]            main_addr_i,    // in every cycle
  input  logic                           main_written_i, // write_i, of that slot
  output logic [Bits-1:0]                main_data_o,    // of the question before
  input  logic                           away_read_i,    // without it away_o's slot stays
  input  logic [AddrBits-1:0]            away_addr_i,    // with away_read_i
  input  logic                           away_written_i, // write_i, of the slot that away_o is of in the next cycle
  output logic [2*Axes-1:0]              away_o,         // where a slot's particle goes, by axis
  input  logic                           stream_read_i,  // without it stream_data_o and row_data_o stay
  input  logic [AddrBits-1:0]            stream_addr_i,  // with stream_read_i
  output logic [SeenBits-1:0]            stream_data_o,  // leading fields of that slot
  input  logic [RowAddrBits-1:0]         row_i,          // with stream_read_i
  output logic [FilterLanes*CoarseBits-1:0] row_data_o,  // by lane, x lowest
  input  logic [ForcePipes*AddrBits-1:0] pipe_addr_i,    // per pipe, in every cycle
  output logic [ForcePipes*SeenBits-1:0] pipe_data_o,    // per pipe, leading fields
  input  logic [ForcePipes*AddrBits-1:0] fault_addr_i,   // per pipe, in every cycle
  output logic [ForcePipes*IdBits-1:0]   fault_id_o      // per pipe, the id
);
  localparam int Rows  = (Capacity + FilterLanes - 1) / FilterLanes;  // of a cell
  localparam int Depth = Cells * Capacity;
  localparam int IndexBits = $clog2(Cells * Rows);

  // The last particle to land may be the first that the next phase reads.
  logic            same_q;
  logic [Bits-1:0] written_q, main_data;
  always_ff @(posedge clk_i) begin
    same_q <= main_written_i;
    if (write_i) written_q <= write_data_i;
  end
  cuboct_ram #(.Bits(Bits), .Depth(Depth), .AddrBits(AddrBits)) u_main (
    .clk_i, .write_i, .write_addr_i, .write_data_i, .read_i(1'b1), .clear_i(1'b0), .read_addr_i(main_addr_i),
    .read_data_o(main_data)
  );
  assign main_data_o = same_q ? written_q : main_data;
  // The migration does not wait for a block's answer. Tools then take LUTs by themselves, or registers where a device
  // has no LUTs that are memory; asked for LUTs, yosys ends there with an error.
  (* no_rw_check *) logic [2*Axes-1:0] away_mem_q [0:Depth-1];
  localparam int DepthBits = $clog2(Depth);
  logic [2*Axes-1:0] away_d, away_q, write_away;
  assign write_away = {write_data_i[Axes*PositionFrac +: 2*(Axes-1)], write_data_i[Bits-1 -: 2]};
  always_comb begin
    away_d = away_q;
    if (away_read_i) away_d = away_mem_q[away_addr_i[DepthBits-1:0]];
    if (away_written_i) away_d = write_away;
  end
  always_ff @(posedge clk_i) begin
    away_q <= away_d;
  end
  always_ff @(posedge clk_i) begin
    if (write_i) away_mem_q[write_addr_i[DepthBits-1:0]] <= write_away;
  end
  assign away_o = away_q;
  cuboct_ram #(.Bits(SeenBits), .Depth(Depth), .AddrBits(AddrBits)) u_stream (
    .clk_i, .write_i, .write_addr_i, .write_data_i(write_data_i[SeenBits-1:0]), .read_i(stream_read_i), .clear_i(1'b0),
    .read_addr_i(stream_addr_i), .read_data_o(stream_data_o)
  );
  for (genvar f = 0; f < ForcePipes; f++) begin : gen_pipe
    cuboct_ram #(.Bits(SeenBits), .Depth(Depth), .AddrBits(AddrBits)) u_pipe (
      .clk_i, .write_i, .write_addr_i, .write_data_i(write_data_i[SeenBits-1:0]), .read_i(1'b1), .clear_i(1'b0),
      .read_addr_i(pipe_addr_i[f*AddrBits +: AddrBits]), .read_data_o(pipe_data_o[f*SeenBits +: SeenBits])
    );
    cuboct_ram #(.Bits(IdBits), .Depth(Depth), .AddrBits(AddrBits)) u_id (
      .clk_i, .write_i, .write_addr_i, .write_data_i(write_data_i[IdLsb +: IdBits]), .read_i(1'b1), .clear_i(1'b0),
      .read_addr_i(fault_addr_i[f*AddrBits +: AddrBits]), .read_data_o(fault_id_o[f*IdBits +: IdBits])
    );
  end

  // Slot s of a cell lies in bank s % FilterLanes, row s / FilterLanes.
  logic [CoarseBits-1:0]  coarse;
  logic [FilterLanes-1:0] lane;
  logic [RowAddrBits-1:0] cell_row, write_row;
  for (genvar a = 0; a < Axes; a++) begin : gen_coarse
    assign coarse[a*FilterFrac +: FilterFrac] = write_data_i[a*PositionFrac+PositionFrac-FilterFrac +: FilterFrac];
  end
  integer s, row;
  always_comb begin
    lane      = '0;
    row       = 0;
    cell_row  = '0;
    for (s = 0; s < Capacity; s = s + 1) begin
      if (write_slot_i == s[SlotBits-1:0]) begin
        lane[s%FilterLanes] = 1'b1;
        row                 = s / FilterLanes;
        cell_row            = row[RowAddrBits-1:0];
      end
    end
  end
  cuboct_brick_addr #(
    .Factor(Rows), .CellBits(CellBits), .SlotBits(RowAddrBits), .AddrBits(RowAddrBits)
  ) u_write_row (.cell_i(write_cell_i), .slot_i(cell_row), .addr_o(write_row));
  logic unused_row;
  assign unused_row = ^{row, write_row, row_i};
  for (genvar l = 0; l < FilterLanes; l++) begin : gen_bank
    (* no_rw_check *) logic [CoarseBits-1:0] bank_q [0:Cells*Rows-1];
    logic [CoarseBits-1:0] row_q;
    always_ff @(posedge clk_i) begin
      if (write_i && lane[l]) bank_q[write_row[IndexBits-1:0]] <= coarse;
    end
    always_ff @(posedge clk_i) begin
      if (stream_read_i) row_q <= bank_q[row_i[IndexBits-1:0]];
    end
    assign row_data_o[l*CoarseBits +: CoarseBits] = row_q;
  end
endmodule
