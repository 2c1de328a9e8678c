// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>

#include "hw/rtl_design.h"
#include "hw/rtl_template.h"

namespace cuboct {
namespace {

std::string head(const RtlDesign& design) {
  return "// SPDX-License-Identifier: MIT\n// " + design.maker + "\n";
}

// A value in two's complement, as a sized hexadecimal literal.
std::string literal(int64_t value, int bits) {
  const uint64_t mask = bits == 64 ? ~uint64_t{0} : (uint64_t{1} << bits) - 1;
  return fmt::format("{}'h{:x}", bits, static_cast<uint64_t>(value) & mask);
}

std::string concatenated(const Int3& values, int bits, int axes) {
  std::string text;
  for (int a = axes - 1; a >= 0; --a) text += (text.empty() ? "" : ", ") + literal(values[a], bits);
  return "{" + text + "}";
}

struct Port {
  const char* direction;
  std::string range;  // with a trailing blank, or empty
  const char* name;
};

// Of a sized literal.
int width_of(const std::string& literal) { return std::stoi(literal); }

// The ports of cuboct_node, or of its cuboct_node_core, in order.
std::vector<Port> node_ports(const RtlDesign& design, bool core) {
  const bool checked = design.checked && !core;
  const int faces = 2 * design.axes;
  const auto by_face = [&](const char* bits) { return fmt::format("[{}*cuboct_pkg::{}-1:0]", faces, bits); };
  const std::string link = by_face(checked ? "WireBits" : "LinkBits"),
                    particle = "[cuboct_pkg::ParticleBits-1:0]", face = fmt::format("[{}:0]", faces - 1);
  std::vector<Port> ports{{"input ", "", "clk_i"},
                          {"input ", "", "rst_ni"},
                          {"input ", "", "start_i"},
                          {"input ", "[31:0]", "steps_i"},
                          {"input ", face, "has_link_i"},
                          {"input ", "", "load_valid_i"},
                          {"input ", particle, "load_data_i"},
                          {"output", face, "link_valid_o"},
                          {"output", face, "link_end_o"},
                          {"output", link, "link_data_o"},
                          {"input ", face, "link_ready_i"}};
  if (checked) ports.push_back({"input ", by_face("AckBits"), "link_ack_i"});
  ports.insert(ports.end(), {{"input ", face, "link_valid_i"},
                             {"input ", face, "link_end_i"},
                             {"input ", link, "link_data_i"},
                             {"output", face, "link_ready_o"}});
  if (checked) {
    ports.push_back({"output", by_face("AckBits"), "link_ack_o"});
    ports.push_back({"output", fmt::format("[{}:0]", 2 * faces - 1), "link_error_o"});
  }
  ports.insert(ports.end(), {{"output", "[7:0]", "phase_start_o"},
                             {"output", "[7:0]", "phase_end_o"},
                             {"output", "[3:0]", "force_event_o"},
                             {"output", "", "observe_valid_o"},
                             {"output", particle, "observe_data_o"},
                             {"output", "", "fault_valid_o"},
                             {"output", "[3:0]", "fault_code_o"},
                             {"output", "[cuboct_pkg::IdBits-1:0]", "fault_id_o"},
                             {"output", "[63:0]", "fault_number_o"},
                             {"output", "", "idle_o"}});
  const auto add_after = [&](const char* name, std::vector<Port> more) {
    const auto at =
        std::find_if(ports.begin(), ports.end(), [&](const Port& p) { return p.name == std::string(name); });
    ports.insert(at + 1, more.begin(), more.end());
  };
  if (design.bricks()) {
    const std::string cell = "[cuboct_pkg::CellBits-1:0]";
    add_after("has_link_i", {{"input ", fmt::format("[{}:0]", width_of(design.extents[0]) - 1), "extent_i"},
                             {"input ", fmt::format("[{}:0]", width_of(design.exits[0]) - 1), "exit_i"}});
    add_after("load_valid_i", {{"input ", cell, "load_cell_i"}});
    add_after("observe_valid_o", {{"output", cell, "observe_cell_o"}});
    add_after("fault_id_o", {{"output", cell, "fault_cell_o"}});
  }
  if (!design.moved.empty()) add_after("load_data_i", {{"input ", velocity_range(design), "velocity_i"}});
  return ports;
}

std::string print_ports(const std::vector<Port>& ports) {
  size_t width = 0;
  for (const Port& p : ports) width = std::max(width, p.range.size());
  std::string text;
  for (size_t k = 0; k < ports.size(); ++k)
    text += fmt::format("  {} logic {:<{}} {}{}\n", ports[k].direction, ports[k].range, width, ports[k].name,
                        k + 1 < ports.size() ? "," : "");
  return text;
}

}  // namespace

std::string print_package(const RtlDesign& design) {
  std::string text =
      head(design) +
      "// The constants of the plan; docs/reference/node.md says what each is.\npackage cuboct_pkg;\n";
  for (const RtlConstant& c : design.constants) {
    const std::string value = c.wide ? literal(c.value, 64) : std::to_string(c.value);
    const std::string declared =
        fmt::format("  localparam {} {:<20} = {};", c.wide ? "logic [63:0]" : "int         ", c.name, value);
    text += c.comment.empty() ? declared + "\n" : fmt::format("{:<62}  // {}\n", declared, c.comment);
  }
  return text + "endpackage\n";
}

std::string print_table(const RtlDesign& design, const RtlTable& table) {
  const int degree = table.c2.empty() ? 1 : 2;
  const int e = table.entry_bits;
  const int bits = (degree + 1) * e;
  std::string text = head(design);
  text += fmt::format(
      "// {} entries of {{{}c1, c0}}, {} bits each. Synchronous read.\n"
      "module {} (\n"
      "  input  logic                clk_i,\n"
      "  input  logic [{}:0] index_i,\n"
      "  output logic signed [{}:0] c0_o,\n"
      "  output logic signed [{}:0] c1_o,\n"
      "  output logic signed [{}:0] c2_o\n"
      ");\n"
      "  (* rom_style = \"block\", ram_style = \"block\" *) logic [{}:0] mem [0:{}];\n"
      "  logic [{}:0] data_q;\n"
      "  always_ff @(posedge clk_i) data_q <= mem[index_i];\n"
      "  assign c0_o = data_q[{}:0];\n"
      "  assign c1_o = data_q[{}:{}];\n",
      table.c0.size(), degree == 2 ? "c2, " : "", e, table.module, table.index_bits - 1, e - 1, e - 1, e - 1,
      bits - 1, table.c0.size() - 1, bits - 1, e - 1, 2 * e - 1, e);
  text += degree == 2 ? fmt::format("  assign c2_o = data_q[{}:{}];\n", 3 * e - 1, 2 * e)
                      : "  assign c2_o = '0;\n";
  text += "  initial begin\n";
  for (size_t k = 0; k < table.c0.size(); ++k)
    text += fmt::format("    mem[{}] = {{{}{}, {}}};\n", k, degree == 2 ? literal(table.c2[k], e) + ", " : "",
                        literal(table.c1[k], e), literal(table.c0[k], e));
  return text + "  end\nendmodule\n";
}

std::string print_scale(const RtlDesign& design) {
  const int t = std::max(1, design.type_bits);  // one type may still have a scale below 1
  std::string text = head(design);
  text += fmt::format(
      "// What a pair of types multiplies its strength by, ScaleFrac fractional bits. Combinational.\n"
      "module cuboct_scale_rom (\n"
      "  input  logic [{0}:0]         own_type_i,\n"
      "  input  logic [{0}:0]         other_type_i,\n"
      "  output logic signed [17:0] scale_o\n"
      ");\n"
      "  always_comb begin\n"
      "    scale_o = '0;\n"
      "    unique case ({{own_type_i, other_type_i}})\n",
      t - 1);
  for (size_t i = 0; i < design.scale.size(); ++i)
    for (size_t j = 0; j < design.scale.size(); ++j)
      text += fmt::format("      {}: scale_o = {};\n", literal(static_cast<int64_t>(i << t | j), 2 * t),
                          literal(design.scale[i][j], 18));
  return text + "      default: scale_o = '0;\n    endcase\n  end\nendmodule\n";
}

std::string velocity_range(const RtlDesign& design) {
  const size_t bits = design.moved.size() * static_cast<size_t>(design.axes * design.velocity_bits);
  return fmt::format("[{}:0]", std::max<size_t>(bits, 1) - 1);
}

std::string print_velocities(const RtlDesign& design) {
  if (design.moved.empty()) return "1'b0";
  std::string text;
  for (const int k : design.moved) {
    const FixedType& type = design.types[static_cast<size_t>(k)];
    text = concatenated(type.velocity, design.velocity_bits, design.axes) + (text.empty() ? "" : ", ") + text;
  }
  return "{" + text + "}";
}

std::string print_types(const RtlDesign& design) {
  const int t = std::max(1, design.type_bits), v = design.velocity_bits, axes = design.axes;
  std::string text = head(design);
  text += fmt::format(
      "// What sets the types apart, axis 0 in the least significant place: imposed axes, velocity (imposed, "
      "or of the\n"
      "// anchor), gravity, whether held by force, gains. Combinational.\n"
      "module cuboct_type_rom (\n"
      "  input  logic {} velocity_i,  // by type that is moved from outside\n"
      "  input  logic [{}:0] type_i,\n"
      "  output logic [{}:0] imposed_o,\n"
      "  output logic [{}:0] velocity_o,\n"
      "  output logic [{}:0] gravity_o,\n"
      "  output logic pd_o,\n"
      "  output logic [17:0] kp_o,\n"
      "  output logic [17:0] kd_o\n"
      ");\n",
      velocity_range(design), t - 1, axes - 1, axes * v - 1, axes * v - 1);
  if (design.moved.empty()) text += "  logic unused_velocity;\n  assign unused_velocity = velocity_i;\n";
  const auto velocity = [&](const FixedType& type, int number) {
    const auto at = std::find(design.moved.begin(), design.moved.end(), number);
    if (at == design.moved.end()) return concatenated(type.velocity, v, axes);
    return fmt::format("velocity_i[{} +: {}]", (at - design.moved.begin()) * axes * v, axes * v);
  };
  const auto assigns = [&](const FixedType& type, int number, const std::string& indent) {
    std::string lines;
    std::string imposed;
    for (int a = axes - 1; a >= 0; --a) imposed += type.imposed[a] ? '1' : '0';
    lines += fmt::format("{}imposed_o  = {}'b{};\n", indent, axes, imposed);
    lines += fmt::format("{}velocity_o = {};\n", indent, velocity(type, number));
    lines += fmt::format("{}gravity_o  = {};\n", indent, concatenated(type.gravity, v, axes));
    lines += fmt::format("{}pd_o       = 1'b{};\n", indent, type.pd ? 1 : 0);
    lines += fmt::format("{}kp_o       = {};\n", indent, literal(type.kp, 18));
    lines += fmt::format("{}kd_o       = {};\n", indent, literal(type.kd, 18));
    return lines;
  };
  if (design.types.size() == 1)
    return text + "  logic unused_type;\n  assign unused_type = ^type_i;\n" +
           assigns(design.types[0], 0, "  assign ") + "endmodule\n";
  text += "  always_comb begin\n" + assigns(FixedType{}, -1, "    ") + "    unique case (type_i)\n";
  for (size_t k = 0; k < design.types.size(); ++k)
    text += fmt::format("      {}: begin\n{}      end\n", literal(static_cast<int64_t>(k), t),
                        assigns(design.types[k], static_cast<int>(k), "        "));
  return text + "      default: imposed_o = '0;\n    endcase\n  end\nendmodule\n";
}

std::string print_node(const RtlDesign& design) {
  const char* core_name = design.bricks() ? "cuboct_brick_core" : "cuboct_node_core";
  std::string text = head(design);
  text += fmt::format(
      "// One node of the plan: {} with the plan's constants{}.\nmodule cuboct_node (\n{});\n", core_name,
      design.checked ? ", and the checks of its links" : "", print_ports(node_ports(design, false)));
  const std::vector<Port> ports = node_ports(design, true);
  // What stands between the core's links and the node's: the core's port `x_o` is the wire `core_x`, `x_i`
  // the wire `wire_x`.
  const auto guarded = [&](const std::string& name) {
    return design.checked && ((name.starts_with("link_")) || name.starts_with("fault_"));
  };
  const auto inner = [](const std::string& name) {
    return (name.ends_with("_o") ? "core_" : "wire_") + name.substr(0, name.size() - 2);
  };
  std::vector<std::string> core, connected;
  for (const Port& p : ports) {
    if (guarded(p.name))
      text += fmt::format("  logic {}{}{};\n", p.range, p.range.empty() ? "" : " ", inner(p.name));
    connected.push_back(guarded(p.name) ? fmt::format("    .{}({})", p.name, inner(p.name))
                                        : fmt::format("    .{}", p.name));
  }
  for (const RtlConstant& c : design.constants)
    if (c.core) core.push_back(fmt::format("    .{0}(cuboct_pkg::{0})", c.name));
  core.push_back(fmt::format("    .MovedTypes({})", design.moved.size()));
  if (design.moved.empty()) connected.emplace_back("    .velocity_i(1'b0)");
  text += fmt::format("  {} #(\n{}\n  ) u_core (\n{}\n  );\n", core_name, fmt::join(core, ",\n"),
                      fmt::join(connected, ",\n"));
  if (design.checked)
    text += fmt::format(
        "  logic unused_core_ready;\n  assign unused_core_ready = ^core_link_ready;\n"
        "  cuboct_link_guard #(\n"
        "    .Faces({}),\n    .LinkBits(cuboct_pkg::LinkBits),\n"
        "    .SequenceBits(cuboct_pkg::LinkSequence),\n    .Window(cuboct_pkg::LinkWindow),\n"
        "    .Patience(cuboct_pkg::LinkPatience),\n    .Retry(cuboct_pkg::LinkRetry),\n"
        "    .CrcBits(cuboct_pkg::LinkCrc),\n    .CrcPolynomial(cuboct_pkg::LinkPolynomial[31:0]),\n"
        "    .CrcStart(cuboct_pkg::LinkStart[31:0]),\n    .AckCrcBits(cuboct_pkg::AckCrc),\n"
        "    .AckPolynomial(cuboct_pkg::AckPolynomial[31:0]),\n    .AckStart(cuboct_pkg::AckStart[31:0]),\n"
        "    .IdBits(cuboct_pkg::IdBits)\n"
        "  ) u_guard (\n"
        "    .clk_i,\n    .rst_ni,\n    .has_link_i,\n"
        "    .node_valid_i(core_link_valid),\n    .node_end_i(core_link_end),\n"
        "    .node_data_i(core_link_data),\n    .node_ready_o(wire_link_ready),\n"
        "    .node_valid_o(wire_link_valid),\n    .node_end_o(wire_link_end),\n"
        "    .node_data_o(wire_link_data),\n    .node_fault_valid_i(core_fault_valid),\n"
        "    .node_fault_code_i(core_fault_code),\n    .node_fault_id_i(core_fault_id),\n"
        "    .node_fault_number_i(core_fault_number),\n"
        "    .link_valid_o,\n    .link_end_o,\n    .link_data_o,\n    .link_ready_i,\n    .link_ack_i,\n"
        "    .link_valid_i,\n    .link_end_i,\n    .link_data_i,\n    .link_ready_o,\n    .link_ack_o,\n"
        "    .link_error_o,\n"
        "    .fault_valid_o,\n    .fault_code_o,\n    .fault_id_o,\n    .fault_number_o\n"
        "  );\n",
        2 * design.axes);
  if (design.checked && design.bricks())
    text +=
        "  // A link's fault is told by the first cell.\n"
        "  assign fault_cell_o = core_fault_valid ? core_fault_cell : '0;\n";
  return text + "endmodule\n";
}

std::string print_lattice(const RtlDesign& design) {
  const size_t nodes = design.cells.size();
  const int faces = 2 * design.axes;
  std::string text = head(design);
  const auto of_bricks = [&](const char* port) { return std::string(design.bricks() ? port : ""); };
  text += fill(
      "// All nodes and their links. Node n's part of a vector over nodes has n times the part's width below "
      "it.\n"
      "// load_valid_i appends load_data_i to node load_node_i; start_i starts all nodes.\n"
      "module cuboct_lattice #(\n"
      "  localparam int Nodes = @NODES@\n"
      ") (\n"
      "  input  logic clk_i,\n"
      "  input  logic rst_ni,\n"
      "  input  logic start_i,\n"
      "  input  logic [31:0] steps_i,\n"
      "  input  logic load_valid_i,\n"
      "  input  logic [31:0] load_node_i,\n"
      "@LOAD_CELL_PORT@"
      "  input  logic [cuboct_pkg::ParticleBits-1:0] load_data_i,\n"
      "@VELOCITY_PORT@"
      "  output logic [8*Nodes-1:0] phase_start_o,\n"
      "  output logic [8*Nodes-1:0] phase_end_o,\n"
      "  output logic [Nodes-1:0] observe_valid_o,\n"
      "@OBSERVE_CELL_PORT@"
      "  output logic [Nodes*cuboct_pkg::ParticleBits-1:0] observe_data_o,\n"
      "  output logic [Nodes-1:0] fault_valid_o,\n"
      "  output logic [4*Nodes-1:0] fault_code_o,\n"
      "  output logic [Nodes*cuboct_pkg::IdBits-1:0] fault_id_o,\n"
      "@FAULT_CELL_PORT@"
      "  output logic [64*Nodes-1:0] fault_number_o,\n",
      {{"NODES", std::to_string(nodes)},
       {"VELOCITY_PORT",
        design.moved.empty() ? "" : "  input  logic " + velocity_range(design) + " velocity_i,\n"},
       {"LOAD_CELL_PORT", of_bricks("  input  logic [cuboct_pkg::CellBits-1:0] load_cell_i,\n")},
       {"OBSERVE_CELL_PORT", of_bricks("  output logic [Nodes*cuboct_pkg::CellBits-1:0] observe_cell_o,\n")},
       {"FAULT_CELL_PORT", of_bricks("  output logic [Nodes*cuboct_pkg::CellBits-1:0] fault_cell_o,\n")}});
  text += fmt::format(
      "  output logic [Nodes-1:0] idle_o\n"
      ");\n"
      "  localparam int LinkBits = cuboct_pkg::{};\n{}\n",
      design.checked ? "WireBits" : "LinkBits",
      design.checked ? "  localparam int AckBits = cuboct_pkg::AckBits;\n" : "");
  for (size_t n = 0; n < nodes; ++n)
    text +=
        fmt::format("  logic [{1}:0] valid_{0}, end_{0}, ready_{0};\n  logic [{2}*LinkBits-1:0] data_{0};\n",
                    n, faces - 1, faces);
  if (design.checked)
    for (size_t n = 0; n < nodes; ++n) {
      text += fmt::format("  logic [{}*AckBits-1:0] ack_{};\n", faces, n);
      text += fmt::format("  logic [{}:0] error_{};\n", 2 * faces - 1, n);
    }
  std::string unused_ends;
  // The nodes' link errors are there for whoever counts them; the faults reach the host without.
  if (design.checked)
    for (size_t n = 0; n < nodes; ++n)
      unused_ends += fmt::format("{}^error_{}", unused_ends.empty() ? "    " : ",\n    ", n);
  std::string events;
  for (size_t n = 0; n < nodes; ++n) events += fmt::format("{}event_{}", n == 0 ? "" : ", ", n);
  text += fmt::format("  logic [3:0] {};\n  logic unused_events;\n  assign unused_events = ^{{{}}};\n",
                      events, events);
  for (size_t n = 0; n < nodes; ++n) {
    const Cell& cell = design.cells[n];
    std::string has, valid, end, ready, data, ack;
    for (int f = faces - 1; f >= 0; --f) {
      const uint32_t to = design.neighbour[n][f];
      const int back = f ^ 1;  // the face of the neighbour that looks here
      const char* comma = f > 0 ? ", " : "";
      const bool linked = to != kNoNode;
      has += linked ? '1' : '0';
      valid += (linked ? fmt::format("valid_{}[{}]", to, back) : "1'b0") + comma;
      end += (linked ? fmt::format("end_{}[{}]", to, back) : "1'b0") + comma;
      ready += (linked ? fmt::format("ready_{}[{}]", to, back) : "1'b0") + comma;
      data +=
          (linked ? fmt::format("data_{}[{}*LinkBits +: LinkBits]", to, back) : "{LinkBits{1'b0}}") + comma;
      ack += (linked ? fmt::format("ack_{}[{}*AckBits +: AckBits]", to, back) : "{AckBits{1'b0}}") + comma;
      if (!linked && design.checked)
        unused_ends +=
            fmt::format("{}^ack_{}[{}*AckBits +: AckBits]", unused_ends.empty() ? "    " : ",\n    ", n, f);
      if (!linked)
        unused_ends +=
            fmt::format("{}valid_{}[{}], end_{}[{}], ready_{}[{}], ^data_{}[{}*LinkBits +: LinkBits]",
                        unused_ends.empty() ? "    " : ",\n    ", n, f, n, f, n, f, n, f);
    }
    text += fmt::format(
        "\n  // {13} ({1}, {2}, {3}).\n"
        "  cuboct_node u_node_{0} (\n"
        "    .clk_i, .rst_ni, .start_i, .steps_i, .has_link_i({9}'b{4}),\n"
        "    .load_valid_i(load_valid_i && load_node_i == 32'd{0}), .load_data_i,{10}\n"
        "    .link_valid_o(valid_{0}), .link_end_o(end_{0}), .link_data_o(data_{0}),\n"
        "    .link_ready_i({{{7}}}),\n"
        "    .link_valid_i({{{5}}}),\n"
        "    .link_end_i({{{6}}}),\n"
        "    .link_data_i({{{8}}}),\n"
        "    .link_ready_o(ready_{0}),\n"
        "{11}"
        "    .phase_start_o(phase_start_o[8*{0} +: 8]), .phase_end_o(phase_end_o[8*{0} +: 8]),\n"
        "    .force_event_o(event_{0}), .observe_valid_o(observe_valid_o[{0}]),\n"
        "    .observe_data_o(observe_data_o[{0}*cuboct_pkg::ParticleBits +: cuboct_pkg::ParticleBits]),\n"
        "    .fault_valid_o(fault_valid_o[{0}]), .fault_code_o(fault_code_o[4*{0} +: 4]),\n"
        "    .fault_id_o(fault_id_o[{0}*cuboct_pkg::IdBits +: cuboct_pkg::IdBits]),\n"
        "    .fault_number_o(fault_number_o[64*{0} +: 64]), .idle_o(idle_o[{0}]){12}\n"
        "  );\n",
        n, cell[0], cell[1], cell[2], has, valid, end, ready, data, faces,
        design.moved.empty() ? "" : " .velocity_i,",
        design.checked ? fmt::format("    .link_ack_i({{{0}}}),\n"
                                     "    .link_ack_o(ack_{1}), .link_error_o(error_{1}),\n",
                                     ack, n)
                       : "",
        design.bricks()
            ? fmt::format(
                  ",\n    .extent_i({1}), .exit_i({2}), .load_cell_i,\n"
                  "    .observe_cell_o(observe_cell_o[{0}*cuboct_pkg::CellBits +: cuboct_pkg::CellBits]),\n"
                  "    .fault_cell_o(fault_cell_o[{0}*cuboct_pkg::CellBits +: cuboct_pkg::CellBits])",
                  n, design.extents[n], design.exits[n])
            : "",
        design.bricks() ? "Cells from" : "Cell");
  }
  if (!unused_ends.empty())
    text += "\n  logic unused_faces;\n  assign unused_faces = ^{\n" + unused_ends + "\n  };\n";
  return text + "endmodule\n";
}

}  // namespace cuboct
