// SPDX-License-Identifier: MIT
// cuboct_brick_migrate with its walk and its numbers of cells, through any number of phases, for bricks of any extent,
// from any particles and counts, under any stalls and any arrivals. SCAN meets each particle of each cell with leavers
// once, in order, and each stays in its place, is sent whole on its side with the number of its cell in the face, is
// told as `left` where the lattice ends, or is kept for another cell. LAND meets in each cell what came to it once,
// from below before from above, each in order, and appends it with its `away` cleared or tells it as `full`. A watched
// particle, any that is in a slot or that arrives, is followed to where it ends; what the other slots hold and what the
// other arrivals are is any value. Counts are exact.
`include "torn_ram.svh"
module brick_migrate_formal #(
  parameter int Axes     = 2,
  parameter int BrickX   = 2,
  parameter int BrickY   = 1,
  parameter int BrickZ   = 1,
  parameter int Capacity = 1,
  parameter int LinkBits = 8
) (
  input logic        clk_i,
  input logic        begin_i,     // a phase begins
  input logic        watch_i,     // in which the watched particle is there
  input logic [1:0]  axis_i,
  input logic [BrickX*BrickY*BrickZ*$clog2(Capacity+1)-1:0] counts_i, low_i, high_i,  // of cells; what comes to them
  input logic [BrickX*BrickY*BrickZ-1:0] leaving_i,
  input logic [1:0]  can_load_i,
  input logic [1:0]  end_i,       // all has come
  input logic [2*Axes+1:0] data_i,                     // of a slot that is not the watched one
  input logic [4*Axes-1:0] came_i,                     // arrivals that are not the watched one
  input logic [2*$clog2(Capacity+1)-1:0] stray_i,      // counts that say nothing
  input logic [1:0]  none_i
);
  localparam int PositionBits = 1;
  localparam int AwayBits  = 2 * (Axes - 1);
  localparam int ParticleBits = PositionBits + AwayBits + 1;  // x y, away, what follows
  localparam int Longest   = (BrickX > BrickY) ? ((BrickX > BrickZ) ? BrickX : BrickZ)
                                               : ((BrickY > BrickZ) ? BrickY : BrickZ);
  localparam int GridBits  = $clog2(Longest + 2);
  localparam int Cells     = BrickX * BrickY * BrickZ;
  localparam int CellBits  = $clog2(Cells);
  localparam int LayerX    = BrickY * BrickZ;
  localparam int LayerY    = (BrickX + 2) * BrickZ;
  localparam int LayerZ    = (Axes == 3) ? (BrickX + 2) * (BrickY + 2) : 1;
  localparam int LayerXY   = (LayerX > LayerY) ? LayerX : LayerY;
  localparam int TagBits   = $clog2((LayerXY > LayerZ) ? LayerXY : LayerZ);
  localparam int FaceY     = BrickX * BrickZ;
  localparam int FaceZ     = (Axes == 3) ? BrickX * BrickY : 1;
  localparam int FaceXY    = (LayerX > FaceY) ? LayerX : FaceY;
  localparam int FaceBits  = $clog2((FaceXY > FaceZ) ? FaceXY : FaceZ);
  localparam int SlotBits  = (Capacity > 1) ? $clog2(Capacity) : 1;
  localparam int CountBits = SlotBits + 1;
  localparam int Held      = $clog2(Capacity + 1);  // bits of a count as the inputs have it
  localparam int SentBits  = ParticleBits + FaceBits;
  localparam int Beats     = (SentBits + LinkBits - 1) / LinkBits;
  localparam int LastBeat  = Beats - 1;
  localparam int SumBits   = $clog2(Cells * Capacity + 1) + 1;

  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;
  (* anyconst *) logic [3*GridBits-1:0] extent;
  (* anyconst *) logic [1:0]            has_link;  // of the axis
  (* anyconst *) logic [2*Cells-1:0]    exits;     // of each cell, along the axis
  // The watched particle: of a cell's slot, or over a face, the number-th that goes to a cell.
  (* anyconst *) logic                    own;
  (* anyconst *) logic [CellBits-1:0]     w_cell;    // where it is
  (* anyconst *) logic [CellBits-1:0]     w_target;  // to which it goes
  (* anyconst *) logic [SlotBits-1:0]     w_slot;
  (* anyconst *) logic [ParticleBits+1:0] w_value;
  (* anyconst *) logic                    w_above;   // over which face it comes
  (* anyconst *) logic [CountBits-1:0]    w_number;

  // Phases.
  logic             active_q, done, first_q, watch_q;
  logic [1:0]       axis_q, ended_q, ended;
  logic [Cells-1:0] leaving_q;
  logic [Cells*Held-1:0] low_q, high_q;
  always_ff @(posedge clk_i) begin
    if (!running_q) begin
      active_q <= 1'b0;
      first_q  <= 1'b0;
      watch_q  <= 1'b0;
    end else begin
      active_q <= active_q ? !done : begin_i;
      first_q  <= begin_i && !active_q;
    end
    if (!active_q) begin
      axis_q    <= axis_i;
      leaving_q <= leaving_i;
      low_q     <= low_i;
      high_q    <= high_i;
      watch_q   <= running_q && watch_i;
    end
    ended_q <= (!active_q || done) ? 2'b00 : ended;
  end
  assign ended = ended_q | end_i | ~has_link;

  logic [CellBits-1:0]     own_cell, after_cell, next_cell;
  logic [3*TagBits-1:0]    face, after_face;
  logic [2:0]              lows, highs, after_lows, after_highs;
  logic                    advance;
  cuboct_brick_cells #(
    .BrickX(BrickX), .BrickY(BrickY), .GridBits(GridBits), .CellBits(CellBits), .TagBits(TagBits)
  ) u_cells (
    .clk_i, .rst_ni(running_q), .extent_i(extent), .advance_i(advance), .own_o(own_cell), .face_o(face), .low_o(lows),
    .high_o(highs), .after_own_o(after_cell), .after_face_o(after_face), .after_low_o(after_lows),
    .after_high_o(after_highs)
  );
  assign next_cell = advance ? after_cell : own_cell;

  // Where each cell lies along the axis of the phase, and whether it is there.
  logic [Cells-1:0]    there, at_low, at_high;
  logic [CellBits-1:0] stride;
  integer              g;
  always_comb begin
    for (g = 0; g < Cells; g = g + 1) begin
      there[g]   = g % BrickX < extent[0 +: GridBits] && (g / BrickX) % BrickY < extent[GridBits +: GridBits]
                   && g / (BrickX * BrickY) < extent[2*GridBits +: GridBits];
      at_low[g]  = (g % BrickX == 0);
      at_high[g] = (g % BrickX + 1 == extent[0 +: GridBits]);
      if (axis_q == 2'd1) begin
        at_low[g]  = ((g / BrickX) % BrickY == 0);
        at_high[g] = ((g / BrickX) % BrickY + 1 == extent[GridBits +: GridBits]);
      end
      if (axis_q == 2'd2) begin
        at_low[g]  = (g / (BrickX * BrickY) == 0);
        at_high[g] = (g / (BrickX * BrickY) + 1 == extent[2*GridBits +: GridBits]);
      end
    end
    stride = 1;
    if (axis_q == 2'd1) stride = BrickX;
    if (axis_q == 2'd2) stride = BrickX * BrickY;
  end

  // Counts, what comes, exits: what is said of the cell that the walk is in.
  logic [Cells*CountBits-1:0] counts_q;
  logic [CountBits-1:0]       count, new_count, low_asked, high_asked, w_count;
  logic                       count_set, leaving, here_low, here_high, asked_low, asked_high, of_after;
  logic [1:0]                 exit_here;
  logic [CountBits-1:0]       low_target, high_target;
  logic [SumBits-1:0]         low_all, high_all, low_before, high_before;
  integer                     k;
  always_comb begin
    {count, low_asked, high_asked, w_count, low_target, high_target} = '0;
    {leaving, here_low, here_high, asked_low, asked_high, exit_here} = '0;
    {low_all, high_all, low_before, high_before} = '0;
    for (k = 0; k < Cells; k = k + 1) begin
      if (own_cell == k) begin
        count     = counts_q[k*CountBits +: CountBits];
        leaving   = leaving_q[k];
        here_low  = at_low[k];
        here_high = at_high[k];
        exit_here = exits[2*k +: 2];
      end
      if ((of_after ? after_cell : own_cell) == k) begin
        asked_low  = at_low[k];
        asked_high = at_high[k];
        low_asked  = low_q[k*Held +: Held];
        high_asked = high_q[k*Held +: Held];
      end
      if (w_cell == k) w_count = counts_q[k*CountBits +: CountBits];
      if (w_target == k) begin
        low_target  = low_q[k*Held +: Held];
        high_target = high_q[k*Held +: Held];
      end
      low_all  = low_all + low_q[k*Held +: Held];
      high_all = high_all + high_q[k*Held +: Held];
      if (k < w_target) begin
        low_before  = low_before + low_q[k*Held +: Held];
        high_before = high_before + high_q[k*Held +: Held];
      end
    end
  end
  integer u;
  always_ff @(posedge clk_i) begin
    for (u = 0; u < Cells; u = u + 1) begin
      if (!active_q) counts_q[u*CountBits +: CountBits] <= counts_i[u*Held +: Held];
      else if (count_set && own_cell == u) counts_q[u*CountBits +: CountBits] <= new_count;
    end
  end

  // Slots answer in the cycle after the question; an answer stays while the question does.
  logic [SlotBits-1:0]     slot_q, held_slot_q, write_slot;
  logic                    leave, cell_ends;
  logic [CellBits-1:0]     asked_q, held_cell_q;
  logic                    held_q, is_watched;
  logic [ParticleBits+1:0] read_data, data_q, write_data;
  assign is_watched = watch_q && own && asked_q == w_cell && slot_q == w_slot;
  always_comb begin
    read_data = data_i;
    if (held_q && asked_q == held_cell_q && slot_q == held_slot_q) read_data = data_q;
    if (is_watched) read_data = w_value;
  end
  always_ff @(posedge clk_i) begin
    asked_q     <= next_cell;
    if (!running_q) slot_q <= '0;
    else if (leave) slot_q <= cell_ends ? '0 : slot_q + 1'b1;
    held_cell_q <= asked_q;
    held_slot_q <= slot_q;
    held_q      <= active_q;
    data_q      <= read_data;
  end

  // Arrivals: the oldest is shown; they come in the order of the cells that they go to.
  logic [SumBits-1:0]        popped_low_q, popped_high_q;
  logic [1:0]                pop, none;
  logic [2*ParticleBits-1:0] arrived;
  logic [2*CountBits-1:0]    land;
  localparam int Pad = CountBits - Held;
  function automatic logic [CountBits-1:0] wide(input logic [Held-1:0] a);
    wide = a;
  endfunction
  always_comb begin
    arrived = came_i;
    if (watch_q && !own && !w_above && popped_low_q == low_before + w_number) arrived[0 +: ParticleBits] = w_value;
    if (watch_q && !own && w_above && popped_high_q == high_before + w_number)
      arrived[ParticleBits +: ParticleBits] = w_value;
    // What is not final, or of a cell that is not at the face, says nothing.
    land[0 +: CountBits]         = (ended[0] && asked_low) ? low_asked : wide(stray_i[0 +: Held]);
    land[CountBits +: CountBits] = (ended[1] && asked_high) ? high_asked : wide(stray_i[Held +: Held]);
    none = {ended[1] ? high_all == '0 : none_i[1], ended[0] ? low_all == '0 : none_i[0]};
  end
  always_ff @(posedge clk_i) begin
    popped_low_q  <= (!active_q || done) ? '0 : popped_low_q + pop[0];
    popped_high_q <= (!active_q || done) ? '0 : popped_high_q + pop[1];
  end

  logic                    some_leaving;
  assign some_leaving = (leaving_q != '0);
  logic                    write, lands, is_end, left, full;
  logic [1:0]              load;
  logic [LinkBits-1:0]     data;
  logic [Axes-1:0]         more;
  logic [ParticleBits-1:0] told, stored;
  logic                    from_above_said;
  logic [2*Axes-1:0]       all_exits;
  integer                  q;
  always_comb for (q = 0; q < Axes; q = q + 1) all_exits[2*q +: 2] = (axis_q == q) ? exit_here : stray_i[1:0];
  cuboct_brick_migrate #(
    .Axes(Axes), .BrickX(BrickX), .BrickY(BrickY), .BrickZ(BrickZ), .CellBits(CellBits),
    .TagBits(TagBits), .FaceBits(FaceBits), .ParticleBits(ParticleBits), .PositionBits(PositionBits),
    .LinkBits(LinkBits), .Capacity(Capacity), .SlotBits(SlotBits), .CountBits(CountBits)
  ) u_dut (
    .clk_i, .rst_ni(running_q), .active_i(active_q), .axis_i(axis_q), .done_o(done), .advance_o(advance),
    .own_i(own_cell), .face_i(face), .low_i(lows), .high_i(highs), .after_own_i(after_cell), .after_low_i(after_lows),
    .after_high_i(after_highs), .any_leaving_i(some_leaving), .leaving_i(leaving), .exit_i(all_exits), .count_i(count),
    .count_set_o(count_set), .count_o(new_count), .leave_o(leave), .ends_o(cell_ends),
    .away_i({read_data[PositionBits +: AwayBits], read_data[ParticleBits +: 2]}), .read_data_i(read_data),
    .write_o(write), .land_o(lands), .write_slot_o(write_slot), .write_data_o(write_data), .leaving_more_o(more),
    .can_load_i, .load_o(load), .end_o(is_end), .data_o(data), .none_i(none), .ended_i(ended), .of_after_o(of_after),
    .land_count_i(land), .arrived_i(arrived), .pop_o(pop), .fault_left_o(left), .fault_full_o(full),
    .fault_particle_o(told), .from_above_o(from_above_said), .stored_o(stored)
  );
  (* keep *) logic tap_moves;  // a particle goes to another cell

  // What a slot's particle wants along the axis: 0 stays, 1 goes down, 2 goes up.
  function automatic logic [1:0] want_of(input logic [ParticleBits+1:0] slot, input logic [1:0] axis);
    logic [1:0] w;
    begin
      w = slot[ParticleBits +: 2];
      if (axis == 2'd1) w = slot[PositionBits +: 2];
      if (Axes == 3 && axis == 2'd2) w = slot[PositionBits+AwayBits-2 +: 2];
      want_of = (w == 2'b00) ? 2'd0 : w[1] ? 2'd1 : 2'd2;
    end
  endfunction
  logic [1:0]          want, w_want;
  logic                outer, exists, w_outer, w_exists;
  logic [CellBits-1:0] target;
  integer              m, v;
  always_comb begin
    want    = want_of(read_data, axis_q);
    w_want  = want_of(w_value, axis_q);
    outer   = (want == 2'd1) ? here_low : here_high;
    exists  = (want == 2'd1) ? exit_here[0] : exit_here[1];
    target  = (want == 2'd1) ? own_cell - stride : own_cell + stride;
    {w_outer, w_exists} = '0;
    for (m = 0; m < Cells; m = m + 1) begin
      if (w_cell == m) begin
        w_outer  = (w_want == 2'd1) ? at_low[m] : at_high[m];
        w_exists = (w_want == 2'd1) ? exits[2*m] : exits[2*m+1];
      end
    end
    assume (axis_q < Axes);
    assume (extent[0 +: GridBits] >= 1 && extent[0 +: GridBits] <= BrickX);
    assume (extent[GridBits +: GridBits] >= 1 && extent[GridBits +: GridBits] <= BrickY);
    assume (extent[2*GridBits +: GridBits] >= 1 && extent[2*GridBits +: GridBits] <= BrickZ);
    for (v = 0; v < Cells; v = v + 1) begin
      assume (counts_q[v*CountBits +: CountBits] <= Capacity && (there[v] || counts_q[v*CountBits +: CountBits] == '0));
      assume (there[v] || !leaving_q[v]);
      // A cell within has both neighbours; over the brick's face only where there is a link.
      assume (!active_q || !there[v] || (at_low[v] ? has_link[0] || !exits[2*v] : exits[2*v]));
      assume (!active_q || !there[v] || (at_high[v] ? has_link[1] || !exits[2*v+1] : exits[2*v+1]));
      assume (low_q[v*Held +: Held] <= Capacity && high_q[v*Held +: Held] <= Capacity);
      assume (!active_q || low_q[v*Held +: Held] == '0 || (there[v] && at_low[v] && has_link[0]));
      assume (!active_q || high_q[v*Held +: Held] == '0 || (there[v] && at_high[v] && has_link[1]));
      // The flag of a cell is set if anyone leaves it; it may be set besides.
      if (active_q && watch_q && own && w_cell == v && w_want != 2'd0) assume (leaving_q[v]);
      if (active_q && watch_q && own && w_cell == v) assume (there[v]);
      if (active_q && watch_q && !own && w_target == v) assume (there[v] && (w_above ? at_high[v] : at_low[v]));
    end
    if (first_q && watch_q && own) assume ({1'b0, w_slot} < w_count);
    if (active_q && watch_q && own && w_want != 2'd0 && !w_outer) begin
      assume (w_target == ((w_want == 2'd1) ? w_cell - stride : w_cell + stride));
    end
    if (active_q && watch_q && !own) assume (w_number < (w_above ? high_target : low_target));
  end

  // SCAN: slots of this cell handled, and kept; LAND: particles of this cell that have come.
  logic                      scanned_q;        // the end beats were loaded
  logic [CountBits-1:0]      handled_q, kept_q, handled;
  logic [CountBits:0]        landed_q;
  logic                      acts, acted, landing;
  logic [Beats*LinkBits-1:0] parts_q, whole;
  logic [3:0]                beat_q;
  integer                    b;
  always_comb begin
    whole = parts_q;
    for (b = 0; b < Beats; b = b + 1) if (beat_q == b[3:0]) whole[b*LinkBits +: LinkBits] = data;
    acts    = (write && !lands) || left || tap_moves || (load != 2'b00 && !is_end);
    acted   = acts && (load == 2'b00 || beat_q == LastBeat);
    handled = handled_q + acted;
    landing = lands || full;
  end
  always_ff @(posedge clk_i) begin
    parts_q <= whole;
    if (!running_q || !active_q || done) begin
      {scanned_q, handled_q, kept_q, landed_q, beat_q} <= '0;
    end else begin
      if (load != 2'b00 && !is_end) beat_q <= (beat_q == LastBeat) ? '0 : beat_q + 1'b1;
      if (is_end) scanned_q <= 1'b1;
      handled_q <= advance ? '0 : handled;
      kept_q    <= advance ? '0 : kept_q + (write && !lands);
      landed_q  <= advance ? '0 : landed_q + landing;
    end
  end

  // Who goes to the watched one's target from other cells of the brick; what became of the watched one.
  logic [CountBits-1:0] ups_q, downs_q, below, above, index_q;
  logic                 met_q, moved_q, kept_w_q, landed_w_q, now, lands_now, t_low, t_high, from_above, w_leaving;
  logic [SlotBits-1:0]  place_q;
  logic [CountBits:0]   due;
  integer               n;
  always_comb begin
    {t_low, t_high, w_leaving} = '0;
    for (n = 0; n < Cells; n = n + 1) begin
      if (w_target == n) begin
        t_low  = at_low[n];
        t_high = at_high[n];
      end
      if (w_cell == n) w_leaving = leaving_q[n];
    end
    below      = t_low ? low_target : ups_q;
    above      = t_high ? high_target : downs_q;
    from_above = own ? (w_want == 2'd1) : w_above;
    due        = (own ? index_q : w_number) + (from_above ? below : {CountBits{1'b0}});
    now        = acted && watch_q && own && own_cell == w_cell && {1'b0, w_slot} == handled_q;
    lands_now  = landing && watch_q && (own ? moved_q : 1'b1) && own_cell == w_target && landed_q == due;
  end
  always_ff @(posedge clk_i) begin
    if (!running_q || !active_q || done) begin
      {ups_q, downs_q, met_q, moved_q, kept_w_q, landed_w_q, index_q, place_q} <= '0;
      if (running_q && !active_q && watch_i && begin_i) place_q <= w_slot;  // where it is not scanned
    end else begin
      if (tap_moves && target == w_target && want == 2'd2) ups_q <= ups_q + 1'b1;
      if (tap_moves && target == w_target && want == 2'd1) downs_q <= downs_q + 1'b1;
      if (now) begin
        met_q    <= 1'b1;
        moved_q  <= tap_moves;
        kept_w_q <= write;
        index_q  <= (want == 2'd2) ? ups_q : downs_q;
        place_q  <= write_slot;
      end
      if (lands_now) begin
        landed_w_q <= 1'b1;
        place_q    <= write_slot;
      end
    end
  end
  logic [ParticleBits-1:0] kept_as;
  logic [Axes-1:0]         goes_on;
  logic                    stays, is_kept;
  integer                  c;
  always_comb begin
    kept_as = w_value[ParticleBits-1:0];
    goes_on = '0;
    for (c = 1; c < Axes; c = c + 1) begin
      if (axis_q >= c) kept_as[PositionBits+2*(c-1) +: 2] = 2'b00;
      goes_on[c] = (kept_as[PositionBits+2*(c-1) +: 2] != 2'b00);
    end
    stays   = watch_q && own && w_want == 2'd0;
    is_kept = stays && (kept_w_q || !w_leaving);  // in its last place
  end
  logic [CountBits-1:0] w_slots;  // of the cell in which it ends
  integer               d;
  always_comb begin
    w_slots = '0;
    for (d = 0; d < Cells; d = d + 1) begin
      if ((stays ? w_cell : w_target) == d) w_slots = counts_q[d*CountBits +: CountBits];
    end
  end

  // Progress: while the links can load and all has come, no two cycles after one another do nothing.
  logic quiet, quiet_q, again_q, dropped_q;
  assign quiet = active_q && can_load_i == 2'b11 && ended == 2'b11 && !acts && load == 2'b00 && !landing && !advance
                 && !done;
  always_ff @(posedge clk_i) begin
    quiet_q   <= running_q && quiet;
    again_q   <= running_q && (again_q || done);
    dropped_q <= running_q && active_q && !done && (dropped_q || (lands_now && full));
  end

  always_ff @(posedge clk_i) begin
    if (running_q) begin
      a_idle:  assert (active_q || (!acts && !landing && load == 2'b00 && pop == 2'b00 && !advance && !count_set
                                    && !done));
      a_may:   assert ((load & ~can_load_i) == 2'b00 && (!is_end || load == 2'b11));
      a_stage: assert ((!acts || !scanned_q) && (!landing || (scanned_q && ended == 2'b11))
                       && (!is_end || (!scanned_q && data == '0 && beat_q == '0 && handled_q == '0)));
      // SCAN: the slot whose turn it is, as it wants.
      a_turn:  assert (!acts || (leaving && handled_q < count && asked_q == own_cell && {1'b0, slot_q} == handled_q));
      a_stay:  assert (!(acts && want == 2'd0) || (write && !left && !tap_moves && load == 2'b00
                       && {1'b0, write_slot} == kept_q && write_data == read_data));
      a_left:  assert (!(acts && want != 2'd0 && !exists) || (left && !write && !tap_moves && load == 2'b00
                       && told == read_data[ParticleBits-1:0]));
      a_moves: assert (!(acts && want != 2'd0 && exists && !outer) || (tap_moves && !left && !write && load == 2'b00));
      a_sends: assert (!(acts && want != 2'd0 && exists && outer) || (!tap_moves && !left && !write
                       && load == (want == 2'd1 ? 2'b01 : 2'b10)));
      a_sent:  assert (!(acted && load != 2'b00) || (whole[ParticleBits-1:0] == read_data[ParticleBits-1:0]
                       && whole[ParticleBits +: FaceBits] == face[axis_q*TagBits +: FaceBits]));
      a_cell:  assert (scanned_q || !advance || (leaving && count != '0 ? acted && handled == count && count_set
                       && new_count == kept_q + (write && !lands) : !acts && !count_set));
      a_set:   assert (!count_set || (scanned_q ? lands && new_count == count + 1'b1 : advance));
      a_range: assert (!count_set || new_count <= Capacity);
      // LAND: as many as came, appended or told.
      a_landing: assert (!landing || ((pop == 2'b00 || pop == 2'b01 || pop == 2'b10) && !(lands && full)
                         && full == (count == Capacity) && count_set == lands && lands == write));
      a_append: assert (!lands || (write_slot == count[SlotBits-1:0] && write_data[ParticleBits +: 2] == 2'b00));
      a_popped: assert (pop == 2'b00 || landing);
      a_came:  assert (!(scanned_q && advance && own_cell == w_target && watch_q)
                       || landed_q + landing == {1'b0, below} + {1'b0, above});
      a_lands: assert (!lands_now || (full ? told == w_value[ParticleBits-1:0]
                                           : write_data == {2'b00, kept_as} && more == goes_on));
      // The watched one.
      a_once:  assert ((!now || !met_q) && (!lands_now || !landed_w_q));
      a_met:   assert (!is_end || !watch_q || !own || !w_leaving || met_q);
      a_ends:  assert (!done || !watch_q || (own && !moved_q) || landed_w_q || lands_now);
      a_kept:  assert (!is_kept || !write || own_cell != w_cell || write_slot != place_q);
      a_appended: assert (!landed_w_q || dropped_q || !write || own_cell != w_target || write_slot != place_q);
      a_there: assert (!done || !is_kept || {1'b0, place_q} < w_slots);
      a_done:  assert (!done || (active_q && (scanned_q || is_end) && ended == 2'b11
                       && popped_low_q + pop[0] == low_all && popped_high_q + pop[1] == high_all && next_cell == '0));
      a_home:  assert (active_q || own_cell == '0);
      a_leave: assert (advance == (leave && cell_ends));
      a_progress: assert (!(quiet && quiet_q));
      c_stays:  cover (done && is_kept && kept_w_q && again_q && (Capacity == 1 || place_q != w_slot));
      c_moved:  cover (done && landed_w_q && own && !dropped_q);
      c_down:   cover (lands_now && lands && own && w_want == 2'd1 && (Capacity == 1 || due != '0));
      c_sent:   cover (now && load == 2'b10 && w_value[0] && own_cell != '0);
      c_left:   cover (now && left);
      c_full:   cover (lands_now && full && !own);
      c_came:   cover (lands_now && lands && !own && w_above && goes_on == '0 && w_target != '0);
      c_ragged: cover (done && landed_w_q && own_cell == w_target && there != '1);
    end
  end
endmodule
