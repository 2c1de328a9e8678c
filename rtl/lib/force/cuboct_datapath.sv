// SPDX-License-Identifier: MIT
// What becomes of particles in a node, of one cell (cuboct_node_core) or of a brick (cuboct_brick_core): pairs go
// through the force pipes, their kicks are summed by particle, the update moves each particle once a step, and the
// least fault of the step is kept. The core chooses the pairs and the slots that are read and written. A
// place is the number of a cell in the node, absent where it has one cell, above that of a slot in the cell.
module cuboct_datapath #(
  // Machine.
  parameter int          Axes                 = 3,      // 2 or 3
  parameter int          Cells                = 1,      // of the node, >= 1
  parameter int          Capacity             = 16,     // particles of a cell, >= 1
  parameter int          Streamers            = 1,      // each has its candidate, and as many pipes
  parameter int          ForcePipes           = 1,      // >= 1
  parameter int          Shared               = 0,      // 0, 1: one multiplier serves the axes in turn
  parameter int          Product              = 1,      // cycles of a multiplier of the pipe; 1 if Shared
  parameter int          Interval             = 1,      // cycles from one pair to the next
  parameter int          Narrow               = 0,      // 1: what the update reads stays until it writes
  parameter int          IdBits               = 8,      // >= 1
  parameter int          TypeBits             = 0,      // 0 with one type
  parameter int          ParticleBits         = 185,    // as the fields of cuboct_node_core add up
  parameter int          SeenBits             = 60,     // of a particle, those that others see
  parameter int          CandidateBits        = 66,
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
  parameter int          DifferenceShift      = 4,
  parameter int          WShift               = 8,
  parameter int          QShift               = 17,
  parameter int          DampShift            = 0,
  parameter int          KickShift            = 0,
  // Law.
  parameter logic [63:0] Cutoff2              = 64'd0,
  parameter logic [63:0] Contact2             = 64'd0,
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
  localparam int         CellBits             = $clog2(Cells),  // of a cell's number in the node, 0 with one
  localparam int         SlotBits             = (Capacity > 1) ? $clog2(Capacity) : 1,
  localparam int         PlaceBits            = CellBits + SlotBits,
  localparam int         TellBits             = IdBits + CellBits,  // of {id, cell}
  localparam int         HostBits             = (MovedTypes > 0) ? MovedTypes * Axes * VelocityBits : 1
) (
  input  logic                            clk_i,
  input  logic                            rst_ni,
  input  logic [HostBits-1:0]             velocity_i,     // by moved type and axis; changes in IDLE alone
  // Pairs of a candidate with own particles, by pipe.
  input  logic [ForcePipes-1:0]           issue_i,        // a pair enters the pipe
  input  logic [ForcePipes*PlaceBits-1:0] issue_place_i,  // with issue_i: of its own particle
  input  logic [Streamers*CandidateBits-1:0] candidate_i,    // with issue_i, of all pipes
  input  logic [ForcePipes*SeenBits-1:0]  own_i,          // in the cycle after issue_i: the own particle
  output logic [ForcePipes-1:0]           busy_o,         // the pipe holds a pair
  // The slots are at addresses: cell * Capacity + slot.
  output logic [ForcePipes*PlaceBits-1:0] kick_addr_o,    // by pipe: of the next cycle's kick, which may be a fault
  input  logic [ForcePipes*IdBits-1:0]    kick_id_i,      // by pipe: the id at kick_addr_o of the cycle before
  input  logic [PlaceBits-1:0]            look_addr_i,    // the sum that the next cycle's take_i or clear_i is about
  input  logic                            clear_i,        // a sum becomes zero, in no cycle with a kick:
  input  logic [PlaceBits-1:0]            clear_addr_i,   // this one; with one cell that of look_addr_i
  // Update: a slot is {away_x, particle}.
  input  logic                            take_i,         // a particle is taken, with its sum
  input  logic [PlaceBits-1:0]            take_place_i,   // with take_i
  input  logic [ParticleBits+1:0]         slot_i,         // with take_i; if Narrow, until written_o
  output logic                            written_o,      // a particle is written back
  output logic [PlaceBits-1:0]            place_o,        // with written_o
  output logic [ParticleBits+1:0]         slot_o,         // with written_o
  output logic [Axes-1:0]                 leaving_o,      // with written_o: axes along which it has left its cell
  // The least fault of a step. Those of migration come beside those of pipes and update.
  input  logic                            step_end_i,     // the step's last cycle
  input  logic                            move_fault_i,   // a fault of migration, told a cycle later
  input  logic [1:0]                      move_axis_i,    // along which it is
  input  logic                            move_full_i,    // no slot is free, else there is no link
  input  logic [TellBits-1:0]             move_tell_i,    // of whom
  output logic                            fault_o,        // with step_end_i: there was one
  output logic [3:0]                      fault_code_o,   // with fault_o: `Fault` in `model/base/error.h`
  output logic [TellBits-1:0]             fault_tell_o,   // with fault_o: {id, cell} of the particle
  output logic [63:0]                     fault_number_o  // with fault_o: the value that does not fit
);
  // Fields of a particle, and of a candidate.
  localparam int PosBits      = Axes * PositionFrac;
  localparam int VelBits      = Axes * VelocityBits;
  localparam int DispBits     = Axes * DisplacementBits;
  localparam int AwayBits     = 2 * (Axes - 1);
  localparam int VelLsb       = PosBits + AwayBits;
  localparam int TypeLsb      = VelLsb + VelBits;
  localparam int IdLsb        = TypeLsb + TypeBits;
  localparam int ResidueLsb   = IdLsb + IdBits;
  localparam int ResidueBits  = Axes * Guard;
  localparam int DispLsb      = ResidueLsb + ResidueBits;
  localparam int SomeType     = (TypeBits > 0) ? TypeBits : 1;
  localparam int HaloType     = (Scaled != 0) ? TypeBits : 0;
  localparam int HaloVelocity = (Damped != 0) ? VelBits : 0;
  localparam int CandPos      = Axes * (PositionFrac + 2);
  // |s| <= 2^(SBits-1) and |d| <= 2^D; a cell sees at most 3^Axes * Capacity kicks.
  localparam int SBits        = (Damped != 0) ? StrengthBits : ForceBits;
  localparam int KickFull     = SBits + PositionFrac - DifferenceShift + 1 - KickShift;
  localparam int KickBits     = (KickFull > 2) ? KickFull : 2;
  localparam int PipeSumBits  = KickBits + $clog2(((Axes == 3) ? 27 : 9) * Capacity);
  // No number that a fault tells is longer: w, s before their checks; sums, v, u; the capacity.
  localparam int DragBits     = DampBits + RelativeVelocityBits;
  localparam int SFullBits    = ((DragBits > ForceBits) ? DragBits : ForceBits) + 2;
  localparam int PullBits     = (Pd != 0) ? GainBits + DisplacementBits + 6 : 10;
  localparam int VFullBits    = ((VelocityBits > SumBits) ? VelocityBits : SumBits) + 4;
  localparam int LongPull     = (PullBits > VFullBits) ? PullBits : VFullBits;
  localparam int LongKick     = (PipeSumBits + ForcePipes > SFullBits) ? PipeSumBits + ForcePipes : SFullBits;
  localparam int LongNumber   = (LongPull > LongKick) ? LongPull : LongKick;
  localparam int NumberBits   = (LongNumber < 64) ? LongNumber : 64;

  logic [ForcePipes-1:0]           kick_valid, pipe_fault, pipe_fault_strength;
  logic [ForcePipes*64-1:0]        pipe_fault_number;
  logic [ForcePipes*TellBits-1:0]  kick_tell;
  logic [ForcePipes*Axes*PipeSumBits-1:0] sums;
  for (genvar f = 0; f < ForcePipes; f++) begin : gen_pipe
    logic [Axes*KickBits-1:0] push;
    logic [PlaceBits-1:0]     place, place_next;
    logic [SeenBits-1:0]      own;
    logic [SomeType-1:0]      own_type, other_type;
    logic [VelBits-1:0]       own_v, other_v;
    localparam int Streamer = f / (ForcePipes / Streamers);
    logic [CandidateBits-1:0] candidate;
    assign candidate = candidate_i[Streamer*CandidateBits +: CandidateBits];
    assign own = own_i[f*SeenBits +: SeenBits];
    if (HaloType > 0) begin : gen_type
      assign own_type   = own[TypeLsb +: SomeType];
      assign other_type = candidate[CandPos +: SomeType];
    end else begin : gen_no_type
      assign own_type   = '0;
      assign other_type = '0;
    end
    if (HaloVelocity > 0) begin : gen_velocity
      assign own_v   = own[VelLsb +: VelBits];
      assign other_v = candidate[CandPos + HaloType +: VelBits];
    end else begin : gen_no_velocity
      assign own_v   = '0;
      assign other_v = '0;
    end
    cuboct_pipe #(
      .Axes(Axes), .PositionFrac(PositionFrac), .DifferenceShift(DifferenceShift), .Cutoff2(Cutoff2),
      .Contact2(Contact2),
      .EntryBits(StrengthBits), .IndexBits(IndexBits), .Octaves(Octaves), .Degree(Degree), .BinBits(BinBits),
      .FirstOctave(FirstOctave), .FractionBits(FractionBits), .ForceBits(ForceBits), .Damped(Damped),
      .VelocityBits(VelocityBits), .RelativeVelocityBits(RelativeVelocityBits), .WShift(WShift), .QShift(QShift),
      .DampShift(DampShift), .DampIndexBits(DampIndexBits), .DampOctaves(DampOctaves), .DampDegree(DampDegree),
      .DampBinBits(DampBinBits), .DampFirstOctave(DampFirstOctave), .DampFractionBits(DampFractionBits),
      .DampBits(DampBits), .StrengthBits(StrengthBits), .Scaled(Scaled), .LawBits(LawBits), .TypeBits(SomeType),
      .ScaleBits(ScaleBits),
      .ScaleFrac(ScaleFrac), .KickShift(KickShift), .KickBits(KickBits), .SlotBits(PlaceBits), .Shared(Shared),
      .Product(Product), .Interval(Interval)
    ) u_pipe (
      .clk_i, .rst_ni, .valid_i(issue_i[f]), .slot_i(issue_place_i[f*PlaceBits +: PlaceBits]),
      .own_x_i(own[PosBits-1:0]), .own_v_i(own_v), .own_type_i(own_type),
      .other_x_i(candidate[CandPos-1:0]), .other_v_i(other_v), .other_type_i(other_type),
      .valid_o(kick_valid[f]), .slot_next_o(place_next), .slot_o(place), .push_o(push),
      .fault_o(pipe_fault[f]), .fault_strength_o(pipe_fault_strength[f]),
      .fault_number_o(pipe_fault_number[f*64 +: 64]), .busy_o(busy_o[f])
    );
    if (Cells > 1) begin : gen_cells
      cuboct_brick_addr #(
        .Factor(Capacity), .CellBits(CellBits), .SlotBits(SlotBits), .AddrBits(PlaceBits)
      ) u_kick_addr (
        .cell_i(place_next[SlotBits +: CellBits]), .slot_i(place_next[SlotBits-1:0]),
        .addr_o(kick_addr_o[f*PlaceBits +: PlaceBits])
      );
      assign kick_tell[f*TellBits +: TellBits] = {kick_id_i[f*IdBits +: IdBits], place[SlotBits +: CellBits]};
      cuboct_brick_sums #(
        .Axes(Axes), .KickBits(KickBits), .SumBits(PipeSumBits), .Depth(Cells * Capacity), .AddrBits(PlaceBits)
      ) u_sums (
        .clk_i, .kick_valid_i(kick_valid[f]), .push_i(push), .zero_i(clear_i), .zero_addr_i(clear_addr_i),
        .busy_i(busy_o[f]), .kick_addr_i(kick_addr_o[f*PlaceBits +: PlaceBits]), .look_addr_i,
        .sum_o(sums[f*Axes*PipeSumBits +: Axes*PipeSumBits])
      );
    end else begin : gen_cell
      assign kick_addr_o[f*PlaceBits +: PlaceBits] = place_next;
      assign kick_tell[f*TellBits +: TellBits]     = kick_id_i[f*IdBits +: IdBits];
      cuboct_sums #(
        .Axes(Axes), .KickBits(KickBits), .SumBits(PipeSumBits), .Capacity(Capacity),
        .Spaced((Interval > 1) ? 1 : 0), .SlotBits(SlotBits)
      ) u_sums (
        .clk_i, .rst_ni, .kick_valid_i(kick_valid[f]), .push_i(push),
        .next_slot_i(busy_o[f] ? place_next : look_addr_i), .take_i(clear_i),
        .sum_o(sums[f*Axes*PipeSumBits +: Axes*PipeSumBits])
      );
      logic unused_clear;
      assign unused_clear = ^clear_addr_i;
    end
    logic unused_own;
    assign unused_own = ^{own, place, candidate};
  end
  // One after the other: of pipe f and those before it.
  for (genvar f = 0; f < ForcePipes; f++) begin : gen_total
    logic [Axes*PipeSumBits-1:0] so_far;
    for (genvar a = 0; a < Axes; a++) begin : gen_axis
      if (f == 0) begin : gen_first
        assign so_far[a*PipeSumBits +: PipeSumBits] = sums[a*PipeSumBits +: PipeSumBits];
      end else begin : gen_more
        assign so_far[a*PipeSumBits +: PipeSumBits] = gen_total[f-1].so_far[a*PipeSumBits +: PipeSumBits]
                                                    + sums[(Axes*f+a)*PipeSumBits +: PipeSumBits];
      end
    end
  end

  logic [2*Axes-1:0]   new_away;
  logic [SomeType-1:0] old_type, new_type;
  logic [TellBits-1:0] old_tell, new_tell;
  logic [DispBits-1:0] old_u, new_u;
  logic                update_fault;
  logic [3:0]          update_fault_code;
  logic [TellBits-1:0] update_fault_tell;
  logic [63:0]         update_fault_number;
  cuboct_update #(
    .Axes(Axes), .PositionFrac(PositionFrac), .Guard(Guard), .VelocityBits(VelocityBits), .TotalBits(PipeSumBits),
    .SumBits(SumBits), .TypeBits(SomeType), .Weighted(Weighted), .Pd(Pd), .Held(Narrow),
    .DisplacementBits(DisplacementBits), .GainBits(GainBits), .GainFrac(GainFrac), .ConstantBits(ConstantBits),
    .MovedTypes(MovedTypes), .SlotBits(PlaceBits), .IdBits(TellBits)
  ) u_update (
    .clk_i, .rst_ni, .velocity_i, .valid_i(take_i), .slot_i(take_place_i), .sum_i(gen_total[ForcePipes-1].so_far),
    .x_i(slot_i[PosBits-1:0]), .residue_i(slot_i[ResidueLsb +: ResidueBits]), .v_i(slot_i[VelLsb +: VelBits]),
    .type_i(old_type), .id_i(old_tell), .u_i(old_u), .valid_o(written_o), .slot_o(place_o),
    .x_o(slot_o[PosBits-1:0]), .residue_o(slot_o[ResidueLsb +: ResidueBits]), .away_o(new_away),
    .v_o(slot_o[VelLsb +: VelBits]), .type_o(new_type), .id_o(new_tell), .u_o(new_u), .fault_o(update_fault),
    .fault_code_o(update_fault_code), .fault_id_o(update_fault_tell), .fault_number_o(update_fault_number)
  );
  assign slot_o[PosBits +: AwayBits] = new_away[2*Axes-1:2];
  assign slot_o[ParticleBits +: 2]   = new_away[1:0];
  assign slot_o[IdLsb +: IdBits]     = new_tell[CellBits +: IdBits];
  for (genvar a = 0; a < Axes; a++) begin : gen_leaving
    assign leaving_o[a] = (new_away[2*a +: 2] != 2'b00);
  end
  assign old_tell[CellBits +: IdBits] = slot_i[IdLsb +: IdBits];
  if (Cells > 1) begin : gen_cell_told
    assign old_tell[CellBits-1:0] = take_place_i[SlotBits +: CellBits];
  end
  if (TypeBits > 0) begin : gen_types
    assign old_type                    = slot_i[TypeLsb +: SomeType];
    assign slot_o[TypeLsb +: SomeType] = new_type;
  end else begin : gen_one_type
    logic unused_new_type;
    assign unused_new_type = ^new_type;
    assign old_type        = '0;
  end
  if (Pd != 0) begin : gen_displacement
    assign old_u                       = slot_i[DispLsb +: DispBits];
    assign slot_o[DispLsb +: DispBits] = new_u;
  end else begin : gen_no_displacement
    logic unused_new_u;
    assign unused_new_u = ^new_u;
    assign old_u        = '0;
  end

  // A particle is in one cell, so the cell below its id changes no order.
  logic [ForcePipes*4-1:0] pipe_code;
  for (genvar f = 0; f < ForcePipes; f++) begin : gen_code
    assign pipe_code[f*4 +: 4] = pipe_fault_strength[f] ? 4'd2 : 4'd1;
  end
  logic                move_fault_q, move_full_q;
  logic [3:0]          move_code, move_code_q;
  logic [TellBits-1:0] move_tell_q;
  assign move_code = 4'd6 + {1'b0, move_axis_i, 1'b0} + {3'b000, move_full_i};  // left, full: 6 7, 8 9, 10 11
  always_ff @(posedge clk_i) begin
    if (!rst_ni) move_fault_q <= 1'b0;
    else move_fault_q <= move_fault_i;
  end
  always_ff @(posedge clk_i) begin
    move_full_q <= move_full_i;
    move_code_q <= move_code;
    move_tell_q <= move_tell_i;
  end
  cuboct_least_fault #(.Sources(ForcePipes), .IdBits(TellBits), .NumberBits(NumberBits)) u_fault (
    .clk_i, .rst_ni, .clear_i(step_end_i), .valid_i(pipe_fault), .code_i(pipe_code), .id_i(kick_tell),
    .number_i(pipe_fault_number), .update_valid_i(update_fault), .update_code_i(update_fault_code),
    .update_id_i(update_fault_tell), .update_number_i(update_fault_number), .move_valid_i(move_fault_q),
    .move_code_i(move_code_q), .move_id_i(move_tell_q), .move_number_i(move_full_q ? {32'd0, Capacity} : 64'd0),
    .valid_o(fault_o), .code_o(fault_code_o), .id_o(fault_tell_o), .number_o(fault_number_o)
  );

  logic unused_fields;
  assign unused_fields = ^{candidate_i, slot_i, new_tell};
endmodule
