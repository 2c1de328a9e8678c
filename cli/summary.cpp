// SPDX-License-Identifier: MIT
#include "cli/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cli/advice.h"

namespace cuboct {
RunMeter::RunMeter(const Loaded& loaded, std::vector<uint64_t> probe_steps, bool watch)
    : loaded_(loaded),
      probe_steps_(probe_steps.begin(), probe_steps.end()),
      meter_(
          loaded.scene, loaded.setup.plan.rule, loaded.setup.plan.lattice, loaded.setup.plan.origin,
          [&](uint32_t id) { return loaded.setup.initial.particles[id]; }, true, 0, watch) {}

void RunMeter::see(const State& state) {
  if (!any_) facts_.momentum_before = momentum(state);
  any_ = true;
  last_ = state;
  facts_.largest_speed =
      std::max(facts_.largest_speed, cuboct::largest_speed(loaded_.setup.plan.rule, state));
  measured_ = probe_steps_.contains(state.step);
  if (measured_) meter_.add(state);
}

RunFacts RunMeter::finish() {
  if (any_ && !measured_) meter_.add(last_);
  facts_.momentum_after = momentum(last_);
  facts_.curves = meter_.curves();
  meter_.conclude();
  if (const Watch* watch = meter_.watch()) {
    facts_.watch = true;
    facts_.findings = watch->findings();
    facts_.watched = watch->last_step();
  }
  return facts_;
}

std::optional<CyclesPerStep> cycles_per_step(const Trace& trace) {
  const size_t row = trace.nodes * kPhases;
  if (trace.cycles.empty() || row == 0) return std::nullopt;
  CyclesPerStep result;
  uint64_t before = 0;
  const size_t steps = trace.cycles.size() / row;
  for (size_t step = 0; step < steps; ++step) {
    uint64_t end = 0;
    for (size_t i = step * row; i < (step + 1) * row; ++i) end = std::max(end, trace.cycles[i].end + 1);
    result.max = std::max(result.max, end - before);
    before = end;
  }
  result.mean = static_cast<double>(before) / static_cast<double>(steps);
  return result;
}

namespace {

bool is_energy(const Curve& curve) { return curve.name.starts_with("energy."); }

// Sums of many doubles: what is this small beside the largest energy that went into them is their rounding.
constexpr double kRounding = 1e-13;

double largest_energy(const std::vector<Curve>& curves) {
  double largest = 0;
  for (const Curve& curve : curves)
    if (is_energy(curve))
      for (const double value : curve.value) largest = std::max(largest, std::abs(value));
  return largest;
}

}  // namespace

void add_curves(Items& items, const Scene& scene, const std::vector<Curve>& curves) {
  const double rounding = kRounding * largest_energy(curves);
  const auto energy = [&](const char* name, double value, const char* note = "") {
    items.add(name, std::abs(value) <= rounding ? 0.0 : value, "J", note);
  };
  for (const Curve& curve : curves) {
    if (curve.value.empty()) continue;
    const auto [low, high] = std::minmax_element(curve.value.begin(), curve.value.end());
    if (!is_energy(curve)) items.add_range(curve.name, curve.value.back(), *low, *high, curve.unit);
    if (curve.name != "energy.total" || curve.value.size() < 2) continue;
    if (keeps_energy(scene.rule, scene.periodic))
      energy("energy drift", *high - *low, "largest minus smallest total");
    else
      energy("energy change", curve.value.back() - curve.value.front(), "driven or damped");
    energy("energy", curve.value.back());
  }
}

void add_end(Items& items, const Trace& trace) {
  const bool whole = trace.steps() == trace.asked;
  items.add("ended", trace.ended(),
            whole ? "" : fmt::format("after {} of {} steps", trace.steps(), *trace.asked));
}

void add_warnings(Items& items, const std::vector<std::string>& of_plan,
                  const std::vector<Finding>& findings) {
  std::vector<Items> list;
  for (const std::string& text : of_plan) list.emplace_back().add("text", text);
  for (const Finding& f : findings) {
    Items& item = list.emplace_back();
    item.add("failure", to_string(f.failure));
    item.add("step", f.step);
    if (f.particle) {
      item.add("particle", *f.particle);
      for (int a = 0; a < 3; ++a) item.add(std::string(1, "xyz"[a]), f.place[a], "m");
    }
    item.add("number", f.number);
    item.add("limit", f.limit);
    item.add("text", f.text);
  }
  items.add_list("warnings", "warning", list);
}

Items summarise(const Loaded& loaded, const Trace& trace, const RunFacts& facts) {
  const Plan& plan = loaded.setup.plan;
  Items items;
  items.add("engine", trace.engine);
  for (const auto& [name, text] : trace.notes) items.add(name, text);
  items.add("scene", loaded.scene.path);
  items.add("particles", plan.particles);
  items.add("nodes", plan.nodes());
  if (plan.bricks.cells() > 1) items.add("cells per node", plan.bricks.cells());
  items.add("steps", trace.steps());
  items.add("simulated time", static_cast<double>(trace.steps()) * plan.rule.dt, "s");
  items.add("host time", trace.seconds, "s");
  if (trace.seconds > 0)
    items.add("speed", static_cast<double>(trace.steps() * plan.particles) / trace.seconds,
              "particle-steps/s");

  const Int3 &before = facts.momentum_before, &after = facts.momentum_after;
  int64_t change = 0;
  for (int axis = 0; axis < 3; ++axis)
    change = std::max<int64_t>(change, std::abs(after[axis] - before[axis]));
  items.add("momentum change", change, "LSB",
            keeps_momentum(loaded.scene.rule) ? "" : "held or driven from outside");

  add_curves(items, loaded.scene, facts.curves);
  items.add("largest speed", facts.largest_speed, "cell/step");
  if (const auto cycles = cycles_per_step(trace)) {
    items.add("mean cycles per step", cycles->mean);
    items.add("most cycles per step", cycles->max);
  }
  for (const auto& [name, value] : trace.counters) items.add(name, value);
  items.add("plan hash", fmt::format("{:016x}", trace.plan_hash));
  if (!trace.state_hash.empty()) items.add("state hash", fmt::format("{:016x}", trace.state_hash.back()));
  if (facts.watch || !plan.warnings.empty()) add_warnings(items, plan.warnings, facts.findings);
  if (trace.stop) {
    if (facts.watched)
      items.add("last look", fmt::format("step {}: {}", *facts.watched,
                                         facts.findings.empty() ? "nothing amiss" : "see the warnings"));
    items.add("advice", advice_on(*trace.stop, plan, loaded.scene));
    items.add("stopped", trace.stop->text);
  }
  return items;
}

}  // namespace cuboct
