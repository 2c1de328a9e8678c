// SPDX-License-Identifier: MIT
// Walks the candidates of a step, segment by segment: own particles, halos by face; every record once for each row of
// own slots. One (record, row) per cycle, or one segment left without a record.
module cuboct_streamer #(
  parameter int Segments    = 7,  // >= 1
  parameter int Arrival     = 0,  // 1: a record may be read before its segment is complete
  parameter int FilterLanes = 8,  // own slots per row
  parameter int RowBits     = 1,  // of a row's number
  parameter int SlotBits    = 4,  // of an own slot's number
  parameter int AddrBits    = 8,  // of a record's number in any segment
  parameter int CountBits   = 8   // of a segment's count
) (
  input  logic                   clk_i,
  input  logic                   rst_ni,
  input  logic                   run_i,        // the force engine's phase
  input  logic                   restart_i,    // its last cycle
  input  logic                   stall_i,      // nothing moves
  input  logic [CountBits-1:0]   own_i,        // own particles
  input  logic [Segments-1:0]    complete_i,   // by segment: all records are there
  input  logic [Segments*CountBits-1:0] counts_i,  // records; Arrival: that are there, else with complete_i
  output logic [Segments-1:0]    pick_o,       // segment, a bit each; none if past_o
  output logic [AddrBits-1:0]    addr_o,       // the record's number in its segment
  output logic [SlotBits-1:0]    slot_o,       // addr_o, for the own particles
  output logic [RowBits-1:0]     row_o,        // of own slots
  output logic                   present_o,    // (pick, addr, row) goes to the filter
  output logic                   past_o        // all segments are done
);
  localparam logic [CountBits-1:0] One = 1;
  localparam logic [Segments-1:0] First = 1;
  localparam int RowSlots = CountBits + $clog2(FilterLanes + 1);  // bits of a slot number beyond the last row

  logic [Segments-1:0]  pick_d, pick_q;
  logic [CountBits-1:0] record_d, record_q;
  logic [CountBits-1:0] next_d, next_q;            // record_q and 1
  logic [RowBits-1:0]   row_d, row_q;
  logic [RowSlots-1:0]  next_slot_d, next_slot_q;  // first slot of the next row
  logic [CountBits-1:0] count;
  logic                 complete, skip, go, last_row, last_record;

  integer s;
  always_comb begin
    count    = '0;
    complete = 1'b0;
    for (s = 0; s < Segments; s = s + 1) begin
      count    = count | (counts_i[s*CountBits +: CountBits] & {CountBits{pick_q[s]}});
      complete = complete || (pick_q[s] && complete_i[s]);
    end
  end

  if (Arrival != 0) begin : gen_arrival
    // There are own particles; they stay from the cycle before a step on.
    logic own_q, there;  // there: a record is to be met
    always_ff @(posedge clk_i) own_q <= (own_i != '0);
    assign there = own_q && (record_q != count);
    assign go    = run_i && !stall_i && (there || complete);
    assign skip  = !there;
  end else begin : gen_phases
    assign go   = run_i && !stall_i && complete;
    assign skip = (own_i == '0) || (count == '0);
  end
  assign last_row    = (next_slot_q >= {{(RowSlots - CountBits) {1'b0}}, own_i});
  assign last_record = ((Arrival == 0) || complete) && (count == next_q);
  assign present_o   = go && !skip;

  always_comb begin
    pick_d      = pick_q;
    record_d    = record_q;
    next_d      = next_q;
    row_d       = row_q;
    next_slot_d = next_slot_q;
    if (go && skip) begin
      pick_d = pick_q << 1;
      if (Arrival != 0) begin  // behind the last record: elsewhere both are what they become
        record_d = '0;
        next_d   = One;
      end
    end else if (go && !last_row) begin
      row_d       = row_q + 1'b1;
      next_slot_d = next_slot_q + FilterLanes[RowSlots-1:0];
    end else if (go) begin
      row_d       = '0;
      next_slot_d = FilterLanes[RowSlots-1:0];
      record_d    = next_q;
      next_d      = next_q + 1'b1;
      if (last_record) begin
        record_d  = '0;
        next_d    = One;
        pick_d    = pick_q << 1;
      end
    end
    if (restart_i) pick_d = First;
  end
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      pick_q      <= First;
      record_q    <= '0;
      next_q      <= One;
      row_q       <= '0;
      next_slot_q <= FilterLanes[RowSlots-1:0];
    end else begin
      pick_q      <= pick_d;
      record_q    <= record_d;
      next_q      <= next_d;
      row_q       <= row_d;
      next_slot_q <= next_slot_d;
    end
  end

  assign pick_o    = pick_q;
  assign addr_o    = record_q[AddrBits-1:0];
  assign slot_o    = record_q[SlotBits-1:0];
  assign row_o     = row_q;
  assign past_o    = (pick_q == '0);
endmodule
