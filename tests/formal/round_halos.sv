// SPDX-License-Identifier: MIT
// cuboct_round_halos, seen over one face: the links carry any beats. Halo k of round r since the clear, k and r any,
// is what the streamer's port and the relay's port of that round answer in the cycle after they asked for address k,
// the first round's a node further on; the answer stays until the next question. Records of other rounds, of other
// faces and particles may come before, between and behind: what a neighbour sends that is a round ahead is kept apart.
// A watched particle is shown once, after those before it and before those after it, unchanged, from the second cycle
// after it came. Counts, ends and what migration is told of the next cycle are exact.
`include "torn_ram.svh"
module round_halos_formal #(
  parameter int Axes         = 2,
  parameter int Face         = 0,  // the one that is looked at
  parameter int Capacity     = 1,
  parameter int Rounds       = 2,  // 1 ... 3
  parameter int Rest         = 1,  // bits of a record of the first round besides its position
  parameter int Second       = 2,  // bits of a record of the second round, of the third; 0: there is none
  parameter int Third        = 0,
  parameter int ParticleBits = 2,
  parameter int LinkBits     = 6,
  localparam int Faces       = 2 * Axes
) (
  input logic                        clk_i,
  input logic [Faces-1:0]            valid_i, end_i,
  input logic [Faces*LinkBits-1:0]   data_i,
  input logic                        clear_i,
  input logic                        read_i,
  input logic [7:0]                  addr_i,
  input logic [Rounds-1:0]           relay_read_i,
  input logic [Rounds*(Faces-2)-1:0] relay_clear_i,
  input logic [Rounds*8-1:0]         relay_addr_i,
  input logic                        migrating_i,
  input logic [Faces-1:0]            migrate_clear_i,
  input logic [Faces-1:0]            pop_i,
  input logic                        watch_i  // the particle that comes in this cycle is the one watched; any may be
);
  localparam int P             = 1;  // bits of a position
  localparam int HaloBits      = Axes * P + 2 * (Axes - 1) + Rest;
  localparam int LastLsb       = (Axes - 1) * (P + 2);
  localparam int CandPos       = Axes * (P + 2);
  localparam int Some          = (Rest > 0) ? Rest : 1;
  localparam logic [47:0] Sizes = {Third[15:0], Second[15:0], HaloBits[15:0]};
  localparam int Later         = ((Rounds > 1) ? Second : 0) + ((Rounds > 2) ? Third : 0);
  localparam int CandidateBits = CandPos + Rest + Later;
  localparam int MostOne       = (Rounds > 1 && Second > HaloBits) ? Second : HaloBits;
  localparam int MostBits      = (Rounds > 2 && Third > MostOne) ? Third : MostOne;
  localparam int Widest        = (MostBits > ParticleBits) ? MostBits : ParticleBits;
  localparam int MaxBeats      = (Widest + LinkBits - 1) / LinkBits;
  localparam int MigrateLast   = (ParticleBits + LinkBits - 1) / LinkBits - 1;
  localparam int Axis          = Face / 2;
  localparam int Depth         = ((Axis == 0) ? 1 : (Axis == 1) ? 3 : 9) * Capacity;
  localparam int AddrBits      = $clog2(((Axes == 3) ? 9 : 3) * Capacity);
  localparam int CountBits     = AddrBits + 1;
  localparam logic [P+1:0] OneNode = 1 << P;

  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;
  (* anyconst *) logic [Faces-1:0]    has_link;
  (* anyconst *) logic [1:0]          round;   // the watched record: its round, its number
  (* anyconst *) logic [AddrBits-1:0] number;
  always_comb assume (round < Rounds[1:0] && Sizes[round*16 +: 16] != 16'd0);

  logic [Rounds*Faces-1:0]        halo_end;
  logic [Faces*CountBits-1:0]     halo_count;
  logic [Faces-1:0]               halo_came, empty, some_next, over_next, pop;
  logic [Faces*CandidateBits-1:0] stream_data;
  logic [Rounds*MostBits-1:0]     relay_data;
  logic [Rounds*AddrBits-1:0]     relay_addr;
  logic [Faces*ParticleBits-1:0]  particles;
  for (genvar g = 0; g < Rounds; g++) begin : gen_addr
    assign relay_addr[g*AddrBits +: AddrBits] = relay_addr_i[g*8 +: AddrBits];
  end
  assign pop = pop_i & ~empty;
  cuboct_round_halos #(
    .Axes(Axes), .PositionFrac(P), .Capacity(Capacity), .LinkBits(LinkBits), .Rounds(Rounds),
    .RecordBits(Sizes[Rounds*16-1:0]), .HaloBits(HaloBits), .MostBits(MostBits), .CandidateBits(CandidateBits),
    .ParticleBits(ParticleBits), .AddrBits(AddrBits), .CountBits(CountBits)
  ) u_dut (
    .clk_i, .rst_ni(running_q), .has_link_i(has_link), .link_valid_i(valid_i), .link_end_i(end_i),
    .link_data_i(data_i), .halo_clear_i(clear_i), .halo_end_o(halo_end), .halo_count_o(halo_count),
    .halo_came_o(halo_came), .stream_read_i({(2*Axes){read_i}}), .stream_addr_i(addr_i[AddrBits-1:0]),
    .stream_data_o(stream_data),
    .relay_read_i, .relay_clear_i, .relay_addr_i(relay_addr), .relay_data_o(relay_data), .migrating_i,
    .migrate_clear_i, .migrate_empty_o(empty), .migrate_some_next_o(some_next), .migrate_over_next_o(over_next),
    .migrate_data_o(particles), .migrate_pop_i(pop)
  );

  // What comes over the face: the number of its stream, particles' behind the last round's; beats of the record.
  logic                         beat_comes, end_comes, record_comes, halo_comes, particle_comes;
  logic [1:0]                   stream_q;
  logic [3:0]                   beat_q, last_beat;
  logic [MaxBeats*LinkBits-1:0] parts_q, word;
  integer                       s, b;
  always_comb begin
    last_beat = MigrateLast[3:0];
    for (s = 0; s < Rounds; s = s + 1) begin
      if (stream_q == s[1:0]) last_beat = (Sizes[s*16 +: 16] - 16'd1) / LinkBits;
    end
    word = parts_q;
    for (b = 0; b < MaxBeats; b = b + 1) begin
      if (beat_q == b[3:0]) word[b*LinkBits +: LinkBits] = data_i[Face*LinkBits +: LinkBits];
    end
  end
  assign beat_comes     = running_q && has_link[Face] && valid_i[Face] && !end_i[Face];
  assign end_comes      = running_q && has_link[Face] && valid_i[Face] && end_i[Face];
  assign record_comes   = beat_comes && beat_q == last_beat;
  assign halo_comes     = record_comes && stream_q != Rounds[1:0];
  assign particle_comes = record_comes && stream_q == Rounds[1:0];
  always_ff @(posedge clk_i) begin
    if (!running_q) begin
      stream_q <= '0;
      beat_q   <= '0;
    end else begin
      if (beat_comes) beat_q <= record_comes ? '0 : beat_q + 1'b1;
      if (end_comes) stream_q <= (stream_q == Rounds[1:0]) ? '0 : stream_q + 1'b1;
    end
    parts_q <= word;
  end

  // By round: records since the clear, and whether an end came since.
  logic [3*CountBits-1:0] counts_q;
  logic [2:0]             ended_q;
  logic                   migrate_ended_q;
  logic [CountBits-1:0]   count, held_q, before_q;
  integer                 c;
  always_ff @(posedge clk_i) begin
    for (c = 0; c < 3; c = c + 1) begin
      if (!running_q || clear_i) begin
        counts_q[c*CountBits +: CountBits] <= '0;
        ended_q[c]                         <= 1'b0;
      end else if (stream_q == c[1:0]) begin
        if (halo_comes) counts_q[c*CountBits +: CountBits] <= counts_q[c*CountBits +: CountBits] + 1'b1;
        if (end_comes && c < Rounds) ended_q[c] <= 1'b1;
      end
    end
    if (!running_q || migrate_clear_i[Face]) migrate_ended_q <= 1'b0;
    else if (end_comes && stream_q == Rounds[1:0]) migrate_ended_q <= 1'b1;
  end
  assign count = counts_q[round*CountBits +: CountBits];
  // The contract: a record has room, an end beat comes between records, a round without records has none, nothing of a
  // halo comes with the clear, nothing of particles with theirs (proofs `rounds_neighbours`, `rounds_neighbours_room`).
  always_comb begin
    if (end_comes) assume (beat_q == '0);
    if (beat_comes && stream_q != Rounds[1:0]) assume (Sizes[stream_q*16 +: 16] != 16'd0);
    if (halo_comes) assume (!clear_i && counts_q[stream_q*CountBits +: CountBits] != Depth[CountBits-1:0]);
    if (end_comes && stream_q != Rounds[1:0]) assume (!clear_i);
    if (particle_comes) assume (held_q != Capacity[CountBits-1:0]);
    if (end_comes && stream_q == Rounds[1:0]) assume (!migrate_clear_i[Face]);
  end

  // The first round's record as a candidate: what is not on the link is 0; then a node further on.
  logic [CandPos+Rest-1:0] candidate;
  logic [HaloBits-1:0]     relayed;  // the same, as it goes on over a link
  logic [MostBits-1:0]     value_q;
  always_comb begin
    candidate = {2'b00, value_q[LastLsb+P-1:0]};
    if (Rest > 0) candidate[CandPos+Rest-1 -: Some] = value_q[HaloBits-1 -: Some];
    candidate[Axis*(P+2) +: P+2] = candidate[Axis*(P+2) +: P+2] + ((Face % 2 == 0) ? -OneNode : OneNode);
    relayed = candidate[LastLsb+P-1:0];
    if (Rest > 0) relayed[HaloBits-1 -: Some] = candidate[CandPos+Rest-1 -: Some];
  end

  // What was asked for, and what the ports answer.
  logic                         there, asked_q, relayed_q, zero_q, kept_q;
  logic [Faces-3:0]             not_it, clears;
  logic [CandPos+Rest-1:0]      first_q;
  logic [MostBits-1:0]          later_q, relay_q, answer, relay_answer;
  logic [CandidateBits-1:0]     face_data;
  assign there        = ({1'b0, number} < count);
  assign clears       = relay_clear_i[round*(Faces-2) +: Faces-2];
  assign face_data    = stream_data[Face*CandidateBits +: CandidateBits];
  assign relay_answer = relay_data[round*MostBits +: MostBits];
  always_comb begin
    not_it = '1;
    if (Face < Faces - 2) not_it[(Face < Faces - 2) ? Face : 0] = 1'b0;
    answer = '0;
    if (Rounds > 1 && round == 2'd1) answer = face_data[CandPos+Rest +: (Second > 0) ? Second : 1];
    if (Rounds > 2 && round == 2'd2) answer = face_data[CandPos+Rest+Second +: (Third > 0) ? Third : 1];
  end
  function automatic logic [MostBits-1:0] sent(input logic [1:0] of, input logic [MostBits-1:0] bits);
    integer i;
    begin
      sent = '0;
      for (i = 0; i < MostBits; i = i + 1) if (i < {16'd0, Sizes[of*16 +: 16]}) sent[i] = bits[i];
    end
  endfunction
  always_ff @(posedge clk_i) begin
    if (!running_q) begin
      asked_q   <= 1'b0;
      relayed_q <= 1'b0;
      zero_q    <= 1'b0;
      kept_q    <= 1'b0;
    end else begin
      if (read_i) asked_q <= there && addr_i[AddrBits-1:0] == number;
      kept_q <= asked_q && !read_i;
      if (relay_read_i[round]) begin
        relayed_q <= Face < Faces - 2 && there && relay_addr_i[round*8 +: AddrBits] == number && clears == not_it;
        zero_q    <= (clears == '1);
      end
    end
    if (halo_comes && stream_q == round && counts_q[round*CountBits +: CountBits] == {1'b0, number}) begin
      value_q <= word[MostBits-1:0];
    end
    if (read_i) begin
      first_q <= candidate;
      later_q <= sent(round, value_q);
    end
    if (relay_read_i[round]) begin
      relay_q <= (round == '0) ? {{(MostBits - HaloBits) {1'b0}}, relayed} : sent(round, value_q);
    end
  end

  // The watched particle: how many are inside, of which the last may not count yet; how many stand before it.
  logic                    pushed_q, watched_q, inside_q, shown_q, migrating_q;
  logic [ParticleBits-1:0] particle_q;
  logic                    told_q, some_told_q, over_told_q;  // in the cycle before, of this one
  always_ff @(posedge clk_i) begin
    migrating_q <= running_q && migrating_i;
    if (!running_q) begin
      held_q    <= '0;
      pushed_q  <= 1'b0;
      watched_q <= 1'b0;
      inside_q  <= 1'b0;
      shown_q   <= 1'b0;
    end else begin
      held_q   <= held_q + {{(CountBits - 1) {1'b0}}, particle_comes} - {{(CountBits - 1) {1'b0}}, pop[Face]};
      pushed_q <= particle_comes;
      shown_q  <= inside_q;
      if (particle_comes && watch_i && !watched_q) begin
        watched_q  <= 1'b1;
        inside_q   <= 1'b1;
        particle_q <= word[ParticleBits-1:0];
        before_q   <= held_q - {{(CountBits - 1) {1'b0}}, pop[Face]};
      end else if (inside_q && pop[Face]) begin
        before_q <= before_q - 1'b1;
        if (before_q == '0) inside_q <= 1'b0;
      end
    end
    told_q      <= running_q && !migrate_clear_i[Face];
    some_told_q <= some_next[Face];
    over_told_q <= over_next[Face];
  end

  logic again_q, out_q;  // halos of all rounds were cleared; a particle came out
  always_ff @(posedge clk_i) begin
    again_q <= running_q && (again_q || (clear_i && ended_q[Rounds-1:0] == '1 && count == Depth[CountBits-1:0]));
    out_q   <= running_q && (out_q || (watched_q && !inside_q));
  end

  always_ff @(posedge clk_i) begin
    if (running_q) begin
      a_count: assert (halo_count[Face*CountBits +: CountBits] == counts_q[0 +: CountBits]);
      a_came:  assert (halo_came[Face] == (halo_comes && stream_q == '0));
      a_end:   assert (halo_end[round*Faces+Face] == (ended_q[round] || !has_link[Face]));
      if (asked_q && round == '0) a_first: assert (face_data[CandPos+Rest-1:0] == first_q);
      if (asked_q && round != '0) a_later: assert (sent(round, answer) == later_q);
      if (relayed_q) a_relay: assert (relay_answer == relay_q);
      if (zero_q) a_zero: assert (relay_answer == '0);
      a_empty: assert (empty[Face] == (held_q == {{(CountBits - 1) {1'b0}}, pushed_q}));
      if (inside_q && shown_q) a_held: assert (!empty[Face]);
      if (inside_q && shown_q && before_q == '0 && migrating_q) begin
        a_particle: assert (particles[Face*ParticleBits +: ParticleBits] == particle_q);
      end
      if (told_q) a_told: assert (some_told_q == !empty[Face]
                                  && over_told_q == (empty[Face] && (migrate_ended_q || !has_link[Face])));
      c_first: cover (asked_q && round == '0 && value_q != '0 && {1'b0, number} + 1'b1 == Depth);
      c_last:  cover (asked_q && round == Rounds - 1 && value_q != '0 && {1'b0, number} + 1'b1 == Depth);
      c_ahead: cover (asked_q && kept_q && round < stream_q && ended_q[Rounds-1] && held_q != '0 && value_q != '0);
      c_again: cover (again_q && asked_q && there && value_q != '0 && (relayed_q || Face >= Faces - 2));
      c_zero:  cover (zero_q && there && again_q);
      c_over:  cover (over_next[Face] && has_link[Face] && out_q);
      c_full:  cover (held_q == Capacity && inside_q && shown_q && before_q == '0 && migrating_q && pop[Face]);
    end
  end
endmodule
