// SPDX-License-Identifier: MIT
#include "synth/estimate.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <stdexcept>

#include "model/base/text.h"
#include "synth/json_file.h"

namespace cuboct::synth {
namespace {

using nlohmann::json;
using Bits = std::vector<int>;  // nets; -1: a constant

class Flattener {
 public:
  Flattener(const json& modules, const Delays& delays, std::vector<TimedCell>& cells)
      : modules_(modules), delays_(delays), cells_(cells) {}

  void add(const std::string& module, const std::string& path, const std::map<std::string, Bits>& ports) {
    const json& m = modules_.at(module);
    std::map<int64_t, int> nets;  // by yosys's number in this module
    for (const auto& [name, port] : m.at("ports").items()) {
      const auto outer = ports.find(name);
      if (outer == ports.end()) continue;
      size_t i = 0;
      for (const json& bit : port.at("bits")) {
        if (bit.is_number() && i < outer->second.size()) nets[bit] = outer->second[i];
        ++i;
      }
    }
    const auto net_of = [&](const json& bit) {
      if (!bit.is_number()) return -1;
      const auto [found, fresh] = nets.try_emplace(bit.get<int64_t>(), next_);
      if (fresh) ++next_;
      return found->second;
    };
    for (const auto& [name, cell] : m.at("cells").items()) {
      const std::string type = cell.at("type");
      const std::string full = path.empty() ? name : fmt::format("{}.{}", path, name);
      std::map<std::string, Bits> pins;
      for (const auto& [pin, bits] : cell.at("connections").items()) {
        Bits& to = pins[pin];
        for (const json& bit : bits) to.push_back(net_of(bit));
      }
      if (const auto inner = modules_.find(type); inner != modules_.end() && !is_black_box(*inner)) {
        add(type, full, pins);
      } else if (type != "$scopeinfo" && !matches(delays_.untimed, type)) {
        TimedCell timed{full, type, delays_of_cell(type, cell), {}};
        for (const auto& [pin, bits] : pins) {
          const bool input = cell.at("port_directions").at(pin) == "input";
          for (size_t i = 0; i < bits.size(); ++i)
            if (bits[i] >= 0)
              timed.pins.push_back({bits.size() == 1 ? pin : fmt::format("{}_{}", pin, i), bits[i], input});
        }
        cells_.push_back(std::move(timed));
      }
    }
  }

 private:
  static bool is_black_box(const json& module) {
    return module.contains("attributes") &&
           (module.at("attributes").contains("blackbox") || module.at("attributes").contains("whitebox"));
  }
  const CellDelays* delays_of_cell(const std::string& type, const json& cell) const {
    for (const CellDelays& c : delays_.cells)
      if (matches(c.cell, type) && (!c.parameter || cell.at("parameters").value(c.parameter, "") == c.value))
        return &c;
    throw std::runtime_error(fmt::format("the netlist has a cell whose delays are not known, {}", type));
  }

