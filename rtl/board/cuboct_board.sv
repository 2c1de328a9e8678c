// SPDX-License-Identifier: MIT
// A lattice with its host's end: what the tops of all boards hold.
module cuboct_board (
  input  logic clk_i,
  input  logic rst_ni,   // synchronous
  input  logic rx_i,     // not synchronous
  output logic tx_o,
  output logic busy_o,   // a run is under way
  output logic fault_o   // some node met a fault since the host's last RESET
);
  localparam int Nodes        = cuboct_board_pkg::Nodes;
  localparam int ParticleBits = cuboct_pkg::ParticleBits;
  localparam int IdBits       = cuboct_pkg::IdBits;
  localparam int VelocityBits = cuboct_pkg::VelocityBits;
  // On the line a particle's word, and a fault's id, have the cell of a brick above them.
  localparam int CellBits     = cuboct_board_pkg::CellBits;
  localparam int WordBits     = ParticleBits + CellBits;
  localparam int TellBits     = IdBits + CellBits;

  logic                          lattice_rst_n, start, load_valid;
  logic [31:0]                   steps, load_node;
  logic [WordBits-1:0]           load_word;
  logic [8*Nodes-1:0]            phase_start, phase_end;
  logic [Nodes-1:0]              observe_valid, fault_valid, idle;
  logic [Nodes*ParticleBits-1:0] observe_data;
  logic [4*Nodes-1:0]            fault_code;
  logic [Nodes*IdBits-1:0]       fault_id;
  logic [Nodes*WordBits-1:0]     observe_word;
  logic [Nodes*TellBits-1:0]     fault_tell;
  logic [64*Nodes-1:0]           fault_number;
  logic                          velocity_reset, velocity_valid;
  logic [7:0]                    velocity_type, velocity_axis;
  logic [VelocityBits-1:0]       velocity_data;
  cuboct_host_link #(
    .Nodes(Nodes), .Axes(cuboct_pkg::Axes), .Capacity(cuboct_board_pkg::Slots), .ParticleBits(WordBits),
    .IdBits(TellBits), .VelocityBits(VelocityBits), .MovedTypes(cuboct_board_pkg::MovedTypes),
    .PlanHash(cuboct_board_pkg::PlanHash), .MachineHash(cuboct_board_pkg::MachineHash),
    .ClockHz(cuboct_board_pkg::ClockHz), .BitClocks16(cuboct_board_pkg::BitClocks16)
  ) u_link (
    .clk_i, .rst_ni, .rx_i, .tx_o, .lattice_rst_no(lattice_rst_n), .start_o(start), .steps_o(steps),
    .load_valid_o(load_valid), .load_node_o(load_node), .load_data_o(load_word),
    .observe_valid_i(observe_valid), .observe_data_i(observe_word), .fault_valid_i(fault_valid),
    .fault_code_i(fault_code), .fault_id_i(fault_tell), .fault_number_i(fault_number), .idle_i(idle),
    .velocity_reset_o(velocity_reset),
    .velocity_valid_o(velocity_valid), .velocity_type_o(velocity_type), .velocity_axis_o(velocity_axis),
    .velocity_data_o(velocity_data), .busy_o, .fault_o
  );
  // Ports that not every lattice has. They bear the ports' names: .* connects those that are there.
  localparam int MovedTypes   = cuboct_board_pkg::MovedTypes;
  localparam int HostBits     = (MovedTypes > 0) ? MovedTypes * cuboct_pkg::Axes * VelocityBits : 1;
  localparam int CellPortBits = (CellBits > 0) ? CellBits : 1;
  logic [HostBits-1:0]           velocity_i;
  logic [CellPortBits-1:0]       load_cell_i;
  logic [Nodes*CellPortBits-1:0] observe_cell_o, fault_cell_o;
  if (MovedTypes > 0) begin : gen_velocities
    cuboct_velocities #(
      .Types(MovedTypes), .Axes(cuboct_pkg::Axes), .Bits(VelocityBits),
      .Initial(cuboct_board_pkg::Velocities)
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
    for (genvar n = 0; n < Nodes; n++) begin : gen_cell
      assign observe_word[n*WordBits +: WordBits]
        = {observe_cell_o[n*CellPortBits +: CellPortBits], observe_data[n*ParticleBits +: ParticleBits]};
      assign fault_tell[n*TellBits +: TellBits]
        = {fault_cell_o[n*CellPortBits +: CellPortBits], fault_id[n*IdBits +: IdBits]};
    end
  end else begin : gen_no_bricks
    logic unused_cells;
    assign unused_cells   = ^{load_cell_i, observe_cell_o, fault_cell_o};
    assign load_cell_i    = '0;
    assign observe_cell_o = '0;
    assign fault_cell_o   = '0;
    assign observe_word   = observe_data;
    assign fault_tell     = fault_id;
  end
  cuboct_lattice u_lattice (
    .*, .clk_i, .rst_ni(lattice_rst_n), .start_i(start), .steps_i(steps), .load_valid_i(load_valid),
    .load_node_i(load_node), .load_data_i(load_word[ParticleBits-1:0]), .phase_start_o(phase_start),
    .phase_end_o(phase_end),
    .observe_valid_o(observe_valid), .observe_data_o(observe_data), .fault_valid_o(fault_valid),
    .fault_code_o(fault_code), .fault_id_o(fault_id), .fault_number_o(fault_number), .idle_o(idle)
  );
  logic unused_phases;
  assign unused_phases = ^{phase_start, phase_end};
endmodule
