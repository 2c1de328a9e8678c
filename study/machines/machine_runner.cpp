// SPDX-License-Identifier: MIT
#include "study/machines/machine_runner.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "hw/cost/energy.h"
#include "hw/cost/memory_traffic.h"
#include "model/base/error_parts.h"
#include "model/base/hash.h"
#include "model/base/interrupt.h"
#include "model/base/json.h"
#include "study/sweep/interrupted.h"
#include "study/sweep/work.h"

namespace cuboct::study {
namespace {

// Machines of one run, so that a setup and a run serve some and threads still share the work.
constexpr size_t kTogether = 24;

MachineCounts counts_of(const nlohmann::json& line) {
  MachineCounts counts;
  counts.steps = line.at("steps"), counts.cycles = line.at("cycles"), counts.most = line.at("most");
  for (const NamedEvent& event : event_names()) counts.events.*event.count = line.at("events").at(event.name);
  for (size_t k = 0; k < kPhases; ++k) counts.events.phase_cycles[k] = line.at("phase_cycles").at(k);
  for (size_t k = 0; k < kStepParts; ++k) counts.parts[k] = line.at("parts").at(k);
  for (size_t k = 0; k < kDemands; ++k) counts.demands[k] = line.at("demands").at(k);
  return counts;
}

// A sum without one of these is open: the true value is larger by what no figure tells. An FPGA at rest takes
// its own constants in place of leakage.
std::vector<std::string> lacking_of(const Technology& t) {
  std::vector<Constant> needed{Constant::add_bit,         Constant::multiply_bit2,  Constant::register_bit,
                               Constant::clock_bit,       Constant::memory_read,    Constant::memory_write,
                               Constant::memory_exponent, Constant::wire_bit_mm,    Constant::transistor_area,
                               Constant::register_area,   Constant::memory_bit_area};
  if (!t.at(Constant::static_device))
    needed.insert(needed.end(), {Constant::leakage_transistor, Constant::leakage_memory_bit});
  std::vector<std::string> lacking;
  for (const Constant constant : needed)
    if (!t.at(constant)) lacking.emplace_back(name_of(constant));
  return lacking;
}

bool has_area(const Technology& t) {
  return t.at(Constant::transistor_area) && t.at(Constant::register_area) && t.at(Constant::memory_bit_area);
}

MachineValue& at(MachineFinding& finding, MachineQuantity quantity) {
  return finding.values[static_cast<size_t>(quantity)];
}

void add_cycles(MachineFinding& f) {
  const Known known = f.screened ? Known::estimated : Known::exact;
  const double cycles = f.counts->mean();
  at(f, MachineQuantity::cycles) = MachineValue::of(cycles, known);
  at(f, MachineQuantity::rate) = MachineValue::of(f.choice.clock / cycles, known);
  at(f, MachineQuantity::time) = MachineValue::of(cycles / f.choice.clock, known);
}

void add_energy(MachineFinding& f, const Plan& plan, const Technology& technology) {
  const MachineCounts& c = *f.counts;
  const std::vector<MemoryTraffic> traffic = memory_traffic(plan, c.events);
  const Energy energy = energy_of(plan, c.events, traffic, c.cycles, f.choice.clock, technology);
  f.lacking = lacking_of(technology);
  if (energy.rows.empty()) return;
  const bool open = !f.lacking.empty();
  const uint64_t updates = c.events.updates / plan.rounds.size();  // a particle has one in each round
  at(f, MachineQuantity::energy) = {1e-12 / static_cast<double>(updates) * energy.sum, Known::estimated,
                                    open};
  at(f, MachineQuantity::power) = {1e-12 * f.choice.clock / static_cast<double>(c.cycles) * energy.sum,
                                   Known::estimated, open};
  if (has_area(technology))
    at(f, MachineQuantity::area) = {1e-6 * area_of(plan, technology).sum, Known::estimated, false};
}

void add_device(MachineFinding& f, const DeviceUse& use) {
  at(f, MachineQuantity::lut) = use.lut, at(f, MachineQuantity::ff) = use.ff;
  at(f, MachineQuantity::dsp) = use.dsp, at(f, MachineQuantity::bram) = use.bram;
}

// The text of `work`'s refusal; empty: there was none.
template <typename Work>
std::string refusal_of(Work work) {
  try {
    work();
  } catch (const InputError& error) {
    const ErrorParts parts = parts_of(error);
    // Its place is in a text that the study made.
    const std::string text = bare_message(error);
    return one_line(parts.hint.empty() ? text : text + "; " + parts.hint);
  }
  return "";
}

Arch arch_of(const Base& base, const Settings& settings) {
  const std::string path = base.arch_path.empty() ? "(default arch)" : base.arch_path;
  const std::string text = base.arch_text.empty() ? "name = \"default\"\n" : base.arch_text;
  return parse_arch(with_changes(text, path, settings.arch), path);
}

}  // namespace

Verdict verdict_of(const MachineStudy& study, const MachineFinding& finding) {
  Verdict worst = Verdict::holds;
  for (size_t k = 0; k < study.constraints.size(); ++k)
    worst = std::max(worst, judge(study.constraints[k], finding.kept[k]));
  return worst;
}

MachineRunner::MachineRunner(const MachineStudy& study, MachineRunnerOptions options)
    : study_(study), options_(std::move(options)) {
  if (options_.kept.empty()) return;
  lines_.emplace(options_.kept, study.hash, "the counts of another scene or arch",
                 [&](const nlohmann::json& line) {
                   Kept kept;
                   if (!line.at("counts").is_null()) kept.counts = counts_of(line.at("counts"));
                   counts_[line.at("machine")] = std::move(kept);
                 });
}

std::optional<MachineRunner::Kept> MachineRunner::kept(const std::string& key) {
  const std::lock_guard guard(mutex_);
  const auto found = counts_.find(key);
  return found == counts_.end() ? std::nullopt : std::optional(found->second);
}

void MachineRunner::keep(const std::string& key, const Kept& kept) {
  const std::lock_guard guard(mutex_);
  if (!counts_.emplace(key, kept).second) return;
  ++counted_;
  if (lines_)
    lines_->add(fmt::format("{{\"machine\":{},\"counts\":{}}}", json(key),
                            kept.counts ? counts_json(*kept.counts) : "null"));
}

// Of machines that share all that bits depend on.
void MachineRunner::find(const std::vector<size_t>& group, uint64_t steps,
                         std::vector<MachineFinding>& findings) {
  if (interrupted()) throw Interrupted();
  const MachineChoice& first = findings[group[0]].choice;
  const Base& base = study_.scenes[first.scene];
  std::unique_ptr<SharedSetup> shared;
  const std::string refused =
      refusal_of([&] { shared = std::make_unique<SharedSetup>(base, of_bits(first.settings)); });
  // Points that differ in clock, technology or target alone have one plan.
  std::map<std::string, Plan> plans;
  std::map<std::string, std::string> why;
  for (const size_t n : group) {
    const std::string key = findings[n].choice.machine_key();
    if (!refused.empty()) why[key] = refused;
    if (plans.contains(key) || why.contains(key)) continue;
    const std::string text = refusal_of([&] {
      const Arch arch = arch_of(base, findings[n].choice.settings);
      plans.emplace(key, with_places(shared->scene(), arch, [&] { return shared->plan_of(arch); }));
    });
    if (!text.empty()) why[key] = text;
  }
  // A scene's place in the study may change, what it says may not: its files are in plan and state.
  Hash said;
  for (const char c : base.scene_text + base.arch_text) said.add(c);
  if (shared) {
    said.add(static_cast<int64_t>(shared->plan().hash));
    said.add(static_cast<int64_t>(hash_of(shared->plan().lattice, shared->initial())));
  }
  const auto key_of = [&](const std::string& machine) {
    return fmt::format("{} steps, {:016x}{}", steps, said.value(),
                       machine.substr(std::min(machine.find(' '), machine.size())));
  };
  std::vector<std::string> missing;
  std::vector<Plan> to_count;
  for (const auto& [key, plan] : plans)
    if (!kept(key_of(key))) missing.push_back(key), to_count.push_back(plan);
  if (!to_count.empty()) {
    auto counted = count_machines(*shared, to_count, steps);
    if (interrupted()) throw Interrupted();
    for (size_t k = 0; k < missing.size(); ++k) keep(key_of(missing[k]), {std::move(counted[k])});
    const std::lock_guard guard(mutex_);
    if (lines_) lines_->save();
  }
  std::map<std::string, ExpectedCycles> expected;
  for (const size_t n : group) {
    MachineFinding& f = findings[n];
    f.values.resize(kMachineQuantities + study_.frame.figures.size());
    const std::string key = f.choice.machine_key();
    if (const auto found = why.find(key); found != why.end()) {
      f.why = found->second;
      continue;
    }
    const Plan& plan = plans.at(key);
    f.nodes = plan.nodes(), f.particles = plan.particles, f.cells = plan.lattice.size();
    if (!expected.contains(key)) expected[key] = shared->expected(plan);
    f.expected = expected[key];
    f.counts = kept(key_of(key))->counts;
    f.screened = steps < study_.steps;
    if (!f.counts) {
      f.why = "the first step breaks a width or a capacity";
      continue;
    }
    f.pairs_per_step =
        f.counts->demands[static_cast<size_t>(Demand::pipes)] * plan.arch.force_pipes / plan.latency.interval;
    at(f, MachineQuantity::nodes) = MachineValue::of(f.nodes, Known::exact);
    add_cycles(f);
    add_energy(f, plan, study_.technologies[f.choice.technology]);
    f.kept.resize(study_.constraints.size());
    if (!options_.device) continue;
    if (!f.choice.target.empty()) add_device(f, options_.device(plan, f.choice.target));
    for (size_t k = 0; k < study_.constraints.size(); ++k) {
      const std::string& target = study_.constraints[k].target;
      if (target.empty()) continue;
      const DeviceUse use = options_.device(plan, target);
      f.kept[k] = use.share;
      if (f.choice.target.empty()) add_device(f, use);
    }
  }
}

void MachineRunner::judge_all(MachineFinding& finding) const {
  finding.kept.resize(study_.constraints.size());
  for (size_t k = 0; k < study_.constraints.size(); ++k)
    if (study_.constraints[k].target.empty() && finding.done())
      finding.kept[k] = finding.values[study_.constraints[k].measure];
}

std::vector<MachineFinding> MachineRunner::evaluate(const std::vector<MachineChoice>& choices,
                                                    uint64_t steps) {
  std::vector<MachineFinding> findings(choices.size());
  std::map<std::string, std::vector<size_t>> alike;
  for (size_t n = 0; n < choices.size(); ++n) {
    findings[n].choice = choices[n];
    MachineChoice bits = choices[n];
    bits.settings = of_bits(bits.settings);
    alike[bits.machine_key()].push_back(n);
  }
  std::vector<std::vector<size_t>> groups;
  for (auto& [key, members] : alike) {
    // Those of one machine stay together.
    std::ranges::stable_sort(members, {}, [&](size_t n) { return choices[n].machine_key(); });
    std::string last;
    size_t machines = 0;
    for (const size_t n : members) {
      const std::string machine = choices[n].machine_key();
      if (machine != last) last = machine, ++machines;
      if (n == members.front() || machines > kTogether) groups.emplace_back(), machines = 1;
      groups.back().push_back(n);
    }
  }
  std::vector<Piece> pieces;
  for (const std::vector<size_t>& group : groups)
    pieces.push_back({static_cast<double>(group.size()), [&, group] { find(group, steps, findings); }});
  work_off(std::move(pieces), options_.jobs, "machines", options_.progress);
  for (MachineFinding& finding : findings) judge_all(finding);
  return findings;
}

void MachineRunner::add_errors(std::vector<MachineFinding>& findings, Runner& errors) const {
  if (study_.frame.figures.empty()) return;
  std::vector<Settings> points;
  std::vector<size_t> of;
  for (size_t n = 0; n < findings.size(); ++n)
    if (findings[n].done()) points.push_back(of_bits(findings[n].choice.settings)), of.push_back(n);
  const std::vector<Outcome> outcomes = errors.errors_of(points);
  for (size_t k = 0; k < of.size(); ++k) {
    MachineFinding& f = findings[of[k]];
    if (outcomes[k].status != Status::done) {
      f.why = outcomes[k].status == Status::unstable ? "unstable: " + outcomes[k].why : outcomes[k].why;
      continue;
    }
    double worst = 0;
    const std::vector<double>& mine = outcomes[k].errors.figures;
    for (size_t e = 0; e < mine.size(); ++e) {
      worst = std::isnan(mine[e]) ? mine[e] : std::max(worst, mine[e]);
      if (!std::isnan(mine[e])) f.values[kMachineQuantities + e] = MachineValue::of(mine[e], Known::measured);
    }
    if (!std::isnan(worst)) at(f, MachineQuantity::error) = MachineValue::of(worst, Known::measured);
    judge_all(f);
  }
}

}  // namespace cuboct::study