  const json& modules_;
  const Delays& delays_;
  std::vector<TimedCell>& cells_;
  int next_ = 0;
};

bool is_clock(const CellDelays& delays, const std::string& pin) {
  return std::any_of(delays.clock_to_q.begin(), delays.clock_to_q.end(),
                     [&](const auto& a) { return matches(a.from, pin); }) ||
         std::any_of(delays.setups.begin(), delays.setups.end(),
                     [&](const auto& s) { return matches(s.clock, pin); });
}

std::string timing(const std::string& related, const char* kind, const char* rise, const char* fall,
                   double ns) {
  return fmt::format(
      "      timing () {{ related_pin : \"{}\"; {}{} (scalar) {{ values (\"{:.4f}\"); }} {} (scalar) {{ "
      "values "
      "(\"{:.4f}\"); }} }}\n",
      related, kind, rise, ns, fall, ns);
}

std::string library_cell(const TimedCell& cell) {
  return cell.delays->parameter ? fmt::format("{}_{}", cell.type, cell.delays->value) : cell.type;
}

}  // namespace

double Path::wires() const {
  double sum = 0;
  for (const Hop& hop : hops) sum += hop.wire;
  return sum;
}

Timer::Timer(const std::string& netlist, const std::string& top, const Delays& delays) : delays_(delays) {
  read_netlist_json(
      netlist, [&](const json& file) { Flattener(file.at("modules"), delays, cells_).add(top, "", {}); });
  std::set<int> clocks;
  for (const TimedCell& cell : cells_)
    for (const TimedCell::Pin& pin : cell.pins)
      if (pin.input && is_clock(*cell.delays, pin.name)) clocks.insert(pin.net);
  clocks_.assign(clocks.begin(), clocks.end());
}

std::string Timer::library() const {
  std::map<std::string, std::map<std::string, bool>> types;  // the pins that occur; whether they are inputs
  std::map<std::string, const CellDelays*> delays;
  for (const TimedCell& cell : cells_) {
    const std::string name = library_cell(cell);
    delays[name] = cell.delays;
    for (const TimedCell::Pin& pin : cell.pins) types[name][pin.name] = pin.input;
  }
  std::string text =
      "library (cells) {\n"
      "  delay_model : table_lookup;\n  time_unit : \"1ns\";\n  voltage_unit : \"1V\";\n  current_unit : "
      "\"1mA\";\n"
      "  capacitive_load_unit (1, pf);\n  pulling_resistance_unit : \"1kohm\";\n  leakage_power_unit : "
      "\"1nW\";\n"
      "  input_threshold_pct_rise : 50;\n  input_threshold_pct_fall : 50;\n  output_threshold_pct_rise : "
      "50;\n"
      "  output_threshold_pct_fall : 50;\n  slew_lower_threshold_pct_rise : 20;\n"
      "  slew_lower_threshold_pct_fall : 20;\n  slew_upper_threshold_pct_rise : 80;\n"
      "  slew_upper_threshold_pct_fall : 80;\n  nom_process : 1;\n  nom_temperature : 25;\n  nom_voltage : "
      "1.1;\n";
  for (const auto& [type, pins] : types) {
    const CellDelays& d = *delays.at(type);
    text += fmt::format("  cell ({}) {{\n", type);
    for (const auto& [pin, input] : pins) {
      text += fmt::format("    pin ({}) {{ direction : {}; capacitance : 0;{}\n", pin,
                          input ? "input" : "output", input && is_clock(d, pin) ? " clock : true;" : "");
      for (const auto& [from, ignored] : pins) {
        if (input) {
          for (const auto& s : d.setups)
            if (matches(s.pin, pin) && matches(s.clock, from))
              text +=
                  timing(from, "timing_type : setup_rising; ", "rise_constraint", "fall_constraint", s.ns);
          continue;
        }
        for (const auto& a : d.arcs)
          if (matches(a.to, pin) && matches(a.from, from))
            text += timing(from, "timing_sense : non_unate; ", "cell_rise", "cell_fall", a.ns);
        for (const auto& a : d.clock_to_q)
          if (matches(a.to, pin) && matches(a.from, from))
            text += timing(from, "timing_type : rising_edge; ", "cell_rise", "cell_fall", a.ns);
      }
      text += "    }\n";
    }
    text += "  }\n";
  }
  return text + "}\n";
}

std::string Timer::netlist() const {
  const std::set<int> clocks(clocks_.begin(), clocks_.end());
  std::set<int> nets;
  for (const TimedCell& cell : cells_)
    for (const TimedCell::Pin& pin : cell.pins)
      if (!clocks.contains(pin.net)) nets.insert(pin.net);
  std::string ports;
  for (const int c : clocks_) ports += fmt::format("{}n{}", ports.empty() ? "" : ", ", c);
  std::string text = fmt::format("module timed ({0});\n  input {0};\n", ports);
  for (const int n : nets) text += fmt::format("  wire n{};\n", n);
  for (size_t c = 0; c < cells_.size(); ++c) {
    std::string pins;
    for (const TimedCell::Pin& pin : cells_[c].pins)
      if (pin.input || !clocks.contains(pin.net))  // a clock comes from outside
        pins += fmt::format("{}.{} (n{})", pins.empty() ? "" : ", ", pin.name, pin.net);
    text += fmt::format("  {} u{} ({});\n", library_cell(cells_[c]), c, pins);
  }
  return text + "endmodule\n";
}

std::string Timer::wires() const {
  struct End {
    size_t cell = 0;
    const TimedCell::Pin* pin = nullptr;
  };
  struct Net {
    End from;
    std::vector<End> to;
  };
  const std::set<int> clocks(clocks_.begin(), clocks_.end());
  std::map<int, Net> nets;
  for (size_t c = 0; c < cells_.size(); ++c)
    for (const TimedCell::Pin& pin : cells_[c].pins) {
      if (clocks.contains(pin.net)) continue;
      if (pin.input)
        nets[pin.net].to.push_back({c, &pin});
      else
        nets[pin.net].from = {c, &pin};
    }
  std::string text =
      "(DELAYFILE (SDFVERSION \"3.0\") (DIVIDER /) (TIMESCALE 1ns)\n (CELL (CELLTYPE \"timed\") (INSTANCE)\n "
      " (DELAY "
      "(ABSOLUTE\n";
  for (const auto& [number, net] : nets) {
    if (!net.from.pin) continue;
    bool taken = false;
    const TimedCell& from = cells_[net.from.cell];
    for (const End& end : net.to) {
      const TimedCell& to = cells_[end.cell];
      const double ns = wire_delay(delays_.wires, from.type, net.from.pin->name, to.type, end.pin->name,
                                   net.to.size(), taken);
      text += fmt::format("   (INTERCONNECT u{}/{} u{}/{} ({:.4f}))\n", net.from.cell, net.from.pin->name,
                          end.cell, end.pin->name, ns);
    }
  }
  return text + "  ))\n )\n)\n";
}

std::string Timer::script(const std::string& out, const std::vector<std::string>& clocks, size_t ends) {
  std::string text = fmt::format(
      "read_liberty {0}/cells.lib\nread_verilog {0}/timed.v\nlink_design timed\nset_cmd_units -time "
      "ns\n",
      tcl_word(out));
  // 1 us: longer than any path.
  for (const std::string& c : clocks)
    text += fmt::format("create_clock -name {0} -period 1000 [get_ports {0}]\n", c);
  if (clocks.size() > 1) {
    text += "set_clock_groups -asynchronous";
    for (const std::string& c : clocks) text += fmt::format(" -group {}", c);
    text += "\n";
  }
  return text +
         fmt::format(
             "read_sdf {0}/wires.sdf\n"
             "report_checks -path_delay max -fields input_pin -format full -digits 3 -group_count {1}\n",
             tcl_word(out), ends);
}

std::vector<std::string> Timer::clocks() const {
  std::vector<std::string> names;
  for (const int c : clocks_) names.push_back(fmt::format("n{}", c));
  return names;
}

std::vector<Path> Timer::read(const std::string& log) const {
  static const std::regex pin_form(R"(^\s*(-?[0-9.]+)\s+-?[0-9.]+ [\^v] u([0-9]+)/(\S+) \()"),
      setup_form(R"(^\s*(-?[0-9.]+)\s+-?[0-9.]+\s+library setup time)");
  std::vector<Path> paths;
  std::istringstream lines(log);
  std::smatch m;
  size_t last = cells_.size();
  bool open = false;  // between a path's beginning and its setup
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("Startpoint:")) {
      paths.emplace_back();
      last = cells_.size();
      open = true;
    } else if (open && std::regex_search(line, m, setup_form)) {
      paths.back().hops.back().delay = -std::stod(m[1]);
      open = false;
    } else if (open && std::regex_search(line, m, pin_form)) {
      const double ns = std::stod(m[1]);
      const size_t cell = std::stoul(m[2]);
      if (cell != last) {  // its input; a register's clock first of all
        paths.back().hops.push_back({cells_.at(cell).name, cells_.at(cell).type, ns, 0});
        last = cell;
      } else {
        paths.back().hops.back().delay = ns;
      }
    }
  }
  for (Path& path : paths)
    for (const Hop& hop : path.hops) path.total += hop.wire + hop.delay;
  std::stable_sort(paths.begin(), paths.end(),
                   [](const Path& a, const Path& b) { return a.total > b.total; });
  return paths;
}

