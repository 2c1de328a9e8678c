// SPDX-License-Identifier: MIT
#include "cli/run/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "cli/run/advice.h"
#include "model/analysis/motion_warnings.h"
#include "model/analysis/tension.h"
#include "model/run/start.h"
#include "model/run/static_engine.h"
#include "model/trace/cycles.h"

namespace cuboct {
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

// Of a static run the work is evaluations of forces: its time steps count the load.
void add_speed(Items& items, const Scene& scene, const Trace& trace, double particles) {
  if (!(trace.seconds > 0)) return;
  if (!scene.loading)
    return items.add("speed", static_cast<double>(trace.steps()) * particles / trace.seconds,
                     "particle-steps/s");
  for (const auto& [name, value] : trace.counters)
    if (name == kEvaluations)
      items.add("speed", value * particles / trace.seconds, "particles/s", "in evaluations of forces");
}

constexpr double kNotThere = std::numeric_limits<double>::quiet_NaN();

void add_tension(Items& items, const Scene& scene, const std::vector<Curve>& curves) {
  for (const Probe& probe : scene.probes) {
    if (probe.kind != Probe::Kind::stress_strain) continue;
    const auto tension = tension_of(curves, probe.name);
    if (!tension) continue;
    const TensionFigures figures = tension_figures(tension_test(*tension, scene, probe));
    const Datasheet sheet = probe.datasheet.value_or(Datasheet{});
    const auto add = [&](const char* name, const CurveFigure& figure, double given, const char* unit,
                         const std::string& how) {
      const std::string beside =
          given > 0 ? fmt::format("; datasheet: {:g}{}{}", given, *unit ? " " : "", unit) : "";
      if (figure.value)
        items.add(probe.name + "." + name, *figure.value, unit,
                  fmt::format("+- {:.2g}; {}{}", figure.error, how, beside));
      else
        items.add(probe.name + "." + name, kNotThere, "", figure.why + beside);
    };
    const size_t window = tension_window(tension->strain->value.size());
    const std::string mean = fmt::format("mean of {} reading{}{}", window, window == 1 ? "" : "s",
                                         figures.rises_at_end ? "; it still rises at the end" : "");
    add("modulus", figures.modulus, sheet.modulus, "Pa",
        fmt::format("slope from {:.3g} to {:.3g} of strain", figures.modulus.from, figures.modulus.to));
    add("strength", figures.strength, sheet.strength, "Pa", mean);
    add("yield_strain", figures.yield_strain, sheet.yield_strain, "", "where the strength is");
    add("strain_at_break", figures.strain_at_break, sheet.strain_at_break, "",
        "from there on below a tenth of the strength");
  }
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
    if (scene.loading)
      energy("energy change", curve.value.back() - curve.value.front(), "by the loading");
    else if (scene.deforms())
      energy("energy change", curve.value.back() - curve.value.front(),
             "by the box, and what drives or damps");
    else if (keeps_energy(scene.rule, scene.periodic))
      energy("energy drift", *high - *low, "largest minus smallest total");
    else
      energy("energy change", curve.value.back() - curve.value.front(), "driven or damped");
    energy("energy", curve.value.back());
  }
  add_tension(items, scene, curves);
}

std::string reached_text(const Trace& trace) {
  const Reached& reached = *trace.reached;
  std::string unit;
  for (const Curve& curve : trace.curves)
    if (curve.name == reached.curve && curve.unit != "1") unit = " " + curve.unit;
  return fmt::format("at step {}: {} is {:.6g}{}, {} {:.6g}{}", reached.step, reached.curve, reached.value,
                     unit, reached.side, reached.limit, unit);
}

void note_start(Trace& trace, const Loaded& loaded, bool real) {
  if (!loaded.scene.began) return;
  const Plan& plan = loaded.setup.plan;
  trace.notes.emplace(trace.notes.begin(), "begins at",
                      start_text(loaded.scene, real ? nullptr : &plan.rule, plan.origin));
}

