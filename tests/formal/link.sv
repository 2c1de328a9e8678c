// SPDX-License-Identifier: MIT
// One link: a sender that cuts records into beats as cuboct_relay and cuboct_migrate do, cuboct_link_tx, a
// wire that stalls when it likes, cuboct_link_rx. What was sent is told once, in order, as it was sent, in
// its own stream.
module link_formal #(
  parameter int LinkBits    = 2,
  parameter int HaloBits    = 5,
  parameter int MigrateBits = 3,
  parameter int Stall       = 3   // longest stall of the wire that the bound on progress supposes
) (
  input logic                   clk_i,
  input logic                   want_i,    // the sender loads a beat if it may
  input logic                   close_i,   // between records: it is the end beat
  input logic                   stall_i,
  input logic [HaloBits-1:0]    halo_i,    // a record that begins now
  input logic [MigrateBits-1:0] migrate_i
);
  localparam int HaloBeats    = (HaloBits + LinkBits - 1) / LinkBits;
  localparam int MigrateBeats = (MigrateBits + LinkBits - 1) / LinkBits;
  localparam int MaxBeats     = (HaloBeats > MigrateBeats) ? HaloBeats : MigrateBeats;
  localparam int BeatBits     = (MaxBeats > 1) ? $clog2(MaxBeats) : 1;
  localparam int HaloLast     = HaloBeats - 1;
  localparam int MigrateLast  = MigrateBeats - 1;

  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;
  (* anyconst *) logic has_link;

  // The sender.
  logic                   migrating_q, can_load, load, close, last;
  logic [BeatBits-1:0]    beat_q, last_beat;
  logic [HaloBits-1:0]    halo_q, halo;
  logic [MigrateBits-1:0] migrate_q, migrate;
  logic [LinkBits-1:0]    halo_beat, migrate_beat, beat;
  assign halo      = (beat_q == '0) ? halo_i : halo_q;
  assign migrate   = (beat_q == '0) ? migrate_i : migrate_q;
  assign load      = running_q && want_i && can_load;
  assign close     = close_i && (beat_q == '0);
  assign last_beat = migrating_q ? MigrateLast[BeatBits-1:0] : HaloLast[BeatBits-1:0];
  assign last      = (beat_q == last_beat);
  cuboct_beat #(.Bits(HaloBits), .LinkBits(LinkBits), .BeatBits(BeatBits)) u_halo_beat (
    .word_i(halo), .beat_i(beat_q), .data_o(halo_beat)
  );
  cuboct_beat #(.Bits(MigrateBits), .LinkBits(LinkBits), .BeatBits(BeatBits)) u_migrate_beat (
    .word_i(migrate), .beat_i(beat_q), .data_o(migrate_beat)
  );
  assign beat = close ? '0 : migrating_q ? migrate_beat : halo_beat;
  always_ff @(posedge clk_i) begin
    if (!running_q) begin
      migrating_q <= 1'b0;
      beat_q      <= '0;
    end else if (load) begin
      halo_q    <= halo;
      migrate_q <= migrate;
      if (close) migrating_q <= !migrating_q;
      else beat_q <= last ? '0 : beat_q + 1'b1;
    end
  end

  logic                   valid, is_end, ready, taken;
  logic [LinkBits-1:0]    data;
  logic                   halo_valid, halo_end, migrate_valid, migrate_end;
  logic [HaloBits-1:0]    halo_out;
  logic [MigrateBits-1:0] migrate_out;
  cuboct_link_tx #(.LinkBits(LinkBits)) u_tx (
    .clk_i, .rst_ni(running_q), .has_link_i(has_link), .load_i(load), .end_i(close), .data_i(beat),
    .can_load_o(can_load), .valid_o(valid), .end_o(is_end), .data_o(data), .ready_i(ready && !stall_i)
  );
  cuboct_link_rx #(.LinkBits(LinkBits), .HaloBits(HaloBits), .MigrateBits(MigrateBits)) u_rx (
    .clk_i, .rst_ni(running_q), .valid_i(valid && !stall_i), .end_i(is_end), .data_i(data), .ready_o(ready),
    .halo_valid_o(halo_valid), .halo_o(halo_out), .halo_end_o(halo_end), .migrate_valid_o(migrate_valid),
    .migrate_o(migrate_out), .migrate_end_o(migrate_end)
  );
  assign taken = valid && ready && !stall_i;

  // What the beat in the register closes: a record, a stream, or nothing yet. There is never more on its way.
  logic                   told_q, told_end_q, told_migrate_q;
  logic [HaloBits-1:0]    told_halo_q;
  logic [MigrateBits-1:0] told_particle_q;
  always_ff @(posedge clk_i) begin
    if (!running_q) begin
      told_q <= 1'b0;
    end else if (load && has_link && (close || last)) begin
      told_q          <= 1'b1;
      told_end_q      <= close;
      told_migrate_q  <= migrating_q;
      told_halo_q     <= halo;
      told_particle_q <= migrate;
    end else if (taken) begin
      told_q <= 1'b0;
    end
  end

  // The wire's stalls, and how long a beat has waited.
  logic [7:0] stalled_q, waited_q;
  logic       fair_q;
  always_ff @(posedge clk_i) begin
    if (!running_q) begin
      stalled_q <= '0;
      waited_q  <= '0;
      fair_q    <= 1'b1;
    end else begin
      stalled_q <= stall_i ? stalled_q + 1'b1 : '0;
      waited_q  <= (valid && !taken) ? waited_q + 1'b1 : '0;
      fair_q    <= fair_q && !(stall_i && stalled_q >= Stall[7:0]);
    end
  end

  logic                held_q, held_end_q;
  logic [LinkBits-1:0] held_data_q;
  always_ff @(posedge clk_i) begin
    held_q      <= running_q && valid && !taken;
    held_end_q  <= is_end;
    held_data_q <= data;
  end

  always_ff @(posedge clk_i) begin
    if (running_q) begin
      a_once: assert ({halo_valid, halo_end, migrate_valid, migrate_end}
                      == ((taken && told_q) ? (4'b1000 >> {told_migrate_q, told_end_q}) : 4'b0000));
      if (halo_valid) a_halo: assert (halo_out == told_halo_q);
      if (migrate_valid) a_migrate: assert (migrate_out == told_particle_q);
      if (held_q) a_held: assert (valid && is_end == held_end_q && data == held_data_q);
      if (!has_link) a_no_link: assert (!valid && can_load);
      if (fair_q) a_progress: assert (waited_q <= Stall[7:0]);
      c_record:  cover (halo_valid && halo_out == '1);
      c_streams: cover (halo_end && told_end_q && migrated_q && waited_q == 8'd2);
    end
  end
  logic migrated_q;  // a particle came
  always_ff @(posedge clk_i) migrated_q <= running_q && (migrated_q || migrate_valid);
endmodule
