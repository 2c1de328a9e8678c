// SPDX-License-Identifier: MIT
// The three migration phases. SCAN sends those who leave along the axis and closes the gaps, END closes the streams,
// TAKE_LOW and TAKE_HIGH append what came from below and from above. SCAN is left out where no one leaves. With Early
// the end beats of such a phase go out in the last cycle before it, TAKE_HIGH is left out where all has come from
// above, and slots are written a cycle later: a phase does not end in the cycle after one that takes a particle.
module cuboct_migrate #(
  parameter int Axes         = 3,    // 2 or 3
  parameter int ParticleBits = 128,  // the word that travels
  parameter int PositionBits = 60,   // its least significant field; away of y and z follow, 2 bits each
  parameter int LinkBits     = 32,
  parameter int Capacity     = 16,
  parameter int SlotBits     = 4,    // of a slot's number
  parameter int CountBits    = 5,    // of the number of own particles
  parameter int Early        = 0     // 0, 1
) (
  input  logic                      clk_i,
  input  logic                      rst_ni,
  input  logic                      active_i,         // the machine is in a migration phase
  input  logic [1:0]                axis_i,           // below Axes
  output logic                      done_o,           // last cycle of the phase
  input  logic [1:0]                has_link_i,       // of the axis: below, above
  input  logic                      before_i,         // Early: the last cycle of UPDATE
  // Own particles: a slot is {away_x, particle}.
  input  logic [Axes-1:0]           next_axis_i,      // the next phase is along it
  input  logic [Axes-1:0]           leaving_i,        // by axis, in the cycle before its phase: some particle leaves
                                                      // along it
  input  logic [CountBits-1:0]      count_i,          // how many; in the cycle before the phase it is that of the phase
  input  logic                      full_i,           // count_i is Capacity
  output logic                      count_set_o,      // they are count_o from the next cycle on
  output logic [CountBits-1:0]      count_o,          // with count_set_o
  output logic                      full_o,           // with count_set_o: count_o is Capacity
  output logic                      read_o,           // asks for a slot; without it read_data_i stays
  output logic [SlotBits-1:0]       read_slot_o,      // with read_o: which one; 0 outside of a phase
  input  logic [ParticleBits+1:0]   read_data_i,      // the slot last asked for
  output logic                      write_o,          // a slot is written
  output logic [SlotBits-1:0]       write_slot_o,     // with write_o
  output logic [ParticleBits+1:0]   write_data_o,     // with write_o
  output logic [Axes-1:0]           leaving_more_o,   // axes along which an arrived particle goes on, if it is kept
  output logic [Axes-1:0]           goes_on_o,        // with pop_o: the same, kept or not
  // Links of the axis: below, above.
  input  logic [1:0]                can_load_i,       // whether each link register can take a beat in this cycle
  output logic [1:0]                load_o,           // which link registers take a beat
  output logic                      end_o,            // with load_o: an end beat
  output logic [LinkBits-1:0]       data_o,           // with load_o: payload; 0 unless someone leaves
  input  logic [Axes-1:0]           next_empty_i,     // Early: by axis: both link registers are empty
  output logic [Axes-1:0]           next_load_o,      // by axis: both take an end beat
  // The inbox that is taken from.
  output logic [2*Axes-1:0]         face_o,           // which one, one bit each; none outside of TAKE_LOW and TAKE_HIGH
  // Of the axis: below, above.
  input  logic [1:0]                some_i,           // a particle waits
  input  logic [1:0]                over_i,           // none does, and the end beat came
  input  logic [ParticleBits-1:0]   arrived_i,        // where one waits: the oldest particle of face_o
  output logic                      pop_o,            // it is taken
  // Faults, of the particle in fault_particle_o.
  output logic                      fault_left_o,     // there is no link: it is dropped
  output logic                      fault_full_o,     // no slot is free: it is dropped
  output logic [ParticleBits-1:0]   fault_particle_o  // with either
);
  localparam int AwayBits = 2 * (Axes - 1);  // in a particle's word
  localparam int Beats    = (ParticleBits + LinkBits - 1) / LinkBits;
  localparam int BeatBits = (Beats > 1) ? $clog2(Beats) : 1;
  localparam int LastBeat = Beats - 1;
  localparam int Last     = Capacity - 1;  // slot
  localparam int LastAxis = Axes - 1;

  typedef enum logic [2:0] {Enter, Scan, End, TakeLow, TakeHigh} state_t;

  state_t               state_d, state_q;
  logic                 scans, ends;                       // in Scan, in End, Enter being the first cycle of either
  logic [CountBits-1:0] next_d, next_q, write_d, write_q;  // Scan: the slot after this one, slots kept
  logic [BeatBits-1:0]  beat_d, beat_q;
  logic [1:0]           away;
  logic                 low_d, low_q, high_d, high_q;      // in TakeLow, in TakeHigh
  logic                 some;                              // a particle is taken
  logic                 follows, stays_low;
  logic                 stays, up, linked, loadable, last_beat, advance, last_slot, takes, looks;

  // The first state depends on what the update, or the axis before, found.
  // What depends on the face depends on registers.
  logic [2*Axes-1:0] face_d, face_q;
  logic [Axes-1:0]   quiet;      // by axis: its phase follows, and no one leaves along it
  logic              took_q;     // a particle was taken in the cycle before
  logic              none_q;     // no particle is left, but for one taken in the cycle before
  // What SCAN has counted: a cycle later, as the links' answers come late and no one asks before.
  logic                 scan_set, scan_set_q, scan_full, scan_full_q;
  logic [CountBits-1:0] scan_count, scan_count_q;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) scan_set_q <= 1'b0;
    else scan_set_q <= scan_set;
  end
  always_ff @(posedge clk_i) begin
    took_q       <= some;
    none_q       <= scan_set_q ? (scan_count_q == '0) : (count_i == '0);
    scan_count_q <= scan_count;
    scan_full_q  <= scan_full;
  end
  assign quiet = (~leaving_i | {Axes{none_q}}) & next_empty_i & next_axis_i & {Axes{follows}};
  for (genvar f = 0; f < 2 * Axes; f++) begin : gen_face
    localparam int Axis = f / 2;
    if (f % 2 == 0) begin : gen_low
      assign face_d[f] = quiet[Axis] || (stays_low && axis_i == Axis[1:0]);
    end else begin : gen_high
      assign face_d[f] = high_d && (axis_i == Axis[1:0]);
    end
  end
  always_ff @(posedge clk_i) begin
    if (!rst_ni) face_q <= '0;
    else face_q <= face_d;
  end
  logic leaving_q;
  always_ff @(posedge clk_i) leaving_q <= ((leaving_i & next_axis_i) != '0) && (count_i != '0);
  assign scans = (state_q == Scan) || (state_q == Enter && leaving_q);
  assign ends  = (state_q == End) || (state_q == Enter && !leaving_q);

  // Where the slot that SCAN looks at wants to go.
  integer b;
  always_comb begin
    away = read_data_i[ParticleBits +: 2];
    for (b = 1; b < Axes; b = b + 1) begin
      if (axis_i == b[1:0]) away = read_data_i[PositionBits+2*(b-1) +: 2];
    end
  end
  assign stays     = (away == 2'b00);
  assign up        = !away[1];
  assign linked    = up ? has_link_i[1] : has_link_i[0];
  assign loadable  = up ? can_load_i[1] : can_load_i[0];
  assign last_beat = (beat_q == LastBeat[BeatBits-1:0]);
  assign advance   = stays || !linked || (loadable && last_beat);  // SCAN is done with the slot
  assign last_slot = (next_q == count_i);

  assign takes     = low_q || high_q;
  assign some      = (low_q && some_i[0]) || (high_q && some_i[1]);
  assign done_o    = over_i[1] && (high_q || (Early != 0 && low_q && over_i[0])) && (Early == 0 || !took_q);
  // Whether all is quiet is known late.
  assign follows   = (Early != 0) && (before_i || (done_o && axis_i != LastAxis[1:0]));  // the next phase begins
  assign stays_low = (active_i && ends && can_load_i == 2'b11) || (low_q && !over_i[0]);
  assign low_d     = (quiet != '0) || stays_low;
  assign high_d    = ((low_q && over_i[0]) || high_q) && !done_o;

  // An arrived particle has come to where it goes on this axis.
  logic [AwayBits-1:0] away_on;
  logic [Axes-1:0]     goes_on;
  integer              a;
  always_comb begin
    away_on = arrived_i[PositionBits +: AwayBits];
    goes_on = '0;
    for (a = 1; a < Axes; a = a + 1) begin
      if (axis_i >= a[1:0]) away_on[2*(a-1) +: 2] = 2'b00;
      goes_on[a] = (away_on[2*(a-1) +: 2] != 2'b00);
    end
  end

  always_comb begin
    state_d        = state_q;
    next_d         = next_q;
    write_d        = write_q;
    beat_d         = beat_q;
    load_o         = 2'b00;
    write_o        = 1'b0;
    // Chosen by the state: what arrives comes late in the cycle.
    write_slot_o   = takes ? count_i[SlotBits-1:0] : write_q[SlotBits-1:0];
    write_data_o   = takes
                   ? {2'b00, arrived_i[ParticleBits-1:PositionBits+AwayBits], away_on, arrived_i[PositionBits-1:0]}
                   : read_data_i;
    scan_set       = 1'b0;
    scan_count     = stays ? write_q + 1'b1 : write_q;
    scan_full      = stays && (write_q == Last[CountBits-1:0]);
    count_set_o    = scan_set_q;
    count_o        = scan_count_q;
    full_o         = scan_full_q;
    leaving_more_o = '0;
    pop_o          = some;
    fault_left_o   = 1'b0;
    fault_full_o   = 1'b0;
    next_load_o    = quiet;
    if (active_i) begin
      if (scans) begin
        state_d = Scan;
        if (stays) begin
          write_o = 1'b1;
          write_d = write_q + 1'b1;
        end else if (!linked) begin
          fault_left_o = 1'b1;
        end else if (loadable) begin
          load_o = {up, !up};
          beat_d = last_beat ? '0 : beat_q + 1'b1;
        end
        if (advance) begin
          next_d = next_q + 1'b1;
        end
        if (advance && last_slot) begin
          next_d      = {{(CountBits - 1) {1'b0}}, 1'b1};
          write_d     = '0;
          scan_set    = 1'b1;
          state_d     = End;
        end
      end
      if (ends) begin
        state_d = End;
        if (can_load_i == 2'b11) load_o = 2'b11;
      end
      if (done_o) state_d = Enter;
    end
    if (high_d) state_d = TakeHigh;
    if (low_d) state_d = TakeLow;
    if (some) begin
      write_o      = !full_i;
      count_set_o  = !full_i;
      count_o      = count_i + 1'b1;
      full_o       = (count_i == Last[CountBits-1:0]);
      fault_full_o = full_i;
      if (!full_i) leaving_more_o = goes_on;
    end
  end

  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      state_q <= Enter;
      next_q  <= {{(CountBits - 1) {1'b0}}, 1'b1};
      write_q <= '0;
      beat_q  <= '0;
      low_q   <= 1'b0;
      high_q  <= 1'b0;
    end else begin
      state_q <= state_d;
      next_q  <= next_d;
      write_q <= write_d;
      beat_q  <= beat_d;
      low_q   <= low_d;
      high_q  <= high_d;
    end
  end

  assign face_o           = face_q;
  assign goes_on_o        = goes_on;
  // From registers: whether SCAN goes on is known late; what is read without need is read again before it is looked at.
  assign looks            = active_i && (state_q == Enter || state_q == Scan);
  assign read_o           = !looks || advance;
  assign read_slot_o      = looks ? next_q[SlotBits-1:0] : '0;
  assign fault_particle_o = fault_left_o ? read_data_i[ParticleBits-1:0] : arrived_i;

  logic [LinkBits-1:0] beat;
  cuboct_beat #(.Bits(ParticleBits), .LinkBits(LinkBits), .BeatBits(BeatBits)) u_beat (
    .word_i(read_data_i[ParticleBits-1:0]), .beat_i(beat_q), .data_o(beat)
  );
  assign data_o = scans ? beat : '0;
  assign end_o  = !scans;  // else only end beats are loaded
endmodule
