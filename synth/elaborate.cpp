// SPDX-License-Identifier: MIT
#include "synth/elaborate.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <functional>
#include <set>
#include <string_view>

#include "model/base/error.h"
#include "model/base/spelling.h"
#include "synth/json_file.h"

namespace cuboct::synth {
namespace {

// The modules of each source, in the order in which a walk from the top meets them.
std::map<std::string, std::vector<std::string>> variants_of(const Design& design) {
  std::map<std::string, std::vector<std::string>> variants;
  std::set<std::string> seen;
  const std::function<void(const std::string&)> walk = [&](const std::string& key) {
    if (!seen.insert(key).second) return;
    const Module& module = design.modules.at(key);
    variants[module.base].push_back(key);
    for (const auto& [name, child] : module.instances) walk(child);
  };
  walk(design.top);
  return variants;
}

}  // namespace

std::string base_name(const std::string& yosys_name) {
  if (!yosys_name.starts_with("$paramod")) return yosys_name;
  const size_t from = yosys_name.find('\\') + 1;
  return yosys_name.substr(from, yosys_name.find('\\', from) - from);
}

// Names go into scripts of yosys, Tcl and a shell.
void check_name(const std::string& name, const std::string& base) {
  const auto plain = [](const std::string& text, std::string_view also) {
    return !text.empty() && std::ranges::all_of(text, [&](char c) {
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
             also.find(c) != also.npos;
    });
  };
  if (plain(base, "_") && plain(name, "_$\\='.:-+")) return;
  throw InputError(fmt::format("the project has a module called '{}'", name),
                   "cuboct synth takes modules of letters, digits and '_'");
}

namespace {

Design design_in(const nlohmann::json& json, const std::string& prefix) {
  Design design;
  for (const auto& [name, module] : json.at("modules").items()) {
    Module& m = design.modules[name];
    m.base = base_name(name);
    check_name(name, m.base);
    if (m.base.starts_with(prefix)) m.base.erase(0, prefix.size());
    if (module.at("attributes").contains("top")) design.top = name;
    for (const auto& [port, what] : module.at("ports").items())
      m.ports.push_back({port, what.at("direction") == "input", what.at("bits").size()});
    for (const auto& [cell, what] : module.at("cells").items()) {
      const std::string type = what.at("type");
      if (json.at("modules").contains(type)) {
        m.instances[cell] = type;
        continue;
      }
      if (!what.contains("port_directions")) continue;
      const auto& directions = what.at("port_directions");
      for (const auto& [port, bits] : what.at("connections").items())
        if (directions.at(port) == "output") m.bits += bits.size();
    }
  }
  return design;
}

// Who walks over a design trusts that no module lies within itself.
void check_ends(const Design& design, const std::string& file) {
  std::set<std::string> open, closed;
  const std::function<void(const std::string&)> walk = [&](const std::string& key) {
    if (closed.contains(key)) return;
    if (!open.insert(key).second || open.size() > kDeepest)
      throw std::runtime_error(fmt::format("{}: the module {} lies within itself", file, key));
    for (const auto& [name, child] : design.modules.at(key).instances) walk(child);
    open.erase(key);
    closed.insert(key);
  };
  for (const auto& [key, module] : design.modules) walk(key);
}

}  // namespace

Design read_design(const std::string& file, const std::string& prefix) {
  Design design =
      read_netlist_json(file, [&](const nlohmann::json& json) { return design_in(json, prefix); });
  if (design.top.empty()) throw std::runtime_error(file + ": no top module");
  check_ends(design, file);
  return design;
}

uint64_t bits_below(const Design& design, const std::string& module) {
  std::map<std::string, uint64_t> known;
  const std::function<uint64_t(const std::string&)> below = [&](const std::string& key) {
    if (const auto found = known.find(key); found != known.end()) return found->second;
    uint64_t bits = design.modules.at(key).bits;
    for (const auto& [name, child] : design.modules.at(key).instances) bits += below(child);
    return known[key] = bits;
  };
  return below(module);
}

std::string module_of(const Design& design, const std::string& unit) {
  const auto variants = variants_of(design);
  const std::string source = unit.substr(0, unit.find('#'));
  const auto found = variants.contains(source) ? variants.find(source) : variants.find("cuboct_" + source);
  if (found == variants.end()) {
    std::vector<std::string> names;
    for (const auto& [name, keys] : variants)
      names.push_back(name.starts_with("cuboct_") ? name.substr(7) : name);
    const std::string near = did_you_mean(source, names);
    throw InputError(fmt::format("the project has no block '{}'", source),
                     near.empty() ? "there are " + fmt::format("{}", fmt::join(names, ", ")) : near);
  }
  const std::vector<std::string>& keys = found->second;
  if (unit.find('#') == std::string::npos) {
    if (keys.size() == 1) return keys[0];
    throw InputError(
        fmt::format("the block '{}' stands in the project with {} sets of parameters", source, keys.size()),
        fmt::format("--unit {0}#1 ... {0}#{1} names one", source, keys.size()));
  }
  const std::string number = unit.substr(unit.find('#') + 1);
  size_t k = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), k);
  if (error != std::errc() || end != number.data() + number.size() || k < 1 || k > keys.size())
    throw InputError(fmt::format("--unit {}: '{}' has {} {} of parameters", unit, source, keys.size(),
                                 keys.size() == 1 ? "set" : "sets"));
  return keys[k - 1];
}

