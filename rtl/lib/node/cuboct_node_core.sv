// SPDX-License-Identifier: MIT
// One particle processor. It knows no coordinates: has_link_i says which faces have a neighbour. The contract, cycle by
// cycle, is docs/reference/node.md; the words are
//   particle:    x[P] y[P] z[P] away_y[2] away_z[2] v[3 x VelocityBits] type[TypeBits] id[IdBits] residue[3 x Guard]
//                u[3 x DisplacementBits, Pd]
//   halo record: x[P+2] y[P+2] z[P] type[TypeBits, Scaled] v[3 x VelocityBits, Damped]
// least significant field first; with two axes nothing of z, and y[P] in the halo record. A residue is what a position
// has below its P visible bits: only the update and the next owner read it, so it stands above all that others see. The
// modules cuboct_force_rom, _damp_rom, _scale_rom and _type_rom are generated.
module cuboct_node_core #(
  // Machine.
  parameter int          Axes                 = 3,      // 2 or 3
  parameter int          Capacity             = 16,     // particles, >= 1
  parameter int          FilterLanes          = 8,      // >= 1
  parameter int          ForcePipes           = 1,      // >= 1
  parameter int          Shared               = 0,      // 0, 1: one multiplier serves the axes in turn
  parameter int          Product              = 1,      // cycles of a multiplier of the pipe; 1 if Shared
  parameter int          Interval             = 1,      // cycles from one pair to the next
  parameter int          QueueDepth           = 16,     // entries, >= 1
  parameter int          Overlap              = 1,      // 0, 1
  parameter int          Arrival              = 0,      // 1: halos are used as they come; with Overlap, not Narrow
  parameter int          Streamers            = 1,      // 1, or with Arrival 2; ForcePipes is a multiple
  parameter int          Narrow               = 0,      // 1: memories of words, one port; one lane and pipe, no overlap
  parameter int          LinkBits             = 66,     // payload of a beat, >= 1
  parameter int          IdBits               = 8,      // >= 1
  parameter int          TypeBits             = 0,      // 0 with one type
  // Formats: model/contract/fixed_rule.h, Widths.
  parameter int          PositionFrac         = 20,
  parameter int          Guard                = 8,
  parameter int          VelocityBits         = 29,
  parameter int          RelativeVelocityBits = 18,
  parameter int          StrengthBits         = 18,
  parameter int          SumBits              = 29,
  parameter int          DisplacementBits     = 29,
  parameter int          ScaleFrac            = 16,
  parameter int          GainFrac             = 16,
  parameter int          GainBits             = 18,
  parameter int          ScaleBits            = 18,
  parameter int          ConstantBits         = 29,     // imposed velocities and gravity
  // Shifts.
  parameter int          FilterFrac           = 8,      // leading bits of a position that the filter tests
  parameter int          DifferenceShift      = 4,
  parameter int          WShift               = 8,
  parameter int          QShift               = 17,
  parameter int          DampShift            = 0,
  parameter int          KickShift            = 0,
  // Law.
  parameter logic [63:0] Cutoff2              = 64'd0,
  parameter logic [63:0] Contact2             = 64'd0,
  parameter logic [63:0] PlanarOne            = 64'd0,
  parameter logic [63:0] PlanarTwo            = 64'd0,
  parameter logic [63:0] PlanarThree          = 64'd0,
  parameter int          Octaves              = 0,      // force table: 0 uniform, 1 octaves
  parameter int          Degree               = 1,
  parameter int          IndexBits            = 9,
  parameter int          BinBits              = 0,
  parameter int          FirstOctave          = 0,
  parameter int          FractionBits         = 17,
  parameter int          ForceBits            = 18,     // of any value of the force table
  parameter int          Damped               = 0,      // 0, 1
  parameter int          DampOctaves          = 0,
  parameter int          DampDegree           = 1,
  parameter int          DampIndexBits        = 9,
  parameter int          DampBinBits          = 0,
  parameter int          DampFirstOctave      = 0,
  parameter int          DampFractionBits     = 17,
  parameter int          DampBits             = 18,     // of any value of the damping table
  parameter int          Scaled               = 0,      // 0, 1
  parameter int          Weighted             = 0,      // 0, 1
  parameter int          LawBits              = 0,      // of the law of a pair of types; 0: all have one
  parameter int          Pd                   = 0,      // 0, 1
  parameter int          MovedTypes           = 0,      // types with velocities from velocity_i; 0: not read
  // Derived; do not set.
  localparam int         Faces                = 2 * Axes,
  localparam int         HaloType             = (Scaled != 0) ? TypeBits : 0,
  localparam int         HaloVelocity         = (Damped != 0) ? Axes * VelocityBits : 0,
  localparam int         HaloBits             = Axes * PositionFrac + 2 * (Axes - 1) + HaloType + HaloVelocity,
  localparam int         ParticleBits         = Axes * PositionFrac + 2 * (Axes - 1) + Axes * VelocityBits + TypeBits
                                                + IdBits + Axes * Guard
                                                + ((Pd != 0) ? Axes * DisplacementBits : 0),
  localparam int         HostBits             = (MovedTypes > 0) ? MovedTypes * Axes * VelocityBits : 1
) (
  input  logic                    clk_i,
  input  logic                    rst_ni,
  input  logic                    start_i,        // in IDLE: run steps_i steps
  input  logic [31:0]             steps_i,
  input  logic [Faces-1:0]        has_link_i,     // constant; faces -x, +x, -y, +y, -z, +z
  input  logic                    load_valid_i,   // in IDLE: append a particle
  input  logic [ParticleBits-1:0] load_data_i,
  input  logic [HostBits-1:0]     velocity_i,     // by moved type and axis; changes in IDLE alone
  output logic [Faces-1:0]        link_valid_o,
  output logic [Faces-1:0]        link_end_o,
  output logic [Faces*LinkBits-1:0] link_data_o,
  input  logic [Faces-1:0]        link_ready_i,
  input  logic [Faces-1:0]        link_valid_i,
  input  logic [Faces-1:0]        link_end_i,
  input  logic [Faces*LinkBits-1:0] link_data_i,
  output logic [Faces-1:0]        link_ready_o,
  output logic [7:0]              phase_start_o,  // exchange x y z, force, update, migrate x y z
  output logic [7:0]              phase_end_o,
  output logic [3*Streamers+ForcePipes:0] force_event_o,  // in this cycle: engine runs; of each streamer: it is
                                                  // stalled, presents a candidate, issues; each pipe takes a pair
  output logic                    observe_valid_o,
  output logic [ParticleBits-1:0] observe_data_o,
  output logic                    fault_valid_o,
  output logic [3:0]              fault_code_o,
  output logic [IdBits-1:0]       fault_id_o,
  output logic [63:0]             fault_number_o,
  output logic                    idle_o
);
  // Every tool ends with an error where a module is missing: the parameters are out of their ranges.
  if (Axes < 2 || Axes > 3 || Capacity < 1 || FilterLanes < 1 || ForcePipes < 1 || QueueDepth < 1 || LinkBits < 1
      || IdBits < 1 || TypeBits < 0 || FilterFrac > PositionFrac
      || (Narrow != 0 && (FilterLanes != 1 || ForcePipes != 1 || Overlap != 0 || Arrival != 0))
      || (Arrival != 0 && Overlap == 0) || Streamers < 1 || Streamers > 1 + Arrival
      || ForcePipes % Streamers != 0) begin : gen_range
    cuboct_parameter_out_of_range u_error ();
  end
  // Fields of a particle.
  localparam int PosBits    = Axes * PositionFrac;
  localparam int AwayBits   = 2 * (Axes - 1);
  localparam int VelLsb     = PosBits + AwayBits;
  localparam int TypeLsb    = VelLsb + Axes * VelocityBits;
  localparam int IdLsb      = TypeLsb + TypeBits;
  localparam int OwnBits    = ParticleBits + 2;  // a slot: {away_x, particle}
  localparam int SeenBits   = (HaloVelocity + HaloType > 0) ? IdLsb : PosBits;  // what others see of it
  // Fields of a candidate: a halo record with all axes of one width.
  localparam int CandPos       = Axes * (PositionFrac + 2);
  localparam int CandidateBits = CandPos + HaloType + HaloVelocity;
  // Numbers of slots, rows, records; counts have a bit to spare over addresses.
  localparam int SlotBits  = (Capacity > 1) ? $clog2(Capacity) : 1;
  localparam int LastSlot  = Capacity - 1;
  localparam int Rows      = (Capacity + FilterLanes - 1) / FilterLanes;
  localparam int RowBits   = (Rows > 1) ? $clog2(Rows) : 1;
  localparam int AddrBits  = $clog2(((Axes == 3) ? 9 : 3) * Capacity);
  localparam int CountBits = AddrBits + 1;
  localparam int HaloBeats = (HaloBits + LinkBits - 1) / LinkBits;
  localparam int FirstWord = Capacity * ((ParticleBits + LinkBits - 1) / LinkBits);  // of the halos in a face's memory
  localparam int WordBits  = $clog2(FirstWord + ((Axes == 3) ? 9 : 3) * Capacity * HaloBeats + 1);
  // Update.
  // A cycle after the last one is written MIGRATE may read it.
  localparam int UpdateLatency = ((Pd != 0) ? 7 : (Weighted != 0) ? 6 : 4) + Arrival;
  localparam int UpdateTail    = UpdateLatency - 2;
  localparam int TickBits      = $clog2(Capacity + UpdateLatency + 1);

  // The main machine.
  logic       in_round, in_exchange, in_update, in_migrate, in_dump, engine_runs, step_end;
  logic [1:0] axis;
  logic [Axes-1:0] past_exchange, past_next;
  logic       exchange_done, force_done, update_done, migrate_done, dump_done;
  logic       force_over;  // what the force engine has read may be cleared
  cuboct_sequencer #(.Axes(Axes), .Overlap(Overlap)) u_sequencer (
    .clk_i, .rst_ni, .start_i, .steps_i, .exchange_done_i(exchange_done), .force_done_i(force_done),
    .update_done_i(update_done), .migrate_done_i(migrate_done), .dump_done_i(dump_done), .idle_o,
    .round_o(in_round), .exchange_o(in_exchange), .update_o(in_update), .migrate_o(in_migrate), .dump_o(in_dump),
    .axis_o(axis), .onehot_o(axis_onehot), .onehot_next_o(axis_next),
    .engine_o(engine_runs), .past_exchange_o(past_exchange), .past_next_o(past_next),
    .step_end_o(step_end), .phase_start_o, .phase_end_o
  );

  // Own particles: how many, and where they are written and read.
  logic [CountBits-1:0]           own_count_d, own_count_q, migrate_count;
  logic                           full_d, full_q, migrate_full;  // Capacity particles
  logic                           own_write, load, update_write, migrate_write, migrate_count_set;
  logic [SlotBits-1:0]            own_write_slot, update_slot, migrate_write_slot, main_slot, stream_slot;
  logic [OwnBits-1:0]             own_write_data, update_data, migrate_write_data, main_data;
  logic [SeenBits-1:0]            stream_data;
  logic                           stream_read;          // the streamer asks for an own particle,
  logic [Streamers-1:0]           row_read;             // and for a row
  logic                           main_read, main_hold, migrate_read;
  logic [ForcePipes*SlotBits-1:0] issue_slot, kick_slot_next;
  logic [ForcePipes*SeenBits-1:0] pipe_data;
  logic [ForcePipes*IdBits-1:0]   kick_id;
  logic [Streamers*RowBits-1:0]   row;
  logic [Streamers*FilterLanes*Axes*FilterFrac-1:0] row_data;

  assign load = idle_o && load_valid_i && !full_q;
  always_comb begin
    own_count_d = own_count_q;
    full_d      = full_q;
    if (load) begin
      own_count_d = own_count_q + 1'b1;
      full_d      = (own_count_q == LastSlot[CountBits-1:0]);
    end else if (migrate_count_set) begin
      own_count_d = migrate_count;
      full_d      = migrate_full;
    end
  end
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      own_count_q <= '0;
      full_q      <= 1'b0;
    end else begin
      own_count_q <= own_count_d;
      full_q      <= full_d;
    end
  end
  // Chosen by the state, which is there before the writes are.
  always_comb begin
    own_write      = load || update_write || migrate_write;
    own_write_slot = update_slot;
    own_write_data = update_data;
    if (in_migrate) begin
      own_write_slot = migrate_write_slot;
      own_write_data = migrate_write_data;
    end else if (idle_o) begin
      own_write_slot = own_count_q[SlotBits-1:0];
      own_write_data = {2'b00, load_data_i};
    end
  end
  logic                slots_write;
  logic [SlotBits-1:0] slots_write_slot;
  logic [OwnBits-1:0]  slots_write_data;
  if (Arrival != 0) begin : gen_later_write
    // The slots' memories and banks are many: they begin at a register. What is loaded goes past it, as DUMP may ask
    // for it in the cycle after.
    logic                write_q;
    logic [SlotBits-1:0] slot_q;
    logic [OwnBits-1:0]  data_q;
    always_ff @(posedge clk_i) begin
      if (!rst_ni) write_q <= 1'b0;
      else write_q <= own_write;
    end
    always_ff @(posedge clk_i) begin
      if (own_write) begin
        slot_q <= own_write_slot;
        data_q <= own_write_data;
      end
    end
    assign slots_write      = idle_o ? load : write_q;
    assign slots_write_slot = idle_o ? own_count_q[SlotBits-1:0] : slot_q;
    assign slots_write_data = idle_o ? {2'b00, load_data_i} : data_q;
  end else begin : gen_write
    assign slots_write      = own_write;
    assign slots_write_slot = own_write_slot;
    assign slots_write_data = own_write_data;
  end
  cuboct_slots #(
    .Axes(Axes), .Bits(OwnBits), .SeenBits(SeenBits), .PositionFrac(PositionFrac), .FilterFrac(FilterFrac),
    .IdLsb(IdLsb), .IdBits(IdBits), .Capacity(Capacity), .SlotBits(SlotBits), .FilterLanes(FilterLanes),
    .RowBits(RowBits), .ForcePipes(ForcePipes), .Streamers(Streamers), .Narrow(Narrow)
  ) u_slots (
    .clk_i, .write_i(slots_write), .write_slot_i(slots_write_slot), .write_data_i(slots_write_data),
    .main_read_i(main_read), .main_slot_i(main_slot), .main_data_o(main_data), .stream_read_i(stream_read),
    .stream_slot_i(stream_slot),
    .stream_data_o(stream_data), .row_read_i(row_read), .row_i(row), .row_data_o(row_data), .pipe_slot_i(issue_slot),
    .pipe_data_o(pipe_data), .fault_slot_i(kick_slot_next), .fault_id_o(kick_id)
  );

  // Links: receivers.
  logic [Faces-1:0]           halo_end, halo_end_next, migrate_end, migrate_empty, migrate_face, migrate_clear;
  logic [Faces*CountBits-1:0] halo_count;
  logic [Faces-1:0]           stream_end, halo_read, halo_next;  // the streamer asks, and takes the answer
  logic [Faces-1:0]           some_next, over_next;  // migrating particles, next cycle: one waits; none does, all came
  logic [Faces-1:0]           stream_came, halo_came;  // a record comes
  logic [Streamers*AddrBits-1:0] stream_addr;
  logic [AddrBits-1:0]        relay_addr, relay_ahead;
  logic                       box_empty;
  logic [Axes*FilterFrac-1:0] box_low, box_high;
  logic                       relay_read;
  logic [Faces-2:0]           relay_pick, relay_clear;
  logic [Faces*CandidateBits-1:0]     stream_halos;
  logic [(Faces-2)*CandidateBits-1:0] relay_halos;
  logic [ParticleBits-1:0]    arrived;  // the oldest of the face that migration takes from
  // Narrow: the word read, whose it is, and the record register.
  logic [WordBits-1:0]  relay_word, walk_word;
  logic [2:0]           walk_segment;
  logic [LinkBits-1:0]  halo_word;
  logic                 record_shift, record_set;
  logic [HaloBits-1:0]  own_record, record;
  logic                 migrate_pop;
  logic [Axes-1:0]      axis_onehot, axis_next;
  if (Narrow != 0) begin : gen_narrow
    logic [Faces-1:0]        face;
    logic                    shown;
    logic [ParticleBits-1:0] particle;
    for (genvar f = 0; f < Faces; f++) begin : gen_face
      localparam int Segment = f + 1;
      logic relayed;
      if (f < Faces - 2) begin : gen_relayed
        assign relayed = relay_pick[f+1];
      end else begin : gen_not_relayed
        assign relayed = 1'b0;
      end
      assign face[f] = in_exchange ? relayed :
                       in_migrate ? migrate_face[f] : (walk_segment == Segment[2:0]);
    end
    cuboct_word_halos #(
      .Axes(Axes), .PositionFrac(PositionFrac), .Capacity(Capacity), .LinkBits(LinkBits), .HaloBits(HaloBits),
      .ParticleBits(ParticleBits), .CountBits(CountBits), .WordBits(WordBits)
    ) u_halos (
      .clk_i, .rst_ni, .has_link_i, .link_valid_i, .link_end_i, .link_data_i, .link_ready_o,
      .halo_clear_i(force_done), .halo_end_o(halo_end), .halo_count_o(halo_count),
      .word_i(in_exchange ? relay_word : walk_word), .face_i(face), .word_o(halo_word), .shift_i(record_shift),
      .set_i(record_set), .halo_i(own_record), .halo_o(record), .migrating_i(in_migrate),
      .taking_i(migrate_face != '0), .migrate_clear_i(migrate_clear), .migrate_end_o(migrate_end),
      .particle_valid_o(shown), .particle_o(particle), .pop_i(migrate_pop)
    );
    assign migrate_empty = {Faces{!shown}};
    assign arrived       = particle;
    assign stream_halos  = '0;
    assign relay_halos   = '0;
    logic unused_addr;
    assign unused_addr = ^{stream_addr, relay_addr, relay_ahead, relay_clear, relay_pick[0], force_over, migrate_empty,
                           box_empty, box_low, box_high};
    assign stream_end   = halo_end;
    assign stream_came  = '0;
    assign halo_came    = '0;
    assign halo_end_next = '0;
    assign some_next    = '0;
    assign over_next    = '0;
  end else begin : gen_wide
    logic [Faces*ParticleBits-1:0] particles;
    cuboct_halos #(
      .Axes(Axes), .PositionFrac(PositionFrac), .Capacity(Capacity), .LinkBits(LinkBits), .HaloBits(HaloBits),
      .CandidateBits(CandidateBits), .ParticleBits(ParticleBits), .AddrBits(AddrBits), .CountBits(CountBits),
      .Arrival(Arrival), .Streamers(Streamers), .FilterFrac(FilterFrac), .PlanarOne(PlanarOne), .PlanarTwo(PlanarTwo),
      .PlanarThree(PlanarThree)
    ) u_halos (
      .clk_i, .rst_ni, .has_link_i, .link_valid_i, .link_end_i, .link_data_i, .link_ready_o,
      .halo_clear_i(force_over), .halo_end_o(halo_end), .halo_end_next_o(halo_end_next), .halo_count_o(halo_count),
      .stream_end_next_o(stream_end),
      .halo_came_o(halo_came), .stream_came_o(stream_came), .run_i(engine_runs),
      .box_empty_i(box_empty), .box_low_i(box_low), .box_high_i(box_high), .stream_read_i(halo_read),
      .stream_next_i(halo_next), .stream_addr_i(stream_addr), .stream_data_o(stream_halos),
      .relay_read_i(relay_read), .relay_clear_i(relay_clear[Faces-2:1]), .relay_addr_i(relay_addr),
      .relay_ahead_i(relay_ahead),
      .relay_data_o(relay_halos), .migrating_i(in_migrate || (Arrival != 0 && in_update)),
      .migrate_clear_i(migrate_clear), .migrate_end_o(migrate_end), .migrate_empty_o(migrate_empty),
      .migrate_some_next_o(some_next), .migrate_over_next_o(over_next),
      .migrate_data_o(particles),
      .migrate_pop_i(migrate_face & ~migrate_empty)
    );
    integer f;
    always_comb begin
      arrived = '0;
      for (f = 0; f < Faces; f = f + 1) begin
        arrived = arrived | (particles[f*ParticleBits +: ParticleBits]
                             & {ParticleBits{migrate_face[f]}});
      end
    end
    assign halo_word = '0;
    assign record    = '0;
    logic unused_narrow;
    assign unused_narrow = ^{relay_word, walk_word, walk_segment, record_shift, record_set, own_record, relay_pick,
                             relay_clear[0], migrate_pop, halo_word, halo_count};
  end

  logic unused_told;
  assign unused_told = ^{halo_came, migrate_end};

  // leaving[a]: some own particle has to go along axis a.
  logic [Axes-1:0] leaving_d, leaving_q, leaving_more, away_axes;

  // Links: senders. One axis speaks at a time: the relay in EXCHANGE, the migration in MIGRATE.
  logic [Faces-1:0]    unused_can_load, load_link;
  logic [1:0]          axis_can_load, axis_load, migrate_load, axis_has_link;
  logic                relay_load, relay_end, migrate_send_end, send_end;
  logic [LinkBits-1:0] relay_beat, relay_halo_beat, migrate_beat, send_data;
  for (genvar f = 0; f < Faces; f++) begin : gen_tx
    cuboct_link_tx #(.LinkBits(LinkBits)) u_tx (
      .clk_i, .rst_ni, .has_link_i(has_link_i[f]), .load_i(load_link[f]), .end_i(send_end), .data_i(send_data),
      .can_load_o(unused_can_load[f]), .valid_o(link_valid_o[f]), .end_o(link_end_o[f]),
      .data_o(link_data_o[f*LinkBits +: LinkBits]), .ready_i(link_ready_i[f])
    );
  end
  // What belongs to the axis of the present phase, and of the one that the next migration is along.
  logic [Axes-1:0]           next_axis, empty_links, migrate_next_load;  // by axis
  logic [1:0]                axis_halo_end;  // below, above: complete
  integer                    b;
  // Links of the axis that must be taken from before they load: known from registers, as much depends on it.
  logic [Faces-1:0]          waits_d, waits_q, holds;
  for (genvar w = 0; w < Faces; w++) begin : gen_waits
    assign waits_d[w] = axis_next[w/2]
                     && ((load_link[w] && has_link_i[w]) || (link_valid_o[w] && !link_ready_i[w]));
  end
  always_ff @(posedge clk_i) begin
    if (!rst_ni) waits_q <= '0;
    else waits_q <= waits_d;
  end
  assign holds = waits_q & ~link_ready_i;
  logic [1:0]                link_d, link_q;
  always_ff @(posedge clk_i) link_q <= link_d;
  assign axis_has_link = link_q;
  always_comb begin
    axis_can_load = 2'b11;
    link_d        = 2'b00;
    for (b = 0; b < Axes; b = b + 1) begin
      axis_can_load = axis_can_load & ~holds[2*b +: 2];
      link_d        = link_d | (has_link_i[2*b +: 2] & {2{axis_next[b]}});
    end
  end
  // The same of the inboxes: what migration is told comes from registers.
  logic [1:0] axis_some, axis_over;  // below, above: a particle waits; none does, and all came
  if (Narrow != 0) begin : gen_narrow_over
    integer e;
    always_comb begin
      axis_halo_end = 2'b00;
      for (e = 0; e < Axes; e = e + 1) axis_halo_end = axis_halo_end | (halo_end[2*e +: 2] & {2{axis_onehot[e]}});
    end
    assign axis_some = ~migrate_empty[1:0];
    assign axis_over = {2{migrate_empty[0] && (migrate_face & migrate_end) != '0}};
    logic unused_next;
    assign unused_next = ^{some_next, over_next, halo_end_next};
  end else begin : gen_wide_over
    logic [1:0] some_here, some_there, over_here, over_there, some_q, over_q;  // of this axis, of the next one
    logic [1:0] ends_d, ends_q;
    integer     c, e;
    always_comb begin
      ends_d = 2'b00;
      for (e = 0; e < Axes; e = e + 1) ends_d = ends_d | (halo_end_next[2*e +: 2] & {2{axis_next[e]}});
    end
    always_ff @(posedge clk_i) begin
      if (!rst_ni) ends_q <= 2'b00;
      else ends_q <= ends_d;
    end
    assign axis_halo_end = ends_q;
    logic unused_halo_end;
    assign unused_halo_end = ^halo_end;
    always_comb begin
      some_here  = 2'b00;
      some_there = 2'b00;
      over_here  = 2'b00;
      over_there = 2'b00;
      for (c = 0; c < Axes; c = c + 1) begin
        some_here = some_here | (some_next[2*c +: 2] & {2{axis_onehot[c]}});
        over_here = over_here | (over_next[2*c +: 2] & {2{axis_onehot[c]}});
        if (c > 0) begin
          some_there = some_there | (some_next[2*c +: 2] & {2{axis_onehot[c-1]}});
          over_there = over_there | (over_next[2*c +: 2] & {2{axis_onehot[c-1]}});
        end
      end
    end
    always_ff @(posedge clk_i) begin
      some_q <= migrate_done ? some_there : some_here;
      over_q <= migrate_done ? over_there : over_here;
    end
    assign axis_some = some_q;
    assign axis_over = over_q;
  end
  assign axis_load = in_migrate ? migrate_load : {2{relay_load}};
  assign send_end  = in_exchange ? relay_end : migrate_send_end;
  assign send_data = migrate_beat | relay_beat | relay_halo_beat;  // all but one are 0
  logic [Faces-1:0] relay_face_load;  // Arrival: by face
  for (genvar a = 0; a < Axes; a++) begin : gen_axis_link
    if (a == 0) begin : gen_first
      assign next_axis[a] = !in_migrate;
    end else begin : gen_later
      assign next_axis[a] = in_migrate && axis_onehot[a-1];
    end
    assign empty_links[a] = (link_valid_o[2*a +: 2] == 2'b00);
    assign load_link[2*a +: 2] = (axis_load & {2{axis_onehot[a]}}) | relay_face_load[2*a +: 2]
                               | {2{migrate_next_load[a]}};
  end

  // A particle as a candidate: x, y, z with their sign bits, then what the rule needs of type and v.
  logic [CandidateBits-1:0] own_candidate, relay_own;
  cuboct_candidate #(
    .Axes(Axes), .PositionFrac(PositionFrac), .VelLsb(VelLsb), .VelBits(HaloVelocity), .TypeLsb(TypeLsb),
    .TypeBits(HaloType), .OwnBits(SeenBits), .CandidateBits(CandidateBits)
  ) u_stream_candidate (.own_i(stream_data), .candidate_o(own_candidate));
  cuboct_candidate #(
    .Axes(Axes), .PositionFrac(PositionFrac), .VelLsb(VelLsb), .VelBits(HaloVelocity), .TypeLsb(TypeLsb),
    .TypeBits(HaloType), .OwnBits(OwnBits), .CandidateBits(CandidateBits)
  ) u_relay_candidate (.own_i(main_data), .candidate_o(relay_own));

  // Exchange.
  logic [SlotBits-1:0]      relay_slot;
  logic                     relay_first_own, relay_sent;
  logic [CandidateBits-1:0] relay_halo;
  logic [HaloBits-1:0]      relay_record, relay_halo_record;
  integer h;
  always_comb begin
    relay_halo = '0;
    for (h = 0; h < Faces - 2; h = h + 1) relay_halo = relay_halo | relay_halos[h*CandidateBits +: CandidateBits];
  end
  // On the link the last axis has no sign: what is sent lies in this node's layer.
  if (CandidateBits > CandPos) begin : gen_record
    assign relay_record      = {relay_own[CandidateBits-1:CandPos], relay_own[CandPos-3:0]};
    assign relay_halo_record = {relay_halo[CandidateBits-1:CandPos], relay_halo[CandPos-3:0]};
  end else begin : gen_bare_record
    assign relay_record      = relay_own[CandPos-3:0];
    assign relay_halo_record = relay_halo[CandPos-3:0];
  end
  logic unused_relay_sign;
  assign unused_relay_sign = ^{relay_own[CandPos-1:CandPos-2], relay_halo[CandPos-1:CandPos-2]};
  logic relay_observe;
  if (Arrival != 0) begin : gen_arrival_relay
    logic [Axes-1:0] sent;
    assign relay_ahead = '0;
    cuboct_arrival_relay #(
      .Axes(Axes), .LinkBits(LinkBits), .HaloBits(HaloBits), .SlotBits(SlotBits), .AddrBits(AddrBits),
      .CountBits(CountBits)
    ) u_relay (
      .clk_i, .rst_ni, .active_i(in_exchange), .own_count_i(own_count_q), .came_i(halo_came[Faces-3:0]),
      .complete_i({halo_end[Faces-3:0], 1'b1}), .read_o(relay_read), .clear_o(relay_clear), .addr_o(relay_addr),
      .slot_o(relay_slot), .own_i(relay_record), .halo_i(relay_halo_record), .has_link_i, .valid_i(link_valid_o),
      .ready_i(link_ready_i),
      .load_o(relay_face_load), .end_o(relay_end), .data_o(relay_beat), .observe_o(relay_observe), .sent_o(sent)
    );
    assign relay_sent      = ((sent & axis_onehot) != '0);
    assign relay_load      = 1'b0;
    assign relay_halo_beat = '0;
    assign relay_pick      = '0;
    assign relay_word      = '0;
    assign relay_first_own = 1'b0;
    logic unused_first_own;
    assign unused_first_own = relay_first_own;
  end else begin : gen_phase_relay
    cuboct_relay #(
      .Axes(Axes), .LinkBits(LinkBits), .HaloBits(HaloBits), .SlotBits(SlotBits), .AddrBits(AddrBits),
      .CountBits(CountBits), .Narrow(Narrow), .FirstWord(FirstWord), .WordBits(WordBits)
    ) u_relay (
      .clk_i, .rst_ni, .active_i(in_exchange), .axis_i(axis), .done_i(exchange_done),
      .counts_i({halo_count[(Faces-2)*CountBits-1:0], own_count_q}), .pick_o(relay_pick), .clear_o(relay_clear),
      .read_o(relay_read), .addr_o(relay_addr), .ahead_o(relay_ahead), .slot_o(relay_slot),
      .record_i(relay_record), .halo_i(relay_halo_record),
      .word_o(relay_word),
      .word_i(halo_word), .can_load_i(axis_can_load == 2'b11), .load_o(relay_load), .end_o(relay_end),
      .data_o(relay_beat), .halo_data_o(relay_halo_beat), .first_own_o(relay_first_own), .sent_o(relay_sent)
    );
    assign relay_face_load = '0;
    assign relay_observe   = relay_first_own && (axis == 2'd0);
  end
  assign exchange_done = in_exchange && relay_sent && (axis_halo_end == 2'b11);

  // Force engine.
  logic [Streamers*CandidateBits-1:0] issue_candidate;
  logic [ForcePipes-1:0]        issue, pipe_busy;
  logic                         finder_done;
  logic [Streamers-1:0]         present, force_stall;
  logic [SlotBits-1:0]          tick_slot, tick_next;
  logic                         take, fault_left, fault_full, some_fault;
  logic [ParticleBits-1:0]      fault_particle;
  if (CandidateBits > CandPos) begin : gen_own_record
    assign own_record = {own_candidate[CandidateBits-1:CandPos], own_candidate[CandPos-3:0]};
  end else begin : gen_bare_own_record
    assign own_record = own_candidate[CandPos-3:0];
  end
  logic unused_own_sign;
  assign unused_own_sign = ^own_candidate[CandPos-1:CandPos-2];
  logic [SlotBits-1:0] walk_slot;  // 0 at rest
  if (Narrow != 0) begin : gen_walk
    // The sign of the last axis, as cuboct_halos puts it.
    logic [1:0] last_sign;
    assign last_sign = {walk_segment == Faces[2:0] - 3'd1, walk_segment >= Faces[2:0] - 3'd1};
    if (CandidateBits > CandPos) begin : gen_rest
      assign issue_candidate = {record[HaloBits-1:CandPos-2], last_sign, record[CandPos-3:0]};
    end else begin : gen_bare
      assign issue_candidate = {last_sign, record};
    end
    cuboct_pair_walk #(
      .Axes(Axes), .PositionFrac(PositionFrac), .FilterFrac(FilterFrac), .PlanarOne(PlanarOne), .PlanarTwo(PlanarTwo),
      .PlanarThree(PlanarThree), .Interval(Interval), .HaloBeats(HaloBeats), .SlotBits(SlotBits),
      .FirstWord(FirstWord), .WordBits(WordBits), .CountBits(CountBits)
    ) u_finder (
      .clk_i, .rst_ni, .run_i(engine_runs), .restart_i(force_done), .counts_i({halo_count, own_count_q}),
      .word_o(walk_word), .segment_o(walk_segment), .shift_o(record_shift), .set_o(record_set), .slot_o(walk_slot),
      .hold_o(main_hold), .own_i(main_data[PosBits-1:0]), .candidate_i(issue_candidate[CandPos-1:0]),
      .issue_o(issue[0]), .issue_slot_o(issue_slot[SlotBits-1:0]), .present_o(present), .stall_o(force_stall),
      .done_o(finder_done)
    );
    assign stream_read = 1'b0;
    assign row_read    = 1'b0;
    assign halo_read   = '0;
    assign halo_next   = '0;
    assign stream_slot = '0;
    assign stream_addr = '0;
    assign row         = '0;
    assign force_event_o[3:1] = {issue[0], present, force_stall};
    logic unused_streams;
    assign unused_streams = ^{past_exchange, past_next, row_data, stream_halos, stream_end, stream_came, halo_read,
                              halo_next};
  end else begin : gen_stream
    localparam int Pipes = ForcePipes / Streamers;
    logic [Streamers-1:0] done;
    for (genvar s = 0; s < Streamers; s++) begin : gen_streamer
      // One walks own particles and all faces; of two the first walks those and the faces below, the other those above.
      localparam int Own   = (s == 0) ? 1 : 0;
      localparam int Halos = Faces / Streamers;
      logic [Halos+Own-1:0]             complete;
      logic [Halos-1:0]                 came;
      logic [Halos*CandidateBits-1:0]   halos;
      logic [SlotBits-1:0]              own_slot;
      logic [Halos+Own-1:0]             reads, nexts;
      if (Own != 0) begin : gen_own
        assign complete[0]            = 1'b1;
        assign stream_slot            = own_slot;
        assign stream_read            = reads[0];
      end else begin : gen_no_own
        logic unused_own_slot;
        assign unused_own_slot = ^own_slot;
      end
      for (genvar k = 0; k < Halos; k++) begin : gen_halo
        localparam int Face = k * Streamers + s;
        assign halo_read[Face]                          = reads[k+Own];
        assign halo_next[Face]                          = nexts[k+Own];
        assign complete[k+Own]                          = (Arrival != 0) ? stream_end[Face] : past_next[Face/2];
        assign came[k]                                  = stream_came[Face];
        assign halos[k*CandidateBits +: CandidateBits]  = stream_halos[Face*CandidateBits +: CandidateBits];
      end
      cuboct_pair_finder #(
        .Axes(Axes), .Halos(Halos), .Own(Own), .Arrival(Arrival), .PositionFrac(PositionFrac), .FilterFrac(FilterFrac),
        .PlanarOne(PlanarOne), .PlanarTwo(PlanarTwo), .PlanarThree(PlanarThree), .CandidateBits(CandidateBits),
        .FilterLanes(FilterLanes), .ForcePipes(Pipes), .Interval(Interval), .QueueDepth(QueueDepth),
        .RowBits(RowBits), .SlotBits(SlotBits), .AddrBits(AddrBits), .CountBits(CountBits)
      ) u_finder (
        .clk_i, .rst_ni, .run_i(engine_runs), .restart_i(force_over), .own_count_i(own_count_q),
        .complete_next_i(complete), .came_i(came), .again_i(1'b0), .counts_i('0), .read_o(reads), .next_o(nexts),
        .row_read_o(row_read[s]), .slot_o(own_slot), .addr_o(stream_addr[s*AddrBits +: AddrBits]),
        .own_i(own_candidate), .halos_i(halos), .row_o(row[s*RowBits +: RowBits]),
        .row_data_i(row_data[s*FilterLanes*Axes*FilterFrac +: FilterLanes*Axes*FilterFrac]),
        .candidate_o(issue_candidate[s*CandidateBits +: CandidateBits]), .issue_o(issue[s*Pipes +: Pipes]),
        .issue_slot_o(issue_slot[s*Pipes*SlotBits +: Pipes*SlotBits]), .present_o(present[s]),
        .stall_o(force_stall[s]), .done_o(done[s])
      );
      assign force_event_o[1+3*s +: 3] = {issue[s*Pipes +: Pipes] != '0, present[s], force_stall[s]};
    end
    assign finder_done = (done == '1);
    if (Arrival != 0) begin : gen_no_phases
      logic unused_phases;
      assign unused_phases = ^{past_exchange, past_next};
    end else begin : gen_no_ends
      logic unused_ends;
      assign unused_ends = ^{stream_end, past_exchange};
    end
    assign walk_slot    = '0;
    assign walk_word    = '0;
    assign walk_segment = 3'd0;
    assign record_shift = 1'b0;
    assign record_set   = 1'b0;
    assign main_hold    = 1'b0;
    logic unused_record;
    assign unused_record = ^record;
  end
  assign force_event_o[0] = engine_runs;
  assign force_event_o[3*Streamers+1 +: ForcePipes] = issue;
  if (Arrival != 0) begin : gen_settled
    // The last candidates may have been met before the last records are sent. What is cleared waits for a register.
    logic found_q, over_q;
    always_ff @(posedge clk_i) begin
      if (!rst_ni) begin
        found_q <= 1'b0;
        over_q  <= 1'b0;
      end else begin
        found_q <= finder_done;
        over_q  <= force_done;
      end
    end
    assign force_done = past_exchange[Axes-1] && found_q && (pipe_busy == '0);
    assign force_over = over_q;
  end else begin : gen_at_once
    assign force_done = engine_runs && finder_done && (pipe_busy == '0);
    assign force_over = force_done;
  end

  // Update and dump walk the slots. Narrow: one after the other, so that the memories' answers stay for the update.
  localparam int Tail = (Narrow != 0) ? 0 : UpdateTail;
  logic [TickBits-1:0] tick, tick_after;
  logic                more, taken_d, taken_q;
  cuboct_tick #(.Tail(Tail), .Registered((Narrow == 0) ? 1 : 0), .CountBits(CountBits), .TickBits(TickBits)) u_tick (
    .clk_i, .rst_ni, .update_i(in_update), .dump_i(in_dump), .step_i(Narrow == 0 || update_write),
    .count_i(own_count_q), .tick_o(tick), .next_o(tick_after), .more_o(more), .update_done_o(update_done),
    .dump_done_o(dump_done)
  );
  assign taken_d = (take || taken_q) && !update_write;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) taken_q <= 1'b0;
    else taken_q <= taken_d;
  end
  assign take      = in_update && more && (Narrow == 0 || !taken_q);
  assign tick_slot = tick[SlotBits-1:0];
  assign tick_next = tick_after[SlotBits-1:0];
  logic unused_tick;
  assign unused_tick = ^{tick, tick_after};

  logic                migrate_arrived;
  logic [Axes-1:0]     migrate_goes_on;
  cuboct_datapath #(
    .Axes(Axes), .Cells(1), .Capacity(Capacity), .Streamers(Streamers), .ForcePipes(ForcePipes), .Shared(Shared),
    .Product(Product),
    .Interval(Interval), .Narrow(Narrow), .IdBits(IdBits), .TypeBits(TypeBits), .ParticleBits(ParticleBits),
    .SeenBits(SeenBits), .CandidateBits(CandidateBits), .PositionFrac(PositionFrac), .Guard(Guard),
    .VelocityBits(VelocityBits), .RelativeVelocityBits(RelativeVelocityBits), .StrengthBits(StrengthBits),
    .SumBits(SumBits), .DisplacementBits(DisplacementBits), .ScaleFrac(ScaleFrac), .GainFrac(GainFrac),
    .GainBits(GainBits), .ScaleBits(ScaleBits), .ConstantBits(ConstantBits), .DifferenceShift(DifferenceShift),
    .WShift(WShift), .QShift(QShift), .DampShift(DampShift), .KickShift(KickShift), .Cutoff2(Cutoff2),
    .Contact2(Contact2),
    .Octaves(Octaves),
    .Degree(Degree), .IndexBits(IndexBits), .BinBits(BinBits), .FirstOctave(FirstOctave), .FractionBits(FractionBits),
    .ForceBits(ForceBits), .Damped(Damped), .DampOctaves(DampOctaves), .DampDegree(DampDegree),
    .DampIndexBits(DampIndexBits), .DampBinBits(DampBinBits), .DampFirstOctave(DampFirstOctave),
    .DampFractionBits(DampFractionBits), .DampBits(DampBits), .Scaled(Scaled), .LawBits(LawBits),
    .MovedTypes(MovedTypes), .Weighted(Weighted), .Pd(Pd)
  ) u_datapath (
    .clk_i, .rst_ni, .velocity_i, .issue_i(issue), .issue_place_i(issue_slot), .candidate_i(issue_candidate),
    .own_i(pipe_data), .busy_o(pipe_busy), .kick_addr_o(kick_slot_next), .kick_id_i(kick_id), .look_addr_i(tick_next),
    .clear_i((Narrow != 0) ? update_write : take), .clear_addr_i(tick_next), .take_i(take),
    .take_place_i(tick_slot), .slot_i(main_data), .written_o(update_write), .place_o(update_slot),
    .slot_o(update_data), .leaving_o(away_axes), .step_end_i(step_end), .move_fault_i(fault_left || fault_full),
    .move_axis_i(axis), .move_full_i(fault_full), .move_tell_i(fault_particle[IdLsb +: IdBits]),
    .fault_o(some_fault), .fault_code_o, .fault_tell_o(fault_id_o), .fault_number_o
  );
  if (Arrival != 0) begin : gen_box
    logic                           box_add;
    logic [Axes*FilterFrac-1:0]     box_x;
    assign box_add = load || (update_write && away_axes == '0) || (migrate_arrived && !full_q && migrate_goes_on == '0);
    for (genvar a = 0; a < Axes; a++) begin : gen_box_axis
      assign box_x[a*FilterFrac +: FilterFrac] = own_write_data[a*PositionFrac+PositionFrac-FilterFrac +: FilterFrac];
    end
    cuboct_box #(.Axes(Axes), .FilterFrac(FilterFrac)) u_box (
      .clk_i, .rst_ni, .clear_i(force_over), .add_i(box_add), .x_i(box_x), .empty_o(box_empty), .low_o(box_low),
      .high_o(box_high)
    );
  end else begin : gen_no_box
    assign box_empty    = 1'b1;
    assign box_low      = '0;
    assign box_high     = '0;
    logic unused_arrived;
    assign unused_arrived = ^{migrate_arrived, migrate_goes_on};
  end
  assign fault_valid_o = some_fault && step_end;  // a step's last cycle is one in which nothing moves

  // Migration.
  logic [SlotBits-1:0]     migrate_read_slot;
  for (genvar a = 0; a < Axes; a++) begin : gen_axis_migrate
    assign migrate_clear[2*a +: 2] = {2{axis_onehot[a] && migrate_done}};
  end
  always_comb begin
    leaving_d = leaving_q | leaving_more;
    if (update_write) leaving_d = leaving_q | away_axes;
    if (migrate_done) leaving_d = leaving_q & ~axis_onehot;
  end
  always_ff @(posedge clk_i) begin
    if (!rst_ni) leaving_q <= '0;
    else leaving_q <= leaving_d;
  end
  cuboct_migrate #(
    .Axes(Axes), .ParticleBits(ParticleBits), .PositionBits(PosBits), .LinkBits(LinkBits), .Capacity(Capacity),
    .SlotBits(SlotBits), .CountBits(CountBits), .Early(Arrival)
  ) u_migrate (
    .clk_i, .rst_ni, .active_i(in_migrate), .axis_i(axis), .done_o(migrate_done), .has_link_i(axis_has_link),
    .before_i(in_update && update_done), .next_empty_i(empty_links), .next_load_o(migrate_next_load),
    .goes_on_o(migrate_goes_on),
    .next_axis_i(next_axis), .leaving_i(leaving_q), .count_i(own_count_q), .full_i(full_q),
    .count_set_o(migrate_count_set), .count_o(migrate_count), .full_o(migrate_full),
    .read_o(migrate_read), .read_slot_o(migrate_read_slot), .read_data_i(main_data), .write_o(migrate_write),
    .write_slot_o(migrate_write_slot), .write_data_o(migrate_write_data), .leaving_more_o(leaving_more),
    .can_load_i(axis_can_load), .load_o(migrate_load), .end_o(migrate_send_end), .data_o(migrate_beat),
    .face_o(migrate_face), .some_i(axis_some), .over_i(axis_over), .arrived_i(arrived),
    .pop_o(migrate_pop),
    .fault_left_o(fault_left), .fault_full_o(fault_full), .fault_particle_o(fault_particle)
  );

  assign migrate_arrived = migrate_pop;

  // The main read port of the slots, asked a cycle ahead, and what is observed through it. Outside its phases each of
  // the four rests at slot 0, where its next phase begins. The port asks in every cycle in which none of them waits.
  assign main_slot       = relay_slot | tick_next | migrate_read_slot | walk_slot;
  assign main_read       = relay_read && migrate_read && !main_hold;
  assign observe_valid_o = relay_observe || (in_dump && (own_count_q != '0));
  assign observe_data_o  = main_data[ParticleBits-1:0];

  logic unused_fields;
  assign unused_fields = ^{stream_data, fault_particle, in_round};
endmodule
