// SPDX-License-Identifier: MIT
#include "synth/fit_measure.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "model/base/error.h"
#include "model/base/output.h"
#include "model/base/process.h"
#include "synth/json_file.h"
#include "synth/netlist.h"
#include "synth/project.h"
#include "synth/script.h"
#include "synth/timing.h"

namespace cuboct::synth {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMeasured = "measured.json";
constexpr Resource kKept[] = {Resource::lut, Resource::ff, Resource::dsp, Resource::bram, Resource::cell};

// What is synthesised of a project.
Synthesis whole(const std::string& directory, bool board, Nodes nodes, const std::string& out) {
  Synthesis s;
  const Project project = read_project(directory);
  const std::vector<std::string> files = board ? read_board(project).files : project.files;
  for (const std::string& f : files) s.files.push_back(fmt::format("{}/{}", directory, f));
  s.top = s.module = s.unit = board ? read_board(project).top : "cuboct_lattice";
  if (nodes == Nodes::apart) s.kept = "cuboct_node";
  s.harness = false;
  s.counts_only = true;
  s.out = out;
  return s;
}

// Nodes below a module that is flat but for them: each is a cell of its own.
uint64_t nodes_in(const std::string& netlist, const std::string& module) {
  return read_netlist_json(netlist, [&](const nlohmann::json& json) {
    uint64_t count = 0;
    for (const auto& [name, cell] : json.at("modules").at(module).at("cells").items())
      count += cell.at("type") == "cuboct_node";
    return count;
  });
}

nlohmann::ordered_json to_json(const Counts& counts) {
  nlohmann::ordered_json json;
  for (const Resource r : kKept) json[to_string(r)] = counts[r];
  return json;
}

Counts kept_counts(const nlohmann::json& json) {
  Counts counts;
  for (const Resource r : kKept) counts[r] = json.at(to_string(r));
  return counts;
}

}  // namespace

Meter::Meter(const Target& target, Hears hears)
    : target_(target), hears_(std::move(hears)), kept_(kept_in_cache("fit")) {
  need("yosys");
  tools_.push_back(first_line("yosys", "-V"));
  if (target.family == Family::ice40) {
    need("nextpnr-ice40");
    tools_.push_back(first_line("nextpnr-ice40", "--version"));
  }
}

InputKey Meter::key_of(const std::string& directory, bool board, Nodes nodes) const {
  Synthesis s = whole(directory, board, nodes, "");
  InputKey key;
  for (std::string& file : s.files) {
    key.add_code(read_text(file));
    file = fs::path(file).filename().string();
  }
  key.add(fpga_script(s, target_));
  for (const std::string& tool : tools_) key.add(tool);
  if (target_.family == Family::ice40) key.add(target_.name);
  return key;
}

Measured Meter::run(const std::string& directory, bool board, Nodes nodes) const {
  const std::string out = directory + "/measure";
  make_directory(out);
  const Runner runner(out, hears_);
  const Synthesis s = whole(directory, board, nodes, out);
  runner.write("synth.ys", fpga_script(s, target_));
  runner.run("yosys", "yosys", "yosys", {out + "/synth.ys"});
  const std::string netlist = out + "/netlist.json";
  const CostOf costs = costs_of(target_.family);
  Measured m;
  const Counts all = count_all(netlist, s.unit, costs);
  const bool flat = nodes == Nodes::flat;
  m.nodes = flat ? 1 : nodes_in(netlist, s.unit);
  m.node = flat ? all : count_all(netlist, s.kept, costs);
  for (const Resource r : kKept) m.around[r] = all[r] - m.nodes * m.node[r];
  if (target_.family == Family::ice40) {
    runner.run("nextpnr-ice40", "pack", "nextpnr-ice40",
               {"--" + target_.name, "--package", target_.package, "--json", netlist, "--top", s.unit,
                "--pack-only"});
    const auto use = read_utilisation(read_text(out + "/pack.log"));
    const auto packed = use.find("ICESTORM_LC");
    if (packed == use.end())
      throw ToolFailed("nextpnr-ice40", "pack.log", "it does not say how many cells it packed");
    // Around the nodes none may share; what this leaves for the nodes is theirs.
    const uint64_t cells = packed->second.used, most = m.around[Resource::lut] + m.around[Resource::ff];
    m.node[Resource::cell] = (cells - std::min(cells, most) + m.nodes - 1) / m.nodes;
    m.around[Resource::cell] = cells - std::min(cells, m.nodes * m.node[Resource::cell]);
  }
  return m;
}

Measured Meter::measure(const std::function<void(const std::string& directory)>& emit, bool board,
                        Nodes nodes) const {
  const Scratch scratch;
  const std::string directory = scratch.path("project");
  emit(directory);
  const std::string key = key_of(directory, board, nodes).text(), file = scratch.path(kMeasured);
  if (kept_.take(key, scratch.path("."))) {
    try {
      const nlohmann::json json = read_json(file);
      return {kept_counts(json.at("node")), kept_counts(json.at("around")), json.at("nodes"), true};
    } catch (const std::exception&) {
      // It is measured anew.
    }
  }
  const Measured m = run(directory, board, nodes);
  const nlohmann::ordered_json json = {
      {"nodes", m.nodes}, {"node", to_json(m.node)}, {"around", to_json(m.around)}, {"tools", tools_}};
  write_text(file, json.dump(2) + "\n");
  kept_.keep(key, scratch.path("."), {kMeasured});
  return m;
}

}  // namespace cuboct::synth