void add_end(Items& items, const Trace& trace) {
  std::string where;
  if (trace.reached)
    where = reached_text(trace);
  else if (trace.steps() != trace.asked)
    where = fmt::format("after {} of {} steps", trace.steps(), *trace.asked);
  items.add("ended", trace.ended(), where);
}

Items facts_of(const Loaded& loaded, const Trace& trace) {
  Items items;
  items.add("engine", trace.engine);
  for (const auto& [name, text] : trace.notes) items.add(name, text);
  items.add("steps", trace.steps());
  items.add("simulated time", static_cast<double>(trace.steps()) * loaded.scene.rule.dt, "s");
  items.add("host time", trace.seconds, "s");
  add_curves(items, loaded.scene, trace.curves);
  if (trace.asked) add_end(items, trace);
  return items;
}

std::vector<std::string> warnings_of(const Loaded& loaded, bool real) {
  std::vector<std::string> warnings = motion_warnings(loaded.scene);
  if (!real)
    warnings.insert(warnings.end(), loaded.setup.plan.warnings.begin(), loaded.setup.plan.warnings.end());
  return warnings;
}

void add_warnings(Items& items, const std::vector<std::string>& before,
                  const std::vector<Finding>& findings) {
  std::vector<Items> list;
  for (const std::string& text : before) list.emplace_back().add("text", text);
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

Items summarise(const Loaded& loaded, const Recorded& run, bool real) {
  const Trace& trace = run.trace;
  const Plan& plan = loaded.setup.plan;
  Items items;
  items.add("engine", trace.engine);
  for (const auto& [name, text] : trace.notes) items.add(name, text);
  items.add("scene", loaded.scene.path);
  items.add("particles", plan.particles);
  if (!real) {
    items.add("nodes", plan.nodes());
    if (plan.bricks.cells() > 1) items.add("cells per node", plan.bricks.cells());
  }
  items.add("steps", trace.steps());
  items.add("simulated time", static_cast<double>(trace.steps()) * plan.rule.dt, "s");
  items.add("host time", trace.seconds, "s");
  add_speed(items, loaded.scene, trace, plan.particles);

  // A body at rest under each load has neither.
  const bool moves = !loaded.scene.loading;
  const char* forced = keeps_momentum(loaded.scene.rule) ? "" : "held or driven from outside";
  if (moves && real)
    items.add("momentum change", run.momentum_change, "kg m/s", forced);
  else if (moves)
    items.add("momentum change", int64_t{std::lround(run.momentum_change)}, "LSB", forced);

  add_curves(items, loaded.scene, trace.curves);
  if (moves) items.add("largest speed", run.largest_speed, "cell/step");
  if (const auto cycles = cycles_per_step(trace)) {
    items.add("mean cycles per step", cycles->mean);
    items.add("most cycles per step", cycles->max);
  }
  constexpr const char* kJoules = "joules_per_particle_step";
  for (const auto& [name, value] : trace.counters)
    if (name != kJoules) items.add(name, value);
  if (!real) {
    items.add("plan hash", fmt::format("{:016x}", trace.plan_hash));
    if (!trace.state_hash.empty()) items.add("state hash", fmt::format("{:016x}", trace.state_hash.back()));
  }
  const std::vector<std::string> before = warnings_of(loaded, real);
  if (trace.watched || !before.empty()) add_warnings(items, before, trace.findings);
  if (trace.stop) {
    if (trace.watched)
      items.add("last look", fmt::format("step {}: {}", *trace.watched,
                                         trace.findings.empty() ? "nothing amiss" : "see the warnings"));
    if (const std::string advice = real ? "" : advice_on(*trace.stop, plan, loaded.scene); !advice.empty())
      items.add("advice", advice);
    items.add("stopped", trace.stop->text);
  }
  for (const auto& [name, value] : trace.counters)
    if (name == kJoules) items.add("energy per particle-step", value, "J", "of the boards");
  return items;
}

}  // namespace cuboct
