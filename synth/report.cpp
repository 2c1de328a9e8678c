// SPDX-License-Identifier: MIT
#include "synth/report.h"

#include <fmt/format.h>

#include <algorithm>

#include "model/base/error.h"
#include "synth/json_file.h"

namespace cuboct::synth {
namespace {

using Ordered = nlohmann::ordered_json;

// Blocks deeper than this are in the JSON only.
constexpr int kShownDepth = 3;

std::string row(const std::string& name, uint64_t instances, const Counts& counts, Family family) {
  std::string text = fmt::format("{:<34} {:>5}", name, instances);
  for (const Resource r : resources_of(family)) text += fmt::format(" {:>8}", counts[r]);
  return text + "\n";
}

void add_rows(const Block& block, int depth, Family family, std::string& text) {
  if (block.counts == Counts{}) return;
  const std::string name = block.module.starts_with("cuboct_") ? block.module.substr(7) : block.module;
  text += row(std::string(static_cast<size_t>(2 * depth), ' ') + name, block.instances, block.counts, family);
  if (depth >= kShownDepth) return;
  // A shell around one block says nothing of its own, nor does that block.
  const Block* inner = &block;
  while (inner->children.size() == 1 && inner->children[0].counts == inner->counts &&
         inner->children[0].instances == inner->instances)
    inner = &inner->children[0];
  for (const Block& child : inner->children) add_rows(child, depth + 1, family, text);
}

Ordered to_json(const Counts& counts, Family family) {
  Ordered json;
  for (const Resource r : resources_of(family)) json[to_string(r)] = counts[r];
  return json;
}

Ordered to_json(const Block& block, Family family) {
  Ordered json = {
      {"module", block.module}, {"instances", block.instances}, {"uses", to_json(block.counts, family)}};
  if (!block.children.empty()) {
    json["blocks"] = Ordered::array();
    for (const Block& child : block.children) json["blocks"].push_back(to_json(child, family));
  }
  return json;
}

Counts counts_of(const nlohmann::json& json) {
  Counts counts;
  for (const Resource r :
       {Resource::lut, Resource::ff, Resource::dsp, Resource::bram, Resource::gates, Resource::area})
    counts[r] = json.value(to_string(r), uint64_t{0});
  return counts;
}

Block block_of(const nlohmann::json& json) {
  Block block{json.at("module"), json.at("instances"), counts_of(json.at("uses")), {}};
  if (json.contains("blocks"))
    for (const auto& child : json.at("blocks")) block.children.push_back(block_of(child));
  return block;
}

// Whether a unit's clock is that of a machine; a block alone takes no steps.
bool whole(const std::string& unit) { return unit == "node" || unit == "lattice" || unit == "board"; }

std::optional<double> steps_per_second(const Report& report, double mhz) {
  const std::optional<double> cycles = report.cycles.best();
  if (!whole(report.unit) || !cycles) return {};
  return mhz * 1e6 / *cycles;
}

std::string cycles_text(const ProjectCycles& c) {
  if (!c.best()) return "not known: no run counted them";
  if (c.steps == 0) return fmt::format("{}, expected of the busiest node: no run counted them", *c.expected);
  return fmt::format("{:.1f}, the mean of the first {} steps, counted; the most {}", c.mean, c.steps, c.most);
}

Ordered to_json(const ProjectCycles& c) {
  Ordered json = Ordered::object();
  if (c.expected) json["expected"] = *c.expected;
  if (c.steps > 0) json["counted"] = {{"mean", c.mean}, {"most", c.most}, {"steps", c.steps}};
  return json;
}

ProjectCycles cycles_of(const nlohmann::json& json) {
  ProjectCycles c;
  if (json.contains("expected")) c.expected = json.at("expected").get<uint64_t>();
  if (json.contains("counted")) {
    const auto& counted = json.at("counted");
    c.mean = counted.at("mean");
    c.most = counted.at("most");
    c.steps = counted.at("steps");
  }
  return c;
}

}  // namespace

void Report::take(const Placed& placed, const std::string& from) {
  fmax = placed.fmax;
  fmax_from = from;
  critical = placed.critical;
  pack(placed.use);
}

void Report::pack(const std::map<std::string, Use>& use) {
  if (const auto packed = use.find("ICESTORM_LC"); packed != use.end())
    cells = packed->second.used - std::min(packed->second.used, harness);
}

std::optional<Fit> fit_of(const Report& report) {
  const Target& target = target_of(report.target);
  std::optional<Fit> fit;
  for (const Resource r : resources_of(target.family)) {
    if (report.block.counts[r] == 0 || report.holds == Counts{}) continue;
    const auto room = static_cast<uint64_t>(planned_share(target, r) * static_cast<double>(report.holds[r]));
    const uint64_t units = room / report.block.counts[r];
    if (!fit || units < fit->units) fit = {units, r};
  }
  // A LUT and a flip-flop share a logic cell only where the one feeds the other.
  if (fit && report.cells && *report.cells > 0)
    if (const uint64_t units = report.holds[Resource::lut] / *report.cells; units < fit->units)
      fit = {units, Resource::cell};
  return fit;
}

std::string elsewhere(const Report& report) {
  const Target* other = nearest_that_holds(report.used, target_of(report.target));
  std::string hint = other ? fmt::format("{} has room for what it takes here", other->name)
                           : "no target that is known has room for it";
  // What is no block alone has other bricks, lanes and pipes.
  if (whole(report.unit))
    hint += fmt::format("; cuboct emit SCENE --fit {} looks for a machine that fits", report.target);
  return hint;
}

std::string print_table(const Report& report) {
  const Target& target = target_of(report.target);
  std::string text =
      fmt::format("{} of plan {} on {} ({})\n\n", report.unit, report.plan, report.target, report.device);
  text += fmt::format("{:<34} {:>5}", "block", "x");
  for (const Resource r : resources_of(target.family)) text += fmt::format(" {:>8}", to_string(r));
  text += "\n";
  add_rows(report.block, 0, target.family, text);
  if (target.family != Family::asic) {
    text += fmt::format("{:<40}", "device holds");
    for (const Resource r : resources_of(target.family)) text += fmt::format(" {:>8}", report.holds[r]);
    text += "\n";
  }
  text += "\n";
  const auto line = [&](const char* what, const std::string& value) {
    text += fmt::format("{:<22} {}\n", what, value);
  };
  if (const auto fit = fit_of(report)) {
    const double share = planned_share(target, fit->limit);
    line("fit the device",
         fmt::format("{} of {}, limited by {}{}", fit->units, report.unit, to_string(fit->limit),
                     share < 1 ? fmt::format(" (planned to {:.0f} %)", 100 * share) : ""));
    if (report.unit == "node" && report.nodes > fit->units)
      line("the scene's nodes", fmt::format("{}: cuboct emit SCENE --fit {} looks for a machine that fits",
                                            report.nodes, report.target));
  }
  if (report.cells)
    line("logic cells, packed", fmt::format("{}, and {} of the harness", *report.cells, report.harness));
  if (whole(report.unit)) line("cycles per step", cycles_text(report.cycles));
  if (report.depth) line("longest path", fmt::format("{} cells between registers", *report.depth));
  if (report.estimate) {
    const Estimate& e = *report.estimate;
    line("clock, estimated",
         fmt::format("{:.1f} MHz before placement, to {:.0f} %: {:.2f} ns, {:.2f} of them wires", e.mhz(),
                     100 * e.error, e.ns, e.wires));
    for (const std::string& block : e.blocks) line("", block);
    if (report.fmax) line("estimate's error", fmt::format("{:+.1f} %", 100 * (e.mhz() / *report.fmax - 1)));
  }
  if (report.silicon) {
    const Silicon& s = *report.silicon;
    line("standard cells", s.library);
    line("area", fmt::format("{:.4g} mm^2", s.area * 1e-6));
    line("longest path", fmt::format("{:.2f} ns", s.delay));
    line("power",
         fmt::format("{:.4g} W at {:.1f} MHz, {:.3g} nJ per cycle; each net changing {:.2g} times per clock",
                     s.power, s.frequency, s.power / s.frequency * 1e3, s.activity));
  }
  if (report.fmax) {
    line("Fmax", fmt::format("{:.2f} MHz ({})", *report.fmax, report.fmax_from));
    if (report.icetime) line("Fmax by icetime", fmt::format("{:.2f} MHz", *report.icetime));
    if (const auto steps = steps_per_second(report, *report.fmax))
      line("steps per second", fmt::format("{:.4g} at Fmax", *steps));
  } else if (!report.silicon) {
    line("Fmax", "not known: not placed");
  }
  return text;
}

std::string report_json(const Report& report) {
  return to_json(report).dump(2, ' ', true, nlohmann::ordered_json::error_handler_t::replace);
}

nlohmann::ordered_json to_json(const Report& report) {
  const Family family = target_of(report.target).family;
  Ordered json = {{"plan", report.plan},
                  {"target", report.target},
                  {"device", report.device},
                  {"unit", report.unit},
                  {"nodes", report.nodes},
                  {"particles", report.particles},
                  {"cycles_per_step", to_json(report.cycles)},
                  {"used", to_json(report.used, family)},
                  {"holds", to_json(report.holds, family)}};
  if (const auto fit = fit_of(report))
    json["fit"] = {{"units", fit->units}, {"limit", to_string(fit->limit)}};
  if (report.cells) json["logic_cells"] = *report.cells;
  json["harness_flip_flops"] = report.harness;
  if (report.depth) json["depth"] = *report.depth;
  if (report.estimate) {
    const Estimate& e = *report.estimate;
    Ordered ends = Ordered::array();
    for (const Estimate::End& end : e.ends)
      ends.push_back({{"from", end.from}, {"to", end.to}, {"ns", end.ns}});
    json["estimate"] = {{"mhz", e.mhz()},     {"ns", e.ns},     {"wires_ns", e.wires}, {"to_share", e.error},
                        {"blocks", e.blocks}, {"path", e.path}, {"ends", ends}};
    if (report.fmax) json["estimate"]["error"] = e.mhz() / *report.fmax - 1;
  }
  if (report.fmax) {
    json["fmax_mhz"] = *report.fmax;
    json["fmax_from"] = report.fmax_from;
    if (const auto steps = steps_per_second(report, *report.fmax)) json["steps_per_second"] = *steps;
    json["critical_path"] = report.critical;
  }
  if (report.icetime) json["icetime_mhz"] = *report.icetime;
  if (report.silicon) {
    const Silicon& s = *report.silicon;
    json["silicon"] = {{"library", s.library}, {"area_um2", s.area},     {"delay_ns", s.delay},
                       {"power_w", s.power},   {"activity", s.activity}, {"at_mhz", s.frequency}};
  }
  json["tools"] = report.tools;
  json["files"] = report.files;
  json["block"] = to_json(report.block, family);
  return json;
}

Report read_report(const std::string& file) {
  Report report;
  try {
    const nlohmann::json json = read_json(file);
    const auto optional = [&](const char* name, auto& value) {
      if (json.contains(name)) value = json.at(name);
    };
    report.plan = json.at("plan");
    report.target = json.at("target");
    report.device = json.at("device");
    report.unit = json.at("unit");
    report.nodes = json.at("nodes");
    report.particles = json.at("particles");
    report.cycles = cycles_of(json.at("cycles_per_step"));
    report.used = counts_of(json.at("used"));
    report.holds = counts_of(json.at("holds"));
    if (json.contains("logic_cells")) report.cells = json.at("logic_cells").get<uint64_t>();
    if (json.contains("depth")) report.depth = json.at("depth").get<uint64_t>();
    if (json.contains("estimate")) {
      const auto& from = json.at("estimate");
      Estimate& e = report.estimate.emplace();
      e.ns = from.at("ns");
      e.wires = from.at("wires_ns");
      e.error = from.at("to_share");
      e.blocks = from.at("blocks");
      e.path = from.at("path");
      for (const auto& end : from.at("ends")) e.ends.push_back({end.at("from"), end.at("to"), end.at("ns")});
    }
    if (json.contains("fmax_mhz")) report.fmax = json.at("fmax_mhz").get<double>();
    if (json.contains("icetime_mhz")) report.icetime = json.at("icetime_mhz").get<double>();
    optional("fmax_from", report.fmax_from);
    optional("critical_path", report.critical);
    report.harness = json.at("harness_flip_flops");
    report.tools = json.at("tools");
    report.files = json.at("files");
    report.block = block_of(json.at("block"));
  } catch (const nlohmann::json::exception&) {
    throw InputError(file + ": is no report of cuboct synth");
  } catch (const InputError&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw InputError(error.what());
  }
  return report;
}

}  // namespace cuboct::synth
