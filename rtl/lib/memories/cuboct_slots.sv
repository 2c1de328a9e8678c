// SPDX-License-Identifier: MIT
// The node's own particles: one write port; read ports for the main machine, the streamer, each force pipe and each
// pipe's fault, each a memory of its own; and the leading bits of the positions once more in one bank per filter lane,
// so that a row of FilterLanes neighbouring slots is read at once. Narrow has the main port alone, for all, and no
// banks. All answer in the cycle after the question. What is
// written in cycle t can be asked for from t+1 on.
module cuboct_slots #(
  parameter int Axes         = 3,    // 2 or 3
  parameter int Bits         = 128,  // width of a particle
  parameter int SeenBits     = 128,  // of these, from the least significant, what the streamer and the pipes need
  parameter int PositionFrac = 20,   // of a position, per axis; positions are least significant
  parameter int FilterFrac   = 8,    // of these, the leading ones that the filter tests
  parameter int IdLsb        = 64,   // where its id starts
  parameter int IdBits       = 8,    // width of the id, >= 1
  parameter int Capacity     = 16,   // slots, >= 1
  parameter int SlotBits     = 4,    // of a slot's number, >= clog2(Capacity)
  parameter int FilterLanes  = 8,    // >= 1
  parameter int RowBits      = 1,    // of a row's number, >= clog2(rows)
  parameter int ForcePipes   = 1,    // >= 1
  parameter int Streamers    = 1,    // 1 or 2; own particles are read by the first, rows by each
  parameter int Narrow       = 0,    // 0, 1
  parameter int Bonds        = 0,    // places of a row of bonds; above 0 a bank holds their partners' ids instead
  parameter int BondLsb      = 0,    // where the row starts in a particle; with the partner's id
  parameter int BondBits     = 1,    // of a place
  localparam int CoarseBits  = (Bonds > 0) ? Bonds * IdBits : Axes * FilterFrac
) (
  input  logic                           clk_i,
  input  logic                           write_i,        // a slot is written
  input  logic [SlotBits-1:0]            write_slot_i,   // which
  input  logic [Bits-1:0]                write_data_i,   // the particle
  input  logic                           main_read_i,    // without it main_data_o stays
  input  logic [SlotBits-1:0]            main_slot_i,    // with main_read_i
  output logic [Bits-1:0]                main_data_o,    // of the question before
  input  logic                           stream_read_i,  // without it stream_data_o stays
  input  logic [SlotBits-1:0]            stream_slot_i,  // with stream_read_i
  output logic [SeenBits-1:0]            stream_data_o,  // leading fields of that slot
  input  logic [Streamers-1:0]           row_read_i,     // by streamer: without it row_data_o stays
  input  logic [Streamers*RowBits-1:0]   row_i,          // with row_read_i
  output logic [Streamers*FilterLanes*CoarseBits-1:0] row_data_o,  // by lane, x lowest
  input  logic [ForcePipes*SlotBits-1:0] pipe_slot_i,    // per pipe, in every cycle
  output logic [ForcePipes*SeenBits-1:0] pipe_data_o,    // per pipe, leading fields
  input  logic [ForcePipes*SlotBits-1:0] fault_slot_i,   // per pipe, in every cycle
  output logic [ForcePipes*IdBits-1:0]   fault_id_o      // per pipe, the id
);
  localparam int Rows = (Capacity + FilterLanes - 1) / FilterLanes;

  cuboct_ram #(.Bits(Bits), .Depth(Capacity), .AddrBits(SlotBits)) u_main (
    .clk_i, .write_i, .write_addr_i(write_slot_i), .write_data_i, .read_i(main_read_i), .clear_i(1'b0),
    .read_addr_i(main_slot_i), .read_data_o(main_data_o)
  );
  if (Narrow != 0) begin : gen_one_port
    assign stream_data_o = main_data_o[SeenBits-1:0];
    assign pipe_data_o   = {ForcePipes{main_data_o[SeenBits-1:0]}};
    assign row_data_o    = '0;
    logic unused_ports;
    assign unused_ports = ^{stream_read_i, stream_slot_i, pipe_slot_i};
  end else begin : gen_ports
    cuboct_ram #(.Bits(SeenBits), .Depth(Capacity), .AddrBits(SlotBits)) u_stream (
      .clk_i, .write_i, .write_addr_i(write_slot_i), .write_data_i(write_data_i[SeenBits-1:0]),
      .read_i(stream_read_i),
      .clear_i(1'b0), .read_addr_i(stream_slot_i), .read_data_o(stream_data_o)
    );
    for (genvar f = 0; f < ForcePipes; f++) begin : gen_pipe
      cuboct_ram #(.Bits(SeenBits), .Depth(Capacity), .AddrBits(SlotBits)) u_pipe (
        .clk_i, .write_i, .write_addr_i(write_slot_i), .write_data_i(write_data_i[SeenBits-1:0]), .read_i(1'b1),
        .clear_i(1'b0),
        .read_addr_i(pipe_slot_i[f*SlotBits +: SlotBits]), .read_data_o(pipe_data_o[f*SeenBits +: SeenBits])
      );
    end
  end
  for (genvar f = 0; f < ForcePipes; f++) begin : gen_id
    cuboct_ram #(.Bits(IdBits), .Depth(Capacity), .AddrBits(SlotBits)) u_id (
      .clk_i, .write_i, .write_addr_i(write_slot_i), .write_data_i(write_data_i[IdLsb +: IdBits]), .read_i(1'b1),
      .clear_i(1'b0), .read_addr_i(fault_slot_i[f*SlotBits +: SlotBits]), .read_data_o(fault_id_o[f*IdBits +: IdBits])
    );
  end

  if (Narrow == 0) begin : gen_banks
    logic [CoarseBits-1:0] coarse;
    if (Bonds > 0) begin : gen_partners
      for (genvar p = 0; p < Bonds; p++) begin : gen_place
        assign coarse[p*IdBits +: IdBits] = write_data_i[BondLsb+p*BondBits +: IdBits];
      end
    end else begin : gen_positions
      for (genvar a = 0; a < Axes; a++) begin : gen_coarse
        assign coarse[a*FilterFrac +: FilterFrac] = write_data_i[a*PositionFrac+PositionFrac-FilterFrac +: FilterFrac];
      end
    end
    for (genvar l = 0; l < FilterLanes; l++) begin : gen_bank
      // Slot s lies in bank s % FilterLanes, row s / FilterLanes.
      logic [CoarseBits-1:0] bank_q [0:Rows-1];
      for (genvar r = 0; r < Rows; r++) begin : gen_row
        localparam int Slot = r * FilterLanes + l;
        if (Slot < Capacity) begin : gen_slot
          always_ff @(posedge clk_i) begin
            if (write_i && write_slot_i == Slot[SlotBits-1:0]) bank_q[r] <= coarse;
          end
        end else begin : gen_none
          always_ff @(posedge clk_i) bank_q[r] <= '0;
        end
      end
      for (genvar s = 0; s < Streamers; s++) begin : gen_streamer
        logic [CoarseBits-1:0] row, row_q;
        if (Rows > 1) begin : gen_read
          assign row = bank_q[row_i[s*RowBits +: $clog2(Rows)]];
          always_ff @(posedge clk_i) begin
            if (row_read_i[s]) row_q <= row;
          end
        end else begin : gen_only
          assign row   = bank_q[0];
          assign row_q = row;
        end
        assign row_data_o[(s*FilterLanes+l)*CoarseBits +: CoarseBits] = row_q;
      end
    end
  end

  logic unused_row;
  assign unused_row = ^{row_i, row_read_i};
endmodule
