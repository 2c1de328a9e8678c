// SPDX-License-Identifier: MIT
// The receiving side of the six links with narrow memories: one cuboct_word_inbox per face, of which one is read at a
// time, and the register in which a record is put together again, a halo in FORCE, a particle in MIGRATE.
module cuboct_word_halos #(
  parameter int Axes         = 3,    // 2 or 3
  parameter int PositionFrac = 20,   // P
  parameter int Capacity     = 16,
  parameter int LinkBits     = 16,
  parameter int HaloBits     = 62,   // of a halo record: x[P+2] y[P+2] z[P] rest; with two axes x[P+2] y[P] rest
  parameter int ParticleBits = 128,
  parameter int CountBits    = 9,    // of a segment's count
  parameter int WordBits     = 10,   // of a word's number
  localparam int Faces       = 2 * Axes
) (
  input  logic                       clk_i,
  input  logic                       rst_ni,
  input  logic [Faces-1:0]           has_link_i,
  input  logic [Faces-1:0]           link_valid_i,
  input  logic [Faces-1:0]           link_end_i,
  input  logic [Faces*LinkBits-1:0]  link_data_i,
  output logic [Faces-1:0]           link_ready_o,
  // Halos.
  input  logic                       halo_clear_i,   // the step's halos are read; with the last cycle of FORCE
  output logic [Faces-1:0]           halo_end_o,     // complete; always where there is no link
  output logic [Faces*CountBits-1:0] halo_count_o,   // by face: records that came in this step
  // The port: a word of the next cycle's word_o, and of which face that is, one hot.
  input  logic [WordBits-1:0]        word_i,         // not in MIGRATE
  input  logic [Faces-1:0]           face_i,         // one hot
  output logic [LinkBits-1:0]        word_o,         // of the question before
  // The record: takes word_o as its last word, or as a whole what is given.
  input  logic                       shift_i,        // takes word_o
  input  logic                       set_i,          // takes halo_i
  input  logic [HaloBits-1:0]        halo_i,         // with set_i
  output logic [HaloBits-1:0]        halo_o,         // once all its words were shifted in
  // Migrating particles of face_i.
  input  logic                       migrating_i,    // a migration phase
  input  logic                       taking_i,       // who waits for one
  input  logic [Faces-1:0]           migrate_clear_i,  // by face: last cycle of its axis's migration
  output logic [Faces-1:0]           migrate_end_o,  // complete, and all were popped; always where there is no link
  output logic                       particle_valid_o,  // one is put together
  output logic [ParticleBits-1:0]    particle_o,     // with particle_valid_o
  input  logic                       pop_i           // in each cycle with particle_valid_o, in no other
);
  localparam int HaloBeats    = (HaloBits + LinkBits - 1) / LinkBits;
  localparam int MigrateBeats = (ParticleBits + LinkBits - 1) / LinkBits;
  localparam int MaxBeats     = (HaloBeats > MigrateBeats) ? HaloBeats : MigrateBeats;
  localparam int RecordBits   = MaxBeats * LinkBits;
  localparam int HaloLsb      = (MaxBeats - HaloBeats) * LinkBits;
  localparam int ParticleLsb  = (MaxBeats - MigrateBeats) * LinkBits;
  localparam int StepBits     = $clog2(MigrateBeats + 2);
  localparam int Asked        = MigrateBeats;      // words
  localparam int Shown        = MigrateBeats + 1;

  logic [Faces-1:0] halo_end_d, halo_end_q, migrate_end_d, migrate_end_q, halo_end, migrate_end, empty;
  assign halo_end_d    = (halo_end_q | halo_end) & ~{Faces{halo_clear_i}};
  assign migrate_end_d = (migrate_end_q | migrate_end) & ~migrate_clear_i;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      halo_end_q    <= '0;
      migrate_end_q <= '0;
    end else begin
      halo_end_q    <= halo_end_d;
      migrate_end_q <= migrate_end_d;
    end
  end
  assign halo_end_o    = halo_end_q | ~has_link_i;
  assign migrate_end_o = (migrate_end_q & empty) | ~has_link_i;
  assign link_ready_o  = '1;

  // A particle is read in MigrateBeats + 2 cycles: a question per word, an answer a cycle after each, then it is shown.
  logic [StepBits-1:0] step_d, step_q;
  logic                some, ask;
  logic [WordBits-1:0] read_d, read_q;  // a particle's next word
  assign some             = taking_i && ((face_i & ~empty) != '0);
  assign ask              = some && (step_q != Asked[StepBits-1:0]) && (step_q != Shown[StepBits-1:0]);
  assign particle_valid_o = (step_q == Shown[StepBits-1:0]);
  always_comb begin
    step_d = step_q;
    if (some) step_d = step_q + 1'b1;
    if (particle_valid_o) step_d = '0;
    read_d = read_q;
    if (ask) read_d = read_q + 1'b1;
    if (!taking_i || (face_i & migrate_end_o) != '0) read_d = '0;  // the next face's start
  end
  always_ff @(posedge clk_i) begin
    if (!rst_ni) step_q <= '0;
    else step_q <= step_d;
  end
  always_ff @(posedge clk_i) read_q <= read_d;

  logic [Faces*LinkBits-1:0] words;
  for (genvar f = 0; f < Faces; f++) begin : gen_face
    localparam int Axis  = f / 2;
    localparam int Depth = ((Axis == 0) ? 1 : (Axis == 1) ? 3 : 9) * Capacity;
    logic unused_full;
    // One node further along the axis: -2^P from below, +2^P from above. The last axis has no sign on the link.
    cuboct_word_inbox #(
      .LinkBits(LinkBits), .HaloBits(HaloBits), .ParticleBits(ParticleBits), .HaloDepth(Depth), .Capacity(Capacity),
      .CountBits(CountBits), .WordBits(WordBits), .Signed((Axis < Axes - 1) ? 1 : 0),
      .SignLsb(Axis * (PositionFrac + 2) + PositionFrac), .Below((f % 2 == 0) ? 1 : 0)
    ) u_inbox (
      .clk_i, .rst_ni, .valid_i(link_valid_i[f] && has_link_i[f]), .end_i(link_end_i[f]),
      .data_i(link_data_i[f*LinkBits +: LinkBits]), .halo_end_o(halo_end[f]), .migrate_end_o(migrate_end[f]),
      .clear_i(halo_clear_i), .count_o(halo_count_o[f*CountBits +: CountBits]), .pop_i(pop_i && face_i[f]),
      .empty_o(empty[f]), .full_o(unused_full), .word_i(migrating_i ? read_q : word_i),
      .data_o(words[f*LinkBits +: LinkBits])
    );
  end
  integer k;
  always_comb begin
    word_o = '0;
    for (k = 0; k < Faces; k = k + 1) word_o = word_o | (words[k*LinkBits +: LinkBits] & {LinkBits{face_i[k]}});
  end

  // Words come in at the top and move down.
  logic [RecordBits-1:0] record_d, record_q;
  logic [RecordBits+LinkBits-1:0] shifted;
  assign shifted = {word_o, record_q};
  always_comb begin
    record_d = record_q;
    if (set_i) record_d[HaloLsb +: HaloBits] = halo_i;
    else if (shift_i || (taking_i && step_q != '0)) record_d = shifted[RecordBits+LinkBits-1:LinkBits];
    if (particle_valid_o) record_d = record_q;
  end
  always_ff @(posedge clk_i) record_q <= record_d;
  assign halo_o     = record_q[HaloLsb +: HaloBits];
  assign particle_o = record_q[ParticleLsb +: ParticleBits];
  logic unused_low;
  assign unused_low = ^{shifted, record_q};
endmodule
