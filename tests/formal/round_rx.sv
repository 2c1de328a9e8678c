// SPDX-License-Identifier: MIT
// One link of a node whose rule has several rounds: a sender that cuts records into beats as cuboct_relay and
// cuboct_migrate do, cuboct_link_tx, a wire that stalls when it likes, cuboct_round_rx. Over any number of steps what
// was sent is told once, in order, as it was sent, to the round that it is of; so are particles, and so is the end of
// each stream. A round without records sends its end alone.
module round_rx_formal #(
  parameter int LinkBits    = 2,
  parameter int Rounds      = 2,  // 1 ... 3
  parameter int First       = 5,  // bits of a record of the first round, of the second, of the third; 0: there is none
  parameter int Second      = 2,
  parameter int Third       = 0,
  parameter int MigrateBits = 3
) (
  input logic                   clk_i,
  input logic                   want_i,    // the sender loads a beat if it may
  input logic                   close_i,   // between records: it is the end beat
  input logic                   stall_i,
  input logic [15:0]            halo_i,    // a record that begins now
  input logic [MigrateBits-1:0] migrate_i
);
  localparam logic [47:0] Sizes = {Third[15:0], Second[15:0], First[15:0]};
  localparam int MostOne   = (Rounds > 1 && Second > First) ? Second : First;
  localparam int MostBits  = (Rounds > 2 && Third > MostOne) ? Third : MostOne;
  localparam int Widest    = (MostBits > MigrateBits) ? MostBits : MigrateBits;
  localparam int MaxBeats  = (Widest + LinkBits - 1) / LinkBits;
  localparam int BeatBits  = (MaxBeats > 1) ? $clog2(MaxBeats) : 1;
  localparam int MigrateBeats = (MigrateBits + LinkBits - 1) / LinkBits;
  localparam int MigrateLast  = MigrateBeats - 1;

  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;
  (* anyconst *) logic has_link;

  // The sender: the number of its stream, particles' behind the last round's; beats of the record.
  logic [1:0]              stream_q;
  logic                    can_load, load, close, last, migrating;
  logic [BeatBits-1:0]     beat_q, last_beat;
  logic [MostBits-1:0]     halo_q, halo;
  logic [MigrateBits-1:0]  migrate_q, migrate;
  logic [LinkBits-1:0]     migrate_beat, beat, halo_beat;
  logic [3*LinkBits-1:0]   halo_beats;
  logic [3*BeatBits-1:0]   lasts;
  logic [2:0]              nothing;  // by round: it has no records
  assign migrating = (stream_q == Rounds[1:0]);
  assign halo      = (beat_q == '0) ? halo_i[MostBits-1:0] : halo_q;
  assign migrate   = (beat_q == '0) ? migrate_i : migrate_q;
  assign load      = running_q && want_i && can_load;
  assign close     = (close_i && beat_q == '0) || (!migrating && nothing[stream_q]);
  for (genvar k = 0; k < 3; k++) begin : gen_cut
    localparam int Bits  = {16'd0, Sizes[k*16 +: 16]};
    localparam int Last  = (Bits > 0) ? (Bits + LinkBits - 1) / LinkBits - 1 : 0;
    assign nothing[k] = (Bits == 0);
    assign lasts[k*BeatBits +: BeatBits] = Last[BeatBits-1:0];
    if (Bits > 0 && k < Rounds) begin : gen_beat
      cuboct_beat #(.Bits(Bits), .LinkBits(LinkBits), .BeatBits(BeatBits)) u_beat (
        .word_i(halo[Bits-1:0]), .beat_i(beat_q), .data_o(halo_beats[k*LinkBits +: LinkBits])
      );
    end else begin : gen_none
      assign halo_beats[k*LinkBits +: LinkBits] = '0;
    end
  end
  cuboct_beat #(.Bits(MigrateBits), .LinkBits(LinkBits), .BeatBits(BeatBits)) u_migrate_beat (
    .word_i(migrate), .beat_i(beat_q), .data_o(migrate_beat)
  );
  integer s;
  always_comb begin
    halo_beat = '0;
    last_beat = migrating ? MigrateLast[BeatBits-1:0] : '0;
    for (s = 0; s < Rounds; s = s + 1) begin
      if (stream_q == s[1:0]) begin
        halo_beat = halo_beats[s*LinkBits +: LinkBits];
        last_beat = lasts[s*BeatBits +: BeatBits];
      end
    end
  end
  assign last = (beat_q == last_beat);
  assign beat = close ? '0 : migrating ? migrate_beat : halo_beat;
  always_ff @(posedge clk_i) begin
    if (!running_q) begin
      stream_q <= '0;
      beat_q   <= '0;
    end else if (load) begin
      halo_q    <= halo;
      migrate_q <= migrate;
      if (close) stream_q <= migrating ? '0 : stream_q + 1'b1;
      else beat_q <= last ? '0 : beat_q + 1'b1;
    end
  end

  logic                   valid, is_end, taken;
  logic [LinkBits-1:0]    data;
  logic [Rounds-1:0]      halo_valid, halo_end;
  logic                   migrate_valid, migrate_end;
  logic [MostBits-1:0]    halo_out;
  logic [MigrateBits-1:0] migrate_out;
  cuboct_link_tx #(.LinkBits(LinkBits)) u_tx (
    .clk_i, .rst_ni(running_q), .has_link_i(has_link), .load_i(load), .end_i(close), .data_i(beat),
    .can_load_o(can_load), .valid_o(valid), .end_o(is_end), .data_o(data), .ready_i(!stall_i)
  );
  cuboct_round_rx #(
    .LinkBits(LinkBits), .Rounds(Rounds), .RecordBits(Sizes[Rounds*16-1:0]), .MostBits(MostBits),
    .MigrateBits(MigrateBits)
  ) u_rx (
    .clk_i, .rst_ni(running_q), .valid_i(valid && !stall_i), .end_i(is_end), .data_i(data),
    .halo_valid_o(halo_valid), .halo_o(halo_out), .halo_end_o(halo_end), .migrate_valid_o(migrate_valid),
    .migrate_o(migrate_out), .migrate_end_o(migrate_end)
  );
  assign taken = valid && !stall_i;

  // What the beat in the register closes: a record, a stream, or nothing yet. There is never more on its way.
  logic                   told_q, told_end_q;
  logic [1:0]             told_stream_q;
  logic [MostBits-1:0]    told_halo_q;
  logic [MigrateBits-1:0] told_particle_q;
  always_ff @(posedge clk_i) begin
    if (!running_q) begin
      told_q <= 1'b0;
    end else if (load && has_link && (close || last)) begin
      told_q          <= 1'b1;
      told_end_q      <= close;
      told_stream_q   <= stream_q;
      told_halo_q     <= halo;
      told_particle_q <= migrate;
    end else if (taken) begin
      told_q <= 1'b0;
    end
  end

  // Which bits of a record count.
  logic [MostBits-1:0] counts;
  integer              m, b;
  always_comb begin
    counts = '0;
    for (m = 0; m < Rounds; m = m + 1) begin
      for (b = 0; b < MostBits; b = b + 1) begin
        if (told_stream_q == m[1:0] && b < {16'd0, Sizes[m*16 +: 16]}) counts[b] = 1'b1;
      end
    end
  end

  // Whole steps, and in this one: a record of each round that has any, a particle.
  logic            again_q, came_q;
  logic [Rounds:0] some_q, some;
  assign some = some_q | {migrate_valid, halo_valid | nothing[Rounds-1:0]};
  always_ff @(posedge clk_i) begin
    if (!running_q) begin
      again_q <= 1'b0;
      came_q  <= 1'b0;
      some_q  <= '0;
    end else begin
      if (migrate_end) again_q <= 1'b1;
      came_q <= (some == '1);
      some_q <= migrate_end ? '0 : some;
    end
  end

  logic [Rounds:0] due;  // the stream of the record or end that is to be told now
  assign due = (taken && told_q) ? {{Rounds {1'b0}}, 1'b1} << told_stream_q : '0;
  always_ff @(posedge clk_i) begin
    if (running_q) begin
      a_once: assert ({migrate_valid, halo_valid} == (told_end_q ? '0 : due));
      a_end:  assert ({migrate_end, halo_end} == (told_end_q ? due : '0));
      if (halo_valid != '0) a_halo: assert (((halo_out ^ told_halo_q) & counts) == '0);
      if (migrate_valid) a_migrate: assert (migrate_out == told_particle_q);
      c_last:  cover (again_q && halo_valid[Rounds-1] && (halo_out & counts) == counts);
      c_all:   cover (came_q && migrate_end);
      c_empty: cover (again_q && halo_end[Rounds-1] && some_q == {1'b0, nothing[Rounds-1:0]});
    end
  end
endmodule