Harness make_harness(const std::string& unit, const std::vector<Port>& ports) {
  uint64_t inputs = 0, outputs = 0;
  std::string connections;
  const auto connect = [&](const Port& port, const std::string& to) {
    connections += fmt::format("{}    .\\{} ({})", connections.empty() ? "" : ",\n", port.name, to);
  };
  for (const Port& p : ports) {
    if (p.name == "clk_i") {
      connect(p, "clk_i");
      continue;
    }
    uint64_t& next = p.input ? inputs : outputs;
    connect(p, fmt::format("{}[{}:{}]", p.input ? "in_q" : "out", next + p.bits - 1, next));
    next += p.bits;
  }
  if (outputs == 0)
    throw InputError(fmt::format("the block '{}' has no output", unit), "there is nothing to keep of it");
  inputs = std::max<uint64_t>(inputs, 1);
  const uint64_t folded = (outputs + 2) / 3;
  Harness harness;
  harness.flip_flops = inputs + outputs + folded;
  harness.text = fmt::format(
      "// Inputs come out of a shift register; outputs go into registers, and three of these and the bit "
      "before them\n"
      "// into each bit of a second shift register. So nothing of the unit is idle, and every path in it "
      "ends in\n"
      "// registers.\n"
      "module {0} (\n"
      "  input  wire clk_i,\n"
      "  input  wire data_i,\n"
      "  output wire data_o\n"
      ");\n"
      "  reg  [{1}:0] in_q;\n"
      "  wire [{2}:0] out;\n"
      "  reg  [{3}:0] out_q;\n"
      "  reg  [{4}:0] folded_q;\n"
      "  integer k;\n"
      "  always @(posedge clk_i) begin\n"
      "    in_q        <= {{in_q, data_i}};\n"
      "    out_q       <= out;\n"
      "    folded_q[0] <= out_q[0] ^ out_q[1] ^ out_q[2];\n"
      "    for (k = 1; k < {5}; k = k + 1)\n"
      "      folded_q[k] <= folded_q[k-1] ^ out_q[3*k] ^ out_q[3*k+1] ^ out_q[3*k+2];\n"
      "  end\n"
      "  assign data_o = folded_q[{4}];\n"
      "{6}"
      "  {7} u_unit (\n{8}\n  );\n"
      "endmodule\n",
      kHarness, inputs - 1, 3 * folded - 1, 3 * folded - 1, folded - 1, folded,
      3 * folded > outputs ? fmt::format("  assign out[{}:{}] = 0;\n", 3 * folded - 1, outputs) : "", unit,
      connections);
  return harness;
}

}  // namespace cuboct::synth
