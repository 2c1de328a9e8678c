// SPDX-License-Identifier: MIT
// A particle processor that serves a brick of cells in turn: cuboct_node_core for several cells. The contract, cycle by
// cycle, is docs/reference/node.md, "Bricks"; a particle's word is that of cuboct_node_core, the others are
//   particle on a link: particle, number of the cell in the face
//   halo record:        x[P] y[P] z[P] type[TypeBits, Scaled] v[3 x VelocityBits, Damped], number of the cell in the
//                       layer
module cuboct_brick_core #(
  // Machine.
  parameter int          Axes                 = 3,      // 2 or 3
  parameter int          BrickX               = 2,      // cells that the node serves; two at least
  parameter int          BrickY               = 2,
  parameter int          BrickZ               = 2,      // 1 with two axes
  parameter int          Capacity             = 16,     // particles of a cell, >= 1
  parameter int          FilterLanes          = 8,      // >= 1
  parameter int          ForcePipes           = 1,      // >= 1
  parameter int          Shared               = 0,      // 0, 1: one multiplier serves the axes in turn
  parameter int          Product              = 1,      // cycles of a multiplier of the pipe; 1 if Shared
  parameter int          Interval             = 1,      // cycles from one pair to the next
  parameter int          QueueDepth           = 16,     // entries, >= 1
  parameter int          Overlap              = 1,      // 0, 1
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
  localparam int         Cells                = BrickX * BrickY * BrickZ,
  localparam int         CellBits             = $clog2(Cells),
  localparam int         Longest              = (BrickX > BrickY) ? ((BrickX > BrickZ) ? BrickX : BrickZ)
                                                                  : ((BrickY > BrickZ) ? BrickY : BrickZ),
  localparam int         GridBits             = $clog2(Longest + 2),  // of a coordinate: cuboct_brick_walk
  localparam int         HaloType             = (Scaled != 0) ? TypeBits : 0,
  localparam int         HaloVelocity         = (Damped != 0) ? Axes * VelocityBits : 0,
  localparam int         HaloBits             = Axes * PositionFrac + HaloType + HaloVelocity,
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
  input  logic [3*GridBits-1:0]   extent_i,       // constant; cells along x, y, z: those of the brick, or fewer
  input  logic [Cells*Faces-1:0]  exit_i,         // constant; by own cell and face: the lattice has a cell there
  input  logic                    load_valid_i,   // in IDLE: append a particle
  input  logic [CellBits-1:0]     load_cell_i,    // to this cell
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
  output logic [ForcePipes+3:0]   force_event_o,  // in this cycle: engine runs, stalled, presents a candidate, issues;
                                                  // each pipe takes a pair
  output logic                    observe_valid_o,
  output logic [CellBits-1:0]     observe_cell_o,
  output logic [ParticleBits-1:0] observe_data_o,
  output logic                    fault_valid_o,
  output logic [3:0]              fault_code_o,
  output logic [IdBits-1:0]       fault_id_o,
  output logic [CellBits-1:0]     fault_cell_o,
  output logic [63:0]             fault_number_o,
  output logic                    idle_o
);
  // Every tool ends with an error where a module is missing: the parameters are out of their ranges.
  if (Axes < 2 || Axes > 3 || Cells < 2 || (Axes == 2 && BrickZ != 1) || Capacity < 1 || FilterLanes < 1
      || ForcePipes < 1 || QueueDepth < 1 || LinkBits < 1 || IdBits < 1 || TypeBits < 0
      || FilterFrac > PositionFrac) begin : gen_range
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
  // A candidate is a halo record with signs.
  localparam int CandPos       = Axes * (PositionFrac + 2);
  localparam int CandidateBits = CandPos + HaloType + HaloVelocity;
  // Cells of the layers over the axes, of the faces; what a number of theirs takes on a link.
  localparam int LayerX    = BrickY * BrickZ;
  localparam int LayerY    = (BrickX + 2) * BrickZ;
  localparam int LayerZ    = (Axes == 3) ? (BrickX + 2) * (BrickY + 2) : 1;
  localparam int LayerXY   = (LayerX > LayerY) ? LayerX : LayerY;
  localparam int Layer     = (LayerXY > LayerZ) ? LayerXY : LayerZ;
  localparam int TagBits   = $clog2(Layer);
  localparam int FaceY     = BrickX * BrickZ;
  localparam int FaceZ     = (Axes == 3) ? BrickX * BrickY : 1;
  localparam int FaceXY    = (LayerX > FaceY) ? LayerX : FaceY;
  localparam int FaceBits  = $clog2((FaceXY > FaceZ) ? FaceXY : FaceZ);
  // Numbers of slots and rows in a cell, and addresses; counts have a bit to spare over slots.
  localparam int SlotBits    = (Capacity > 1) ? $clog2(Capacity) : 1;
  localparam int CountBits   = SlotBits + 1;
  localparam int PlaceBits   = CellBits + SlotBits;  // {cell, slot}
  localparam int AddrBits    = PlaceBits;            // cell * Capacity + slot
  localparam int Rows        = (Capacity + FilterLanes - 1) / FilterLanes;
  localparam int RowBits     = (Rows > 1) ? $clog2(Rows) : 1;
  localparam int RowAddrBits = CellBits + RowBits;
  localparam int HaloAddrBits = TagBits + SlotBits;
  // Update.
  // A cycle after the last one is written MIGRATE may read it.
  localparam int UpdateLatency = (Pd != 0) ? 7 : (Weighted != 0) ? 6 : 4;
  localparam int UpdateTail    = UpdateLatency - 2;
  localparam int TailBits      = $clog2(UpdateLatency);

  // The main machine.
  logic       in_round, in_exchange, in_update, in_migrate, in_dump, engine_runs, step_end;
  logic [1:0] axis;
  logic [Axes-1:0] past_exchange, axis_onehot, unused_axis_next, unused_past_next;
  logic       exchange_done, force_done, update_done, migrate_done, dump_done;
  cuboct_sequencer #(.Axes(Axes), .Overlap(Overlap)) u_sequencer (
    .clk_i, .rst_ni, .start_i, .steps_i, .exchange_done_i(exchange_done), .force_done_i(force_done),
    .update_done_i(update_done), .migrate_done_i(migrate_done), .dump_done_i(dump_done), .idle_o,
    .round_o(in_round), .exchange_o(in_exchange), .update_o(in_update), .migrate_o(in_migrate), .dump_o(in_dump),
    .axis_o(axis), .onehot_o(axis_onehot), .onehot_next_o(unused_axis_next),
    .engine_o(engine_runs), .past_exchange_o(past_exchange), .past_next_o(unused_past_next),
    .step_end_o(step_end), .phase_start_o, .phase_end_o
  );

  // Its walk over the own cells, in UPDATE, MIGRATE and DUMP; that of the relay over layers of cells.
  logic                  ticking, tick_over, migrate_advance, migrate_leave, migrate_ends, tick_advance, advance;
  logic                  last_cell;
  logic [CellBits-1:0]   main_own, after_own, asked_own, here;
  logic [3*TagBits-1:0]  main_face, after_face;
  logic [2:0]            main_low, main_high, after_low, after_high;
  assign advance   = migrate_advance || tick_advance;
  assign last_cell = (main_high == 3'b111);
  cuboct_brick_cells #(
    .BrickX(BrickX), .BrickY(BrickY), .GridBits(GridBits), .CellBits(CellBits), .TagBits(TagBits)
  ) u_cells (
    .clk_i, .rst_ni, .extent_i, .advance_i(advance), .own_o(main_own), .face_o(main_face), .low_o(main_low),
    .high_o(main_high), .after_own_o(after_own), .after_face_o(after_face), .after_low_o(after_low),
    .after_high_o(after_high)
  );
  logic [3*GridBits-1:0] relay_low, relay_high, relay_first, relay_cell, relay_after, relay_next;
  logic                  relay_advance, relay_restart, relay_step, relay_last;
  logic [CellBits-1:0]   relay_own, relay_own_d, first_own, next_own;
  logic [3*TagBits-1:0]  relay_layer, relay_layer_d, first_layer, first_face, next_layer, next_face;
  cuboct_brick_walk #(.GridBits(GridBits)) u_walk (
    .clk_i, .rst_ni, .low_i(relay_low), .high_i(relay_high), .advance_i(relay_advance), .restart_i(relay_restart),
    .first_i(relay_first), .cell_o(relay_cell), .after_o(relay_after), .next_o(relay_next), .last_o(relay_last)
  );
  cuboct_brick_place #(
    .BrickX(BrickX), .BrickY(BrickY), .GridBits(GridBits), .CellBits(CellBits), .TagBits(TagBits)
  ) u_first_place (.cell_i(relay_first), .own_o(first_own), .layer_o(first_layer), .face_o(first_face));
  cuboct_brick_place #(
    .BrickX(BrickX), .BrickY(BrickY), .GridBits(GridBits), .CellBits(CellBits), .TagBits(TagBits)
  ) u_next_place (.cell_i(relay_after), .own_o(next_own), .layer_o(next_layer), .face_o(next_face));
  always_comb begin
    relay_own_d   = relay_own;
    relay_layer_d = relay_layer;
    if (relay_restart) begin
      relay_own_d   = first_own;
      relay_layer_d = first_layer;
    end else if (relay_advance) begin
      relay_own_d   = next_own;
      relay_layer_d = next_layer;
    end
  end
  localparam int HomeZ = BrickX + 3;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      relay_own   <= '0;
      relay_layer <= {HomeZ[TagBits-1:0], {(TagBits - 1) {1'b0}}, 1'b1, {TagBits{1'b0}}};
    end else begin
      relay_own   <= relay_own_d;
      relay_layer <= relay_layer_d;
    end
  end

  // Own particles: how many, and where they are written and read.
  logic [CountBits-1:0]           main_count, main_count_d, asked_count, stream_own_count, stream_near_count, count_set;
  logic [CountBits-1:0]           migrate_count, relay_own_count;
  logic [CellBits-1:0]            stream_own, stream_near, write_cell;
  logic                           own_write, load, update_write, migrate_write, migrate_count_set, migrate_land;
  logic                           any_held, count_write, alone, leave, main_written, away_written;
  logic [SlotBits-1:0]            write_slot, migrate_write_slot;
  logic [PlaceBits-1:0]           update_place;
  logic [AddrBits-1:0]            write_addr, main_addr, stream_addr, after_addr, leave_addr, away_addr, first_addr;
  logic [AddrBits-1:0]            next_addr, own_addr_d, own_addr_q, relay_addr_d, relay_addr_q;
  logic [OwnBits-1:0]             write_data, update_data, migrate_write_data, main_data;
  logic [2*Axes-1:0]              main_away;
  logic [SeenBits-1:0]            stream_data;
  logic                           stream_read;
  logic [ForcePipes*SlotBits-1:0] issue_slot;
  logic [ForcePipes*PlaceBits-1:0] issue_place;
  logic [ForcePipes*AddrBits-1:0] pipe_addr, kick_addr_next;
  logic [ForcePipes*SeenBits-1:0] pipe_data;
  logic [ForcePipes*IdBits-1:0]   kick_id;
  logic [CellBits-1:0]            issue_cell;
  logic [RowAddrBits-1:0]         row;
  logic [FilterLanes*Axes*FilterFrac-1:0] row_data;

  // The present cell's count is in a register; the counts are asked for that of the cell after it.
  assign here        = idle_o ? load_cell_i : main_own;
  assign asked_own   = idle_o ? load_cell_i : after_own;
  assign load        = idle_o && load_valid_i && (asked_count != Capacity[CountBits-1:0]);
  assign count_write = load || migrate_count_set;
  cuboct_brick_counts #(.Cells(Cells), .AddrBits(CellBits), .Bits(CountBits), .Reads(4)) u_counts (
    .clk_i, .rst_ni, .clear_i(1'b0), .write_i(count_write), .write_addr_i(here), .count_i(count_set),
    .addr_i({relay_own, stream_near, stream_own, asked_own}),
    .count_o({relay_own_count, stream_near_count, stream_own_count, asked_count}), .any_o(any_held)
  );
  assign alone = (after_own == main_own);  // a ragged brick of one cell
  always_comb begin
    main_count_d = main_count;
    if (migrate_land || (load && here == main_own)) main_count_d = main_count + 1'b1;
    if (advance && alone) begin
      if (migrate_count_set) main_count_d = migrate_count;
    end else if (advance) begin
      main_count_d = asked_count;
    end
  end
  always_ff @(posedge clk_i) begin
    if (!rst_ni) main_count <= '0;
    else main_count <= main_count_d;
  end
  always_comb begin
    count_set  = idle_o ? asked_count + 1'b1 : migrate_count;
    own_write  = load || update_write || migrate_write;
    // Chosen by the state, which is there before the writes are.
    write_cell = update_place[SlotBits +: CellBits];
    write_slot = update_place[SlotBits-1:0];
    write_data = update_data;
    if (in_migrate) begin
      write_cell = here;
      write_slot = migrate_write_slot;
      write_data = migrate_write_data;
    end else if (idle_o) begin
      write_cell = here;
      write_slot = asked_count[SlotBits-1:0];
      write_data = {2'b00, load_data_i};
    end
  end
  cuboct_brick_addr #(
    .Factor(Capacity), .CellBits(CellBits), .SlotBits(SlotBits), .AddrBits(AddrBits)
  ) u_write_addr (.cell_i(write_cell), .slot_i(write_slot), .addr_o(write_addr));
  // The main read port is asked a cycle ahead: by the relay, else for a slot of the own cell, the next one, the first
  // one of the cell after it, or the same again.
  cuboct_brick_addr #(
    .Factor(Capacity), .CellBits(CellBits), .SlotBits(SlotBits), .AddrBits(AddrBits)
  ) u_first_addr (.cell_i(first_own), .slot_i({SlotBits{1'b0}}), .addr_o(first_addr));
  cuboct_brick_addr #(
    .Factor(Capacity), .CellBits(CellBits), .SlotBits(SlotBits), .AddrBits(AddrBits)
  ) u_next_addr (.cell_i(next_own), .slot_i({SlotBits{1'b0}}), .addr_o(next_addr));
  always_comb begin
    relay_addr_d = relay_addr_q;
    if (relay_step) relay_addr_d = relay_addr_q + 1'b1;
    if (relay_advance) relay_addr_d = next_addr;
    if (relay_restart) relay_addr_d = first_addr;
  end
  always_ff @(posedge clk_i) begin
    if (!rst_ni) relay_addr_q <= '0;
    else relay_addr_q <= relay_addr_d;
  end
  cuboct_brick_addr #(
    .Factor(Capacity), .CellBits(CellBits), .SlotBits(SlotBits), .AddrBits(AddrBits)
  ) u_after_addr (.cell_i(after_own), .slot_i({SlotBits{1'b0}}), .addr_o(after_addr));
  assign leave        = migrate_leave || ticking;
  assign leave_addr   = (in_migrate ? migrate_ends : tick_over) ? after_addr : own_addr_q + 1'b1;
  assign own_addr_d   = leave ? leave_addr : own_addr_q;
  assign main_addr    = leave ? leave_addr : in_exchange ? relay_addr_d : own_addr_q;
  // Before MIGRATE only the first cell's first slot matters of where a particle goes: it is asked for with the last
  // one.
  assign away_addr    = (!in_migrate || migrate_ends) ? after_addr : own_addr_q + 1'b1;
  // No phase asks for a next slot of the cell in the cycle in which this is written.
  assign main_written = own_write && (leave ? advance && write_addr == after_addr : write_addr == own_addr_q);
  assign away_written = own_write && (leave ? (!in_migrate || migrate_ends) && write_addr == after_addr
                                            : write_addr == own_addr_q);
  always_ff @(posedge clk_i) begin
    if (!rst_ni) own_addr_q <= '0;
    else own_addr_q <= own_addr_d;
  end
  for (genvar f = 0; f < ForcePipes; f++) begin : gen_addr
    cuboct_brick_addr #(
      .Factor(Capacity), .CellBits(CellBits), .SlotBits(SlotBits), .AddrBits(AddrBits)
    ) u_pipe_addr (
      .cell_i(issue_cell), .slot_i(issue_slot[f*SlotBits +: SlotBits]), .addr_o(pipe_addr[f*AddrBits +: AddrBits])
    );
    assign issue_place[f*PlaceBits +: PlaceBits] = {issue_cell, issue_slot[f*SlotBits +: SlotBits]};
  end
  cuboct_brick_slots #(
    .Axes(Axes), .Bits(OwnBits), .SeenBits(SeenBits), .PositionFrac(PositionFrac), .FilterFrac(FilterFrac),
    .IdLsb(IdLsb), .IdBits(IdBits), .Cells(Cells), .CellBits(CellBits), .Capacity(Capacity), .SlotBits(SlotBits),
    .AddrBits(AddrBits), .FilterLanes(FilterLanes), .RowAddrBits(RowAddrBits), .ForcePipes(ForcePipes)
  ) u_slots (
    .clk_i, .write_i(own_write), .write_cell_i(write_cell), .write_slot_i(write_slot), .write_addr_i(write_addr),
    .write_data_i(write_data), .main_addr_i(main_addr), .main_written_i(main_written), .main_data_o(main_data),
    .away_read_i(leave), .away_addr_i(away_addr), .away_written_i(away_written), .away_o(main_away),
    .stream_read_i(stream_read), .stream_addr_i(stream_addr), .stream_data_o(stream_data), .row_i(row),
    .row_data_o(row_data),
    .pipe_addr_i(pipe_addr), .pipe_data_o(pipe_data), .fault_addr_i(kick_addr_next), .fault_id_o(kick_id)
  );

  // Links: receivers.
  logic [Faces-1:0]              halo_end, migrate_end, migrate_none, migrate_pop, migrate_clear;
  logic [3*TagBits-1:0]          stream_layer;
  logic [Faces*CountBits-1:0]    stream_halo_count, relay_halo_count;
  logic [3*HaloAddrBits-1:0]     stream_halo_addr, relay_halo_addr;
  logic [Faces*HaloBits-1:0]     stream_halos, relay_halos;
  logic                          of_after;
  logic [Faces*CountBits-1:0]    land_count;
  logic [Faces*ParticleBits-1:0] arrived;
  for (genvar a = 0; a < 3; a++) begin : gen_relay_addr
    logic [HaloAddrBits-1:0] first_at, next_at, at_d, at_q;
    cuboct_brick_addr #(
      .Factor(Capacity), .CellBits(TagBits), .SlotBits(SlotBits), .AddrBits(HaloAddrBits)
    ) u_first (.cell_i(first_layer[a*TagBits +: TagBits]), .slot_i({SlotBits{1'b0}}), .addr_o(first_at));
    cuboct_brick_addr #(
      .Factor(Capacity), .CellBits(TagBits), .SlotBits(SlotBits), .AddrBits(HaloAddrBits)
    ) u_next (.cell_i(next_layer[a*TagBits +: TagBits]), .slot_i({SlotBits{1'b0}}), .addr_o(next_at));
    always_comb begin
      at_d = at_q;
      if (relay_step) at_d = at_q + 1'b1;
      if (relay_advance) at_d = next_at;
      if (relay_restart) at_d = first_at;
    end
    always_ff @(posedge clk_i) begin
      if (!rst_ni) at_q <= '0;  // of no use until the walk comes to a halo
      else at_q <= at_d;
    end
    assign relay_halo_addr[a*HaloAddrBits +: HaloAddrBits] = at_d;
  end
  cuboct_brick_halos #(
    .Axes(Axes), .BrickX(BrickX), .BrickY(BrickY), .BrickZ(BrickZ), .Capacity(Capacity), .LinkBits(LinkBits),
    .HaloBits(HaloBits), .ParticleBits(ParticleBits), .TagBits(TagBits), .FaceBits(FaceBits), .CountBits(CountBits),
    .AddrBits(HaloAddrBits)
  ) u_halos (
    .clk_i, .rst_ni, .has_link_i, .link_valid_i, .link_end_i, .link_data_i, .link_ready_o,
    .halo_clear_i(force_done), .halo_end_o(halo_end), .stream_cell_i(stream_layer),
    .stream_count_o(stream_halo_count), .stream_read_i(stream_read), .stream_addr_i(stream_halo_addr),
    .stream_data_o(stream_halos), .relay_cell_i(relay_layer), .relay_count_o(relay_halo_count),
    .relay_addr_i(relay_halo_addr), .relay_data_o(relay_halos), .migrating_i(in_migrate),
    .migrate_clear_i(migrate_clear), .migrate_end_o(migrate_end), .migrate_none_o(migrate_none),
    .land_cell_i(of_after ? after_face : main_face), .land_count_o(land_count), .migrate_data_o(arrived),
    .migrate_pop_i(migrate_pop)
  );

  // Links: senders. One axis speaks at a time: the relay in EXCHANGE, the migration in MIGRATE.
  logic [Faces-1:0]    can_load, load_link;
  logic [1:0]          axis_can_load, axis_load, relay_load, migrate_load;
  logic                relay_end, migrate_send_end, send_end;
  logic [LinkBits-1:0] relay_beat, migrate_beat, send_data;
  for (genvar f = 0; f < Faces; f++) begin : gen_tx
    cuboct_link_tx #(.LinkBits(LinkBits)) u_tx (
      .clk_i, .rst_ni, .has_link_i(has_link_i[f]), .load_i(load_link[f]), .end_i(send_end), .data_i(send_data),
      .can_load_o(can_load[f]), .valid_o(link_valid_o[f]), .end_o(link_end_o[f]),
      .data_o(link_data_o[f*LinkBits +: LinkBits]), .ready_i(link_ready_i[f])
    );
  end
  // leaving[cell][a]: some particle of the cell has to go along axis a.
  logic [Cells*Axes-1:0]     leaving_d, leaving_q;
  logic [Axes-1:0]           leaving_more, away_axes, here_leaving;
  logic [2*Axes-1:0]         here_exits;
  // What belongs to the axis of the present phase.
  logic [1:0]                axis_halo_end, axis_none, axis_ended;
  logic                      any_leaving, axis_leaving;
  logic [2*CountBits-1:0]    axis_land_count;
  logic [2*ParticleBits-1:0] axis_arrived;
  logic [Axes-1:0]           some_leaving;
  integer                    b, c;
  always_comb begin
    some_leaving = '0;
    for (c = 0; c < Cells; c = c + 1) some_leaving = some_leaving | leaving_q[c*Axes +: Axes];
  end
  always_comb begin
    axis_can_load   = 2'b00;
    axis_halo_end   = 2'b00;
    axis_none       = 2'b00;
    axis_ended      = 2'b00;
    axis_leaving    = 1'b0;
    any_leaving     = 1'b0;
    axis_land_count = '0;
    axis_arrived    = '0;
    for (b = 0; b < Axes; b = b + 1) begin
      if (axis_onehot[b]) begin
        axis_can_load   = can_load[2*b +: 2];
        axis_halo_end   = halo_end[2*b +: 2];
        axis_none       = migrate_none[2*b +: 2];
        axis_ended      = migrate_end[2*b +: 2];
        axis_leaving    = here_leaving[b];
        axis_land_count = land_count[2*b*CountBits +: 2*CountBits];
        any_leaving     = some_leaving[b];
      end
      axis_arrived = axis_arrived | (arrived[2*b*ParticleBits +: 2*ParticleBits] & {2 * ParticleBits{axis_onehot[b]}});
    end
  end
  integer e;
  always_comb begin
    here_leaving = '0;
    here_exits   = '0;
    for (e = 0; e < Cells; e = e + 1) begin
      if (main_own == e[CellBits-1:0]) begin
        here_leaving = leaving_q[e*Axes +: Axes];
        here_exits   = exit_i[e*Faces +: Faces];
      end
    end
  end
  assign axis_load = in_migrate ? migrate_load : relay_load;
  assign send_end  = in_migrate ? migrate_send_end : relay_end;
  assign send_data = in_migrate ? migrate_beat : relay_beat;
  for (genvar a = 0; a < Axes; a++) begin : gen_axis_link
    assign load_link[2*a +: 2] = axis_load & {2{axis_onehot[a]}};
  end

  // A particle as a record: x, y, z, then what the rule needs of type and v.
  logic [HaloBits-1:0] stream_record, main_seen;
  assign stream_record[PosBits-1:0] = stream_data[PosBits-1:0];
  assign main_seen[PosBits-1:0]     = main_data[PosBits-1:0];
  if (HaloType > 0) begin : gen_type_seen
    assign stream_record[PosBits +: HaloType] = stream_data[TypeLsb +: HaloType];
    assign main_seen[PosBits +: HaloType]     = main_data[TypeLsb +: HaloType];
  end
  if (HaloVelocity > 0) begin : gen_velocity_seen
    assign stream_record[PosBits+HaloType +: HaloVelocity] = stream_data[VelLsb +: HaloVelocity];
    assign main_seen[PosBits+HaloType +: HaloVelocity]     = main_data[VelLsb +: HaloVelocity];
  end

  // Exchange.
  logic relay_sent;
  cuboct_brick_relay #(
    .Axes(Axes), .BrickX(BrickX), .BrickY(BrickY), .BrickZ(BrickZ), .GridBits(GridBits), .TagBits(TagBits),
    .LinkBits(LinkBits), .HaloBits(HaloBits), .SlotBits(SlotBits), .CountBits(CountBits)
  ) u_relay (
    .clk_i, .rst_ni, .active_i(in_exchange), .axis_i(axis), .done_i(exchange_done), .has_link_i, .extent_i,
    .low_o(relay_low), .high_o(relay_high), .advance_o(relay_advance), .restart_o(relay_restart),
    .first_o(relay_first), .cell_i(relay_cell), .last_i(relay_last), .layer_i(relay_layer),
    .own_count_i(relay_own_count),
    .halo_count_i(relay_halo_count[(Faces-2)*CountBits-1:0]), .step_o(relay_step), .own_i(main_seen),
    .halo_i(relay_halos[(Faces-2)*HaloBits-1:0]), .can_load_i(axis_can_load), .load_o(relay_load), .end_o(relay_end),
    .data_o(relay_beat), .sent_o(relay_sent)
  );
  assign exchange_done = in_exchange && relay_sent && (axis_halo_end == 2'b11);

  // Force engine.
  logic [CandidateBits-1:0]     issue_candidate;
  logic [ForcePipes-1:0]        issue, pipe_busy;
  logic                         finder_done, force_stall, meet, take, fault_left, fault_full, kept_fault;
  cuboct_brick_finder #(
    .Axes(Axes), .BrickX(BrickX), .BrickY(BrickY), .GridBits(GridBits), .CellBits(CellBits),
    .TagBits(TagBits), .Capacity(Capacity), .PositionFrac(PositionFrac), .FilterFrac(FilterFrac),
    .PlanarOne(PlanarOne), .PlanarTwo(PlanarTwo), .PlanarThree(PlanarThree), .HaloBits(HaloBits),
    .FilterLanes(FilterLanes), .ForcePipes(ForcePipes), .Interval(Interval), .QueueDepth(QueueDepth),
    .RowBits(RowBits), .RowAddrBits(RowAddrBits), .SlotBits(SlotBits), .OwnAddrBits(AddrBits),
    .HaloAddrBits(HaloAddrBits), .CountBits(CountBits)
  ) u_finder (
    .clk_i, .rst_ni, .run_i(engine_runs), .restart_i(force_done), .available_i({past_exchange, 1'b1}), .has_link_i,
    .extent_i, .own_cell_o(stream_own), .own_count_i(stream_own_count), .near_cell_o(stream_near),
    .near_count_i(stream_near_count), .near_layer_o(stream_layer), .layer_count_i(stream_halo_count),
    .read_o(stream_read), .own_addr_o(stream_addr), .halo_addr_o(stream_halo_addr), .own_i(stream_record),
    .halos_i(stream_halos), .row_o(row), .row_data_i(row_data), .candidate_o(issue_candidate), .cell_o(issue_cell),
    .issue_o(issue), .issue_slot_o(issue_slot), .meet_o(meet), .stall_o(force_stall), .done_o(finder_done)
  );
  assign force_event_o = {issue, issue != '0, meet, force_stall, engine_runs};
  assign force_done = engine_runs && finder_done && (pipe_busy == '0);

  // Update and dump walk the cells and their slots.
  logic [SlotBits-1:0] tick_d, tick_q;
  logic                past_d, past_q;  // past: no cell is left
  logic [TailBits-1:0] tail_d, tail_q;
  assign ticking      = (in_update && !past_q && any_held) || in_dump;
  assign tick_over    = (main_count <= {{(CountBits - SlotBits) {1'b0}}, tick_q} + 1'b1);  // the cell is
  assign tick_advance = ticking && tick_over;
  assign take         = ticking && in_update && (main_count != '0);
  assign update_done  = in_update && (!any_held || (past_q && {{(32 - TailBits) {1'b0}}, tail_q} == UpdateTail));
  assign dump_done    = in_dump && tick_over && last_cell;
  always_comb begin
    tick_d = tick_q;
    past_d = past_q;
    tail_d = tail_q;
    if (ticking) tick_d = tick_over ? '0 : tick_q + 1'b1;
    if (tick_advance && last_cell && in_update) past_d = 1'b1;
    if (past_q) tail_d = tail_q + 1'b1;
    if (update_done) begin
      past_d = 1'b0;
      tail_d = '0;
    end
  end
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      tick_q <= '0;
      past_q <= 1'b0;
      tail_q <= '0;
    end else begin
      tick_q <= tick_d;
      past_q <= past_d;
      tail_q <= tail_d;
    end
  end

  // What the migration says is told a cycle later, but for a full cell in the step's last cycle.
  localparam int TellBits = IdBits + CellBits;
  logic [3:0]              kept_code;
  logic [TellBits-1:0]     kept_id;
  logic [63:0]             kept_number;
  logic [ParticleBits-1:0] fault_particle;
  cuboct_datapath #(
    .Axes(Axes), .Cells(Cells), .Capacity(Capacity), .ForcePipes(ForcePipes), .Shared(Shared), .Product(Product),
    .Interval(Interval), .IdBits(IdBits), .TypeBits(TypeBits), .ParticleBits(ParticleBits),
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
    .clk_i, .rst_ni, .velocity_i, .issue_i(issue), .issue_place_i(issue_place), .candidate_i(issue_candidate),
    .own_i(pipe_data), .busy_o(pipe_busy), .kick_addr_o(kick_addr_next), .kick_id_i(kick_id), .look_addr_i(own_addr_d),
    .clear_i(take || load || migrate_land), .clear_addr_i(take ? own_addr_q : write_addr), .take_i(take),
    .take_place_i({main_own, tick_q}), .slot_i(main_data), .written_o(update_write), .place_o(update_place),
    .slot_o(update_data), .leaving_o(away_axes), .step_end_i(step_end),
    .move_fault_i((fault_left || fault_full) && !step_end), .move_axis_i(axis), .move_full_i(of_after),
    .move_tell_i({fault_particle[IdLsb +: IdBits], main_own}), .fault_o(kept_fault), .fault_code_o(kept_code),
    .fault_tell_o(kept_id), .fault_number_o(kept_number)
  );

  // Migration.
  logic [1:0]              axis_pop;
  logic                    from_above;
  logic [ParticleBits-1:0] stored;
  for (genvar a = 0; a < Axes; a++) begin : gen_axis_migrate
    assign migrate_pop[2*a +: 2]   = axis_pop & {2{axis_onehot[a]}};
    assign migrate_clear[2*a +: 2] = {2{axis_onehot[a] && migrate_done}};
  end
  integer g;
  always_comb begin
    leaving_d = leaving_q;
    for (g = 0; g < Cells; g = g + 1) begin
      if (update_write && write_cell == g[CellBits-1:0])
        leaving_d[g*Axes +: Axes] = leaving_q[g*Axes +: Axes] | away_axes;
      if (migrate_land && main_own == g[CellBits-1:0])
        leaving_d[g*Axes +: Axes] = leaving_q[g*Axes +: Axes] | leaving_more;
    end
    if (step_end) leaving_d = '0;
  end
  always_ff @(posedge clk_i) begin
    if (!rst_ni) leaving_q <= '0;
    else leaving_q <= leaving_d;
  end
  cuboct_brick_migrate #(
    .Axes(Axes), .BrickX(BrickX), .BrickY(BrickY), .BrickZ(BrickZ), .CellBits(CellBits), .TagBits(TagBits),
    .FaceBits(FaceBits), .ParticleBits(ParticleBits), .PositionBits(PosBits), .LinkBits(LinkBits), .Capacity(Capacity),
    .SlotBits(SlotBits), .CountBits(CountBits)
  ) u_migrate (
    .clk_i, .rst_ni, .active_i(in_migrate), .axis_i(axis), .done_o(migrate_done), .advance_o(migrate_advance),
    .own_i(main_own), .face_i(main_face), .low_i(main_low), .high_i(main_high), .after_own_i(after_own),
    .after_low_i(after_low), .after_high_i(after_high), .any_leaving_i(any_leaving), .leaving_i(axis_leaving),
    .exit_i(here_exits), .count_i(main_count), .count_set_o(migrate_count_set), .count_o(migrate_count),
    .leave_o(migrate_leave), .ends_o(migrate_ends), .away_i(main_away), .read_data_i(main_data),
    .write_o(migrate_write), .land_o(migrate_land),
    .write_slot_o(migrate_write_slot), .write_data_o(migrate_write_data), .leaving_more_o(leaving_more),
    .can_load_i(axis_can_load), .load_o(migrate_load), .end_o(migrate_send_end), .data_o(migrate_beat),
    .none_i(axis_none), .ended_i(axis_ended), .of_after_o(of_after), .land_count_i(axis_land_count),
    .arrived_i(axis_arrived), .pop_o(axis_pop), .fault_left_o(fault_left), .fault_full_o(fault_full),
    .fault_particle_o(fault_particle), .from_above_o(from_above), .stored_o(stored)
  );

  assign observe_valid_o = take || (in_dump && main_count != '0);
  assign observe_cell_o  = main_own;
  assign observe_data_o  = main_data[ParticleBits-1:0];

  // The code of a full cell in the step's last cycle is the highest one there is, its cell the last one, highest along
  // the axis; so who comes from above comes over the face.
  localparam int LastAxis = Axes - 1;
  localparam int LastFull = 7 + 2 * LastAxis;
  logic                    last_first;
  logic [TellBits-1:0]     last_id;
  logic [ParticleBits-1:0] last_low, last_high, last_particle;
  assign last_low       = arrived[2*LastAxis*ParticleBits +: ParticleBits];
  assign last_high      = arrived[(2*LastAxis+1)*ParticleBits +: ParticleBits];
  assign last_particle  = from_above ? last_high : main_low[LastAxis] ? last_low : stored;
  assign last_id        = {last_particle[IdLsb +: IdBits], main_own};
  assign last_first     = fault_full && (!kept_fault || (kept_code == LastFull[3:0] && last_id < kept_id));
  assign fault_valid_o  = (kept_fault || fault_full) && step_end;
  assign fault_code_o   = kept_fault ? kept_code : LastFull[3:0];
  assign {fault_id_o, fault_cell_o} = last_first ? last_id : kept_id;
  assign fault_number_o = kept_fault ? kept_number : {32'd0, Capacity};

  logic unused_fields;
  assign unused_fields = ^{stream_data, fault_particle, last_particle, relay_next, first_face, next_face,
                           relay_halo_count, relay_halos, in_round};
endmodule