std::string block_of(const std::string& cell) {
  // Passes that did not name a cell after a net leave the instance's path behind the first backslash.
  std::string name = cell;
  if (const size_t odd = name.find("$flatten"); odd != std::string::npos) name.erase(odd, 8);
  std::erase(name, '\\');
  const std::string unit = "u_unit.";
  if (name.starts_with(unit))
    name.erase(0, unit.size());
  else if (name != "u_unit")
    return "harness";
  // Up to the last instance: generate blocks and nets have no "u_".
  size_t end = 0;
  for (size_t from = 0, dot; (dot = name.find('.', from)) != std::string::npos; from = dot + 1)
    if (name.compare(from, 2, "u_") == 0) end = dot;
  return end == 0 ? "." : name.substr(0, end);
}

std::optional<Estimate> summary(const std::vector<Path>& paths, const Delays& delays) {
  if (paths.empty()) return std::nullopt;
  Estimate e;
  const Path& longest = paths.front();
  e.ns = longest.total;
  e.wires = longest.wires();
  e.error = delays.error;
  std::vector<std::pair<std::string, double>> blocks;
  for (const Hop& hop : longest.hops) {
    if (hop.wire > 0) e.path.push_back(fmt::format("{:.2f} ns wire", hop.wire));
    e.path.push_back(fmt::format("{:.2f} ns {} {}", hop.delay, hop.type, hop.cell));
    const std::string block = block_of(hop.cell);
    if (blocks.empty() || blocks.back().first != block) blocks.emplace_back(block, 0);
    blocks.back().second += hop.wire + hop.delay;
  }
  for (const auto& [block, ns] : blocks) e.blocks.push_back(fmt::format("{:5.2f} ns {}", ns, block));
  std::set<std::string> seen;
  for (const Path& path : paths) {
    const std::string to = block_of(path.hops.back().cell);
    if (seen.insert(to).second) e.ends.push_back({block_of(path.hops.front().cell), to, path.total});
  }
  return e;
}

}  // namespace cuboct::synth
