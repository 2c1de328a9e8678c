// SPDX-License-Identifier: MIT
#include "hw/rtl/rtl_ports.h"

#include <fmt/format.h>

#include <algorithm>

#include "model/trace/trace.h"

namespace cuboct {
namespace {

constexpr bool kIn = false, kOut = true;

bool is_number(const std::string& bits) { return bits.find_first_not_of("0123456789") == std::string::npos; }

// Of a sized literal.
std::string width_text(const std::string& literal) { return literal.substr(0, literal.find('\'')); }

}  // namespace

std::vector<RtlPort> node_ports(const RtlDesign& design, bool core) {
  const bool checked = design.checked && !core, bricks = design.bricks();
  const std::string faces = std::to_string(2 * design.axes), particle = "cuboct_pkg::ParticleBits",
                    cell = "cuboct_pkg::CellBits",
                    link = faces + "*cuboct_pkg::" + (checked ? "WireBits" : "LinkBits"),
                    ack = faces + "*cuboct_pkg::AckBits";
  std::vector<RtlPort> ports;
  const auto add = [&](bool there, bool output, const char* name, const std::string& bits,
                       const char* meaning) {
    if (there) ports.push_back({output, name, bits, meaning});
  };
  add(true, kIn, "clk_i", "1", "clock");
  add(true, kIn, "rst_ni", "1", "reset, active low, synchronous");
  add(true, kIn, "start_i", "1", "in IDLE: run steps_i steps; not with load_valid_i");
  add(true, kIn, "steps_i", "32", "with start_i");
  add(true, kIn, "has_link_i", faces, "constant: the face has a neighbour; -x, +x, -y, +y, -z, +z");
  if (bricks) {
    add(true, kIn, "extent_i", width_text(design.extents[0]), "constant: cells along x, y, z");
    add(true, kIn, "exit_i", width_text(design.exits[0]),
        "constant: by cell and face, the lattice has a cell there");
  }
  add(true, kIn, "load_valid_i", "1", "in IDLE: append a particle");
  add(bricks, kIn, "load_cell_i", cell, "with load_valid_i: to this cell of the node");
  add(true, kIn, "load_data_i", particle, "with load_valid_i: the particle");
  add(!design.moved.empty(), kIn, "velocity_i", std::to_string(velocities_bits(design)),
      "velocities by moved type and axis; changes in IDLE alone");
  add(true, kOut, "link_valid_o", faces, "a beat goes out over the face");
  add(true, kOut, "link_end_o", faces, "it ends a stream");
  add(true, kOut, "link_data_o", link, "its payload");
  add(true, kIn, "link_ready_i", faces, "the neighbour takes it");
  add(checked, kIn, "link_ack_i", ack, "about the beats that go out over the face");
  add(true, kIn, "link_valid_i", faces, "a beat comes in over the face");
  add(true, kIn, "link_end_i", faces, "it ends a stream");
  add(true, kIn, "link_data_i", link, "its payload");
  add(true, kOut, "link_ready_o", faces, "it is taken");
  add(checked, kOut, "link_ack_o", ack, "about the beats that come in over the face");
  add(checked, kOut, "link_error_o", std::to_string(4 * design.axes), "a beat, an acknowledgement was wrong");
  const std::string phases = std::to_string(phases_of(design.rounds));
  add(true, kOut, "phase_start_o", phases,
      "first cycle of a phase: exchange x y z, force, update, migrate x y z");
  add(true, kOut, "phase_end_o", phases, "last cycle of a phase");
  add(true, kOut, "force_event_o", std::to_string(1 + 3 * design.streamers + design.pipes),
      "the force engine runs; each streamer is stalled, presents a candidate, issues pairs; each pipe takes "
      "a pair");
  add(true, kOut, "observe_valid_o", "1", "a particle, at the start of each step and after the last");
  add(bricks, kOut, "observe_cell_o", cell, "with observe_valid_o: its cell in the node");
  add(true, kOut, "observe_data_o", particle, "with observe_valid_o: the particle");
  add(true, kOut, "fault_valid_o", "1", "at the end of a step that had a fault");
  add(true, kOut, "fault_code_o", "4", "with fault_valid_o: which");
  add(design.text, kOut, "fault_stage_o", "4",
      "with fault_valid_o: twice the round, one more of its finish; those of migrations are last");
  add(true, kOut, "fault_id_o", "cuboct_pkg::IdBits", "with fault_valid_o: of which particle");
  add(bricks, kOut, "fault_cell_o", cell, "with fault_valid_o: in which cell of the node");
  add(true, kOut, "fault_number_o", "64", "with fault_valid_o: the value that does not fit, signed");
  add(true, kOut, "idle_o", "1", "in IDLE");
  return ports;
}

std::vector<RtlPort> lattice_ports(const RtlDesign& design) {
  std::vector<RtlPort> ports, probes;
  const std::vector<RtlPort> of_node = node_ports(design, true);
  const auto add = [&](bool output, const char* name, const std::string& bits, const char* meaning) {
    ports.push_back({output, name, bits, meaning});
  };
  for (const RtlPort& port : of_node) {
    if (port.output || port.name == "has_link_i" || port.name == "extent_i" || port.name == "exit_i" ||
        port.name.starts_with("link_"))
      continue;
    ports.push_back(port);
    if (port.name == "steps_i") ports.back().meaning = "with start_i; 0: show the particles alone";
    if (port.name == "load_valid_i") ports.back().meaning = "in IDLE: append a particle to node_i";
    if (port.name == "load_data_i") {
      add(kIn, "select_i", "1", "from now on node_i is the node observed; with start_i or not");
      add(kIn, "node_i", "32", "with load_valid_i or select_i: a node; none has a number from Nodes on");
    }
  }
  add(kOut, "idle_o", "1", "nothing runs; falls in the cycle after start_i, or select_i");
  add(kOut, "busy_o", "1", "some node is not in IDLE; as many cycles as the run took");
  add(kOut, "settled_o", "1", "the other outputs know of the last start_i and select_i");
  add(kOut, "faulty_o", "1", "some node had a fault since the reset");
  for (const RtlPort& port : of_node) {
    if (!port.output) continue;
    const bool observe = port.name.starts_with("observe_"), fault = port.name.starts_with("fault_");
    if (observe || fault) ports.push_back(port);
    if (port.name == "observe_valid_o") ports.back().meaning = "the node observed shows a particle";
    if (port.name == "fault_valid_o") ports.back().meaning = "the node observed had a fault since the reset";
    if (fault && port.name != "fault_valid_o")
      ports.back().meaning += port.name == "fault_code_o" ? "; of the first" : "";
    if (observe || fault || port.name.starts_with("phase_") || port.name == "idle_o")
      probes.push_back({kOut, "probe_" + port.name,
                        port.bits == "1" ? "ProbeNodes" : "ProbeNodes*" + port.bits,
                        fmt::format("if Probe = 1, by node: {}", port.meaning)});
  }
  ports.insert(ports.end(), probes.begin(), probes.end());
  return ports;
}

std::string range_of(const RtlPort& port) {
  if (port.bits == "1") return "";
  return is_number(port.bits) ? fmt::format("[{}:0] ", std::stoi(port.bits) - 1) : "[" + port.bits + "-1:0] ";
}

std::string print_ports(const std::vector<RtlPort>& ports) {
  size_t width = 0;
  for (const RtlPort& p : ports) width = std::max(width, range_of(p).size());
  std::string text;
  for (const RtlPort& p : ports)
    text += fmt::format("  {} logic {:<{}}{}{}\n", p.output ? "output" : "input ", range_of(p), width, p.name,
                        &p == &ports.back() ? "" : ",");
  return text;
}

}  // namespace cuboct
