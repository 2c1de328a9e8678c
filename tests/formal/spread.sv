// SPDX-License-Identifier: MIT
// cuboct_tree with any commands: each node gets a start, its own loads and no others, Levels cycles later, with the
// data of that cycle; one node is observed, the last one selected; what nodes show comes out or-ed, Levels later.
module spread_formal #(
  parameter int Nodes = 9,
  parameter int Bits  = 2
) (
  input logic              clk_i,
  input logic              start_i,
  input logic              load_i,
  input logic              select_i,
  input logic [31:0]       node_i,
  input logic [Bits-1:0]   data_i,
  input logic [4*Nodes-1:0] flags_i,
  input logic [2*Nodes-1:0] shown_i,
  input logic [3:0]        which_i   // any node, the same in all cycles
);
  localparam int Levels = (Nodes <= 1) ? 0 : (Nodes <= 8) ? 1 : 2;
  localparam int Groups = (Nodes + 7) / 8;
  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;

  logic settled, busy, idle, faulty, fault_valid, fault, observe_valid, observe_data;
  logic [Groups-1:0]      start;
  logic [Nodes-1:0]       load, observed;
  logic [Groups*Bits-1:0] data;
  cuboct_tree #(.Nodes(Nodes), .CommandBits(Bits), .ParticleBits(1), .FaultBits(1)) u_dut (
    .clk_i, .rst_ni(running_q), .start_i, .load_valid_i(load_i), .select_i, .node_i, .command_i(data_i),
    .settled_o(settled), .busy_o(busy), .idle_o(idle), .faulty_o(faulty), .fault_valid_o(fault_valid),
    .fault_o(fault), .observe_valid_o(observe_valid), .observe_data_o(observe_data), .node_start_o(start),
    .node_load_o(load), .node_observed_o(observed), .node_command_o(data), .node_flags_i(flags_i),
    .node_data_i(shown_i)
  );
  logic [3:0] which_q;
  always_ff @(posedge clk_i) which_q <= which_i;
  always_comb begin
    assume (which_i < Nodes[3:0]);
    if (running_q) assume (which_i == which_q);
  end

  // The inputs of the last cycles, the newest at 0, and what they make of the observed node.
  logic [1:0]      start_q, load_q, select_q, hit_q, ran_q;
  logic [2*Bits-1:0] data_q;
  logic [7:0]      flags_q;
  logic [3:0]      data_or_q;
  logic            observed_q, hit;
  logic [3:0]      flags;
  logic [1:0]      shown;
  integer          n;
  assign hit = (node_i == {28'd0, which_i});
  always_comb begin
    flags = '0;
    shown = '0;
    for (n = 0; n < Nodes; n = n + 1) begin
      flags = flags | flags_i[4*n +: 4];
      shown = shown | shown_i[2*n +: 2];
    end
  end
  always_ff @(posedge clk_i) begin
    ran_q     <= {ran_q[0] && running_q, running_q};
    start_q   <= {start_q[0], start_i && running_q};
    load_q    <= {load_q[0], load_i && running_q};
    select_q  <= {select_q[0], select_i && running_q};
    hit_q     <= {hit_q[0], hit};
    data_q    <= {data_q[Bits-1:0], data_i};
    flags_q   <= {flags_q[3:0], flags};
    data_or_q <= {data_or_q[1:0], shown};
    if (!running_q) {ran_q, start_q, load_q, select_q, hit_q} <= '0;
    if (!running_q) observed_q <= (which_i == 4'd0);
    else if ((Levels == 1) ? select_i : select_q[Levels-2]) observed_q <= (Levels == 1) ? hit : hit_q[Levels-2];
  end
  always_ff @(posedge clk_i) begin
    if (running_q) begin
      a_start: assert (start[which_i/8] == start_q[Levels-1]);
      a_load:  assert (load[which_i] == (load_q[Levels-1] && hit_q[Levels-1]));
      a_observed: assert (observed[which_i] == observed_q);
      if (ran_q[Levels-1]) begin
        a_data:  assert (data[which_i/8*Bits +: Bits] == data_q[(Levels-1)*Bits +: Bits]);
        a_flags: assert ({busy, faulty, fault_valid, observe_valid} == flags_q[(Levels-1)*4 +: 4]);
        a_or:    assert ({fault, observe_data} == data_or_q[(Levels-1)*2 +: 2]);
      end
      a_idle:  assert (idle == (settled && !busy));
      if (start_q[0] || select_q[0]) a_unsettled: assert (!settled);
      c_load:  cover (load[which_i] && which_i == Nodes[3:0] - 4'd1);
      c_away:  cover (observed_q && which_i != 4'd0 && settled);
    end
  end
endmodule
