// SPDX-License-Identifier: MIT
// cuboct_word_inbox: word b of halo record r since the clear, any of them, is what the port answers in the cycle
// after it was asked for, the record's sign moved on by one node; so is word b of the p-th particle of a stream, from
// the cycle after its last beat until it is popped. Counts, full and empty exact; the ends told once, in their
// streams. Neither stream touches what the other one keeps, and a word that is asked for while it is written is not
// looked at.
module word_inbox_formal #(
  parameter int LinkBits     = 2,
  parameter int HaloBits     = 3,
  parameter int ParticleBits = 5,
  parameter int HaloDepth    = 2,
  parameter int Capacity     = 2,
  parameter int Signed       = 1,
  parameter int SignLsb      = 1,
  parameter int Below        = 0
) (
  input logic                clk_i,
  input logic                valid_i,
  input logic                end_i,
  input logic [LinkBits-1:0] data_i,
  input logic                clear_i,
  input logic                pop_i,
  input logic [7:0]          word_i
);
  localparam int HaloBeats     = (HaloBits + LinkBits - 1) / LinkBits;
  localparam int ParticleBeats = (ParticleBits + LinkBits - 1) / LinkBits;
  localparam int First         = Capacity * ParticleBeats;
  localparam int Depth         = First + HaloDepth * HaloBeats;
  localparam int WordBits      = $clog2(Depth) + 1;  // one to spare, as where depths differ by face
  localparam int CountBits     = 4;
  localparam int RecordBits    = HaloBeats * LinkBits;

  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;

  logic                 halo_end, particle_end, empty, full;
  logic [CountBits-1:0] count;
  logic [LinkBits-1:0]  data;
  cuboct_word_inbox #(
    .LinkBits(LinkBits), .HaloBits(HaloBits), .ParticleBits(ParticleBits), .HaloDepth(HaloDepth), .Capacity(Capacity),
    .CountBits(CountBits), .WordBits(WordBits), .Signed(Signed), .SignLsb(SignLsb), .Below(Below)
  ) u_dut (
    .clk_i, .rst_ni(running_q), .valid_i, .end_i, .data_i, .halo_end_o(halo_end), .migrate_end_o(particle_end),
    .clear_i,
    .count_o(count), .pop_i, .empty_o(empty), .full_o(full), .word_i(word_i[WordBits-1:0]), .data_o(data)
  );

  // What came: the stream, beats of a record, halos since the clear, particles of the stream, those that were popped.
  logic                 particles_q, cleared_q, first_q;  // first: nothing of these particles came, nor their end
  logic [2:0]           beat_q;
  logic [CountBits-1:0] halos_q, came_q, popped_q, held;
  logic                 beat, last, halo_done, particle_done;
  assign held          = came_q - popped_q;
  assign beat          = valid_i && !end_i;
  assign last          = beat && beat_q == (particles_q ? ParticleBeats[2:0] - 3'd1 : HaloBeats[2:0] - 3'd1);
  assign halo_done     = last && !particles_q;
  assign particle_done = last && particles_q;
  // Records are whole and streams take turns (proof `link`). Between two streams of halos is one clear at least, before
  // the stream of particles between them ends; and what a stream of particles brought was popped when the next one
  // begins, but halos may come meanwhile (docs/reference/node.md, section Order). There is room (`neighbours_room`).
  always_comb begin
    if (valid_i) assume (running_q);
    if (valid_i && end_i) assume (beat_q == '0);
    if (beat && !particles_q) assume (cleared_q && !clear_i && halos_q != HaloDepth[CountBits-1:0]);
    if (beat && particles_q) assume (first_q || came_q != Capacity[CountBits-1:0]);
    if (valid_i && particles_q && first_q) assume (held == '0);
    if (clear_i) assume (particles_q);
    if (pop_i) assume (running_q && held != '0);
  end
  always_ff @(posedge clk_i) begin
    if (!running_q) begin
      particles_q <= 1'b0;
      cleared_q   <= 1'b1;
      first_q     <= 1'b1;
      beat_q      <= '0;
      halos_q     <= '0;
      came_q      <= '0;
      popped_q    <= '0;
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
      if (valid_i && end_i && !particles_q) cleared_q <= 1'b0;
      if (clear_i) begin
        cleared_q <= 1'b1;
        halos_q   <= '0;
      end
    end
  end

  // The watched records, by their numbers, as they came; and a word of each.
  (* anyconst *) logic [CountBits-1:0] number;
  (* anyconst *) logic [2:0]           word;
  logic [RecordBits-1:0]               halo_q, moved;
  logic [LinkBits-1:0]                 particle_q, moved_word;
  logic                                halo_there, particle_there;
  logic [7:0]                          halo_place, particle_place;
  always_comb assume (number < HaloDepth[CountBits-1:0] || number < Capacity[CountBits-1:0]);
  assign halo_there     = (number < halos_q) && word < HaloBeats[2:0];
  assign particle_there = (number < came_q) && (number >= popped_q) && word < ParticleBeats[2:0];
  assign halo_place     = First[7:0] + {4'd0, number} * HaloBeats[7:0] + {5'd0, word};
  assign particle_place = {4'd0, number} * ParticleBeats[7:0] + {5'd0, word};
  integer b;
  always_ff @(posedge clk_i) begin
    for (b = 0; b < HaloBeats; b = b + 1) begin
      if (beat && !particles_q && halos_q == number && beat_q == b[2:0]) halo_q[b*LinkBits +: LinkBits] <= data_i;
    end
    if (beat && particles_q && (first_q ? '0 : came_q) == number && beat_q == word) particle_q <= data_i;
  end
  // One node further: one less from below, one more from above, of two bits.
  always_comb begin
    moved = halo_q;
    if (Signed != 0) moved[SignLsb +: 2] = (Below != 0) ? halo_q[SignLsb +: 2] - 2'd1 : halo_q[SignLsb +: 2] + 2'd1;
    moved_word = '0;
    for (b = 0; b < HaloBeats; b = b + 1) begin
      if (word == b[2:0]) moved_word = moved[b*LinkBits +: LinkBits];
    end
  end
  logic                halo_asked_q, particle_asked_q;
  logic [LinkBits-1:0] halo_word_q, particle_word_q;
  always_ff @(posedge clk_i) begin
    halo_asked_q     <= running_q && halo_there && word_i == halo_place;
    particle_asked_q <= running_q && particle_there && word_i == particle_place;
    halo_word_q      <= moved_word;
    particle_word_q  <= particle_q;
  end

  (* keep *) logic                tap_write;
  (* keep *) logic [WordBits-1:0] tap_write_addr;
  logic                           torn_q, wrapped_q, again_q;
  always_ff @(posedge clk_i) begin
    torn_q <= running_q && tap_write && tap_write_addr == word_i[WordBits-1:0];
    if (!running_q) begin
      wrapped_q <= 1'b0;
      again_q   <= 1'b0;
    end else begin
      if (full) wrapped_q <= 1'b1;
      if (wrapped_q && clear_i) again_q <= 1'b1;
    end
  end

  always_ff @(posedge clk_i) begin
    if (running_q) begin
      a_count: assert (count == halos_q);
      a_full:  assert (full == (held == Capacity[CountBits-1:0]));
      a_empty: assert (empty == (held == '0));
      a_ends:  assert (halo_end == (valid_i && end_i && !particles_q)
                       && particle_end == (valid_i && end_i && particles_q));
      if (halo_asked_q) a_halo: assert (data == halo_word_q && !torn_q);
      if (particle_asked_q) a_particle: assert (data == particle_word_q && !torn_q);
      c_all:   cover (halo_asked_q && count == HaloDepth[CountBits-1:0] && full
                      && number == HaloDepth[CountBits-1:0] - 1'b1);
      c_moved: cover (halo_asked_q && halo_q[SignLsb +: 2] == 2'b01 && (Signed == 0 || moved[SignLsb +: 2] != 2'b01));
      c_kept:  cover (particle_asked_q && beat && !particles_q && (HaloDepth == 1 || halos_q != '0));
      c_ahead: cover (particle_asked_q && particles_q && first_q && halos_q != '0);
      c_late:  cover (halo_asked_q && particles_q && particle_done);
      c_pops:  cover (pop_i && (Capacity == 1 || particle_done));
      c_empty: cover (empty && wrapped_q && particles_q && count != '0);
      c_again: cover (again_q && full && halo_asked_q);
      c_torn:  cover (torn_q);
    end
  end
endmodule
