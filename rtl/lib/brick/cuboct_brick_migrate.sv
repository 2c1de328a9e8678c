// SPDX-License-Identifier: MIT
// The migration phases of a brick. SCAN walks the own cells: who leaves over a face of the brick is sent, who goes to
// another cell of it is stored, and the gaps are closed; END closes the streams, WAIT until all that comes has come,
// LAND walks the cells and appends to each what came to it, from below before from above. SCAN and LAND are left out
// where no one leaves, no one came.
module cuboct_brick_migrate #(
  parameter int Axes         = 3,    // 2 or 3
  parameter int BrickX       = 2,
  parameter int BrickY       = 2,
  parameter int BrickZ       = 2,
  parameter int CellBits     = 3,    // of an own cell's number
  parameter int TagBits      = 4,
  parameter int FaceBits     = 2,    // of a cell's number in a face, on the link
  parameter int ParticleBits = 128,  // the word that travels
  parameter int PositionBits = 60,   // its least significant field; away of y and z follow, 2 bits each
  parameter int LinkBits     = 32,
  parameter int Capacity     = 16,   // of a cell
  parameter int SlotBits     = 4,    // of a slot's number in its cell
  parameter int CountBits    = 5
) (
  input  logic                      clk_i,
  input  logic                      rst_ni,
  input  logic                      active_i,         // the machine is in a migration phase
  input  logic [1:0]                axis_i,           // below Axes
  output logic                      done_o,           // last cycle of the phase
  // The walk over the own cells: cuboct_brick_cells.
  output logic                      advance_o,        // to the next cell
  input  logic [CellBits-1:0]       own_i,            // the cell's number,
  input  logic [3*TagBits-1:0]      face_i,           // those in the faces
  input  logic [2:0]                low_i,            // whether it is the lowest along x, y, z
  input  logic [2:0]                high_i,           // whether it is the highest: with all three, the last cell
  input  logic [CellBits-1:0]       after_own_i,      // of the cell after it: its number,
  input  logic [2:0]                after_low_i,      // whether it is the lowest,
  input  logic [2:0]                after_high_i,     // the highest
  // Own particles of the cell: a slot is {away_x, particle}.
  input  logic                      any_leaving_i,    // some particle of the brick leaves its cell along the axis,
  input  logic                      leaving_i,        // one of this cell
  input  logic [2*Axes-1:0]         exit_i,           // faces of the cell over which the lattice has a cell
  input  logic [CountBits-1:0]      count_i,          // particles of the cell
  output logic                      count_set_o,      // they are count_o from the next cycle on
  output logic [CountBits-1:0]      count_o,          // with count_set_o
  // The next cycle's read_data_i is the first slot of the cell after this one with leave_o and ends_o, the next slot
  // with leave_o alone, else the same again.
  output logic                      leave_o,          // the slot is left
  output logic                      ends_o,           // advance_o, with leave_o
  input  logic [2*Axes-1:0]         away_i,           // where the particle of read_data_i goes, by axis
  input  logic [ParticleBits+1:0]   read_data_i,      // as the phase begins, the first cell's first slot
  output logic                      write_o,          // a slot is written
  output logic                      land_o,           // write_o: of a particle that came
  output logic [SlotBits-1:0]       write_slot_o,     // with write_o
  output logic [ParticleBits+1:0]   write_data_o,     // with write_o
  output logic [Axes-1:0]           leaving_more_o,   // axes along which an arrived particle goes on
  // Links of the axis: below, above.
  input  logic [1:0]                can_load_i,       // whether each link register can take a beat in this cycle
  output logic [1:0]                load_o,           // which link registers take a beat
  output logic                      end_o,            // with load_o: an end beat
  output logic [LinkBits-1:0]       data_o,           // with load_o: payload
  // What came over the faces of the axis: below, above.
  input  logic [1:0]                none_i,           // no particle came in this phase
  input  logic [1:0]                ended_i,          // the end beat came
  output logic                      of_after_o,       // asks for the count of the cell after this one, else of this
  input  logic [2*CountBits-1:0]    land_count_i,     // by face: particles that go to the cell asked for
  input  logic [2*ParticleBits-1:0] arrived_i,        // the oldest particle of each face
  output logic [1:0]                pop_o,            // it is taken
  // Faults, of the particle in fault_particle_o.
  output logic                      fault_left_o,     // there is no link: it is dropped
  output logic                      fault_full_o,     // no slot is free: it is dropped
  output logic [ParticleBits-1:0]   fault_particle_o, // with either
  // Whence a particle lands: a face of the axis, or out of the brick's store.
  output logic                      from_above_o,     // else from below
  output logic [ParticleBits-1:0]   stored_o          // the oldest one there
);
  localparam int Cells    = BrickX * BrickY * BrickZ;
  localparam int AwayBits = 2 * (Axes - 1);  // in a particle's word
  localparam int SentBits = ParticleBits + FaceBits;
  localparam int Beats    = (SentBits + LinkBits - 1) / LinkBits;
  localparam int BeatBits = (Beats > 1) ? $clog2(Beats) : 1;
  localparam int LastBeat = Beats - 1;
  localparam int Store    = Cells * Capacity;  // particles between two cells of the brick
  localparam int StoreBits = $clog2(Store + 1);
  localparam int TopStore = Store - 1;

  typedef enum logic [2:0] {Enter, Scan, End, Wait, Land} state_t;

  state_t               state_d, state_q, state;
  logic [CountBits-1:0] read_d, read_q, write_d, write_q;    // Scan: slots read, slots kept; of the cell
  logic [CountBits-1:0] below_d, below_q, above_d, above_q;  // Land: particles that still come to the cell
  logic [BeatBits-1:0]  beat_d, beat_q;
  logic [1:0]           away;
  logic                 visit, stays, up, exists, at_low, at_high, outer, loadable, last_beat, slot_done, last_slot;
  logic                 last_cell;
  logic                 moves;  // to another cell of the brick

  always_comb begin
    state = state_q;
    if (state_q == Enter) begin
      state = End;
      if (any_leaving_i) state = Scan;
    end
  end

  // Where the slot that SCAN looks at wants to go; where the cell lies along the axis.
  integer b;
  logic   asked_low, asked_high;
  logic [CellBits-1:0] stride;
  logic [TagBits-1:0]  face;
  logic [1:0]          exits;
  localparam int StrideZ = BrickX * BrickY;
  always_comb begin
    away       = away_i[1:0];
    at_low     = low_i[0];
    at_high    = high_i[0];
    asked_low  = of_after_o ? after_low_i[0] : low_i[0];
    asked_high = of_after_o ? after_high_i[0] : high_i[0];
    exits      = exit_i[1:0];
    face       = face_i[0 +: TagBits];
    for (b = 1; b < Axes; b = b + 1) begin
      if (axis_i == b[1:0]) begin
        away       = away_i[2*b +: 2];
        at_low     = low_i[b];
        at_high    = high_i[b];
        asked_low  = of_after_o ? after_low_i[b] : low_i[b];
        asked_high = of_after_o ? after_high_i[b] : high_i[b];
        exits      = exit_i[2*b +: 2];
        face       = face_i[b*TagBits +: TagBits];
      end
    end
    stride = 1;
    if (axis_i == 2'd1) stride = BrickX[CellBits-1:0];
    if (axis_i == 2'd2) stride = StrideZ[CellBits-1:0];
  end
  assign visit     = leaving_i && (count_i != '0);
  assign stays     = (away == 2'b00);
  assign up        = !away[1];
  assign exists    = up ? exits[1] : exits[0];
  assign outer     = up ? at_high : at_low;
  assign loadable  = up ? can_load_i[1] : can_load_i[0];
  assign last_beat = (beat_q == LastBeat[BeatBits-1:0]);
  assign slot_done = stays || !exists || !outer || (loadable && last_beat);
  assign last_slot = (read_q + 1'b1 == count_i);
  assign last_cell = (high_i == 3'b111);
  assign leave_o   = active_i && (state == Scan ? !visit || slot_done : state == Land && last_landing);
  assign ends_o    = (state == Land) || !visit || last_slot;
  assign advance_o = leave_o && ends_o;

  // The store of those that stay in the brick: upward ones from its bottom on, downward ones from its top; with counts
  // by the cell that they go to, all of which come from one cell.
  logic [StoreBits-1:0] ups_d, ups_q, downs_d, downs_q, up_read_d, up_read_q, down_read_d, down_read_q;
  logic [StoreBits-1:0] store_write, store_read;
  logic [CountBits-1:0] up_count_d, up_count_q, down_count_d, down_count_q, up_asked, down_asked;
  logic [CellBits-1:0]  asked;
  logic                 none_moved, some_up, some_down, pop_up, pop_down;
  logic [ParticleBits-1:0] stored;
  assign of_after_o = (state_q == Land);
  assign asked      = of_after_o ? after_own_i : own_i;
  cuboct_brick_counts #(.Cells(Cells), .AddrBits(CellBits), .Bits(CountBits), .Reads(1)) u_ups (
    .clk_i, .rst_ni, .clear_i(done_o), .write_i(moves && up), .write_addr_i(own_i + stride),
    .count_i(up_count_q + 1'b1), .addr_i(asked), .count_o(up_asked), .any_o(some_up)
  );
  cuboct_brick_counts #(.Cells(Cells), .AddrBits(CellBits), .Bits(CountBits), .Reads(1)) u_downs (
    .clk_i, .rst_ni, .clear_i(done_o), .write_i(moves && !up), .write_addr_i(own_i - stride),
    .count_i(down_count_q + 1'b1), .addr_i(asked), .count_o(down_asked), .any_o(some_down)
  );
  assign none_moved  = !some_up && !some_down;
  assign store_write = up ? ups_q : downs_q;
  cuboct_ram #(.Bits(ParticleBits), .Depth(Store), .AddrBits(StoreBits)) u_store (
    .clk_i, .write_i(moves), .write_addr_i(store_write), .write_data_i(read_data_i[ParticleBits-1:0]), .read_i(1'b1),
    .clear_i(1'b0), .read_addr_i(store_read), .read_data_o(stored)
  );

  // Landing: from below over the face if the cell is at it, else out of the store; so from above.
  logic [CountBits-1:0] below, above;  // to the cell asked for
  logic                 landing_now, last_landing, from_above, from_face, has_room, next_above;
  assign below        = asked_low ? land_count_i[0 +: CountBits] : up_asked;
  assign above        = asked_high ? land_count_i[CountBits +: CountBits] : down_asked;
  assign from_above   = (below_q == '0);
  assign landing_now  = active_i && (state_q == Land) && !(from_above && above_q == '0);
  assign last_landing = from_above ? (above_q[CountBits-1:1] == '0) : (below_q[CountBits-1:1] == '0 && above_q == '0);
  assign from_face    = from_above ? at_high : at_low;
  assign has_room     = (count_i != Capacity[CountBits-1:0]);
  // Whose turn is next, to ask for it. To a cell at the low end nothing comes out of the store from below: nothing was
  // counted for it, and what the store is asked for is looked at only from above.
  assign next_above = last_landing ? (up_asked == '0) : (below_q[CountBits-1:1] == '0);
  assign pop_up     = landing_now && !from_above && !at_low;
  assign pop_down   = landing_now && from_above && !at_high;
  assign store_read = (state_q != Land || next_above) ? down_read_d : up_read_d;
  always_comb begin
    ups_d       = ups_q;
    downs_d     = downs_q;
    up_read_d   = up_read_q;
    down_read_d = down_read_q;
    if (moves && up) ups_d = ups_q + 1'b1;
    if (moves && !up) downs_d = downs_q - 1'b1;
    if (pop_up) up_read_d = up_read_q + 1'b1;
    if (pop_down) down_read_d = down_read_q - 1'b1;
    if (done_o) begin
      ups_d       = '0;
      downs_d     = TopStore[StoreBits-1:0];
      up_read_d   = '0;
      down_read_d = TopStore[StoreBits-1:0];
    end
  end
  always_comb begin
    up_count_d   = up_count_q;
    down_count_d = down_count_q;
    if (moves && up) up_count_d = up_count_q + 1'b1;
    if (moves && !up) down_count_d = down_count_q + 1'b1;
    if (advance_o) begin
      up_count_d   = '0;
      down_count_d = '0;
    end
  end
  // Those that come to the cell; until LAND, to the first one.
  always_comb begin
    below_d = below_q;
    above_d = above_q;
    if (state_q != Land || advance_o) begin
      below_d = below;
      above_d = above;
    end else if (from_above) begin
      above_d = above_q - 1'b1;
    end else begin
      below_d = below_q - 1'b1;
    end
  end

  // An arrived particle has come to where it goes on this axis.
  logic [ParticleBits-1:0] candidate;
  logic [AwayBits-1:0]     away_on;
  logic [Axes-1:0]         goes_on;
  integer                  a;
  assign candidate = !from_face ? stored : from_above ? arrived_i[ParticleBits +: ParticleBits]
                                                      : arrived_i[0 +: ParticleBits];
  always_comb begin
    away_on = candidate[PositionBits +: AwayBits];
    goes_on = '0;
    for (a = 1; a < Axes; a = a + 1) begin
      if (axis_i >= a[1:0]) away_on[2*(a-1) +: 2] = 2'b00;
      goes_on[a] = (away_on[2*(a-1) +: 2] != 2'b00);
    end
  end

  always_comb begin
    state_d        = state_q;
    read_d         = read_q;
    write_d        = write_q;
    beat_d         = beat_q;
    done_o         = 1'b0;
    load_o         = 2'b00;
    end_o          = 1'b0;
    moves          = 1'b0;
    write_o        = 1'b0;
    land_o         = 1'b0;
    write_slot_o   = write_q[SlotBits-1:0];
    write_data_o   = read_data_i;
    count_set_o    = 1'b0;
    count_o        = write_q;
    leaving_more_o = '0;
    pop_o          = 2'b00;
    fault_left_o   = 1'b0;
    fault_full_o   = 1'b0;
    if (active_i) begin
      unique case (state)
        Scan: begin
          state_d = Scan;
          if (visit) begin
            if (stays) begin
              write_o = 1'b1;
              write_d = write_q + 1'b1;
            end else if (!exists) begin
              fault_left_o = 1'b1;
            end else if (!outer) begin
              moves = 1'b1;
            end else if (loadable) begin
              load_o = {up, !up};
              beat_d = last_beat ? '0 : beat_q + 1'b1;
            end
            if (slot_done) read_d = read_q + 1'b1;
            if (slot_done && last_slot) begin
              read_d      = '0;
              write_d     = '0;
              count_set_o = 1'b1;
              count_o     = stays ? write_q + 1'b1 : write_q;
            end
          end
          if (advance_o && last_cell) state_d = End;
        end
        End: begin
          state_d = End;
          if (can_load_i == 2'b11) begin
            load_o  = 2'b11;
            end_o   = 1'b1;
            state_d = Wait;
          end
        end
        Wait: begin
          if (ended_i == 2'b11) begin
            state_d = Land;
            if (none_moved && none_i == 2'b11) begin
              state_d = Enter;
              done_o  = 1'b1;
            end
          end
        end
        Land: begin
          if (landing_now) begin
            pop_o        = {from_above && at_high, !from_above && at_low};
            land_o       = has_room;
            write_o      = has_room;
            write_slot_o = count_i[SlotBits-1:0];
            write_data_o = {2'b00, candidate[ParticleBits-1:PositionBits+AwayBits], away_on,
                            candidate[PositionBits-1:0]};
            count_set_o  = has_room;
            count_o      = count_i + 1'b1;
            fault_full_o = !has_room;
            if (has_room) leaving_more_o = goes_on;
          end
          if (last_landing && last_cell) begin
            state_d = Enter;
            done_o  = 1'b1;
          end
        end
        default: state_d = Enter;
      endcase
    end
  end

  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      state_q      <= Enter;
      read_q       <= '0;
      write_q      <= '0;
      beat_q       <= '0;
      ups_q        <= '0;
      downs_q      <= TopStore[StoreBits-1:0];
      up_read_q    <= '0;
      down_read_q  <= TopStore[StoreBits-1:0];
      up_count_q   <= '0;
      down_count_q <= '0;
    end else begin
      state_q      <= state_d;
      read_q       <= read_d;
      write_q      <= write_d;
      beat_q       <= beat_d;
      ups_q        <= ups_d;
      downs_q      <= downs_d;
      up_read_q    <= up_read_d;
      down_read_q  <= down_read_d;
      up_count_q   <= up_count_d;
      down_count_q <= down_count_d;
    end
    below_q <= below_d;
    above_q <= above_d;
  end

  assign from_above_o     = from_above;
  assign stored_o         = stored;
  assign fault_particle_o = (state_q == Land) ? candidate : read_data_i[ParticleBits-1:0];

  logic [LinkBits-1:0] beat;
  cuboct_beat #(.Bits(SentBits), .LinkBits(LinkBits), .BeatBits(BeatBits)) u_beat (
    .word_i({face[FaceBits-1:0], read_data_i[ParticleBits-1:0]}), .beat_i(beat_q), .data_o(beat)
  );
  assign data_o = end_o ? '0 : beat;
  logic unused;
  assign unused = ^face;
endmodule
