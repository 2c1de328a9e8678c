// SPDX-License-Identifier: MIT
// Made by cuboct emit from plan 5290aa12107ad825; do not edit.
// Loads the lattice, runs Steps steps and compares every particle that a node shows with golden's. Then it reads the
// last state back as hosts do, a node at a time. +waves writes cuboct_bench.vcd, where the simulator can.
`timescale 1ns / 1ns
module cuboct_bench;
  localparam int Nodes        = 2;
  localparam int ProbeNodes   = Nodes;
  localparam int ParticleBits = cuboct_pkg::ParticleBits;
  localparam int IdBits       = cuboct_pkg::IdBits;
  localparam int Loads        = 8;
  localparam int Expected     = 24;
  localparam int Steps        = 2;
  localparam int Limit        = 2096;  // cycles; a run that takes longer hangs

  logic clk;
  logic rst_n;
  logic start;
  logic [31:0] steps;
  logic load_valid;
  logic [cuboct_pkg::ParticleBits-1:0] load_data;
  logic select;
  logic [31:0] node;
  logic idle;
  logic busy;
  logic settled;
  logic faulty;
  logic observe_valid;
  logic [cuboct_pkg::ParticleBits-1:0] observe_data;
  logic fault_valid;
  logic [3:0] fault_code;
  logic [cuboct_pkg::IdBits-1:0] fault_id;
  logic [63:0] fault_number;
  logic [ProbeNodes*8-1:0] probe_phase_start;
  logic [ProbeNodes*8-1:0] probe_phase_end;
  logic [ProbeNodes-1:0] probe_observe_valid;
  logic [ProbeNodes*cuboct_pkg::ParticleBits-1:0] probe_observe_data;
  logic [ProbeNodes-1:0] probe_fault_valid;
  logic [ProbeNodes*4-1:0] probe_fault_code;
  logic [ProbeNodes*cuboct_pkg::IdBits-1:0] probe_fault_id;
  logic [ProbeNodes*64-1:0] probe_fault_number;
  logic [ProbeNodes-1:0] probe_idle;

  cuboct_lattice #(.Probe(1)) u_lattice (
    .clk_i(clk),
    .rst_ni(rst_n),
    .start_i(start),
    .steps_i(steps),
    .load_valid_i(load_valid),
    .load_data_i(load_data),
    .select_i(select),
    .node_i(node),
    .idle_o(idle),
    .busy_o(busy),
    .settled_o(settled),
    .faulty_o(faulty),
    .observe_valid_o(observe_valid),
    .observe_data_o(observe_data),
    .fault_valid_o(fault_valid),
    .fault_code_o(fault_code),
    .fault_id_o(fault_id),
    .fault_number_o(fault_number),
    .probe_phase_start_o(probe_phase_start),
    .probe_phase_end_o(probe_phase_end),
    .probe_observe_valid_o(probe_observe_valid),
    .probe_observe_data_o(probe_observe_data),
    .probe_fault_valid_o(probe_fault_valid),
    .probe_fault_code_o(probe_fault_code),
    .probe_fault_id_o(probe_fault_id),
    .probe_fault_number_o(probe_fault_number),
    .probe_idle_o(probe_idle)
  );

  // Words are {node, particle}; {step, slot, particle}, all of node 0 in the order of time, then of node 1, ...;
  // and where each node's begin, with the end.
  logic [ParticleBits+31:0] loads [0:Loads-1];
  logic [ParticleBits+63:0] expected [0:Expected-1];
  logic [31:0] first [0:Nodes];

  integer next [0:Nodes-1];
  integer last [0:Nodes-1];  // where the last state of a node begins; -1: it has no particle
  integer n, k, cycle, compared, phases, counted;
  logic [ParticleBits-1:0] got, want;
  logic [31:0] step, slot;
  logic running, reads;

  initial clk = 1'b0;
  always #5 clk = !clk;

  initial begin
    $readmemh("loads.hex", loads);
    $readmemh("expected.hex", expected);
    $readmemh("first.hex", first);
    for (n = 0; n < Nodes; n = n + 1) next[n] = first[n];
    rst_n = 1'b0; start = 1'b0; load_valid = 1'b0; node = '0; load_data = '0; running = 1'b0;
    select = 1'b0; steps = '0;
  end

  initial if ($test$plusargs("waves")) begin
    $dumpfile("cuboct_bench.vcd");
    $dumpvars(0, cuboct_bench);
  end

  // Four cycles of reset, a particle per cycle, start.
  integer tick;
  initial tick = 0;
  always @(posedge clk) begin
    tick       <= tick + 1;
    rst_n      <= (tick >= 4);
    load_valid <= (tick >= 6 && tick < 6 + Loads);
    if (tick >= 6 && tick < 6 + Loads) {node, load_data} <= loads[tick-6];
    start      <= (tick == 6 + Loads);
    steps      <= Steps;
    select     <= 1'b0;
    if (tick == 7 + Loads) running <= 1'b1;
    if (reads) begin
      start  <= idle && !start && reader < Nodes;
      select <= idle && !start && reader < Nodes;
      node   <= reader;
      steps  <= 32'd0;
    end
  end

  initial begin
    cycle    = 0;
    compared = 0;
    phases   = 0;
    counted  = 0;
  end
  always @(posedge clk) if (running && !reads) begin
    if (!(&probe_idle)) cycle = cycle + 1;
    if (busy) counted = counted + 1;
    for (k = 0; k < Nodes; k = k + 1) begin
      if (probe_fault_valid[k]) begin
        $display("FAIL node %0d: fault %0d, particle %0d, number %0d", k, probe_fault_code[4*k +: 4],
                 probe_fault_id[IdBits*k +: IdBits], $signed(probe_fault_number[64*k +: 64]));
        $fatal(1, "fault");
      end
      if (probe_observe_valid[k]) begin
        got = probe_observe_data[ParticleBits*k +: ParticleBits];
        if (next[k] >= first[k+1]) begin
          $display("FAIL node %0d: observes a particle more than golden has", k);
          $fatal(1, "more");
        end
        {step, slot, want} = expected[next[k]];
        if (got[0 +: 20] !== want[0 +: 20]) begin
          $display("FAIL step %0d node %0d slot %0d particle %0d: x_x is %0d, golden has %0d", step, k,
                   slot, want[151 +: IdBits], got[0 +: 20], want[0 +: 20]);
          $fatal(1, "differs");
        end
        if (got[20 +: 20] !== want[20 +: 20]) begin
          $display("FAIL step %0d node %0d slot %0d particle %0d: x_y is %0d, golden has %0d", step, k,
                   slot, want[151 +: IdBits], got[20 +: 20], want[20 +: 20]);
          $fatal(1, "differs");
        end
        if (got[40 +: 20] !== want[40 +: 20]) begin
          $display("FAIL step %0d node %0d slot %0d particle %0d: x_z is %0d, golden has %0d", step, k,
                   slot, want[151 +: IdBits], got[40 +: 20], want[40 +: 20]);
          $fatal(1, "differs");
        end
        if (got[60 +: 2] !== want[60 +: 2]) begin
          $display("FAIL step %0d node %0d slot %0d particle %0d: away_y is %0d, golden has %0d", step, k,
                   slot, want[151 +: IdBits], $signed(got[60 +: 2]), $signed(want[60 +: 2]));
          $fatal(1, "differs");
        end
        if (got[62 +: 2] !== want[62 +: 2]) begin
          $display("FAIL step %0d node %0d slot %0d particle %0d: away_z is %0d, golden has %0d", step, k,
                   slot, want[151 +: IdBits], $signed(got[62 +: 2]), $signed(want[62 +: 2]));
          $fatal(1, "differs");
        end
        if (got[64 +: 29] !== want[64 +: 29]) begin
          $display("FAIL step %0d node %0d slot %0d particle %0d: v_x is %0d, golden has %0d", step, k,
                   slot, want[151 +: IdBits], $signed(got[64 +: 29]), $signed(want[64 +: 29]));
          $fatal(1, "differs");
        end
        if (got[93 +: 29] !== want[93 +: 29]) begin
          $display("FAIL step %0d node %0d slot %0d particle %0d: v_y is %0d, golden has %0d", step, k,
                   slot, want[151 +: IdBits], $signed(got[93 +: 29]), $signed(want[93 +: 29]));
          $fatal(1, "differs");
        end
        if (got[122 +: 29] !== want[122 +: 29]) begin
          $display("FAIL step %0d node %0d slot %0d particle %0d: v_z is %0d, golden has %0d", step, k,
                   slot, want[151 +: IdBits], $signed(got[122 +: 29]), $signed(want[122 +: 29]));
          $fatal(1, "differs");
        end
        if (got[151 +: 3] !== want[151 +: 3]) begin
          $display("FAIL step %0d node %0d slot %0d particle %0d: id is %0d, golden has %0d", step, k,
                   slot, want[151 +: IdBits], got[151 +: 3], want[151 +: 3]);
          $fatal(1, "differs");
        end
        if (got[154 +: 8] !== want[154 +: 8]) begin
          $display("FAIL step %0d node %0d slot %0d particle %0d: residue_x is %0d, golden has %0d", step, k,
                   slot, want[151 +: IdBits], got[154 +: 8], want[154 +: 8]);
          $fatal(1, "differs");
        end
        if (got[162 +: 8] !== want[162 +: 8]) begin
          $display("FAIL step %0d node %0d slot %0d particle %0d: residue_y is %0d, golden has %0d", step, k,
                   slot, want[151 +: IdBits], got[162 +: 8], want[162 +: 8]);
          $fatal(1, "differs");
        end
        if (got[170 +: 8] !== want[170 +: 8]) begin
          $display("FAIL step %0d node %0d slot %0d particle %0d: residue_z is %0d, golden has %0d", step, k,
                   slot, want[151 +: IdBits], got[170 +: 8], want[170 +: 8]);
          $fatal(1, "differs");
        end
        compared = compared + 1;
        if (step == Steps && last[k] < 0) last[k] = next[k];
        next[k] = next[k] + 1;
      end
      if (probe_phase_end[8*k+7]) phases = phases + 1;
    end
    if (cycle > 0 && idle) begin
      for (k = 0; k < Nodes; k = k + 1) if (next[k] != first[k+1]) begin
        {step, slot, want} = expected[next[k]];
        $display("FAIL step %0d node %0d slot %0d: particle %0d was not observed", step, k, slot,
                 want[151 +: IdBits]);
        $fatal(1, "less");
      end
      if (compared != Expected || phases != Steps * Nodes) begin
        $display("FAIL %0d of %0d comparisons, %0d of %0d steps of nodes", compared, Expected, phases,
                 Steps * Nodes);
        $fatal(1, "count");
      end
      if (counted != cycle) begin
        $display("FAIL busy_o was high in %0d cycles of %0d", counted, cycle);
        $fatal(1, "busy");
      end
      reads <= 1'b1;
    end
    if (cycle > Limit) begin
      for (k = Nodes - 1; k > 0 && probe_idle[k]; k = k - 1) ;
      $display("FAIL node %0d: still busy after %0d cycles", k, cycle);
      $fatal(1, "timeout");
    end
  end

  // Node by node: start with select shows its particles.
  integer reader, read, place, m;
  initial begin
    reads  = 1'b0;
    reader = 0;
    read   = 0;
    place  = 0;
    for (m = 0; m < Nodes; m = m + 1) last[m] = -1;
  end
  always @(posedge clk) if (reads) begin
    if (observe_valid) begin
      want = expected[last[reader-1]+place][0 +: ParticleBits];
      if (place >= first[reader] - last[reader-1] || observe_data !== want) begin
        $display("FAIL node %0d: reads particle %0d of the last state as %h, golden has %h", reader - 1, place,
                 observe_data, want);
        $fatal(1, "read");
      end
      place = place + 1;
      read  = read + 1;
    end
    if (start) reader <= reader + 1;
    if (start) place = 0;
    if (idle && !start && reader == Nodes) begin
      if (read != Loads || faulty) begin
        $display("FAIL %0d of %0d particles were read, fault %0d", read, Loads, faulty);
        $fatal(1, "read");
      end
      $display("PASS %0d comparisons, %0d steps, %0d nodes, %0d cycles", compared, Steps, Nodes, cycle);
      $finish;
    end
  end

  logic unused_phases;
  assign unused_phases = ^{probe_phase_start, settled, fault_valid, fault_code, fault_id, fault_number};
endmodule
