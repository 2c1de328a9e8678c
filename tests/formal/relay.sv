// SPDX-License-Identifier: MIT
// cuboct_relay through any number of exchange phases, with any counts and any pauses of the links: each
// record of each segment is sent once, segments and records in order, then one end beat, then nothing until
// the phase is over. A record's content is its own name, (segment, number), so what is sent tells where it
// was read; the memories answer in the cycle after the question.
module relay_formal #(
  parameter int Axes     = 3,
  parameter int AddrBits = 2,   // a segment holds up to 2^AddrBits records
  parameter int LinkBits = 2
) (
  input logic       clk_i,
  input logic       can_load_i,
  input logic       over_i,     // the phase ends, if all was sent
  input logic       begin_i,    // a phase begins
  input logic [1:0] axis_i,
  input logic [(2*Axes-1)*(AddrBits+1)-1:0] counts_i
);
  localparam int CountBits = AddrBits + 1;
  localparam int Segments  = 2 * Axes - 1;
  localparam int HaloBits  = 3 + AddrBits;
  localparam int Beats     = (HaloBits + LinkBits - 1) / LinkBits;
  localparam int LastBeat  = Beats - 1;
  localparam int Most      = 1 << AddrBits;

  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;

  // The phases. The sequencer ends one only when all was sent (cuboct_node_core: exchange_done).
  logic                          active_q, done, sent;
  logic [1:0]                    axis_q;
  logic [Segments*CountBits-1:0] counts_q;
  assign done = active_q && sent && over_i;
  always_ff @(posedge clk_i) begin
    if (!running_q) active_q <= 1'b0;
    else active_q <= active_q ? (!done || begin_i) : begin_i;
    if (!active_q || done) begin
      axis_q   <= axis_i;
      counts_q <= counts_i;
    end
  end
  integer a;
  always_comb begin
    assume (axis_q < Axes[1:0] && axis_i < Axes[1:0]);
    for (a = 0; a < Segments; a = a + 1) begin
      assume (counts_q[a*CountBits +: CountBits] <= Most[CountBits-1:0]);
      assume (counts_i[a*CountBits +: CountBits] <= Most[CountBits-1:0]);
    end
  end

  logic [Segments-1:0] pick;
  logic [HaloBits-1:0] halo;
  logic [LinkBits-1:0] own_data, halo_data;
  assign data = own_data | halo_data;
  // Of own ones the next cycle's.
  logic [Segments*CountBits-1:0] counts;
  assign counts = {counts_q[Segments*CountBits-1:CountBits],
                   (!active_q || done) ? counts_i[0 +: CountBits] : counts_q[0 +: CountBits]};
  logic [2:0]          segment;  // picked; beyond all if none is
  logic [AddrBits-1:0] addr, slot, addr_q, slot_q;  // asked for in the cycle before
  logic                load, is_end, first_own;
  logic [LinkBits-1:0] data;
  cuboct_relay #(
    .Axes(Axes), .LinkBits(LinkBits), .HaloBits(HaloBits), .SlotBits(AddrBits), .AddrBits(AddrBits),
        .CountBits(CountBits)
  ) u_dut (
    .clk_i, .rst_ni(running_q), .active_i(active_q), .axis_i(axis_q), .done_i(done), .counts_i(counts),
    .pick_o(pick), .clear_o(clear), .read_o(read), .addr_o(addr), .ahead_o(ahead), .slot_o(slot),
    .record_i(answers_q[0 +: HaloBits]),
    .halo_i(halo), .can_load_i, .load_o(load),
    .end_o(is_end), .data_o(own_data), .halo_data_o(halo_data), .first_own_o(first_own), .sent_o(sent)
  );
  // The memories' answers; that of own particles is taken when they are picked, of the others the relay clears.
  logic [Segments-1:0]          clear;
  logic                         read;
  logic [AddrBits-1:0]          ahead;  // what the last memories are asked for: a record more than they answer
  logic [Segments*HaloBits-1:0] answers_q, after_q;
  for (genvar m = 0; m < Segments; m++) begin : gen_memory
    localparam logic [2:0] Memory = m;
    always_ff @(posedge clk_i) begin
      if (m > 0 && read && clear[m]) answers_q[m*HaloBits +: HaloBits] <= '0;
      else if (read) answers_q[m*HaloBits +: HaloBits] <= (m >= Segments - 2) ? after_q[m*HaloBits +: HaloBits]
                                                                             : {Memory, addr};
      if (read) after_q[m*HaloBits +: HaloBits] <= {Memory, clear[m] ? {AddrBits{1'b0}} : ahead};
    end
  end
  integer h;
  always_comb begin
    halo = '0;
    for (h = 1; h < Segments; h = h + 1) halo = halo | answers_q[h*HaloBits +: HaloBits];
  end
  integer p;
  always_comb begin
    segment = (pick == '0) ? '1 : '0;  // beyond all
    for (p = 0; p < Segments; p = p + 1) begin
      if (pick[p]) segment = segment | p[2:0];
    end
  end
  always_ff @(posedge clk_i) begin
    if (read) addr_q <= addr;
    if (read) slot_q <= slot;
  end

  // What must come: the next record is the least (segment, number) not yet sent, of those that the axis
  // sends.
  logic [2:0]            due_segment_q, next_segment, sends;
  logic [CountBits-1:0]  due_record_q, count;
  logic [Beats*LinkBits-1:0] due, parts_q, whole;
  logic [3:0]            beat_q;
  logic                  ended_q, all;
  integer                s, b;
  always_comb begin
    sends        = (axis_q == 2'd0) ? 3'd1 : (axis_q == 2'd1) ? 3'd3 : 3'd5;
    next_segment = due_segment_q;
    all          = 1'b1;
    count        = '0;
    for (s = Segments - 1; s >= 0; s = s - 1) begin
      if (s[2:0] < sends && s[2:0] >= due_segment_q && counts_q[s*CountBits +: CountBits] != '0
          && !(s[2:0] == due_segment_q && due_record_q == counts_q[s*CountBits +: CountBits])) begin
        next_segment = s[2:0];
        count        = counts_q[s*CountBits +: CountBits];
        all          = 1'b0;
      end
    end
    due               = '0;
    due[HaloBits-1:0] = {next_segment, (next_segment == due_segment_q)
        ? due_record_q[AddrBits-1:0] : {AddrBits{1'b0}}};
    whole             = parts_q;
    for (b = 0; b < Beats; b = b + 1) begin
      if (beat_q == b[3:0]) whole[b*LinkBits +: LinkBits] = data;
    end
  end
  logic record;  // the last beat of a record is loaded
  assign record = load && !is_end && (beat_q == LastBeat[3:0]);
  always_ff @(posedge clk_i) begin
    if (!running_q || !active_q || done) begin
      due_segment_q <= '0;
      due_record_q  <= '0;
      beat_q        <= '0;
      ended_q       <= 1'b0;
    end else begin
      if (load && !is_end) beat_q <= record ? '0 : beat_q + 1'b1;
      parts_q <= whole;
      if (record) begin
        due_segment_q <= next_segment;
        due_record_q  <= ((next_segment == due_segment_q) ? due_record_q : '0) + 1'b1;
      end
      if (is_end) ended_q <= 1'b1;
    end
  end

  // Progress: a cycle in which the links can load moves (sent, segment, record, beat) upwards, so that a
  // phase takes no more such cycles than there are values.
  logic [AddrBits+7:0] rank, rank_q;
  logic                moves_q;
  assign rank = {sent, segment, addr_q, beat_q};
  always_ff @(posedge clk_i) begin
    rank_q  <= rank;
    moves_q <= running_q && active_q && can_load_i && !sent;
  end

  always_ff @(posedge clk_i) begin
    if (running_q) begin
      if (load) a_may: assert (active_q && can_load_i && !sent);
      if (record) a_record: assert (!all && whole == due);
      if (load && !is_end) a_inside: assert (!all);
      if (is_end) a_end: assert (load && all && data == '0 && beat_q == '0);
      a_sent: assert (sent == (active_q && ended_q));
      if (first_own) a_first: assert (load && !is_end && beat_q == '0 && next_segment == 3'd0);
      if (load && !is_end && beat_q == '0 && next_segment == 3'd0)
        a_told: assert (first_own && slot_q == addr_q);
      if (moves_q) a_progress: assert (rank > rank_q);
      c_nothing: cover (is_end && axis_q == Axes[1:0] - 2'd1 && counts_q == '0);
      c_full:    cover (record && counts_q[CountBits-1:0] == Most[CountBits-1:0] && addr_q == '1);
      c_last:    cover (record && next_segment == Segments[2:0] - 3'd1 && counts_q[0 +: CountBits] == '0);
      c_again:   cover (done && begin_i && due_record_q != '0);
    end
  end
endmodule
