// SPDX-License-Identifier: MIT
// The three migration phases. SCAN sends those who leave along the axis and closes the gaps, END closes the streams,
// TAKE_LOW and TAKE_HIGH append what came from below and from above. SCAN is left out where no one leaves.
module cuboct_migrate #(
  parameter int Axes         = 3,    // 2 or 3
  parameter int ParticleBits = 128,  // the word that travels
  parameter int PositionBits = 60,   // its least significant field; away of y and z follow, 2 bits each
  parameter int LinkBits     = 32,
  parameter int Capacity     = 16,
  parameter int SlotBits     = 4,    // of a slot's number
  parameter int CountBits    = 5     // of the number of own particles
) (
  input  logic                      clk_i,
  input  logic                      rst_ni,
  input  logic                      active_i,         // the machine is in a migration phase
  input  logic [1:0]                axis_i,           // below Axes
  output logic                      done_o,           // last cycle of the phase
  input  logic [1:0]                has_link_i,       // of the axis: below, above
  // Own particles: a slot is {away_x, particle}.
  input  logic                      leaving_i,        // some particle leaves along the axis
  input  logic [CountBits-1:0]      count_i,          // how many there are
  output logic                      count_set_o,      // they are count_o from the next cycle on
  output logic [CountBits-1:0]      count_o,          // with count_set_o
  output logic [SlotBits-1:0]       read_slot_o,      // of the next cycle's read_data_i
  input  logic [ParticleBits+1:0]   read_data_i,      // the slot of the cycle before's read_slot_o
  output logic                      write_o,          // a slot is written
  output logic [SlotBits-1:0]       write_slot_o,     // with write_o
  output logic [ParticleBits+1:0]   write_data_o,     // with write_o
  output logic [Axes-1:0]           leaving_more_o,   // axes along which an arrived particle goes on
  // Links of the axis: below, above.
  input  logic [1:0]                can_load_i,       // whether each link register can take a beat in this cycle
  output logic [1:0]                load_o,           // which link registers take a beat
  output logic                      end_o,            // with load_o: an end beat
  output logic [LinkBits-1:0]       data_o,           // with load_o: payload
  // FIFOs of the axis: below, above.
  output logic [1:0]                take_o,           // TAKE_LOW, TAKE_HIGH
  input  logic [1:0]                empty_i,          // no particle waits
  input  logic [1:0]                ended_i,          // the end beat came
  input  logic [2*ParticleBits-1:0] arrived_i,        // the oldest particle of each
  output logic [1:0]                pop_o,            // with arrived_i: taken
  // Faults, of the particle in fault_particle_o.
  output logic                      fault_left_o,     // there is no link: it is dropped
  output logic                      fault_full_o,     // no slot is free: it is dropped
  output logic [ParticleBits-1:0]   fault_particle_o  // with either
);
  localparam int AwayBits = 2 * (Axes - 1);  // in a particle's word
  localparam int Beats    = (ParticleBits + LinkBits - 1) / LinkBits;
  localparam int BeatBits = (Beats > 1) ? $clog2(Beats) : 1;
  localparam int LastBeat = Beats - 1;

  typedef enum logic [2:0] {Enter, Scan, End, TakeLow, TakeHigh} state_t;

  state_t               state_d, state_q, state;
  logic [CountBits-1:0] read_d, read_q, write_d, write_q;  // Scan: slots read, slots kept
  logic [CountBits-1:0] next_d, next_q;                    // read_q and 1
  logic [BeatBits-1:0]  beat_d, beat_q;
  logic [1:0]           away;
  logic                 stays, up, linked, loadable, last_beat, advance, last_slot, taking, side, has_room;
  logic [ParticleBits-1:0] candidate;

  // The first state depends on what the update, or the axis before, found.
  always_comb begin
    state = state_q;
    if (state_q == Enter) begin
      state = End;
      if (leaving_i && count_i != '0) state = Scan;
    end
  end

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

  assign side      = (state == TakeHigh);
  assign taking    = active_i && (state == TakeLow || state == TakeHigh) && !(side ? empty_i[1] : empty_i[0]);
  assign candidate = side ? arrived_i[ParticleBits +: ParticleBits] : arrived_i[0 +: ParticleBits];
  assign has_room  = (count_i != Capacity[CountBits-1:0]);

  // An arrived particle has come to where it goes on this axis.
  logic [AwayBits-1:0] away_on;
  logic [Axes-1:0]     goes_on;
  integer              a;
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
    next_d         = next_q;
    write_d        = write_q;
    beat_d         = beat_q;
    done_o         = 1'b0;
    load_o         = 2'b00;
    end_o          = 1'b0;
    write_o        = 1'b0;
    write_slot_o   = write_q[SlotBits-1:0];
    // Chosen by the state: what arrives comes late in the cycle.
    write_data_o   = (state_q == TakeLow || state_q == TakeHigh)
                   ? {2'b00, candidate[ParticleBits-1:PositionBits+AwayBits], away_on, candidate[PositionBits-1:0]}
                   : read_data_i;
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
            read_d = next_q;
            next_d = next_q + 1'b1;
          end
          if (advance && last_slot) begin
            read_d      = '0;
            next_d      = {{(CountBits - 1) {1'b0}}, 1'b1};
            write_d     = '0;
            count_set_o = 1'b1;
            count_o     = stays ? write_q + 1'b1 : write_q;
            state_d     = End;
          end
        end
        End: begin
          state_d = End;
          if (can_load_i == 2'b11) begin
            load_o  = 2'b11;
            end_o   = 1'b1;
            state_d = TakeLow;
          end
        end
        TakeLow: begin
          if (!taking && ended_i[0]) state_d = TakeHigh;
        end
        TakeHigh: begin
          if (!taking && ended_i[1]) begin
            state_d = Enter;
            done_o  = 1'b1;
          end
        end
        default: state_d = Enter;
      endcase
      if (taking) begin
        pop_o        = {side, !side};
        write_slot_o = count_i[SlotBits-1:0];
        write_o      = has_room;
        count_set_o  = has_room;
        count_o      = count_i + 1'b1;
        fault_full_o = !has_room;
        if (has_room) leaving_more_o = goes_on;
      end
    end
  end

  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      state_q <= Enter;
      read_q  <= '0;
      next_q  <= {{(CountBits - 1) {1'b0}}, 1'b1};
      write_q <= '0;
      beat_q  <= '0;
    end else begin
      state_q <= state_d;
      read_q  <= read_d;
      next_q  <= next_d;
      write_q <= write_d;
      beat_q  <= beat_d;
    end
  end

  assign take_o           = {active_i && state == TakeHigh, active_i && state == TakeLow};
  assign read_slot_o      = read_d[SlotBits-1:0];
  assign fault_particle_o = fault_left_o ? read_data_i[ParticleBits-1:0] : candidate;

  logic [LinkBits-1:0] beat;
  cuboct_beat #(.Bits(ParticleBits), .LinkBits(LinkBits), .BeatBits(BeatBits)) u_beat (
    .word_i(read_data_i[ParticleBits-1:0]), .beat_i(beat_q), .data_o(beat)
  );
  assign data_o = end_o ? '0 : beat;
endmodule
