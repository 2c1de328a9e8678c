// SPDX-License-Identifier: MIT
// cuboct_migrate with the slots, two link registers and two inboxes of arrivals, through any number of phases, each
// from any slots and count, under any stalls and any arrivals. The slots answer in the cycle after the question; who
// asks for one in the cycle in which it is written gets anything. A watched own particle, any, stays once in its place,
// or is sent once, in its place, on the link of its direction, or is told once as a fault where that link does not
// exist. A watched arrival, any, is appended once in its place or told once as a fault where no slot is free. Early:
// where no one leaves along a phase's axis the end beats may go out in the last cycle before it, which is one of the
// update or the last of the phase before, and do so if both link registers are empty.
module migrate_formal #(
  parameter int Axes     = 2,
  parameter int Capacity = 2,
  parameter int LinkBits = 4,
  parameter int TagBits  = 1,
  parameter int Early    = 0   // 0, 1
) (
  input logic                    clk_i,
  input logic                    begin_i,    // a phase begins
  input logic [1:0]              axis_i,     // its axis,
  input logic                    leaving_i,  // and what the node says of it
  input logic                    set_i,      // between phases: a slot and the count take any value
  input logic [3:0]              set_slot_i,
  input logic [1+2*Axes+TagBits-1:0] set_data_i,
  input logic [3:0]              set_count_i,
  input logic [1+2*Axes+TagBits-1:0] torn_i, // what a slot answers that is written
  input logic [1:0]              ready_i,    // of the neighbours
  input logic [1:0]              arrive_i,   // a particle comes from below, above
  input logic [1:0]              arrived_all_i,
  input logic [2*(2*Axes-1+TagBits)-1:0] arrive_data_i
);
  localparam int PositionBits = 1;
  localparam int AwayBits     = 2 * (Axes - 1);
  localparam int ParticleBits = PositionBits + AwayBits + TagBits;
  localparam int SlotWidth    = ParticleBits + 2;
  localparam int SlotBits     = (Capacity > 1) ? $clog2(Capacity) : 1;
  localparam int CountBits    = $clog2(Capacity + 1) + 1;
  localparam int Beats        = (ParticleBits + LinkBits - 1) / LinkBits;
  localparam int LastBeat     = Beats - 1;

  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;
  (* anyconst *) logic [1:0] has_link;

  // Phases.
  logic       active_q, done, first_q, leaving_q, begins, next_load;
  logic [Axes-1:0] next_axis, next_loads;  // of the phase that follows
  logic [1:0] axis_q;
  localparam int LastAxis = Axes - 1;
  assign next_axis = {{(Axes - 1) {1'b0}}, 1'b1} << axis_i;
  assign next_load = (next_loads != '0);
  assign begins = running_q && begin_i && (!active_q || done);
  // Early: the phases of a step follow one another, the first behind the update.
  always_comb begin
    if (Early != 0 && begins) assume (axis_i == (active_q ? axis_q + 2'd1 : 2'd0));
    if (Early != 0 && begins && !active_q) assume (axis_q == 2'd0);  // in the update, too
    if (Early != 0 && active_q && done) assume (begin_i == (axis_q != LastAxis[1:0]));
  end
  always_ff @(posedge clk_i) begin
    if (!running_q) begin
      active_q <= 1'b0;
      first_q  <= 1'b0;
    end else begin
      active_q <= active_q ? (!done || begin_i) : begin_i;
      first_q  <= begin_i && (!active_q || done);
    end
    if (!active_q || done) begin
      axis_q    <= axis_i;
      leaving_q <= leaving_i;
    end
  end

  // Slots.
  logic [CountBits-1:0]          count_q, new_count;
  logic [Capacity*SlotWidth-1:0] slots_q;
  logic [SlotBits-1:0]           read_slot, write_slot;
  logic [SlotWidth-1:0]          read_data, write_data;
  logic                          count_set, new_full, write, read;
  integer                        r, w;
  // Early: slots are written through a register.
  logic                          stored;
  logic [SlotBits-1:0]           stored_slot;
  logic [SlotWidth-1:0]          stored_data;
  if (Early != 0) begin : gen_stored
    logic                 stored_q;
    logic [SlotBits-1:0]  stored_slot_q;
    logic [SlotWidth-1:0] stored_data_q;
    always_ff @(posedge clk_i) begin
      stored_q      <= running_q && write;
      stored_slot_q <= write_slot;
      stored_data_q <= write_data;
    end
    assign stored      = stored_q;
    assign stored_slot = stored_slot_q;
    assign stored_data = stored_data_q;
  end else begin : gen_stored_at_once
    assign stored      = write;
    assign stored_slot = write_slot;
    assign stored_data = write_data;
  end
  always_ff @(posedge clk_i) begin
    for (r = 0; r < Capacity; r = r + 1) begin
      if (read && read_slot == r[SlotBits-1:0]) read_data <= slots_q[r*SlotWidth +: SlotWidth];
    end
    if (read && stored && stored_slot == read_slot) read_data <= torn_i;
  end
  // Early: in the update no one ceases to leave, nor does the count change.
  logic known_q;
  always_ff @(posedge clk_i) known_q <= leaving_i && count_q != '0;
  always_comb if (Early != 0 && begins && !active_q && known_q) assume (leaving_i && count_q != '0);
  logic [CountBits-1:0] count_before_q;
  always_ff @(posedge clk_i) count_before_q <= count_q;
  always_comb if (Early != 0 && begins && !active_q) assume (count_q == count_before_q);
  // No phase begins in the cycle after the reset.
  logic ran_q = 1'b0;
  always_ff @(posedge clk_i) ran_q <= running_q;
  always_comb if (Early != 0 && begins) assume (ran_q);
  // The slot that is asked for in the cycle before the phase is not written in that cycle, nor does the count change.
  logic sets;
  assign sets = !active_q && set_i;
  always_comb begin
    if (sets && begin_i)
      assume (set_slot_i != {{(4 - SlotBits) {1'b0}}, read_slot} && set_count_i[CountBits-1:0] == count_q);
  end
  always_ff @(posedge clk_i) begin
    if (!running_q) count_q <= '0;
    else if (count_set) count_q <= new_count;
    else if (sets) count_q <= set_count_i[CountBits-1:0];
    for (w = 0; w < Capacity; w = w + 1) begin
      if (stored && stored_slot == w[SlotBits-1:0]) slots_q[w*SlotWidth +: SlotWidth] <= stored_data;
      else if (sets && set_slot_i == w[3:0]) slots_q[w*SlotWidth +: SlotWidth] <= set_data_i;
    end
  end

  // Inboxes, and what came since the clear: a record or an end in one cycle, as the link brings them. Where
  // there is no link nothing comes and the end counts as seen.
  logic [1:0]                empty, pop, full, ended, ended_q, push;
  logic [2*ParticleBits-1:0] arrived;
  logic [2*Axes-1:0]         face;  // taken from
  logic [1:0]                side;
  logic [2*Axes+1:0]         faces;
  logic [ParticleBits-1:0]   taken;
  logic                      pops;
  assign faces = {2'b00, face};
  assign side  = faces[2*axis_q +: 2];
  assign taken = side[1] ? arrived[ParticleBits +: ParticleBits] : arrived[0 +: ParticleBits];
  assign pop   = side & {2{pops}};
  logic [2*CountBits-1:0]    came_q;
  assign ended = ended_q | ~has_link;
  for (genvar f = 0; f < 2; f++) begin : gen_inbox
    assign push[f] = running_q && arrive_i[f] && !ended[f]
        && came_q[f*CountBits +: CountBits] != Capacity[CountBits-1:0];
    cuboct_inbox #(
      .HaloBits(1), .ParticleBits(ParticleBits), .HaloDepth(1), .Capacity(Capacity), .Relayed(0),
      .AddrBits(1), .CountBits(CountBits)
    ) u_inbox (
      .clk_i, .rst_ni(running_q), .clear_i(1'b0), .append_i(1'b0), .halo_i(1'b0), .read_i(1'b0), .next_i(1'b0),
      .addr_i(1'b0), .relay_addr_i(1'b0), .migrating_i(active_q || (Early != 0 && begins)), .push_i(push[f]),
      .particle_i(arrive_data_i[f*ParticleBits +: ParticleBits]), .full_o(full[f]), .pop_i(pop[f]),
      .particle_o(arrived[f*ParticleBits +: ParticleBits]), .empty_o(empty[f])
    );
    always_ff @(posedge clk_i) begin
      if (!running_q || done) begin
        came_q[f*CountBits +: CountBits] <= '0;
        ended_q[f]                       <= 1'b0;
      end else begin
        if (push[f]) came_q[f*CountBits +: CountBits] <= came_q[f*CountBits +: CountBits] + 1'b1;
        if (arrived_all_i[f] && !push[f]) ended_q[f] <= 1'b1;
      end
    end
  end

  logic [1:0]              can_load, load, valid, sent_end;
  logic                    tells_end, is_end, fault_left, fault_full;
  assign is_end = tells_end && (load != 2'b00 || next_load);  // what is not loaded is nothing
  logic [LinkBits-1:0]     data;
  logic [2*LinkBits-1:0]   sent_data;
  logic [ParticleBits-1:0] fault_particle;
  logic [Axes-1:0]         more;
  for (genvar f = 0; f < 2; f++) begin : gen_tx
    cuboct_link_tx #(.LinkBits(LinkBits)) u_tx (
      .clk_i, .rst_ni(running_q), .has_link_i(has_link[f]), .load_i(load[f] || next_load), .end_i(is_end),
      .data_i(data),
      .can_load_o(can_load[f]), .valid_o(valid[f]), .end_o(sent_end[f]),
          .data_o(sent_data[f*LinkBits +: LinkBits]),
      .ready_i(ready_i[f])
    );
  end
  cuboct_migrate #(
    .Axes(Axes), .ParticleBits(ParticleBits), .PositionBits(PositionBits), .LinkBits(LinkBits),
        .Capacity(Capacity),
    .SlotBits(SlotBits), .CountBits(CountBits), .Early(Early)
  ) u_dut (
    .clk_i, .rst_ni(running_q), .active_i(active_q), .axis_i(axis_q), .done_o(done), .has_link_i(has_link),
    .before_i(Early != 0 && begins && !active_q), .next_axis_i(next_axis), .leaving_i({Axes{leaving_i}}),
    .next_empty_i({Axes{valid == 2'b00}}), .next_load_o(next_loads), .count_i(count_q),
    .full_i(count_q == Capacity[CountBits-1:0]), .count_set_o(count_set),
    .count_o(new_count), .full_o(new_full),
    .read_o(read), .read_slot_o(read_slot), .read_data_i(read_data), .write_o(write), .write_slot_o(write_slot),
    .write_data_o(write_data), .leaving_more_o(more), .can_load_i(can_load), .load_o(load), .end_o(tells_end),
    .data_o(data), .face_o(face), .some_i(~empty), .over_i(ended & empty),
    .arrived_i(taken), .pop_o(pops),
    .fault_left_o(fault_left), .fault_full_o(fault_full), .fault_particle_o(fault_particle)
  );

  // What each slot's particle wants when the phase begins: 0 stays, 1 goes down, 2 goes up; how many before
  // the watched one want the same, and how many of all.
  (* anyconst *) logic [3:0] watched;
  logic [1:0]                want, want_w;
  logic [SlotWidth-1:0]      slot;
  logic [CountBits-1:0]      stay_n, down_n, up_n, left_n, stay_w, down_w, up_w, left_w;
  logic [SlotWidth-1:0]      value_w;
  integer                    s;
  always_comb begin
    {stay_n, down_n, up_n, left_n} = '0;
    {stay_w, down_w, up_w, left_w} = '0;
    want_w                         = 2'd0;
    value_w                        = '0;
    slot                           = '0;
    want                           = 2'd0;
    for (s = 0; s < Capacity; s = s + 1) begin
      slot = slots_q[s*SlotWidth +: SlotWidth];
      want = slot[ParticleBits +: 2];
      if (axis_q == 2'd1) want = slot[PositionBits +: 2];
      if (Axes == 3 && axis_q == 2'd2) want = slot[PositionBits+AwayBits-2 +: 2];
      want = (want == 2'b00) ? 2'd0 : want[1] ? 2'd1 : 2'd2;
      if (watched == s[3:0]) begin
        value_w = slot;
        want_w  = want;
        stay_w  = stay_n;
        down_w  = down_n;
        up_w    = up_n;
        left_w  = left_n;
      end
      if (s[CountBits-1:0] < count_q) begin
        if (want == 2'd0) stay_n = stay_n + 1'b1;
        else if (want == 2'd1 ? !has_link[0] : !has_link[1]) left_n = left_n + 1'b1;
        else if (want == 2'd1) down_n = down_n + 1'b1;
        else up_n = up_n + 1'b1;
      end
    end
  end
  always_comb begin
    assume (axis_q < Axes[1:0]);
    assume (count_q <= Capacity[CountBits-1:0]);
    assume (watched < Capacity[3:0]);
    // The node's flag is set if anyone leaves; it may be set besides.
    if (first_q && (down_n != '0 || up_n != '0 || left_n != '0)) assume (leaving_q);
  end

  // The plan of the phase, from its first cycle on.
  logic                 is_q, is;
  logic [1:0]           want_q, wanted;
  logic [CountBits-1:0] stays_q, downs_q, ups_q, lefts_q, place_q, stays, downs, ups, lefts, place;
  logic [SlotWidth-1:0] value_q, value;
  assign is     = first_q ? (watched < {{(4 - CountBits) {1'b0}}, count_q}) : is_q;
  assign wanted = first_q ? want_w : want_q;
  assign value  = first_q ? value_w : value_q;
  assign stays  = first_q ? stay_n : stays_q;
  assign downs  = first_q ? down_n : downs_q;
  assign ups    = first_q ? up_n : ups_q;
  assign lefts  = first_q ? left_n : lefts_q;
  logic leaves_w;  // where no link is
  assign leaves_w = (want_w == 2'd1) ? !has_link[0] : (want_w == 2'd2) && !has_link[1];
  assign place    = first_q ? (leaves_w ? left_w : (want_w == 2'd0) ? stay_w : (want_w == 2'd1)
      ? down_w : up_w) : place_q;
  logic linked;
  assign linked = (wanted == 2'd1) ? has_link[0] : has_link[1];
  always_ff @(posedge clk_i) begin
    is_q    <= is;
    want_q  <= wanted;
    value_q <= value;
    stays_q <= stays;
    downs_q <= downs;
    ups_q   <= ups;
    lefts_q <= lefts;
    place_q <= place;
  end

  // What was done so far in this phase.
  logic [CountBits-1:0]      down_q, up_q, left_q, full_q;
  logic [Beats*LinkBits-1:0] parts_q, whole;
  logic [3:0]                beat_q;
  logic                      record, ended_both_q;
  logic [Axes-1:0]           more_q;
  integer                    b;
  always_comb begin
    whole = parts_q;
    for (b = 0; b < Beats; b = b + 1) begin
      if (beat_q == b[3:0]) whole[b*LinkBits +: LinkBits] = data;
    end
  end
  assign record = (load != 2'b00) && !is_end && (beat_q == LastBeat[3:0]);
  always_ff @(posedge clk_i) begin
    parts_q <= whole;
    if (!running_q || !active_q || done) begin
      down_q       <= '0;
      up_q         <= '0;
      left_q       <= '0;
      full_q       <= '0;
      beat_q       <= '0;
      ended_both_q <= running_q && next_load;
      more_q       <= '0;
    end else begin
      if (load != 2'b00 && !is_end) beat_q <= record ? '0 : beat_q + 1'b1;
      if (record && load[0]) down_q <= down_q + 1'b1;
      if (record && load[1]) up_q <= up_q + 1'b1;
      if (fault_left) left_q <= left_q + 1'b1;
      if (fault_full) full_q <= full_q + 1'b1;
      if (is_end) ended_both_q <= 1'b1;
      more_q <= more_q | more;
    end
  end

  // The watched arrival.
  (* anyconst *) logic                 above;
  (* anyconst *) logic [CountBits-1:0] number;
  logic                                came_w_q;
  logic [ParticleBits-1:0]             arrival_q, kept_as;
  logic [CountBits+1:0]                arrival_place, total;
  integer                              c;
  always_ff @(posedge clk_i) begin
    if (!running_q || done) begin
      came_w_q <= 1'b0;
    end else if (push[above] && (above ? came_q[CountBits +: CountBits] : came_q[0 +: CountBits])
        == number) begin
      came_w_q  <= 1'b1;
      arrival_q <= above ? arrive_data_i[ParticleBits +: ParticleBits] : arrive_data_i[0 +: ParticleBits];
    end
  end
  assign arrival_place = {2'b00, stays} + {2'b00, number} + (above ? {2'b00, came_q[0 +: CountBits]} : '0);
  assign total         = {2'b00, stays} + {2'b00, came_q[0 +: CountBits]} + {2'b00,
      came_q[CountBits +: CountBits]};
  always_comb begin
    kept_as = arrival_q;  // it has arrived along this axis and those before
    for (c = 1; c < Axes; c = c + 1) begin
      if (axis_q >= c[1:0]) kept_as[PositionBits+2*(c-1) +: 2] = 2'b00;
    end
  end
  logic [SlotWidth-1:0] at_place, at_arrival;
  integer               p;
  always_comb begin
    at_place   = '0;
    at_arrival = '0;
    for (p = 0; p < Capacity; p = p + 1) begin
      if (place == p[CountBits-1:0]) at_place = slots_q[p*SlotWidth +: SlotWidth];
      if (arrival_place == p[CountBits+1:0]) at_arrival = slots_q[p*SlotWidth +: SlotWidth];
    end
  end
  logic room;
  assign room = (arrival_place < Capacity[CountBits+1:0]);

  // Progress: while both links can load and all has arrived, no two cycles after one another do nothing; what
  // can be done is bounded by slots and arrivals.
  logic quiet, quiet_q;
  assign quiet = active_q && can_load == 2'b11 && ended == 2'b11 && load == 2'b00 && !write && !count_set
                 && pop == 2'b00 && !fault_left && !done;
  always_ff @(posedge clk_i) quiet_q <= running_q && quiet;

  logic again_q;  // a second phase
  always_ff @(posedge clk_i) again_q <= running_q && (again_q || done);

  logic stays_watched, arrival_goes_on;
  assign stays_watched = is && wanted == 2'd0;
  integer g;
  always_comb begin
    arrival_goes_on = 1'b1;  // each later axis that it goes on along was told
    for (g = 1; g < Axes; g = g + 1) begin
      if (axis_q < g[1:0] && arrival_q[PositionBits+2*(g-1) +: 2] != 2'b00
          && !more_q[g]) arrival_goes_on = 1'b0;
    end
  end
  always_ff @(posedge clk_i) begin
    if (running_q) begin
      a_idle:  assert (active_q || (!write && !count_set && load == 2'b00 && pop == 2'b00 && !fault_left
          && !fault_full));
      a_may:   assert ((load & ~can_load) == 2'b00);
      a_one:   assert (!is_end ? (load != 2'b11) : next_load ? (load == 2'b00) : (load == 2'b11));
      a_face:  assert ((face & ~({{(2 * Axes - 2) {1'b0}}, 2'b11} << {axis_q, 1'b0})) == '0 && side != 2'b11
                       && (active_q || face == '0));
      a_pop:   assert ((pop & empty) == 2'b00);
      a_fifo:  assert ((push & full) == 2'b00);
      a_full_set: assert (!count_set || new_full == (new_count == Capacity[CountBits-1:0]));
      a_range: assert (!count_set || new_count <= Capacity[CountBits-1:0]);
      if (record && is && wanted == 2'd1 && load[0] && down_q == place) begin
        a_sent_down: assert (whole[ParticleBits-1:0] == value[ParticleBits-1:0]);
      end
      if (record && is && wanted == 2'd2 && load[1] && up_q == place) begin
        a_sent_up: assert (whole[ParticleBits-1:0] == value[ParticleBits-1:0]);
      end
      if (fault_left && is && wanted != 2'd0 && !linked && left_q == place) begin
        a_left: assert (fault_particle == value[ParticleBits-1:0]);
      end
      if (is_end && !next_load) a_end: assert (data == '0 && beat_q == '0 && !ended_both_q && down_q == downs && up_q
          == ups);
      // The early end beats: of a phase that begins, along which no one leaves, if both link registers are empty.
      a_early: assert (next_load == (Early != 0 && begins && (!leaving_i || count_q == '0) && valid == 2'b00));
      if (next_load) a_early_end: assert (is_end && data == '0 && beat_q == '0);
      if (first_q && ended_both_q) a_no_one: assert (downs == '0 && ups == '0 && lefts == '0);
      if (ended_both_q && load != 2'b00) a_after: assert (0);
      if (fault_full && came_w_q && !room && {2'b00, full_q} == arrival_place - Capacity[CountBits+1:0]) begin
        a_full: assert (fault_particle == arrival_q && above == pop[1]);
      end
      if (done) begin
        a_done:   assert (active_q && ended_both_q && ended == 2'b11 && empty == 2'b11);
        a_count:  assert ({2'b00, count_q} == ((total < Capacity[CountBits+1:0])
            ? total : Capacity[CountBits+1:0]));
        a_lefts:  assert (left_q == lefts && down_q == downs && up_q == ups);
        a_fulls:  assert ({2'b00, full_q} == total - {2'b00, count_q});
        if (stays_watched) a_kept: assert (at_place == value);
        if (came_w_q && room) begin
          a_appended: assert (at_arrival == {2'b00, kept_as});
          a_goes_on:  assert (arrival_goes_on);
        end
        c_early:   cover (Early == 0 || (first_q && axis_q == LastAxis[1:0]));
        c_still:   cover ((Early != 0 || quiet_q) && stays != '0 && came_w_q);
        c_crowded: cover (fault_full || full_q != '0);
        c_swap:    cover (down_q != '0 && came_w_q && room && count_q == Capacity[CountBits-1:0]);
        c_left:    cover (left_q != '0);
        c_kept:    cover (stays_watched && (Capacity == 1 || place != watched[CountBits-1:0]));
        c_again:   cover (again_q && up_q != '0 && axis_q == 2'd1);
      end
      a_progress: assert (!(quiet && quiet_q));
    end
  end
endmodule
