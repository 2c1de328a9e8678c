// SPDX-License-Identifier: MIT
// cuboct_word_halos, the two faces of one axis linked: a halo of either, any of those there, is in the record
// register, its sign moved on, once its words were asked for one after the other and shifted in. In TAKE each
// particle of a face is shown once, in order, whole, in the cycle MigrateBeats + 2 of its reading, never another.
// Ends are told from the cycle after they came until they are cleared, of particles only when all were shown; counts
// are exact.
module word_halos_formal #(
  parameter int Axis         = 0,
  parameter int Capacity     = 1,
  parameter int LinkBits     = 2,
  parameter int RestBits     = 0,  // of a halo record, behind its position
  parameter int ParticleBits = 3
) (
  input logic                  clk_i,
  input logic [1:0]            valid_i, end_i,
  input logic [2*LinkBits-1:0] data_i,
  input logic                  clear_i,
  input logic [1:0]            migrate_clear_i,
  input logic                  read_i,         // start to read the watched halo
  input logic                  set_i,
  input logic [3+RestBits:0]   set_halo_i,
  input logic                  take_i,         // start to take of a face
  input logic                  take_high_i,    // which one
  input logic                  migrating_i,
  input logic [7:0]            any_word_i
);
  localparam int HaloBits      = 4 + RestBits;  // x[3] y[1]: two axes, one bit of fraction
  localparam int HaloBeats     = (HaloBits + LinkBits - 1) / LinkBits;
  localparam int ParticleBeats = (ParticleBits + LinkBits - 1) / LinkBits;
  localparam int First         = Capacity * ParticleBeats;
  localparam int Depth         = ((Axis == 0) ? 1 : 3) * Capacity;
  localparam int WordBits      = $clog2(First + 3 * Capacity * HaloBeats) + 1;
  localparam int CountBits     = 4;
  localparam int SignLsb       = 1;  // of x; y has none on the link
  localparam int Shown         = ParticleBeats + 1;

  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;
  (* anyconst *) logic                 high;    // the watched face of the axis
  (* anyconst *) logic [CountBits-1:0] number;  // the watched halo, and particle, of it

  // What came over either face.
  logic [2*CountBits-1:0] halos, held, popped;
  logic [1:0]             halo_ended, particles_ended, started, pop;
  logic [2*HaloBits-1:0]     halo;
  logic [2*ParticleBits-1:0] particle;
  for (genvar f = 0; f < 2; f++) begin : gen_face
    word_stream #(
      .LinkBits(LinkBits), .HaloBits(HaloBits), .ParticleBits(ParticleBits), .HaloDepth(Depth), .Capacity(Capacity),
      .CountBits(CountBits)
    ) u_stream (
      .clk_i, .running_i(running_q), .number_i(number), .valid_i(valid_i[f]), .end_i(end_i[f]),
      .data_i(data_i[f*LinkBits +: LinkBits]), .clear_i, .migrate_clear_i(migrate_clear_i[f]), .pop_i(pop[f]),
      .halos_o(halos[f*CountBits +: CountBits]), .held_o(held[f*CountBits +: CountBits]),
      .popped_o(popped[f*CountBits +: CountBits]), .halo_ended_o(halo_ended[f]), .ended_o(particles_ended[f]),
      .halo_o(halo[f*HaloBits +: HaloBits]), .particle_o(particle[f*ParticleBits +: ParticleBits])
    );
  end
  logic [CountBits-1:0] here_halos, turn_held, turn_popped;
  assign here_halos  = high ? halos[CountBits +: CountBits] : halos[0 +: CountBits];

  // Reading a halo: its words one after the other, each shifted in a cycle later; FORCE and EXCHANGE do. Taking of a
  // face, until all that came was shown. Not both; and a halo may be read again before the clear.
  logic [3:0] step_q, step;  // words asked for, 0 where nothing is read
  logic       reads, last_word, has_q, set_q, taking, taking_q, turn, turn_q, take_over, shift;
  logic [HaloBits-1:0] set_halo_q;
  assign step      = step_q;
  assign reads     = (step != '0) || (read_i && !taking);
  assign shift     = (step != '0);
  assign last_word = (step == HaloBeats[3:0]);
  assign taking    = running_q && (taking_q || take_i);
  assign turn      = taking_q ? turn_q : take_high_i;
  logic [3:0]          halo_end, migrate_end, face;
  logic [WordBits-1:0] word;
  logic                valid;
  always_comb begin
    if (!running_q) assume (!read_i && !take_i && !set_i);
    if (read_i) assume (!taking && step == '0 && number < here_halos && !clear_i);
    if (step != '0) assume (!take_i && !clear_i);
    if (taking) assume (migrating_i);
    if (reads) assume (!migrating_i);
    if (reads || taking) assume (!set_i);
    if (migrate_clear_i[0]) assume (migrate_end[2*Axis]);
    if (migrate_clear_i[1]) assume (migrate_end[2*Axis+1]);
    if (take_i && !taking_q) assume (!(take_high_i ? migrate_clear_i[1] : migrate_clear_i[0]));
    face = 4'd0;
    if (reads) face = high ? 4'd2 << (2 * Axis) : 4'd1 << (2 * Axis);
    if (taking) face = turn ? 4'd2 << (2 * Axis) : 4'd1 << (2 * Axis);
    word = any_word_i[WordBits-1:0];
    if (reads && !last_word) word = First[WordBits-1:0] + number * HaloBeats[WordBits-1:0] + step;
    pop = 2'b00;
    if (valid) pop = turn ? 2'b10 : 2'b01;
  end
  assign take_over = turn ? migrate_end[2*Axis+1] : migrate_end[2*Axis];
  always_ff @(posedge clk_i) begin
    step_q     <= (!running_q || last_word) ? '0 : reads ? step + 1'b1 : '0;
    taking_q   <= taking && !take_over;
    turn_q     <= turn;
    set_q      <= set_i;
    set_halo_q <= set_halo_i;
    has_q      <= running_q && !reads && !taking && !set_i && has_q && !clear_i;
    if (running_q && last_word) has_q <= 1'b1;
  end

  logic [HaloBits-1:0]     record;
  logic [ParticleBits-1:0] shown;
  logic [4*CountBits-1:0]  count;
  logic [3:0]              ready;
  logic [LinkBits-1:0]     word_o;
  cuboct_word_halos #(
    .Axes(2), .PositionFrac(1), .Capacity(Capacity), .LinkBits(LinkBits), .HaloBits(HaloBits),
    .ParticleBits(ParticleBits), .CountBits(CountBits), .WordBits(WordBits)
  ) u_dut (
    .clk_i, .rst_ni(running_q), .has_link_i((Axis == 0) ? 4'b0011 : 4'b1100), .link_valid_i({2{valid_i}}),
    .link_end_i({2{end_i}}), .link_data_i({2{data_i}}), .link_ready_o(ready), .halo_clear_i(clear_i),
    .halo_end_o(halo_end),
    .halo_count_o(count), .word_i(word), .face_i(face), .word_o(word_o), .shift_i(shift), .set_i, .halo_i(set_halo_i),
    .halo_o(record), .migrating_i, .taking_i(taking), .migrate_clear_i({2{migrate_clear_i}}),
    .migrate_end_o(migrate_end),
    .particle_valid_o(valid), .particle_o(shown), .pop_i(valid)
  );

  // The watched halo, a node further: one less from below, one more from above; and for how long a particle is read.
  logic [HaloBits-1:0] came, moved;
  logic [3:0]          reading_q;
  logic                some;
  assign came        = high ? halo[HaloBits +: HaloBits] : halo[0 +: HaloBits];
  assign turn_held   = turn ? held[CountBits +: CountBits] : held[0 +: CountBits];
  assign turn_popped = turn ? popped[CountBits +: CountBits] : popped[0 +: CountBits];
  assign some        = taking && turn_held != '0;
  always_comb begin
    moved = came;
    if (Axis == 0) moved[SignLsb +: 2] = high ? came[SignLsb +: 2] + 2'd1 : came[SignLsb +: 2] - 2'd1;
  end
  always_ff @(posedge clk_i) reading_q <= (running_q && some && !valid) ? reading_q + 1'b1 : '0;

  // Helpers.
  localparam int StepBits = $clog2(ParticleBeats + 2);
  (* keep *) logic [StepBits-1:0] tap_step;
  (* keep *) logic [WordBits-1:0] tap_read;
  always_ff @(posedge clk_i) begin
    if (running_q) begin
      a_halo:     assert (!has_q || record == moved);
      a_set:      assert (!set_q || record == set_halo_q);
      a_shown:    assert (valid == (some && reading_q == Shown[3:0]));
      a_particle: assert (!(valid && turn == high && turn_popped == number)
                          || shown == (high ? particle[ParticleBits +: ParticleBits] : particle[0 +: ParticleBits]));
      a_ends:     assert (halo_end[2*Axis +: 2] == halo_ended && halo_end[2-2*Axis +: 2] == 2'b11);
      a_all:      assert (migrate_end[2*Axis] == (particles_ended[0] && held[0 +: CountBits] == '0)
                          && migrate_end[2*Axis+1] == (particles_ended[1] && held[CountBits +: CountBits] == '0)
                          && migrate_end[2-2*Axis +: 2] == 2'b11);
      a_count:    assert (count[2*Axis*CountBits +: 2*CountBits] == halos);
      a_ready:    assert (ready == 4'b1111);
      i_step:     assert ({{(4 - StepBits) {1'b0}}, tap_step} == reading_q && (taking_q || reading_q == '0));
      i_read:     assert (tap_read == (taking_q ? turn_popped * ParticleBeats[WordBits-1:0]
                                                  + {{(WordBits - StepBits) {1'b0}},
                                                     (tap_step > ParticleBeats[StepBits-1:0])
                                                     ? ParticleBeats[StepBits-1:0] : tap_step} : '0));
      c_halo:     cover (has_q && number == Depth[CountBits-1:0] - 1'b1 && high && moved != '0);
      c_low:      cover (has_q && !high && moved == '1);
      c_particle: cover (valid && turn == high && high && turn_popped == number
                         && number == Capacity[CountBits-1:0] - 1'b1 && shown == '1);
      c_other:    cover (valid && turn != high && particles_ended == 2'b00);
      c_waits:    cover (taking_q && !some && turn_popped != '0 && !take_over);
      c_next:     cover (taking_q && some && halos != '0 && has_q == 1'b0 && halo_ended == 2'b11);
      c_set:      cover (set_q && record != '0 && here_halos != '0);
    end
  end
endmodule

// What came over a face, and what may come: as in the proof `word_inbox`; a stream of particles after the clear of
// the last one's end. The watched records are put together again.
module word_stream #(
  parameter int LinkBits     = 2,
  parameter int HaloBits     = 4,
  parameter int ParticleBits = 3,
  parameter int HaloDepth    = 1,
  parameter int Capacity     = 1,
  parameter int CountBits    = 4
) (
  input  logic                    clk_i,
  input  logic                    running_i,
  input  logic [CountBits-1:0]    number_i,
  input  logic                    valid_i,
  input  logic                    end_i,
  input  logic [LinkBits-1:0]     data_i,
  input  logic                    clear_i,
  input  logic                    migrate_clear_i,
  input  logic                    pop_i,
  output logic [CountBits-1:0]    halos_o, held_o, popped_o,
  output logic                    halo_ended_o, ended_o,
  output logic [HaloBits-1:0]     halo_o,
  output logic [ParticleBits-1:0] particle_o
);
  localparam int HaloBeats     = (HaloBits + LinkBits - 1) / LinkBits;
  localparam int ParticleBeats = (ParticleBits + LinkBits - 1) / LinkBits;

  logic                 particles_q, cleared_q, first_q, halo_ended_q, ended_q;
  logic [2:0]           beat_q;
  logic [CountBits-1:0] halos_q, came_q, popped_q;
  logic                 beat, last, halo_done, particle_done;
  assign beat          = valid_i && !end_i;
  assign last          = beat && beat_q == (particles_q ? ParticleBeats[2:0] - 3'd1 : HaloBeats[2:0] - 3'd1);
  assign halo_done     = last && !particles_q;
  assign particle_done = last && particles_q;
  assign halos_o       = halos_q;
  assign popped_o      = popped_q;
  assign held_o        = came_q - popped_q;
  assign halo_ended_o  = halo_ended_q;
  assign ended_o       = ended_q;
  always_comb begin
    if (valid_i) assume (running_i);
    if (valid_i && end_i) assume (beat_q == '0);
    if (beat && !particles_q) assume (cleared_q && !clear_i && halos_q != HaloDepth[CountBits-1:0]);
    if (valid_i && !particles_q) assume (cleared_q && !clear_i);
    if (beat && particles_q) assume (first_q || came_q != Capacity[CountBits-1:0]);
    if (valid_i && particles_q && first_q) assume (held_o == '0 && !ended_q);
    if (clear_i) assume (running_i && particles_q);
  end
  always_ff @(posedge clk_i) begin
    if (!running_i) begin
      particles_q  <= 1'b0;
      cleared_q    <= 1'b1;
      first_q      <= 1'b1;
      halo_ended_q <= 1'b0;
      ended_q      <= 1'b0;
      beat_q       <= '0;
      halos_q      <= '0;
      came_q       <= '0;
      popped_q     <= '0;
    end else begin
      if (valid_i && end_i) particles_q <= !particles_q;
      if (beat) beat_q <= last ? '0 : beat_q + 1'b1;
      if (halo_done) halos_q <= halos_q + 1'b1;
      if (particle_done) came_q <= came_q + 1'b1;
      if (pop_i) popped_q <= popped_q + 1'b1;
      if (valid_i && particles_q && first_q) begin
        came_q   <= {{(CountBits - 1) {1'b0}}, particle_done};
        popped_q <= '0;
      end
      if (valid_i) first_q <= !particles_q;
      if (valid_i && end_i && !particles_q) begin
        cleared_q    <= 1'b0;
        halo_ended_q <= 1'b1;
      end
      if (valid_i && end_i && particles_q) ended_q <= 1'b1;
      if (migrate_clear_i) begin
        ended_q  <= 1'b0;
        came_q   <= '0;
        popped_q <= '0;
      end
      if (clear_i) begin
        cleared_q    <= 1'b1;
        halo_ended_q <= 1'b0;
        halos_q      <= '0;
      end
    end
  end

  logic [HaloBeats*LinkBits-1:0]     halo_q;
  logic [ParticleBeats*LinkBits-1:0] particle_q;
  integer                            b;
  always_ff @(posedge clk_i) begin
    for (b = 0; b < HaloBeats; b = b + 1) begin
      if (beat && !particles_q && halos_q == number_i && beat_q == b[2:0]) halo_q[b*LinkBits +: LinkBits] <= data_i;
    end
    for (b = 0; b < ParticleBeats; b = b + 1) begin
      if (beat && particles_q && (first_q ? '0 : came_q) == number_i && beat_q == b[2:0]) begin
        particle_q[b*LinkBits +: LinkBits] <= data_i;
      end
    end
  end
  assign halo_o     = halo_q[HaloBits-1:0];
  assign particle_o = particle_q[ParticleBits-1:0];
endmodule
