// SPDX-License-Identifier: MIT
// One particle processor that runs a rule of text. It is cuboct_node_core, with wide memories and halos by phases, but
// for the rounds: each exchanges what it reads of others, meets them and finishes. Three modules are generated of the
// rule: cuboct_rule_candidate says what others see of a particle, cuboct_rule_datapath is what pairs and finishes make.
// The contract, cycle by cycle, is docs/reference/node.md; words are those of cuboct_pkg.
module cuboct_rule_core #(
  // Machine.
  parameter int          Axes          = 3,   // 2 or 3
  parameter int          Capacity      = 16,  // particles, >= 1
  parameter int          FilterLanes   = 8,   // >= 1
  parameter int          ForcePipes    = 1,   // >= 1
  parameter int          QueueDepth    = 16,  // entries, >= 1
  parameter int          Overlap       = 1,   // 0, 1
  parameter int          LinkBits      = 66,  // payload of a beat, >= 1
  parameter int          IdBits        = 8,   // >= 1
  parameter int          PositionFrac  = 20,
  parameter int          FilterFrac    = 8,   // leading bits of a position that the filter tests
  parameter logic [63:0] PlanarOne     = 64'd0,
  parameter logic [63:0] PlanarTwo     = 64'd0,
  parameter logic [63:0] PlanarThree   = 64'd0,
  // Words.
  parameter int          ParticleBits  = 128,
  parameter int          IdLsb         = 90,  // of a particle's id; what others see lies below the id's end
  // Rounds.
  parameter int          Rounds        = 1,   // 1 ... 5
  parameter logic [Rounds*16-1:0] RecordBits = {Rounds{16'd62}},  // by round: of a record on the link
  parameter logic [Rounds*16-1:0] FinishCycles = {Rounds{16'd6}}, // by round: from a particle's read to its result's
  parameter int          MostBits      = 62,  // of any round's record
  parameter int          LaterBits     = 0,   // of all later rounds' records together
  // Bonds of the body as packed: a particle's word ends with its row of them.
  parameter int          Bonds         = 0,   // places of the row, 0: partners are all that are near
  parameter int          BondLsb       = 0,   // of the row
  parameter int          BondBits      = 1,   // of a place, which begins with the partner's id
  parameter int          IdInCandidate = 0,   // where a candidate's id is; Bonds only
  parameter int          Moves         = 1,   // 0: no particle leaves its node; of a migration the ends come alone
  localparam int         Faces         = 2 * Axes,
  localparam int         Phases        = 5 * Rounds + 3
) (
  input  logic                    clk_i,
  input  logic                    rst_ni,
  input  logic                    start_i,        // in IDLE: run steps_i steps
  input  logic [31:0]             steps_i,
  input  logic [Faces-1:0]        has_link_i,     // constant; faces -x, +x, -y, +y, -z, +z
  input  logic                    load_valid_i,   // in IDLE: append a particle
  input  logic [ParticleBits-1:0] load_data_i,
  output logic [Faces-1:0]        link_valid_o,
  output logic [Faces-1:0]        link_end_o,
  output logic [Faces*LinkBits-1:0] link_data_o,
  input  logic [Faces-1:0]        link_ready_i,
  input  logic [Faces-1:0]        link_valid_i,
  input  logic [Faces-1:0]        link_end_i,
  input  logic [Faces*LinkBits-1:0] link_data_i,
  output logic [Faces-1:0]        link_ready_o,
  output logic [Phases-1:0]       phase_start_o,  // exchange x y z, force, update of each round, migrate x y z
  output logic [Phases-1:0]       phase_end_o,
  output logic [3+ForcePipes:0]   force_event_o,  // in this cycle: engine runs, is stalled, presents a candidate,
                                                  // issues; each pipe takes a pair
  output logic                    observe_valid_o,
  output logic [ParticleBits-1:0] observe_data_o,
  output logic                    fault_valid_o,
  output logic [3:0]              fault_code_o,
  output logic [3:0]              fault_stage_o,  // twice the round, one more of a finish, two more of a migration
  output logic [IdBits-1:0]       fault_id_o,
  output logic [63:0]             fault_number_o,
  output logic                    idle_o
);
  // Every tool ends with an error where a module is missing: the parameters are out of their ranges.
  if (Axes < 2 || Axes > 3 || Capacity < 1 || FilterLanes < 1 || ForcePipes < 1 || QueueDepth < 1 || LinkBits < 1
      || IdBits < 1 || FilterFrac > PositionFrac || Rounds < 1 || Rounds > 5) begin : gen_range
    cuboct_parameter_out_of_range u_error ();
  end
  localparam int PosBits       = Axes * PositionFrac;
  localparam int OwnBits       = ParticleBits + 2;  // a slot: {away_x, particle}
  localparam int SeenBits      = IdLsb + IdBits;    // what others see of it
  localparam int PairBits      = (Bonds > 0) ? ParticleBits : SeenBits;  // what a pair reads of it
  localparam int LaneBits      = (Bonds > 0) ? Bonds * IdBits : Axes * FilterFrac;
  localparam int HaloBits      = {16'd0, RecordBits[15:0]};
  localparam int CandPos       = Axes * (PositionFrac + 2);
  localparam int RestBits      = HaloBits - Axes * PositionFrac - 2 * (Axes - 1);
  localparam int CandidateBits = CandPos + RestBits + LaterBits;
  // Numbers of slots, rows, records; counts have a bit to spare over addresses.
  localparam int SlotBits  = (Capacity > 1) ? $clog2(Capacity) : 1;
  localparam int LastSlot  = Capacity - 1;
  localparam int Rows      = (Capacity + FilterLanes - 1) / FilterLanes;
  localparam int RowBits   = (Rows > 1) ? $clog2(Rows) : 1;
  localparam int AddrBits  = $clog2(((Axes == 3) ? 9 : 3) * Capacity);
  localparam int CountBits = AddrBits + 1;

  function automatic integer later_lsb(input integer round);
    integer k;
    begin
      later_lsb = 0;
      for (k = 1; k < round; k = k + 1) later_lsb = later_lsb + {16'd0, RecordBits[k*16 +: 16]};
    end
  endfunction

  // The main machine.
  logic              in_exchange, in_update, in_migrate, in_dump, engine_runs, step_end;
  logic [Rounds-1:0] round;  // one bit each
  logic [1:0]        axis;
  logic [Axes-1:0]   axis_onehot, unused_axis_next, past_exchange, past_next;
  logic              exchange_done, force_done, update_done, migrate_done, dump_done, last_force;
  cuboct_sequencer #(.Axes(Axes), .Overlap(Overlap), .Rounds(Rounds)) u_sequencer (
    .clk_i, .rst_ni, .start_i, .steps_i, .exchange_done_i(exchange_done), .force_done_i(force_done),
    .update_done_i(update_done), .migrate_done_i(migrate_done), .dump_done_i(dump_done), .idle_o, .round_o(round),
    .exchange_o(in_exchange), .update_o(in_update), .migrate_o(in_migrate), .dump_o(in_dump), .axis_o(axis),
    .onehot_o(axis_onehot), .onehot_next_o(unused_axis_next), .engine_o(engine_runs), .past_exchange_o(past_exchange),
    .past_next_o(past_next), .step_end_o(step_end),
    .phase_start_o, .phase_end_o
  );
  assign last_force = force_done && round[Rounds-1];

  // Own particles: how many, and where they are written and read.
  logic [CountBits-1:0]           own_count_d, own_count_q, migrate_count;
  logic                           full_d, full_q, migrate_full;  // Capacity particles
  logic                           own_write, load, update_write, migrate_write, migrate_count_set;
  logic [SlotBits-1:0]            own_write_slot, update_slot, migrate_write_slot, main_slot, stream_slot;
  logic [OwnBits-1:0]             own_write_data, update_data, migrate_write_data, main_data;
  logic [PairBits-1:0]            stream_data;
  logic                           row_read, main_read, migrate_read;
  logic [Faces:0]                 stream_read;  // of own particles, and by face
  logic [ForcePipes*SlotBits-1:0] issue_slot, kick_slot_next;
  logic [ForcePipes*PairBits-1:0] pipe_data;
  logic [ForcePipes*IdBits-1:0]   kick_id;
  logic [RowBits-1:0]             row;
  logic [FilterLanes*LaneBits-1:0] row_data;

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
  cuboct_slots #(
    .Axes(Axes), .Bits(OwnBits), .SeenBits(PairBits), .PositionFrac(PositionFrac), .FilterFrac(FilterFrac),
    .IdLsb(IdLsb), .IdBits(IdBits), .Capacity(Capacity), .SlotBits(SlotBits), .FilterLanes(FilterLanes),
    .RowBits(RowBits), .ForcePipes(ForcePipes), .Streamers(1), .Narrow(0), .Bonds(Bonds),
    .BondLsb(BondLsb), .BondBits(BondBits)
  ) u_slots (
    .clk_i, .write_i(own_write), .write_slot_i(own_write_slot), .write_data_i(own_write_data),
    .main_read_i(main_read), .main_slot_i(main_slot), .main_data_o(main_data),
    .stream_read_i(stream_read[0]), .row_read_i(row_read),
    .stream_slot_i(stream_slot), .stream_data_o(stream_data), .row_i(row), .row_data_o(row_data),
    .pipe_slot_i(issue_slot), .pipe_data_o(pipe_data), .fault_slot_i(kick_slot_next), .fault_id_o(kick_id)
  );

  // Links: receivers.
  logic [Rounds*Faces-1:0]           halo_end;
  logic [Faces-1:0]                  migrate_empty, migrate_face, migrate_clear, halo_came, some_next, over_next;
  logic [Faces*CountBits-1:0]        halo_count;
  logic [AddrBits-1:0]               stream_addr;
  logic [Faces*CandidateBits-1:0]    stream_halos;
  logic [Rounds-1:0]                 relay_read;
  logic [Rounds*(Faces-2)-1:0]       relay_clear;
  logic [Rounds*AddrBits-1:0]        relay_addr;
  logic [Rounds*MostBits-1:0]        relay_halos;
  logic [Faces*ParticleBits-1:0]     particles;
  logic [ParticleBits-1:0]           arrived;  // the oldest of the face that migration takes from
  cuboct_round_halos #(
    .Axes(Axes), .PositionFrac(PositionFrac), .Capacity(Capacity), .LinkBits(LinkBits), .Rounds(Rounds),
    .RecordBits(RecordBits), .HaloBits(HaloBits), .MostBits(MostBits),
    .CandidateBits(CandidateBits), .ParticleBits(ParticleBits), .Moves(Moves), .AddrBits(AddrBits),
    .CountBits(CountBits)
  ) u_halos (
    .clk_i, .rst_ni, .has_link_i, .link_valid_i, .link_end_i, .link_data_i, .halo_clear_i(last_force),
    .halo_end_o(halo_end), .halo_count_o(halo_count), .halo_came_o(halo_came),
    .stream_read_i(stream_read[Faces:1]),
    .stream_addr_i(stream_addr), .stream_data_o(stream_halos), .relay_read_i(relay_read), .relay_clear_i(relay_clear),
    .relay_addr_i(relay_addr), .relay_data_o(relay_halos), .migrating_i(in_migrate), .migrate_clear_i(migrate_clear),
    .migrate_empty_o(migrate_empty), .migrate_some_next_o(some_next), .migrate_over_next_o(over_next),
    .migrate_data_o(particles), .migrate_pop_i(migrate_face & ~migrate_empty)
  );
  assign link_ready_o = '1;
  integer f;
  always_comb begin
    arrived = '0;
    for (f = 0; f < Faces; f = f + 1) begin
      arrived = arrived | (particles[f*ParticleBits +: ParticleBits] & {ParticleBits{migrate_face[f]}});
    end
  end

  // leaving[a]: some own particle has to go along axis a.
  logic [Axes-1:0] leaving_d, leaving_q, leaving_more, away_axes;

  // Links: senders. One axis speaks at a time: a relay in EXCHANGE, the migration in MIGRATE.
  logic [Faces-1:0]    can_load, load_link;
  logic [1:0]          axis_can_load, axis_load, migrate_load, axis_has_link;
  logic                relay_load, relay_end, migrate_send_end, send_end;
  logic [LinkBits-1:0] relay_beat, relay_halo_beat, migrate_beat, send_data;
  for (genvar t = 0; t < Faces; t++) begin : gen_tx
    cuboct_link_tx #(.LinkBits(LinkBits)) u_tx (
      .clk_i, .rst_ni, .has_link_i(has_link_i[t]), .load_i(load_link[t]), .end_i(send_end), .data_i(send_data),
      .can_load_o(can_load[t]), .valid_o(link_valid_o[t]), .end_o(link_end_o[t]),
      .data_o(link_data_o[t*LinkBits +: LinkBits]), .ready_i(link_ready_i[t])
    );
  end
  // What belongs to the axis of the present phase, and of the one that the next migration is along.
  logic [Faces-1:0]  round_end;     // of this round's halos
  logic [1:0]        axis_halo_end;
  logic [Axes-1:0]   next_axis;     // of the next migration phase
  integer            b, r;
  always_comb begin
    round_end = '0;
    for (r = 0; r < Rounds; r = r + 1) round_end = round_end | (halo_end[r*Faces +: Faces] & {Faces{round[r]}});
    axis_can_load = 2'b00;
    axis_has_link = 2'b00;
    axis_halo_end = 2'b00;
    next_axis     = '0;
    next_axis[0]  = !in_migrate;
    for (b = 0; b < Axes; b = b + 1) begin
      if (axis_onehot[b]) begin
        axis_can_load = can_load[2*b +: 2];
        axis_has_link = has_link_i[2*b +: 2];
        axis_halo_end = round_end[2*b +: 2];
      end
      if (b > 0) next_axis[b] = in_migrate && axis_onehot[b-1];
    end
  end
  // The same of the inboxes: what migration is told comes from registers.
  logic [1:0] some_here, some_there, over_here, over_there, some_q, over_q;  // of this axis, of the next one
  integer     c;
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
  assign axis_load = in_migrate ? migrate_load : {2{relay_load}};
  assign send_end  = in_exchange ? relay_end : migrate_send_end;
  // All but one are 0.
  cuboct_late #(.Bits(LinkBits)) u_send (
    .early_i(migrate_beat | relay_beat), .late_i(relay_halo_beat), .other_i('0), .or_o(send_data)
  );
  for (genvar a = 0; a < Axes; a++) begin : gen_axis_link
    assign load_link[2*a +: 2] = axis_load & {2{axis_onehot[a]}};
  end

  // Particles as candidates.
  logic [CandidateBits-1:0] own_candidate, relay_own;
  cuboct_rule_candidate u_stream_candidate (.own_i(stream_data[SeenBits-1:0]), .candidate_o(own_candidate));
  cuboct_rule_candidate u_relay_candidate (.own_i(main_data[SeenBits-1:0]), .candidate_o(relay_own));

  // Exchange: a relay for each round.
  logic [Rounds-1:0]          sends, ends, sent, first_own;
  logic [Rounds*LinkBits-1:0] beats, halo_beats;
  logic [Rounds*SlotBits-1:0] relay_slots;
  for (genvar k = 0; k < Rounds; k++) begin : gen_relay
    localparam int Bits  = {16'd0, RecordBits[k*16 +: 16]};
    localparam int Width = (Bits > 0) ? Bits : 1;
    logic [Width-1:0]                own, halo;
    logic [(Faces-1)*CountBits-1:0]  counts;
    logic [Faces-2:0]                pick, clear;
    logic [AddrBits-1:0]             ahead;
    if (Bits == 0) begin : gen_nothing
      assign own    = '0;
      assign halo   = '0;
      assign counts = '0;
    end else begin : gen_records
      if (k > 0) begin : gen_later
        assign own = relay_own[CandPos+RestBits+later_lsb(k) +: Bits];
      end else if (RestBits > 0) begin : gen_first
        assign own = {relay_own[CandPos +: RestBits], relay_own[CandPos-3:0]};
      end else begin : gen_bare
        assign own = relay_own[CandPos-3:0];
      end
      assign halo   = relay_halos[k*MostBits +: Bits];
      assign counts = {halo_count[(Faces-2)*CountBits-1:0], own_count_d};
    end
    logic [0:0]          no_word;
    cuboct_relay #(
      .Axes(Axes), .LinkBits(LinkBits), .HaloBits(Width), .SlotBits(SlotBits), .AddrBits(AddrBits),
      .CountBits(CountBits), .Narrow(0)
    ) u_relay (
      .clk_i, .rst_ni, .active_i(in_exchange && round[k]), .axis_i(axis), .done_i(exchange_done), .counts_i(counts),
      .pick_o(pick), .clear_o(clear), .read_o(relay_read[k]), .addr_o(relay_addr[k*AddrBits +: AddrBits]),
      .ahead_o(ahead), .slot_o(relay_slots[k*SlotBits +: SlotBits]), .record_i(own), .halo_i(halo),
      .word_o(no_word), .word_i('0),
      .can_load_i(axis_can_load == 2'b11), .load_o(sends[k]), .end_o(ends[k]),
      .data_o(beats[k*LinkBits +: LinkBits]), .halo_data_o(halo_beats[k*LinkBits +: LinkBits]),
      .first_own_o(first_own[k]), .sent_o(sent[k])
    );
    assign relay_clear[k*(Faces-2) +: Faces-2] = clear[Faces-2:1];
    logic unused_relay;
    assign unused_relay = ^{pick, clear[0], ahead, no_word};
  end
  logic [SlotBits-1:0] relay_slot;
  integer              k;
  always_comb begin
    relay_beat      = '0;
    relay_halo_beat = '0;
    relay_slot      = '0;
    for (k = 0; k < Rounds; k = k + 1) begin
      relay_beat      = relay_beat | beats[k*LinkBits +: LinkBits];
      relay_halo_beat = relay_halo_beat | halo_beats[k*LinkBits +: LinkBits];
      relay_slot      = relay_slot | relay_slots[k*SlotBits +: SlotBits];
    end
  end
  assign relay_load    = (sends != '0);
  assign relay_end     = (ends != '0);
  assign exchange_done = in_exchange && (sent & round) != '0 && (axis_halo_end == 2'b11);

  // Force engine.
  logic [CandidateBits-1:0] issue_candidate;
  logic [ForcePipes-1:0]    issue, pipe_busy;
  logic                     finder_done, present, force_stall;
  logic [Faces:0]           complete, stream_next;
  logic                     unused_next;
  assign unused_next = ^stream_next;
  assign complete[0] = 1'b1;
  for (genvar h = 0; h < Faces; h++) begin : gen_complete
    assign complete[h+1] = past_next[h/2];
  end
  cuboct_pair_finder #(
    .Axes(Axes), .Halos(Faces), .Own(1), .Arrival(0), .Rounds(Rounds), .PositionFrac(PositionFrac),
    .FilterFrac(FilterFrac), .PlanarOne(PlanarOne), .PlanarTwo(PlanarTwo), .PlanarThree(PlanarThree),
    .CandidateBits(CandidateBits), .FilterLanes(FilterLanes), .ForcePipes(ForcePipes), .Interval(1),
    .QueueDepth(QueueDepth), .RowBits(RowBits), .SlotBits(SlotBits), .AddrBits(AddrBits), .CountBits(CountBits),
    .Bonds(Bonds), .IdBits(IdBits), .IdLsb(IdInCandidate)
  ) u_finder (
    .clk_i, .rst_ni, .run_i(engine_runs), .restart_i(force_done), .own_count_i(own_count_q), .complete_next_i(complete),
    .came_i(halo_came), .again_i(!round[Rounds-1]), .counts_i(halo_count), .read_o(stream_read), .next_o(stream_next),
    .row_read_o(row_read), .slot_o(stream_slot), .addr_o(stream_addr), .own_i(own_candidate), .halos_i(stream_halos),
    .row_o(row), .row_data_i(row_data), .candidate_o(issue_candidate), .issue_o(issue), .issue_slot_o(issue_slot),
    .present_o(present), .stall_o(force_stall), .done_o(finder_done)
  );
  assign force_event_o = {issue, issue != '0, present, force_stall, engine_runs};
  assign force_done    = engine_runs && finder_done && (pipe_busy == '0);

  // Updates and dump walk the slots.
  logic [SlotBits-1:0] tick_slot, tick_next;
  logic [Rounds-1:0]   more, updated, dumped;
  logic [Rounds*SlotBits-1:0] ticks, nexts;
  for (genvar u = 0; u < Rounds; u++) begin : gen_tick
    localparam int Cycles   = {16'd0, FinishCycles[u*16 +: 16]};
    localparam int TickBits = $clog2(Capacity + Cycles + 1);
    localparam int First    = (u == 0) ? 1 : 0;  // the first one dumps
    logic [TickBits-1:0] tick, next;
    cuboct_tick #(.Tail(Cycles - 2), .Registered(0), .CountBits(CountBits), .TickBits(TickBits)) u_tick (
      .clk_i, .rst_ni, .update_i(in_update && round[u]), .dump_i(in_dump && First != 0), .step_i(1'b1),
      .count_i(own_count_q), .tick_o(tick), .next_o(next), .more_o(more[u]), .update_done_o(updated[u]),
      .dump_done_o(dumped[u])
    );
    assign ticks[u*SlotBits +: SlotBits] = tick[SlotBits-1:0];
    assign nexts[u*SlotBits +: SlotBits] = next[SlotBits-1:0];
    logic unused_tick;
    assign unused_tick = ^{tick, next};
  end
  integer m;
  always_comb begin
    tick_slot = '0;
    tick_next = '0;
    for (m = 0; m < Rounds; m = m + 1) begin
      tick_slot = tick_slot | ticks[m*SlotBits +: SlotBits];
      tick_next = tick_next | nexts[m*SlotBits +: SlotBits];
    end
  end
  assign update_done = (updated != '0);
  assign dump_done   = (dumped != '0);
  logic take, fault_left, fault_full, some_fault;
  assign take = in_update && (more & round) != '0;

  logic [ParticleBits-1:0] fault_particle;
  cuboct_rule_datapath u_datapath (
    .clk_i, .rst_ni, .round_i(round), .issue_i(issue), .issue_slot_i(issue_slot), .candidate_i(issue_candidate),
    .own_i(pipe_data), .busy_o(pipe_busy), .kick_slot_o(kick_slot_next), .kick_id_i(kick_id), .look_slot_i(tick_next),
    .take_i(take), .take_slot_i(tick_slot), .slot_i(main_data), .written_o(update_write), .slot_number_o(update_slot),
    .slot_o(update_data), .leaving_o(away_axes), .step_end_i(step_end), .move_fault_i(fault_left || fault_full),
    .move_axis_i(axis), .move_full_i(fault_full), .move_id_i(fault_particle[IdLsb +: IdBits]), .fault_o(some_fault),
    .fault_code_o({fault_stage_o, fault_code_o}), .fault_id_o, .fault_number_o
  );
  assign fault_valid_o = some_fault && step_end;  // a step's last cycle is one in which nothing moves

  // Migration.
  logic [SlotBits-1:0] migrate_read_slot;
  logic                migrate_pop;
  logic [Axes-1:0]     next_load, goes_on;
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
    .SlotBits(SlotBits), .CountBits(CountBits), .Early(0)
  ) u_migrate (
    .clk_i, .rst_ni, .active_i(in_migrate), .axis_i(axis), .done_o(migrate_done), .has_link_i(axis_has_link),
    .before_i(1'b0), .next_axis_i(next_axis), .leaving_i(leaving_q), .next_empty_i('0), .next_load_o(next_load),
    .goes_on_o(goes_on),
    .count_i(own_count_q), .full_i(full_q), .count_set_o(migrate_count_set), .count_o(migrate_count),
    .full_o(migrate_full), .read_o(migrate_read), .read_slot_o(migrate_read_slot), .read_data_i(main_data),
    .write_o(migrate_write), .write_slot_o(migrate_write_slot), .write_data_o(migrate_write_data),
    .leaving_more_o(leaving_more), .can_load_i(axis_can_load), .load_o(migrate_load), .end_o(migrate_send_end),
    .data_o(migrate_beat), .face_o(migrate_face), .some_i(some_q), .over_i(over_q), .arrived_i(arrived),
    .pop_o(migrate_pop), .fault_left_o(fault_left), .fault_full_o(fault_full), .fault_particle_o(fault_particle)
  );

  // The main read port of the slots, asked a cycle ahead, and what is observed through it. Outside its phases each that
  // asks rests at slot 0, where its next phase begins. The port asks in every cycle in which none of them waits.
  assign main_slot       = relay_slot | tick_next | migrate_read_slot;
  assign main_read       = (relay_read == '1) && migrate_read;
  assign observe_valid_o = (first_own[0] && axis == 2'd0) || (in_dump && (own_count_q != '0));
  assign observe_data_o  = main_data[ParticleBits-1:0];

  logic unused_past;
  assign unused_past = ^past_exchange;
  logic unused_fields;
  assign unused_fields = ^{stream_data, relay_own, relay_halos, fault_particle, migrate_pop, next_load, goes_on,
                           first_own};
endmodule
