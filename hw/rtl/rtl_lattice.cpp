// SPDX-License-Identifier: MIT
// cuboct_lattice: its wiring is a loop over nodes, and tables as flat vectors that say what sets them apart.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <map>

#include "hw/rtl/rtl_ports.h"

namespace cuboct {
namespace {

// A concatenation of a literal for each node, the last node first; `literal` must have one width.
template <typename Literal>
std::string table(const RtlDesign& design, const std::string& name, int bits, Literal literal) {
  const size_t nodes = design.cells.size();
  const size_t per_line = std::clamp<size_t>(84 / (literal(size_t{0}).size() + 2), 1, 8);
  std::vector<std::string> lines;
  for (size_t end = nodes; end > 0;) {
    const size_t low = (end - 1) / per_line * per_line;
    std::vector<std::string> row;
    for (size_t n = end; n > low; --n) row.push_back(literal(n - 1));
    const Cell& cell = design.cells[low];
    lines.push_back(fmt::format("    {}{}  // node {}: {} ({}, {}, {})\n", fmt::join(row, ", "),
                                low > 0 ? "," : "", low, design.bricks() ? "cells from" : "cell", cell[0],
                                cell[1], cell[2]));
    end = low;
  }
  return fmt::format("  localparam logic [{}*Nodes-1:0] {} = {{\n{}  }};\n", bits, name,
                     fmt::join(lines, ""));
}

// The neighbours over all faces as one hexadecimal literal, -x in the lowest place; `none` where there is
// none.
std::string neighbours(const RtlDesign& design, size_t node, int bits, uint32_t none) {
  const int faces = 2 * design.axes;
  std::string text;
  int digit = 0, at = 0;
  const auto add = [&](uint32_t bit) {
    digit |= static_cast<int>(bit) << at;
    if (++at < 4) return;
    text.insert(text.begin(), "0123456789abcdef"[digit]);
    digit = at = 0;
  };
  for (int f = 0; f < faces; ++f) {
    const uint32_t to = design.neighbour[node][f];
    for (int b = 0; b < bits; ++b) add((to == kNoNode ? none : to) >> b & 1);
  }
  while (at != 0) add(0);
  return fmt::format("{}'h{}", faces * bits, text);
}

int width_of(const std::string& literal) { return std::stoi(literal.substr(0, literal.find('\''))); }

// What a node's port is connected to in the loop; an empty one: to the signal of its own name.
std::map<std::string, std::string> connections(const RtlDesign& design) {
  const std::string particle = "cuboct_pkg::ParticleBits", cell = "cuboct_pkg::CellBits";
  std::map<std::string, std::string> all{{"clk_i", "clk_i"},
                                         {"rst_ni", "rst_ni"},
                                         {"start_i", "node_start[n/8]"},
                                         {"has_link_i", "has_link"},
                                         {"load_valid_i", "node_load[n]"},
                                         {"steps_i", "steps"},
                                         {"load_cell_i", "load_cell"},
                                         {"load_data_i", "load_data"},
                                         {"velocity_i", "velocity"}};
  if (design.bricks()) {
    const int extent = width_of(design.extents[0]), exit = width_of(design.exits[0]);
    all["extent_i"] = fmt::format("Extents[{0}*n +: {0}]", extent);
    all["exit_i"] = fmt::format("Exits[{0}*n +: {0}]", exit);
  }
  for (const char* port : {"valid", "end", "data", "ready", "ack"})
    for (const char* way : {"_i", "_o"})
      all[fmt::format("link_{}{}", port, way)] = fmt::format(
          "{}{}", port == std::string("end") ? "last" : port, way == std::string("_i") ? "_in" : "");
  all["link_error_o"] = "error";
  return all;
}

// A fault as one word, of signals whose names end in `end`.
std::string fault_word(const RtlDesign& design, const char* end) {
  return fmt::format("{{fault_number{0}, {1}fault_id{0}, {2}fault_code{0}}}", end,
                     design.bricks() ? fmt::format("fault_cell{}, ", end) : "",
                     design.text ? fmt::format("fault_stage{}, ", end) : "");
}

// The signals of one node and what its neighbours drive.
std::string print_links(const RtlDesign& design) {
  const int faces = 2 * design.axes;
  struct Wire {
    const char* name;
    const char* part;  // of a face; nullptr: a bit
  };
  std::vector<Wire> wires{{"valid", nullptr}, {"last", nullptr}, {"ready", nullptr}, {"data", "LinkBits"}};
  if (design.checked) wires.push_back({"ack", "AckBits"});
  std::string declared = fmt::format("    logic [{}:0] has_link;\n", faces - 1), linked, alone, unused;
  for (const Wire& w : wires) {
    const std::string part = w.part == nullptr ? "[{}]" : fmt::format("[{{}}*{0} +: {0}]", w.part);
    const auto of = [&](const char* face) { return fmt::format(fmt::runtime(part), face); };
    declared += w.part == nullptr
                    ? fmt::format("    logic [{}:0] {}, {}_in;\n", faces - 1, w.name, w.name)
                    : fmt::format("    logic [{0}*{1}-1:0] {2}, {2}_in;\n", faces, w.part, w.name);
    linked +=
        fmt::format("        assign {}_in{} = gen_node[To].{}{};\n", w.name, of("f"), w.name, of("Back"));
    alone += fmt::format("        assign {}_in{} = '0;\n", w.name, of("f"));
    unused += fmt::format("{}{}{}", unused.empty() ? "" : ", ", w.name, of("f"));
  }
  if (design.checked)  // for whoever counts them; faults reach the host without
    declared +=
        fmt::format("    logic [{}:0] error;\n    logic unused_error;\n    assign unused_error = ^error;\n",
                    2 * faces - 1);
  return fmt::format(
      "{0}    for (genvar f = 0; f < {1}; f++) begin : gen_face\n"
      "      localparam int To   = {{{{(32-NodeBits){{1'b0}}}}, Neighbours[({1}*n+f)*NodeBits +: "
      "NodeBits]}};\n"
      "      localparam int Back = (f % 2 == 0) ? f + 1 : f - 1;  // the face of the neighbour that looks "
      "here\n"
      "      if (To < Nodes) begin : gen_link\n"
      "        assign has_link[f] = 1'b1;\n{2}"
      "      end else begin : gen_end\n"
      "        logic unused_end;\n"
      "        assign unused_end = ^{{{3}}};\n"
      "        assign has_link[f] = 1'b0;\n{4}"
      "      end\n"
      "    end\n",
      declared, faces, linked, unused, alone);
}

// Signals of a node's outputs to the host, the node, and what watches it.
std::string print_node_in_loop(const RtlDesign& design) {
  std::string text;
  const std::map<std::string, std::string> connected = connections(design);
  std::vector<std::string> lines;
  for (const RtlPort& p : node_ports(design, false)) {
    const auto at = connected.find(p.name);
    const std::string own = p.name.substr(0, p.name.size() - 2);
    lines.push_back(fmt::format("      .{}({})", p.name, at == connected.end() ? own : at->second));
    if (at == connected.end()) text += fmt::format("    logic {}{};\n", range_of(p), own);
  }
  text += "    logic unused_event;\n    assign unused_event = ^force_event;\n";
  std::vector<std::string> fields{"steps", "load_data"};
  std::string declared = "    logic [31:0] steps;\n    logic [cuboct_pkg::ParticleBits-1:0] load_data;\n";
  if (design.bricks()) {
    declared += "    logic [cuboct_pkg::CellBits-1:0] load_cell;\n";
    fields.insert(fields.begin() + 1, "load_cell");
  }
  if (!design.moved.empty()) {
    declared += fmt::format("    logic [{}:0] velocity;\n", velocities_bits(design) - 1);
    fields.insert(fields.begin(), "velocity");
  }
  text += declared + fmt::format("    assign {{{}}} = node_command[n/8*CommandBits +: CommandBits];\n",
                                 fmt::join(fields, ", "));
  text += fmt::format("    cuboct_node u_node (\n{}\n    );\n", fmt::join(lines, ",\n"));
  const char* particle = design.bricks() ? "{observe_cell, observe_data}" : "observe_data";
  text += fmt::format(
      "    cuboct_watch #(.ParticleBits(WordBits), .FaultBits(FaultBits), .Delay((Nodes > 1) ? 1 : 0)) "
      "u_watch (\n"
      "      .clk_i, .rst_ni, .observed_i(node_observed[n]), .idle_i(idle), "
      ".observe_valid_i(observe_valid),\n"
      "      .observe_data_i({}), .fault_valid_i(fault_valid), .fault_i({}),\n"
      "      .flags_o(node_flags[4*n +: 4]), .data_o(node_data[n*(FaultBits+WordBits) +: "
      "FaultBits+WordBits])\n"
      "    );\n",
      particle, fault_word(design, ""));
  std::string probes, unused;
  for (const RtlPort& p : lattice_ports(design)) {
    if (!p.name.starts_with("probe_")) continue;
    const std::string own = p.name.substr(6, p.name.size() - 8);
    const size_t times = p.bits.find('*');
    probes += times == std::string::npos
                  ? fmt::format("      assign {}[n] = {};\n", p.name, own)
                  : fmt::format("      assign {}[n*{} +: {}] = {};\n", p.name, p.bits.substr(times + 1),
                                p.bits.substr(times + 1), own);
    if (own.starts_with("phase_")) unused += (unused.empty() ? "" : ", ") + own;
  }
  return text + fmt::format(
                    "    if (Probe != 0) begin : gen_probe\n{}"
                    "    end else begin : gen_no_probe\n"
                    "      logic unused_phases;\n      assign unused_phases = ^{{{}}};\n"
                    "    end\n",
                    probes, unused);
}

}  // namespace

std::string print_lattice(const RtlDesign& design) {
  const size_t nodes = design.cells.size();
  const int faces = 2 * design.axes;
  const int node_bits = std::bit_width(nodes);  // that hold Nodes too, which stands for no neighbour
  const bool bricks = design.bricks(), moved = !design.moved.empty();
  std::string text = head(design);
  text += fmt::format(
      "// All nodes, their links, and the host's way to them (cuboct_tree). The host's side is one node "
      "wide; README.md\n"
      "// of the project tells when what happens.\n"
      "module cuboct_lattice #(\n"
      "  parameter  int Probe      = 0,  // 1: probe_* show all nodes, node 0 lowest, for benches; 0: they "
      "are zeros\n"
      "  localparam int Nodes      = {},\n"
      "  localparam int ProbeNodes = (Probe != 0) ? Nodes : 1\n"
      ") (\n"
      "{});\n"
      "  localparam int LinkBits    = cuboct_pkg::{};\n{}"
      "  localparam int NodeBits    = {};\n"
      "  localparam int WordBits    = cuboct_pkg::ParticleBits{};\n"
      "  localparam int FaultBits   = {} + cuboct_pkg::IdBits{} + 64;\n"
      "  localparam int CommandBits = {}32 + WordBits;\n"
      "  localparam int Groups      = (Nodes + 7) / 8;\n",
      nodes, print_ports(lattice_ports(design)), design.checked ? "WireBits" : "LinkBits",
      design.checked ? "  localparam int AckBits     = cuboct_pkg::AckBits;\n" : "", node_bits,
      bricks ? " + cuboct_pkg::CellBits" : "", design.text ? 8 : 4, bricks ? " + cuboct_pkg::CellBits" : "",
      moved ? fmt::format("{} + ", velocities_bits(design)) : "");
  text += fmt::format(
      "  // By node and face (-x, +x, -y, +y{}), -x of node 0 in the lowest place: the neighbour; Nodes "
      "where there is "
      "none.\n",
      faces == 6 ? ", -z, +z" : "");
  text += table(design, "Neighbours", faces * node_bits,
                [&](size_t n) { return neighbours(design, n, node_bits, static_cast<uint32_t>(nodes)); });
  if (bricks) {
    text +=
        "  // By node: cells along x, y, z; and, by cell and face, whether the lattice has a cell there.\n";
    text +=
        table(design, "Extents", width_of(design.extents[0]), [&](size_t n) { return design.extents[n]; });
    text += table(design, "Exits", width_of(design.exits[0]), [&](size_t n) { return design.exits[n]; });
  }
  text += fmt::format(
      "\n  logic [Groups-1:0] node_start;\n"
      "  logic [Nodes-1:0] node_load, node_observed;\n"
      "  logic [Groups*CommandBits-1:0] node_command;\n"
      "  logic [Nodes*4-1:0] node_flags;\n"
      "  logic [Nodes*(FaultBits+WordBits)-1:0] node_data;\n"
      "  cuboct_tree #(\n"
      "    .Nodes(Nodes), .CommandBits(CommandBits), .ParticleBits(WordBits), .FaultBits(FaultBits)\n"
      "  ) u_tree (\n"
      "    .clk_i, .rst_ni, .start_i, .load_valid_i, .select_i, .node_i,\n"
      "    .command_i({{{}steps_i, {}load_data_i}}),\n"
      "    .settled_o, .busy_o, .idle_o, .faulty_o, .fault_valid_o,\n"
      "    .fault_o({}), .observe_valid_o,\n"
      "    .observe_data_o({}),\n"
      "    .node_start_o(node_start), .node_load_o(node_load), .node_observed_o(node_observed),\n"
      "    .node_command_o(node_command), .node_flags_i(node_flags), .node_data_i(node_data)\n"
      "  );\n",
      moved ? "velocity_i, " : "", bricks ? "load_cell_i, " : "", fault_word(design, "_o"),
      bricks ? "{observe_cell_o, observe_data_o}" : "observe_data_o");
  text += "\n  for (genvar n = 0; n < Nodes; n++) begin : gen_node\n" + print_links(design) +
          print_node_in_loop(design) + "  end\n";
  text += "  if (Probe == 0) begin : gen_no_probes\n";
  for (const RtlPort& p : lattice_ports(design))
    if (p.name.starts_with("probe_")) text += fmt::format("    assign {} = '0;\n", p.name);
  return text + "  end\nendmodule\n";
}

}  // namespace cuboct
