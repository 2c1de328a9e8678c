// SPDX-License-Identifier: MIT
// Walks the candidates of a step: own particles, then the halos of -x, +x, -y, +y, -z, +z; every record once for each
// row of own slots. One (record, row) per cycle, or one empty segment left.
module cuboct_streamer #(
  parameter int Axes        = 3,  // 2 or 3
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
  input  logic [Axes:0]          available_i,  // own; x, y, z halos complete
  input  logic [(2*Axes+1)*CountBits-1:0] counts_i,     // by segment
  output logic [2*Axes:0]        pick_o,       // segment, a bit each: own, -x, +x, -y, +y, -z, +z; none if past_o
  output logic [AddrBits-1:0]    addr_o,       // the record's number in its segment
  output logic [SlotBits-1:0]    slot_o,       // addr_o, for the own particles
  output logic [RowBits-1:0]     row_o,        // of own slots
  output logic                   present_o,    // (pick, addr, row) goes to the filter
  output logic                   past_o        // all segments are done
);
  localparam int Segments = 2 * Axes + 1;
  localparam logic [CountBits-1:0] One = 1;
  localparam logic [Segments-1:0] First = 1;
  localparam int RowSlots = CountBits + $clog2(FilterLanes + 1);  // bits of a slot number beyond the last row

  logic [Segments-1:0]  pick_d, pick_q;
  logic [AddrBits-1:0]  record_d, record_q;
  logic [CountBits-1:0] next_d, next_q;            // record_q and 1
  logic [RowBits-1:0]   row_d, row_q;
  logic [RowSlots-1:0]  next_slot_d, next_slot_q;  // first slot of the next row
  logic [CountBits-1:0] count, own;
  logic                 available, skip, go, last_row, last_record;

  integer s;
  always_comb begin
    count     = '0;
    available = 1'b0;
    for (s = 0; s < Segments; s = s + 1) begin
      count     = count | (counts_i[s*CountBits +: CountBits] & {CountBits{pick_q[s]}});
      available = available || (pick_q[s] && available_i[(s+1)/2]);
    end
  end

  assign own         = counts_i[0 +: CountBits];
  assign go          = run_i && !stall_i && available;
  assign skip        = (own == '0) || (count == '0);
  assign last_row    = (next_slot_q >= {{(RowSlots - CountBits) {1'b0}}, own});
  assign last_record = (count == next_q);
  assign present_o   = go && !skip;

  always_comb begin
    pick_d      = pick_q;
    record_d    = record_q;
    next_d      = next_q;
    row_d       = row_q;
    next_slot_d = next_slot_q;
    if (go && skip) begin
      pick_d = pick_q << 1;
    end else if (go && !last_row) begin
      row_d       = row_q + 1'b1;
      next_slot_d = next_slot_q + FilterLanes[RowSlots-1:0];
    end else if (go) begin
      row_d       = '0;
      next_slot_d = FilterLanes[RowSlots-1:0];
      record_d    = next_q[AddrBits-1:0];
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
  assign addr_o    = record_q;
  assign slot_o    = record_q[SlotBits-1:0];
  assign row_o     = row_q;
  assign past_o    = (pick_q == '0);
endmodule
