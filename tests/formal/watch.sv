// SPDX-License-Identifier: MIT
// cuboct_watch beside any node: what a host sees of it is the node's first fault since the reset and its particles,
// while the host observes it, else zeros; busy and "had a fault" are shown always.
module watch_formal #(
  parameter int ParticleBits = 2,
  parameter int FaultBits    = 2,
  parameter int Delay        = 1
) (
  input logic                    clk_i,
  input logic                    observed_i,
  input logic                    idle_i,
  input logic                    observe_valid_i,
  input logic [ParticleBits-1:0] observe_data_i,
  input logic                    fault_valid_i,
  input logic [FaultBits-1:0]    fault_i
);
  localparam int DataBits = FaultBits + ParticleBits;
  logic running_q = 1'b0;  // reset in the first cycle only
  always_ff @(posedge clk_i) running_q <= 1'b1;

  logic [3:0]          flags;
  logic [DataBits-1:0] data;
  cuboct_watch #(.ParticleBits(ParticleBits), .FaultBits(FaultBits), .Delay(Delay)) u_dut (
    .clk_i, .rst_ni(running_q), .observed_i, .idle_i, .observe_valid_i, .observe_data_i,
    .fault_valid_i(fault_valid_i && running_q), .fault_i, .flags_o(flags), .data_o(data)
  );

  // The node's first fault: told from the cycle after it on.
  logic                 had_q, second_q;
  logic [FaultBits-1:0] first_q;
  always_ff @(posedge clk_i) begin
    if (!running_q) {had_q, second_q} <= '0;
    else begin
      had_q    <= had_q || fault_valid_i;
      second_q <= second_q || (had_q && fault_valid_i && fault_i != first_q);
    end
    if (!had_q) first_q <= fault_i;
  end

  // What it is told in this cycle; with Delay in the next.
  logic                    ran, shows, observed, had, busy;
  logic [ParticleBits-1:0] particle;
  logic [FaultBits-1:0]    first;
  if (Delay == 0) begin : gen_at_once
    assign ran      = 1'b1;
    assign observed = observed_i;
    assign shows    = observe_valid_i;
    assign busy     = !idle_i;
    assign had      = had_q;
    assign particle = observe_data_i;
    assign first    = first_q;
  end else begin : gen_later
    logic                    ran_q, shows_q, observed_q, had_before_q, busy_q;
    logic [ParticleBits-1:0] particle_q;
    logic [FaultBits-1:0]    first_before_q;
    always_ff @(posedge clk_i) begin
      ran_q          <= running_q;
      observed_q     <= observed_i;
      shows_q        <= observe_valid_i;
      busy_q         <= !idle_i;
      had_before_q   <= had_q;
      particle_q     <= observe_data_i;
      first_before_q <= first_q;
      if (!running_q) {ran_q, had_before_q} <= '0;
    end
    assign ran      = ran_q;
    assign observed = observed_q;
    assign shows    = shows_q;
    assign busy     = busy_q;
    assign had      = had_before_q;
    assign particle = particle_q;
    assign first    = first_before_q;
  end

  always_ff @(posedge clk_i) begin
    if (running_q && ran) begin
      a_flags: assert (flags == {busy, had, observed && had, observed && shows});
      if (observed && had) a_fault: assert (data[DataBits-1:ParticleBits] == first);
      if (observed && shows) a_particle: assert (data[ParticleBits-1:0] == particle);
      if (!observed) a_zeros: assert (data == '0);
      c_first: cover (second_q && observed && had && busy);
      c_away:  cover (!observed && had && !busy);
    end
    // From a reset on nothing is told of what was before it.
    if (running_q && !ran) a_reset: assert (flags[2:0] == 3'b000);
  end
endmodule
