// SPDX-License-Identifier: MIT
// A lattice with its host's end, whatever carries the bytes: what all boards and bus wrappers hold.
module cuboct_machine #(
  parameter int ClockHz = 12000000  // told by INFO
) (
  input  logic       clk_i,
  input  logic       rst_ni,
  input  logic       rx_valid_i,  // a byte from the host
  input  logic [7:0] rx_data_i,   // with rx_valid_i
  output logic       rx_ready_o,  // a byte is taken in a cycle with rx_valid_i and rx_ready_o
  output logic       tx_valid_o,  // a byte to the host; stays until tx_ready_i
  output logic [7:0] tx_data_o,   // with tx_valid_o; stays likewise
  input  logic       tx_ready_i,  // a byte is taken in a cycle with tx_valid_o and tx_ready_i
  output logic       busy_o,      // a run is under way
  output logic       fault_o      // some node met a fault since the host's last RESET
);
  localparam int ParticleBits = cuboct_pkg::ParticleBits;
  localparam int IdBits       = cuboct_pkg::IdBits;
  localparam int VelocityBits = cuboct_machine_pkg::VelocityBits;
  // On the line a particle's word, and a fault's id, have the cell of a brick above them; and above that the
  // fault of a rule of text has its stage.
  localparam int CellBits     = cuboct_machine_pkg::CellBits;
  localparam int StageBits    = cuboct_machine_pkg::StageBits;
  localparam int WordBits     = ParticleBits + CellBits;
  localparam int TellBits     = IdBits + CellBits + StageBits;

  logic                    lattice_rst_n, start, load_valid, select, idle, busy, settled, faulty;
  logic                    observe_valid, fault_valid;
  logic [31:0]             steps, node;
  logic [WordBits-1:0]     load_word, observe_word;
  logic [ParticleBits-1:0] observe_data;
  logic [3:0]              fault_code;
  logic [IdBits-1:0]       fault_id;
  logic [TellBits-1:0]     fault_tell;
  logic [63:0]             fault_number;
  logic                    velocity_reset, velocity_valid;
  logic [7:0]              velocity_type, velocity_axis;
  logic [VelocityBits-1:0] velocity_data;
  cuboct_host_link #(
    .Nodes(cuboct_machine_pkg::Nodes), .Axes(cuboct_pkg::Axes), .Capacity(cuboct_machine_pkg::Slots),
    .ParticleBits(WordBits), .IdBits(TellBits), .VelocityBits(VelocityBits),
    .MovedTypes(cuboct_machine_pkg::MovedTypes), .PlanHash(cuboct_machine_pkg::PlanHash),
    .MachineHash(cuboct_machine_pkg::MachineHash), .ClockHz(ClockHz)
  ) u_link (
    .clk_i, .rst_ni, .rx_valid_i, .rx_data_i, .rx_ready_o, .tx_valid_o, .tx_data_o, .tx_ready_i,
    .lattice_rst_no(lattice_rst_n), .start_o(start), .steps_o(steps), .load_valid_o(load_valid),
    .load_data_o(load_word), .select_o(select), .node_o(node), .idle_i(idle), .busy_i(busy),
    .settled_i(settled), .faulty_i(faulty), .fault_valid_i(fault_valid), .fault_code_i(fault_code),
    .fault_id_i(fault_tell), .fault_number_i(fault_number), .observe_valid_i(observe_valid),
    .observe_data_i(observe_word), .velocity_reset_o(velocity_reset),
    .velocity_valid_o(velocity_valid), .velocity_type_o(velocity_type), .velocity_axis_o(velocity_axis),
    .velocity_data_o(velocity_data), .busy_o, .fault_o
  );
  // Ports that not every lattice has. They bear the ports' names: .* connects those that are there.
  localparam int MovedTypes   = cuboct_machine_pkg::MovedTypes;
  localparam int HostBits     = (MovedTypes > 0) ? MovedTypes * cuboct_pkg::Axes * VelocityBits : 1;
  localparam int CellPortBits = (CellBits > 0) ? CellBits : 1;
  logic [HostBits-1:0]     velocity_i;
  logic [CellPortBits-1:0] load_cell_i, observe_cell_o, fault_cell_o;
  logic [3:0]              fault_stage_o;
  // probe_* show nothing, as Probe is 0.
  logic [cuboct_machine_pkg::PhaseBits-1:0] probe_phase_start_o, probe_phase_end_o;
  logic                    probe_observe_valid_o, probe_fault_valid_o, probe_idle_o;
  logic [ParticleBits-1:0] probe_observe_data_o;
  logic [3:0]              probe_fault_code_o, probe_fault_stage_o;
  logic [IdBits-1:0]       probe_fault_id_o;
  logic [CellPortBits-1:0] probe_observe_cell_o, probe_fault_cell_o;
  logic [63:0]             probe_fault_number_o;
  logic                    unused_probes;
  assign unused_probes = ^{probe_phase_start_o, probe_phase_end_o, probe_observe_valid_o, probe_fault_valid_o,
                           probe_idle_o, probe_observe_data_o, probe_fault_code_o, probe_fault_stage_o,
                           probe_fault_id_o, probe_observe_cell_o, probe_fault_cell_o, probe_fault_number_o};
  if (MovedTypes > 0) begin : gen_velocities
    cuboct_velocities #(
      .Types(MovedTypes), .Axes(cuboct_pkg::Axes), .Bits(VelocityBits),
      .Initial(cuboct_machine_pkg::Velocities)
    ) u_velocities (
      .clk_i, .reset_i(velocity_reset), .valid_i(velocity_valid), .type_i(velocity_type),
      .axis_i(velocity_axis), .data_i(velocity_data), .velocity_o(velocity_i)
    );
  end else begin : gen_no_velocities
    logic unused_velocities;
    assign velocity_i        = '0;
    assign unused_velocities = ^{velocity_reset, velocity_valid, velocity_type, velocity_axis, velocity_data,
                                 velocity_i};
  end
  if (CellBits > 0) begin : gen_bricks
    assign load_cell_i = load_word[ParticleBits +: CellPortBits];
    assign observe_word = {observe_cell_o, observe_data};
    assign fault_tell[IdBits +: CellPortBits] = fault_cell_o;
  end else begin : gen_no_bricks
    logic unused_cells;
    assign unused_cells   = ^{load_cell_i, observe_cell_o, fault_cell_o};
    assign load_cell_i    = '0;
    assign observe_cell_o = '0;
    assign fault_cell_o   = '0;
    assign probe_observe_cell_o = '0;
    assign probe_fault_cell_o   = '0;
    assign observe_word   = observe_data;
  end
  assign fault_tell[IdBits-1:0] = fault_id;
  if (StageBits > 0) begin : gen_stages
    assign fault_tell[TellBits-1 -: StageBits] = fault_stage_o;
  end else begin : gen_no_stages
    logic unused_stages;
    assign fault_stage_o       = '0;
    assign probe_fault_stage_o = '0;
    assign unused_stages       = ^fault_stage_o;
  end
  cuboct_lattice u_lattice (
    .*, .clk_i, .rst_ni(lattice_rst_n), .start_i(start), .steps_i(steps), .load_valid_i(load_valid),
    .load_data_i(load_word[ParticleBits-1:0]), .select_i(select), .node_i(node), .idle_o(idle), .busy_o(busy),
    .settled_o(settled), .faulty_o(faulty), .observe_valid_o(observe_valid), .observe_data_o(observe_data),
    .fault_valid_o(fault_valid), .fault_code_o(fault_code), .fault_id_o(fault_id),
    .fault_number_o(fault_number)
  );
endmodule
