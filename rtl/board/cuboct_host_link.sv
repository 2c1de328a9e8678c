// SPDX-License-Identifier: MIT
// The host's end of a lattice: takes requests from a stream of bytes, does them, replies. Frames and commands are those
// of docs/reference/board.md. One request at a time: while a reply is made and sent no byte is taken.
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
  parameter int          ClockHz      = 12000000  // told by INFO
) (
  input  logic                          clk_i,
  input  logic                          rst_ni,
  // Bytes from the host and to it.
  input  logic                          rx_valid_i,  // a byte is there
  input  logic [7:0]                    rx_data_i,   // with rx_valid_i
  output logic                          rx_ready_o,  // a byte is taken in a cycle with rx_valid_i and rx_ready_o
  output logic                          tx_valid_o,  // a byte is there; stays until tx_ready_i
  output logic [7:0]                    tx_data_o,   // with tx_valid_o; stays likewise
  input  logic                          tx_ready_i,  // a byte is taken in a cycle with tx_valid_o and tx_ready_i
  // To the lattice.
  output logic                          lattice_rst_no,  // its reset, active low
  output logic                          start_o,     // in IDLE only
  output logic [31:0]                   steps_o,     // with start_o
  output logic                          load_valid_o,  // in IDLE only
  output logic [ParticleBits-1:0]       load_data_o, // with load_valid_o
  output logic                          select_o,    // node_o is to be observed
  output logic [31:0]                   node_o,      // with load_valid_o or select_o
  input  logic                          idle_i,      // nothing runs
  input  logic                          busy_i,      // in as many cycles as a run takes
  input  logic                          settled_i,   // the other inputs know of the last start_o and select_o
  input  logic                          faulty_i,    // a node met a fault since lattice_rst_no
  input  logic                          fault_valid_i,  // the node observed did
  input  logic [3:0]                    fault_code_i,  // with fault_valid_i
  input  logic [IdBits-1:0]             fault_id_i,  // with fault_valid_i
  input  logic [63:0]                   fault_number_i,  // with fault_valid_i
  input  logic                          observe_valid_i,  // the node observed shows a particle
  input  logic [ParticleBits-1:0]       observe_data_i,  // with observe_valid_i
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
  localparam int SlotBits  = $clog2(Capacity + 1);
  localparam int IndexBits = $clog2(ArgBytes + 32);

  // The stream.
  logic       byte_valid, frame_end, crc_clear, crc_valid, crc_ready, crc_shift, crc_good;
  logic       send_valid, send_flag, send_ready, frame_ready, hears;
  logic [7:0] byte_data, crc_sum, send_data;
  cuboct_frame_rx u_frame_rx (
    .clk_i, .rst_ni, .enable_i(hears), .valid_i(rx_valid_i && rx_ready_o), .data_i(rx_data_i), .valid_o(byte_valid),
    .data_o(byte_data), .end_o(frame_end)
  );
  cuboct_crc32 u_crc (
    .clk_i, .rst_ni, .clear_i(crc_clear), .valid_i(crc_valid), .ready_o(crc_ready),
    .data_i(hears ? byte_data : send_data), .sum_o(crc_sum), .shift_i(crc_shift), .good_o(crc_good)
  );
  cuboct_frame_tx u_frame_tx (
    .clk_i, .rst_ni, .valid_i(send_valid && crc_ready), .flag_i(send_flag), .data_i(send_data),
    .ready_o(frame_ready), .valid_o(tx_valid_o), .data_o(tx_data_o), .ready_i(tx_ready_i)
  );
  // Of a serial line no byte comes before the check sum is ready.
  assign rx_ready_o = hears && crc_ready;
  assign send_ready = frame_ready && crc_ready;

  typedef enum logic [3:0] {
    Hear, Execute, Settle, DumpStart, Dump, SendStart, SendHead, SendWord, SendSum, SendEnd
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
  logic                rests, load, run;
  logic [SlotBits-1:0] slot_d, slot_q, seen_d, seen_q;
  logic [7:0]          words_d, words_q;    // still to read
  assign rests          = idle_i && !run_q;
  assign lattice_rst_no = rst_ni && !reset_q;
  assign load_valid_o   = load;
  assign node_o         = {16'd0, node};
  assign busy_o         = run_q;
  assign fault_o        = faulty_i;

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
    fault_number_i, {(32-IdBits){1'b0}}, fault_id_i, 4'd0, fault_valid_i ? fault_code_i : 4'd0
  };
  assign count_data  = {{(16-SlotBits){1'b0}}, seen_q};
  assign status      = {5'd0, refused_q, faulty_i, run_q};
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
    select_o   = 1'b0;
    velocity_reset_o = reset_q;
    velocity_valid_o = 1'b0;

    // A run's cycles: those in which some node is not idle.
    if (run_q) begin
      if (idle_i) run_d = 1'b0;
      else if (busy_i) cycles_d = cycles_q + 48'd1;
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
            load      = rests && load_index == loaded_q && is_node_number;
            refused_d = !load;
            if (load) loaded_d = loaded_q + 16'd1;
          end
          Run: begin
            run       = rests && !faulty_i && run_from == steps_q && run_steps != '0;
            refused_d = !run;
            if (run) begin
              start_o = 1'b1;
              steps_o = run_steps;
              steps_d = steps_q + run_steps;
              run_d   = 1'b1;
            end
          end
          Read: begin
            slot_d    = read_first[SlotBits-1:0];
            words_d   = read_words;
            seen_d    = '0;
            refused_d = !rests || !is_node_number || read_first[15:SlotBits] != '0;
            if (!refused_d) begin
              select_o = 1'b1;
              state_d  = DumpStart;
            end
          end
          Velocity: begin
            velocity_valid_o = rests && is_moved && velocity_axis_o < Axes[7:0];
            refused_d        = !velocity_valid_o;
          end
          Fault: begin
            refused_d = !is_node_number;
            select_o  = is_node_number;
            state_d   = Settle;
          end
          default: refused_d = 1'b1;
        endcase
      end
      Settle: if (settled_i) state_d = SendStart;
      DumpStart: begin
        start_o = 1'b1;
        seen_d  = '0;
        state_d = Dump;
      end
      Dump: begin
        if (observe_valid_i) begin
          if (seen_q == slot_q) word_d[ParticleBits-1:0] = observe_data_i;
          seen_d = seen_q + 1'b1;
        end
        if (idle_i) begin
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
    slot_q    <= slot_d;
    seen_q    <= seen_d;
    words_q   <= words_d;
  end
endmodule
