// SPDX-License-Identifier: MIT
#include "cli/view/machine.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "hw/plan/plan.h"
#include "model/base/error.h"
#include "model/base/json.h"

namespace cuboct {
namespace {

static_assert(std::endian::native == std::endian::little, "blocks are little-endian");

constexpr size_t kMostPoints = 4096;  // of the curve over all steps

std::string bytes_of(const auto& words) {
  return {reinterpret_cast<const char*>(words.data()), words.size() * sizeof(words[0])};
}

std::string axes_json(const auto& of) {
  std::vector<double> values;
  for (int axis = 0; axis < 3; ++axis) values.push_back(of[axis]);
  return json(values);
}

// The axis of an exchange or a migration; -1 of other phases.
int axis_of(Phase kind) {
  if (kind <= Phase::exchange_z) return static_cast<int>(kind);
  if (kind >= Phase::migrate_x) return static_cast<int>(kind) - static_cast<int>(Phase::migrate_x);
  return -1;
}

}  // namespace

ViewMachine::ViewMachine(const Loaded& loaded, const Trace& trace, const RunRecord& record, bool real)
    : loaded_(loaded),
      trace_(trace),
      command_(fmt::format("cuboct run {} --engine lattice --cycles{} --out DIR", record.scene,
                           record.arch.empty() ? "" : " --arch " + record.arch)) {
  const Plan& plan = loaded.setup.plan;
  if (real)
    missing_ = "A run in real numbers has no machine. One in integers has, and records its cycles with:";
  else if (const std::string why = machine_refusal(plan); !why.empty())
    missing_ = "No machine runs this plan: " + why, command_.clear();
  const size_t row = trace.nodes * trace.phases();
  if (!missing_.empty() || trace.cycles.empty()) return;
  if (trace.nodes != plan.nodes() || trace.cycles.size() % row != 0)
    throw InputError(fmt::format("the phases in the trace are of {} nodes, and the scene's machine has {}",
                                 trace.nodes, plan.nodes()),
                     "run the scene again");
  steps_ = trace.cycles.size() / row;
}

size_t ViewMachine::step_bytes() const { return 8 + 8 * trace_.nodes * trace_.phases(); }

std::string ViewMachine::nodes() const {
  const Plan& plan = loaded_.setup.plan;
  std::vector<int32_t> words;
  for (uint32_t node = 0; node < plan.nodes(); ++node) {
    const Cell low = plan.low_of(node);
    int32_t cells = 0, cut = 0;
    for (uint32_t local = 0; local < plan.bricks.cells(); ++local)
      cells += plan.cell_of(node, local) != kNoCell;
    for (int face = 0; face < kFaces; ++face) cut |= plan.crosses(node, face) ? 1 << face : 0;
    words.insert(words.end(), {low[0], low[1], low[2], cells, cut});
    for (int face = 0; face < kFaces; ++face)
      words.push_back(static_cast<int32_t>(plan.neighbour(node, face)));  // kNoNode: -1
  }
  return bytes_of(words);
}

std::string ViewMachine::held(const State& state) const {
  const Plan& plan = loaded_.setup.plan;
  std::vector<uint32_t> count(plan.nodes());
  for (const Particle& particle : state.particles) ++count[plan.node_of(particle.cell)];
  return bytes_of(count);
}

std::string ViewMachine::spans(size_t step) const {
  const size_t row = trace_.nodes * trace_.phases();
  const auto first = trace_.cycles.begin() + static_cast<ptrdiff_t>(step * row);
  const auto last = first + static_cast<ptrdiff_t>(row);
  const uint64_t base = std::min_element(first, last, [](const PhaseSpan& a, const PhaseSpan& b) {
                          return a.start < b.start;
                        })->start;
  std::vector<uint32_t> words{static_cast<uint32_t>(base), static_cast<uint32_t>(base >> 32)};
  for (auto span = first; span != last; ++span) {
    words.push_back(static_cast<uint32_t>(span->start - base));
    words.push_back(static_cast<uint32_t>(span->end + 1 - base));  // an empty one ends where it starts
  }
  return bytes_of(words);
}

// What each step takes: from the end of its slowest node to that of the next.
std::string ViewMachine::per_step() const {
  const size_t row = trace_.nodes * trace_.phases(), every = (steps_ + kMostPoints - 1) / kMostPoints;
  std::vector<size_t> steps;
  std::vector<double> cycles;
  uint64_t before = 0;
  for (size_t step = 0; step < steps_; ++step) {
    uint64_t end = 0;
    for (size_t i = step * row; i < (step + 1) * row; ++i) end = std::max(end, trace_.cycles[i].end + 1);
    if (step % every == 0) steps.push_back(step), cycles.push_back(static_cast<double>(end - before));
    before = end;
  }
  return json_object({{"name", cuboct::json(std::string("cycles of a step"))},
                      {"unit", cuboct::json(std::string("1"))},
                      {"step", cuboct::json(steps)},
                      {"value", cuboct::json(cycles)}});
}

std::string ViewMachine::json(const std::optional<std::vector<size_t>>& kept) const {
  if (!is_there())
    return json_object(
        {{"nodes", "0"}, {"missing", cuboct::json(missing_)}, {"command", cuboct::json(command_)}});
  const Plan& plan = loaded_.setup.plan;
  const CellEdges edges = plan.rule.edges();
  std::vector<std::string> names;
  std::string axes, kinds;
  for (int p = 0; p < static_cast<int>(trace_.phases()); ++p) {
    const Phase kind = phase_at(p, trace_.rounds).kind;
    names.push_back(phase_name(p, trace_.rounds));
    axes += fmt::format("{}{}", p == 0 ? "" : ",", axis_of(kind));
    kinds += fmt::format("{}{}", p == 0 ? "" : ",", static_cast<int>(kind));
  }
  return json_object({{"nodes", std::to_string(plan.nodes())},
                      {"command", cuboct::json(command_)},
                      {"brick", axes_json(plan.bricks.shape())},
                      {"edge", axes_json(edges)},
                      {"origin", axes_json(plan.origin)},
                      {"steps", std::to_string(steps_)},
                      {"kept", kept ? cuboct::json(*kept) : "null"},
                      {"phases", cuboct::json(names)},
                      {"axes", "[" + axes + "]"},
                      {"kinds", "[" + kinds + "]"},
                      {"per_step", steps_ > 0 ? per_step() : "null"}});
}

}  // namespace cuboct
