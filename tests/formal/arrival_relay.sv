// SPDX-License-Identifier: MIT
// cuboct_arrival_relay through any number of exchanges, with any counts, records that come one by one in any cycle,
// also before the exchange, and any pauses of each link: each record of each segment is sent once, segments and records
// in order, in lock step over all links of its axis and those behind, and only after it came; behind an axis's last
// record both its links get one end beat. A record's content is its own name, (segment, number), so what is sent tells
// where it was read; the memories answer in the cycle after the question, with anything for a record that has not come.
module arrival_relay_formal #(
  parameter int Axes     = 2,
  parameter int AddrBits = 1,   // a segment holds up to 2^AddrBits records
  parameter int LinkBits = 3,
  parameter int Patience = 5    // cycles of two links free and something to send, within which a beat is loaded
) (
  input logic                clk_i,
  input logic [2*Axes-1:0]   held_i,   // before an exchange: the link's register will hold a beat in the next cycle
  input logic [2*Axes-1:0]   ready_i,  // what it holds is taken
  input logic                over_i,   // the exchange ends, if all was sent
  input logic                begin_i,
  input logic [2*Axes-2:0]   come_i,   // a record of the segment comes, or after the last its end
  input logic [3+AddrBits-1:0] junk_i, // what the memories answer without a record
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

  // Exchanges, what there is to come, and what has come. Own particles are there from the first cycle on.
  logic                          active_q, done;
  logic [Axes-1:0]               sent;
  logic [Segments*CountBits-1:0] counts_q, came_q;
  logic [Segments-1:0]           complete_q;
  integer                        t;
  // A link's register holds what was loaded until it is taken; before an exchange what it holds comes from anyone.
  (* anyconst *) logic [2*Axes-1:0] has_link;
  logic [2*Axes-1:0] held_q, can_load, load;
  always_ff @(posedge clk_i) begin
    if (!running_q) held_q <= '0;
    else held_q <= (active_q ? load | (held_q & ~ready_i) : held_i) & has_link;
  end
  assign can_load = ~held_q | ready_i;
  assign done = active_q && sent == '1 && over_i;
  logic [Segments-1:0] come;  // a record does
  always_comb begin
    come = '0;
    for (t = 1; t < Segments; t = t + 1) begin
      come[t] = running_q && !done && come_i[t]
             && came_q[t*CountBits +: CountBits] != counts_q[t*CountBits +: CountBits];
    end
  end
  always_ff @(posedge clk_i) begin
    active_q <= running_q && (active_q ? !done : begin_i);
    if (!running_q || done) counts_q <= counts_i;
    for (t = 1; t < Segments; t = t + 1) begin
      if (!running_q || done) begin
        came_q[t*CountBits +: CountBits] <= '0;
        complete_q[t]                    <= 1'b0;
      end else if (come[t]) begin
        came_q[t*CountBits +: CountBits] <= came_q[t*CountBits +: CountBits] + 1'b1;
      end else if (come_i[t]) begin
        complete_q[t] <= 1'b1;
      end
    end
  end
  integer a;
  always_comb begin
    for (a = 0; a < Segments; a = a + 1) begin
      assume (counts_i[a*CountBits +: CountBits] <= Most[CountBits-1:0]);
      if (running_q) assume (counts_q[a*CountBits +: CountBits] <= Most[CountBits-1:0]);
    end
  end
  logic [Segments*CountBits-1:0] there;  // records that may be asked for
  logic [Segments-1:0]           complete;
  assign there    = {came_q[Segments*CountBits-1:CountBits], counts_q[0 +: CountBits]};
  assign complete = {complete_q[Segments-1:1], 1'b1};

  logic                         is_end, observe, read;
  logic [LinkBits-1:0]          data;
  logic [Segments-1:0]          clear;
  logic [AddrBits-1:0]          addr, slot;
  logic [HaloBits-1:0]          own, halo;
  logic [Segments*HaloBits-1:0] answers_q;
  cuboct_arrival_relay #(
    .Axes(Axes), .LinkBits(LinkBits), .HaloBits(HaloBits), .SlotBits(AddrBits), .AddrBits(AddrBits),
    .CountBits(CountBits)
  ) u_dut (
    .clk_i, .rst_ni(running_q), .active_i(active_q), .own_count_i(counts_q[0 +: CountBits]),
    .came_i(come[Segments-1:1]), .complete_i(complete), .read_o(read),
    .clear_o(clear), .addr_o(addr), .slot_o(slot), .own_i(own), .halo_i(halo), .has_link_i(has_link),
    .valid_i(held_q), .ready_i, .load_o(load), .end_o(is_end), .data_o(data), .observe_o(observe), .sent_o(sent)
  );
  for (genvar m = 0; m < Segments; m++) begin : gen_memory
    localparam logic [2:0] Memory = m;
    logic [AddrBits-1:0] asked;
    assign asked = (m == 0) ? slot : addr;
    always_ff @(posedge clk_i) begin
      if (m > 0 && read && clear[m]) answers_q[m*HaloBits +: HaloBits] <= '0;
      else if (read && {1'b0, asked} < there[m*CountBits +: CountBits])
        answers_q[m*HaloBits +: HaloBits] <= {Memory, asked};
      else if (read) answers_q[m*HaloBits +: HaloBits] <= junk_i;
    end
  end
  assign own = answers_q[0 +: HaloBits];
  integer h;
  always_comb begin
    halo = '0;
    for (h = 1; h < Segments; h = h + 1) halo = halo | answers_q[h*HaloBits +: HaloBits];
  end

  // What must come: the least (segment, number) not yet sent, of the segments of the axes that have not ended; or,
  // where those of the next axis to end are all sent, its end.
  logic [2:0]                due_segment_q, next_segment;
  logic [CountBits-1:0]      due_record_q, next_record;
  logic [1:0]                ended_q;   // axes that have
  logic                      some, ends, ready;  // a record is due; an end is; what is due may go out
  logic [Beats*LinkBits-1:0] due, parts_q, whole;
  logic [3:0]                beat_q;
  logic [2*Axes-1:0]         links;     // that it goes over
  integer                    s, b, f;
  always_comb begin
    next_segment = due_segment_q;
    next_record  = due_record_q;
    some         = 1'b0;
    ready        = 1'b1;
    for (s = Segments - 1; s >= 0; s = s - 1) begin
      if (s <= 2 * ended_q && s[2:0] >= due_segment_q && counts_q[s*CountBits +: CountBits] != '0
          && !(s[2:0] == due_segment_q && due_record_q == counts_q[s*CountBits +: CountBits])) begin
        next_segment = s[2:0];
        next_record  = (s[2:0] == due_segment_q) ? due_record_q : '0;
        some         = 1'b1;
      end
    end
    // All before it is known to be over, and it has come; before an end all of the axis is over.
    for (s = 0; s < Segments; s = s + 1) begin
      if (s <= 2 * ended_q && (!some || s[2:0] < next_segment) && !complete[s]) ready = 1'b0;
      if (some && s[2:0] == next_segment && next_record >= there[s*CountBits +: CountBits]) ready = 1'b0;
    end
    ends  = !some && ended_q != Axes[1:0];
    links = '0;
    for (f = 0; f < 2 * Axes; f = f + 1) links[f] = some ? (f / 2 >= ended_q) : (f / 2 == ended_q);
    due               = '0;
    due[HaloBits-1:0] = {next_segment, next_record[AddrBits-1:0]};
    whole             = parts_q;
    for (b = 0; b < Beats; b = b + 1) begin
      if (beat_q == b[3:0]) whole[b*LinkBits +: LinkBits] = data;
    end
  end
  logic record;  // the last beat of a record is loaded
  assign record = load != '0 && !is_end && (beat_q == LastBeat[3:0]);
  logic [CountBits-1:0] observed_q;
  logic [3:0]           idle_q;  // cycles in which something could be sent, and was not, one after the other
  logic                 idle, late_q, split_q;
  assign idle = active_q && can_load == '1 && (some || ends) && ready && load == '0;
  always_ff @(posedge clk_i) begin
    parts_q <= whole;
    idle_q  <= (running_q && idle) ? idle_q + 1'b1 : '0;
    if (!running_q || !active_q || done) begin
      due_segment_q <= '0;
      due_record_q  <= '0;
      ended_q       <= '0;
      beat_q        <= '0;
      observed_q    <= '0;
      late_q        <= 1'b0;
      split_q       <= 1'b0;
    end else begin
      if (load != '0 && !is_end) beat_q <= record ? '0 : beat_q + 1'b1;
      if (record) begin
        due_segment_q <= next_segment;
        due_record_q  <= next_record + 1'b1;
      end
      if (load != '0 && is_end) ended_q <= ended_q + 1'b1;
      if (observe) observed_q <= observed_q + 1'b1;
      late_q  <= late_q || (some && !ready && next_record != '0);
      split_q <= split_q || (some && ready && can_load != '0 && can_load != '1);
    end
  end

  always_ff @(posedge clk_i) begin
    if (running_q) begin
      if (load != '0) begin
        a_may:   assert (active_q && (load & ~can_load) == '0);
        a_links: assert (load == links);
        a_kind:  assert (is_end ? ends : some);
        a_come:  assert (ready);
        if (is_end) a_end: assert (data == '0 && beat_q == '0);
      end
      if (record) a_record: assert (whole == due);
      if (observe) begin
        a_observe: assert (own == {3'd0, observed_q[AddrBits-1:0]} && observed_q != counts_q[0 +: CountBits]);
      end
      if (ended_q != '0) a_observed: assert (observed_q == counts_q[0 +: CountBits]);
      if (active_q) a_sent: assert (sent == (({{(Axes - 1) {1'b0}}, 1'b1} << ended_q) - 1'b1));
      a_progress: assert (idle_q <= Patience[3:0]);
      c_nothing: cover (done && counts_q == '0);
      c_full:    cover (done && counts_q == {Segments{Most[CountBits-1:0]}});
      c_late:    cover (done && late_q && split_q && due_segment_q == Segments[2:0] - 3'd1);
    end
  end
endmodule
