// SPDX-License-Identifier: MIT
// The host's end of a lattice: takes requests from a serial line, does them, replies. The frames and commands
// are those of docs/reference/board.md. One request at a time: what comes while a reply is sent is not heard.
//
// Particles travel through one register, `word`: shifted in for LOAD; for READ taken from a dump (a run of no
// steps) and shifted out. A dump shows all particles of a node, so there is one for each particle that is
// read.
module cuboct_host_link #(
  parameter int          Nodes        = 1,      // 1 to 65535
  parameter int          Axes         = 3,      // 2 or 3
  parameter int          Capacity     = 16,     // of a node
  parameter int          ParticleBits = 154,    // >= 1
  parameter int          IdBits       = 8,      // of a particle's id
  parameter int          VelocityBits = 29,     // at most 64
  parameter int          MovedTypes   = 0,      // types whose velocities can be set
  parameter logic [63:0] PlanHash     = 64'd0,  // told by INFO
  parameter logic [63:0] MachineHash  = 64'd0,  // of the plan with all these velocities zero
  parameter int          ClockHz      = 12000000,  // told by INFO
  parameter int          BitClocks16  = 192     // length of a bit in 1/16 clocks, >= 64
) (
  input  logic                          clk_i,
  input  logic                          rst_ni,
  input  logic                          rx_i,        // the serial line, not synchronous
  output logic                          tx_o,        // the serial line
  // To the lattice.
  output logic                          lattice_rst_no,  // its reset, active low
  output logic                          start_o,     // in IDLE only
  output logic [31:0]                   steps_o,     // with start_o
  output logic                          load_valid_o,  // in IDLE only
  output logic [31:0]                   load_node_o, // with load_valid_o
  output logic [ParticleBits-1:0]       load_data_o, // with load_valid_o
  input  logic [Nodes-1:0]              observe_valid_i,  // by node: a particle is shown
  input  logic [Nodes*ParticleBits-1:0] observe_data_i,  // by node: its word
  input  logic [Nodes-1:0]              fault_valid_i,  // by node: a fault
  input  logic [4*Nodes-1:0]            fault_code_i,  // by node, with fault_valid_i
  input  logic [Nodes*IdBits-1:0]       fault_id_i,  // by node, with fault_valid_i
  input  logic [64*Nodes-1:0]           fault_number_i,  // by node, with fault_valid_i
  input  logic [Nodes-1:0]              idle_i,      // by node
  // To the velocities of moved types.
  output logic                          velocity_reset_o,  // to the plan's
  output logic                          velocity_valid_o,  // one is set
  output logic [7:0]                    velocity_type_o,  // with velocity_valid_o
  output logic [7:0]                    velocity_axis_o,  // with velocity_valid_o
  output logic [VelocityBits-1:0]       velocity_data_o,  // with velocity_valid_o
  // For lamps.
  output logic                          busy_o,      // a run is under way
  output logic                          fault_o      // a node met a fault since RESET
);
  localparam logic [7:0] Info = 8'h01, Status = 8'h02, Reset = 8'h03, Load = 8'h04, Run = 8'h05, Read = 8'h06,
                         Velocity = 8'h07, Fault = 8'h08;
  localparam logic [7:0] Version = 8'd1;  // of the protocol
  // Bytes.
  localparam int WordBytes = (ParticleBits + 7) / 8;
  localparam int ArgBytes  = (WordBytes + 4 > 10) ? WordBytes + 4 : 10;
  localparam int ArgBits   = 8 * ArgBytes;
  localparam int HeadBytes = 2;  // of a request: number, command
  localparam int SumBytes  = 4;
  localparam int NodeBits  = (Nodes > 1) ? $clog2(Nodes) : 1;
  localparam int SlotBits  = $clog2(Capacity + 1);
  localparam int IndexBits = $clog2(ArgBytes + 32);
  localparam int FaultBits = 4 + IdBits + 64;

  // The line.
  logic       line_valid, byte_valid, frame_end, crc_clear, crc_valid, crc_shift, crc_good;
  logic       send_valid, send_flag, send_ready, raw_valid, raw_ready, hears;
  logic [7:0] line_data, byte_data, crc_sum, send_data, raw_data;
  cuboct_uart_rx #(.BitClocks16(BitClocks16)) u_uart_rx (
    .clk_i, .rst_ni, .rx_i, .valid_o(line_valid), .data_o(line_data)
  );
  cuboct_frame_rx u_frame_rx (
    .clk_i, .rst_ni, .enable_i(hears), .valid_i(line_valid), .data_i(line_data), .valid_o(byte_valid),
    .data_o(byte_data), .end_o(frame_end)
  );
  cuboct_crc32 u_crc (
    .clk_i, .clear_i(crc_clear), .valid_i(crc_valid), .data_i(hears ? byte_data : send_data), .sum_o(crc_sum),
    .shift_i(crc_shift), .good_o(crc_good)
  );
  cuboct_frame_tx u_frame_tx (
    .clk_i, .rst_ni, .valid_i(send_valid), .flag_i(send_flag), .data_i(send_data), .ready_o(send_ready),
    .valid_o(raw_valid), .data_o(raw_data), .ready_i(raw_ready)
  );
  cuboct_uart_tx #(.BitClocks16(BitClocks16)) u_uart_tx (
    .clk_i, .rst_ni, .valid_i(raw_valid), .data_i(raw_data), .ready_o(raw_ready), .tx_o
  );

  typedef enum logic [3:0] {
    Hear, Execute, DumpStart, Dump, SendStart, SendHead, SendWord, SendSum, SendEnd
  } state_t;
  state_t               state_d, state_q;
  logic [IndexBits-1:0] index_d, index_q;  // of a byte in a request, a reply's head, a word, the check sum
  logic [7:0]           number_d, number_q, command_d, command_q;
  logic [ArgBits-1:0]   word_d, word_q;
  logic                 refused_d, refused_q;

  // What a request says besides its number and command: these many bytes, which end up at the top of `word`.
  logic [IndexBits-1:0] arg_bytes;
  always_comb begin
    unique case (command_q)
      Load:     arg_bytes = 4 + WordBytes[IndexBits-1:0];
      Run:      arg_bytes = 8;
      Read:     arg_bytes = 5;
      Velocity: arg_bytes = 10;
      Fault:    arg_bytes = 2;
      default:  arg_bytes = 0;
    endcase
  end
  logic [IndexBits-1:0] all_bytes;
  assign all_bytes = arg_bytes + HeadBytes[IndexBits-1:0] + SumBytes[IndexBits-1:0];
  logic [31:0] run_from, run_steps;
  logic [15:0] load_index, node, read_first;
  logic [7:0]  read_words;
  localparam int LoadAt = ArgBits - 8 * (WordBytes + 4);
  assign node            = word_q[ArgBits-16 +: 16];  // of LOAD, READ and FAULT
  assign load_index      = word_q[LoadAt +: 16];
  assign load_data_o     = word_q[LoadAt+16 +: ParticleBits];
  assign run_from        = word_q[ArgBits-64 +: 32];
  assign run_steps       = word_q[ArgBits-32 +: 32];
  assign read_first      = word_q[ArgBits-40 +: 16];
  assign read_words      = word_q[ArgBits-24 +: 8];
  assign velocity_type_o = word_q[ArgBits-80 +: 8];
  assign velocity_axis_o = word_q[ArgBits-72 +: 8];
  assign velocity_data_o = word_q[ArgBits-64 +: VelocityBits];
  // Comparisons of the bits that matter alone: a wide one costs a carry chain.
  logic is_node_number;
  localparam int UsedBits = $clog2(Nodes);
  if (Nodes == 2 ** UsedBits) begin : gen_all_numbers
    assign is_node_number = (node[15:UsedBits] == '0);
  end else begin : gen_some_numbers
    assign is_node_number = (node[15:UsedBits] == '0) && (node[UsedBits-1:0] < Nodes[UsedBits-1:0]);
  end
  logic is_moved;
  if (MovedTypes > 0) begin : gen_moved
    assign is_moved = (velocity_type_o < MovedTypes[7:0]);
  end else begin : gen_none_moved
    assign is_moved = 1'b0;
  end

  // The lattice.
  logic [15:0]         loaded_d, loaded_q;  // particles since RESET
  logic [31:0]         steps_d, steps_q;    // since RESET, once no run is under way
  logic [47:0]         cycles_d, cycles_q;  // of runs since RESET
  logic                run_d, run_q;        // under way
  logic                reset_d, reset_q;
  logic                all_idle, settled, load, run, fault_any;
  logic [NodeBits-1:0] node_d, node_q;      // to read
  logic [SlotBits-1:0] slot_d, slot_q, seen_d, seen_q;
  logic [7:0]          words_d, words_q;    // still to read
  assign all_idle       = (&idle_i);
  assign settled        = all_idle && !run_q;
  assign lattice_rst_no = rst_ni && !reset_q;
  assign load_valid_o   = load;
  assign load_node_o    = {16'd0, node};
  assign busy_o         = run_q;
  assign fault_o        = fault_any;

  // The node to read, and its particle.
  logic [Nodes-1:0]        is_node;
  logic                    observe_valid;
  logic [ParticleBits-1:0] observe_data;
  logic [FaultBits-1:0]    fault_data;  // {number, id, code}
  integer                  n;
  always_comb begin
    observe_data = '0;
    for (n = 0; n < Nodes; n = n + 1)
      observe_data = observe_data
                   | (observe_data_i[n*ParticleBits +: ParticleBits] & {ParticleBits{is_node[n]}});
  end
  assign observe_valid = ((observe_valid_i & is_node) != '0);

  // The first fault of each node since RESET.
  logic [Nodes-1:0]           faulty_q;
  logic [Nodes*FaultBits-1:0] faults_q;
  for (genvar k = 0; k < Nodes; k++) begin : gen_node
    localparam int Node = k;
    assign is_node[k] = (Nodes == 1) || (node_q == Node[NodeBits-1:0]);
    always_ff @(posedge clk_i) begin
      if (!lattice_rst_no) faulty_q[k] <= 1'b0;
      else if (fault_valid_i[k]) faulty_q[k] <= 1'b1;
    end
    always_ff @(posedge clk_i) begin
      if (fault_valid_i[k] && !faulty_q[k])
        faults_q[k*FaultBits +: FaultBits] <=
            {fault_number_i[64*k +: 64], fault_id_i[IdBits*k +: IdBits], fault_code_i[4*k +: 4]};
    end
  end
  integer f;
  always_comb begin
    fault_data = '0;
    for (f = 0; f < Nodes; f = f + 1)
      fault_data = fault_data | (faults_q[f*FaultBits +: FaultBits] & {FaultBits{is_node[f]}});
  end
  logic [3:0] fault_code;
  assign fault_code = ((faulty_q & is_node) != '0) ? fault_data[3:0] : 4'd0;
  assign fault_any = (faulty_q != '0);

  // Replies: number, command, status, then what the command asks for, least significant byte first.
  localparam int InfoBytes = 26;
  logic [8*InfoBytes-1:0] info_data;
  assign info_data[7:0]     = Version;
  assign info_data[71:8]    = PlanHash;
  assign info_data[135:72]  = MachineHash;
  assign info_data[151:136] = Nodes[15:0];
  assign info_data[167:152] = ParticleBits[15:0];
  assign info_data[199:168] = ClockHz;
  assign info_data[207:200] = MovedTypes[7:0];
  localparam int ShortBytes = 6, StateBytes = 12, FaultBytes = 13, CountBytes = 2;
  logic [8*StateBytes-1:0] state_data;
  logic [8*FaultBytes-1:0] fault_reply;
  logic [8*CountBytes-1:0] count_data;
  logic [IndexBits-1:0]    body_index, body_bytes;
  logic [7:0]              status, head_data;
  assign state_data  = {cycles_q, steps_q, loaded_q};
  assign fault_reply = {
    fault_data[4+IdBits +: 64], {(32-IdBits){1'b0}}, fault_data[4 +: IdBits], 4'd0, fault_code
  };
  assign count_data  = {{(16-SlotBits){1'b0}}, seen_q};
  assign status      = {5'd0, refused_q, fault_any, run_q};
  assign body_index  = index_q - HeadBytes[IndexBits-1:0] - 1'b1;
  always_comb begin
    body_bytes = ShortBytes[IndexBits-1:0];
    head_data  = state_data[8*body_index[3:0] +: 8];
    unique case (command_q)
      Info: begin
        body_bytes = InfoBytes[IndexBits-1:0];
        head_data  = info_data[8*body_index[4:0] +: 8];
      end
      Status: body_bytes = StateBytes[IndexBits-1:0];
      Read: begin
        body_bytes = CountBytes[IndexBits-1:0];
        head_data  = count_data[8*body_index[0] +: 8];
      end
      Fault: begin
        body_bytes = FaultBytes[IndexBits-1:0];
        head_data  = fault_reply[8*body_index[3:0] +: 8];
      end
      default: ;
    endcase
    if (index_q == 0) head_data = number_q;
    else if (index_q == 1) head_data = command_q;
    else if (index_q == 2) head_data = status;
  end

  assign hears = (state_q == Hear);
  logic more_words;
  assign more_words = (words_q != 8'd0) && (slot_q < seen_q) && !refused_q;
  always_comb begin
    state_d    = state_q;
    index_d    = index_q;
    number_d   = number_q;
    command_d  = command_q;
    word_d     = word_q;
    refused_d  = refused_q;
    loaded_d   = loaded_q;
    steps_d    = steps_q;
    cycles_d   = cycles_q;
    run_d      = run_q;
    reset_d    = 1'b0;
    node_d     = node_q;
    slot_d     = slot_q;
    seen_d     = seen_q;
    words_d    = words_q;
    crc_clear  = 1'b0;
    crc_valid  = 1'b0;
    crc_shift  = 1'b0;
    send_valid = 1'b0;
    send_flag  = 1'b0;
    send_data  = head_data;
    start_o    = 1'b0;
    steps_o    = '0;
    load       = 1'b0;
    run        = 1'b0;
    velocity_reset_o = reset_q;
    velocity_valid_o = 1'b0;

    // A run's cycles: from the one after its start on, to the last in which some node is not idle.
    if (run_q) begin
      if (all_idle) run_d = 1'b0;
      else cycles_d = cycles_q + 48'd1;
    end

    unique case (state_q)
      Hear: begin
        if (byte_valid) begin
          crc_valid = 1'b1;
          if (index_q == 0) number_d = byte_data;
          else if (index_q == 1) command_d = byte_data;
          else if (index_q < HeadBytes[IndexBits-1:0] + arg_bytes) word_d = {byte_data, word_q[ArgBits-1:8]};
          if (index_q != '1) index_d = index_q + 1'b1;
        end
        if (frame_end) begin
          crc_clear = 1'b1;
          index_d   = '0;
          if (crc_good && index_q == all_bytes) state_d = Execute;
        end
      end
      Execute: begin
        state_d   = SendStart;
        refused_d = 1'b0;
        unique case (command_q)
          Info, Status: ;
          Reset: begin
            reset_d  = 1'b1;
            loaded_d = '0;
            steps_d  = '0;
            cycles_d = '0;
            run_d    = 1'b0;
          end
          Load: begin
            load      = settled && load_index == loaded_q && is_node_number;
            refused_d = !load;
            if (load) loaded_d = loaded_q + 16'd1;
          end
          Run: begin
            run       = settled && !fault_any && run_from == steps_q && run_steps != '0;
            refused_d = !run;
            if (run) begin
              start_o = 1'b1;
              steps_o = run_steps;
              steps_d = steps_q + run_steps;
              run_d   = 1'b1;
            end
          end
          Read: begin
            node_d    = node[NodeBits-1:0];
            slot_d    = read_first[SlotBits-1:0];
            words_d   = read_words;
            seen_d    = '0;
            refused_d = !settled || !is_node_number || read_first[15:SlotBits] != '0;
            if (!refused_d) state_d = DumpStart;
          end
          Velocity: begin
            velocity_valid_o = settled && is_moved && velocity_axis_o < Axes[7:0];
            refused_d        = !velocity_valid_o;
          end
          Fault: begin
            node_d    = node[NodeBits-1:0];
            refused_d = !is_node_number;
          end
          default: refused_d = 1'b1;
        endcase
      end
      DumpStart: begin
        start_o = 1'b1;
        seen_d  = '0;
        state_d = Dump;
      end
      Dump: begin
        if (observe_valid) begin
          if (seen_q == slot_q) word_d[ParticleBits-1:0] = observe_data;
          seen_d = seen_q + 1'b1;
        end
        if (all_idle) begin
          // The first dump of a reply comes before its head.
          state_d = SendWord;
          if (index_q == '0) state_d = SendStart;
          index_d = '0;
        end
      end
      SendStart: begin
        send_valid = 1'b1;
        send_flag  = 1'b1;
        index_d    = '0;
        if (send_ready) state_d = SendHead;
      end
      SendHead: begin
        send_valid = 1'b1;
        if (send_ready) begin
          crc_valid = 1'b1;
          index_d   = index_q + 1'b1;
          if (body_index == body_bytes - 1'b1) begin
            index_d = '0;
            state_d = SendSum;
            if (command_q == Read && more_words) state_d = SendWord;
          end
        end
      end
      SendWord: begin
        send_valid = 1'b1;
        send_data  = word_q[7:0];
        if (send_ready) begin
          crc_valid = 1'b1;
          word_d    = {8'd0, word_q[ArgBits-1:8]};
          index_d   = index_q + 1'b1;
          if (index_q == WordBytes[IndexBits-1:0] - 1'b1) begin
            slot_d  = slot_q + 1'b1;
            words_d = words_q - 8'd1;
            state_d = SendSum;
            index_d = '0;
            if (words_q != 8'd1 && slot_q + 1'b1 < seen_q) begin
              index_d = 1;
              state_d = DumpStart;
            end
          end
        end
      end
      SendSum: begin
        send_valid = 1'b1;
        send_data  = crc_sum;
        if (send_ready) begin
          crc_valid = 1'b1;
          crc_shift = 1'b1;
          index_d   = index_q + 1'b1;
          if (index_q == SumBytes[IndexBits-1:0] - 1'b1) state_d = SendEnd;
        end
      end
      SendEnd: begin
        send_valid = 1'b1;
        send_flag  = 1'b1;
        index_d    = '0;
        if (send_ready) begin
          crc_clear = 1'b1;
          state_d   = Hear;
        end
      end
      default: state_d = Hear;
    endcase
  end

  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      state_q  <= SendEnd;
      index_q  <= '0;
      loaded_q <= '0;
      steps_q  <= '0;
      cycles_q <= '0;
      run_q    <= 1'b0;
      reset_q  <= 1'b1;
    end else begin
      state_q  <= state_d;
      index_q  <= index_d;
      loaded_q <= loaded_d;
      steps_q  <= steps_d;
      cycles_q <= cycles_d;
      run_q    <= run_d;
      reset_q  <= reset_d;
    end
  end
  always_ff @(posedge clk_i) begin
    number_q  <= number_d;
    command_q <= command_d;
    word_q    <= word_d;
    refused_q <= refused_d;
    node_q    <= node_d;
    slot_q    <= slot_d;
    seen_q    <= seen_d;
    words_q   <= words_d;
  end
endmodule
