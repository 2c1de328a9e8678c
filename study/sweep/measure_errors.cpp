// SPDX-License-Identifier: MIT
#include "study/sweep/measure_errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "hw/plan/setup.h"
#include "model/analysis/measure.h"
#include "model/base/error.h"
#include "model/rules/rounds_rule.h"
#include "study/sweep/cost.h"
#include "study/sweep/gpu_program.h"
#include "study/sweep/measure_run.h"

namespace cuboct::study {
namespace {

void add_reason(Outcome& outcome, const std::string& reason) {
  outcome.why += (outcome.why.empty() ? "" : "; ") + one_line(reason);
}

// Pair forces of the engine on the particles of a kept state.
std::vector<Vec3> forces_on(const Case& c, const Plan* plan, const Body& body, const Periodic& periodic,
                            GpuRuns* gpu) {
  if (plan) {
    const State state = to_fixed(body, plan->rule, plan->lattice, plan->origin);
    std::vector<Vec3> forces;
    for (const Int3& kick : summed_kicks(plan->rule, plan->lattice, state, 1))
      forces.push_back(force_of(plan->rule, kick));
    return forces;  // the same in every fixed engine
  }
  if (on_gpu(c.settings)) return gpu_forces(c, body, gpu);
  RealOptions options;
  options.precision = c.settings.arithmetic == Arithmetic::float32 ? Precision::float32 : Precision::float64;
  return Reference(c.scene.rule, body, periodic, options).forces();
}

// The element that a share `part` of the values does not pass.
double quantile(std::vector<double> values, double part) {
  const auto at = static_cast<size_t>(std::ceil(part * static_cast<double>(values.size())));
  const auto nth = values.begin() + static_cast<ptrdiff_t>(std::max<size_t>(at, 1) - 1);
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

// A truth may come from another's results: its bodies must be the case's.
void check_body(const Body& body, const Scene& scene) {
  const bool alike = body.x.size() == scene.body.size() && body.v.size() == scene.body.size() &&
                     body.type == scene.body.type &&
                     std::ranges::all_of(body.x, [](const Vec3& x) { return x.allFinite(); });
  if (!alike)
    throw InputError("a truth in the results is of another scene", "remove the results and begin again");
}

void compare_forces(const Case& c, const Plan* plan, const Truth& own, GpuRuns* gpu, Outcome& outcome) {
  // Of rounds in integers doubles tell the forces; a state without what its bonds keep has none.
  if (c.scene.rule.rounds != nullptr && (plan != nullptr || has_reference_bonds(c.scene.rule))) return;
  std::vector<double> errors;
  for (const KeptState& state : own.states) {
    check_body(state.body, c.scene);
    Body body = state.body;
    body.u.clear();  // pair forces do not depend on the anchors
    const std::vector<Vec3> truth = Reference(c.scene.rule, body, c.scene.periodic, RealOptions{}).forces();
    std::vector<Vec3> forces;
    try {
      forces = forces_on(c, plan, body, c.scene.periodic, gpu);
    } catch (const InputError& error) {
      add_reason(outcome, fmt::format("forces not compared: {}", error.what()));
      return;
    }
    for (size_t i = 0; i < truth.size(); ++i) {
      const double scale = (truth[i].norm() + forces[i].norm()) / 2;
      errors.push_back(scale > 0 ? (forces[i] - truth[i]).norm() / scale : 0);
    }
  }
  if (errors.empty()) return;
  outcome.errors.force_median = quantile(errors, 0.5);
  outcome.errors.force_999 = quantile(errors, 0.999);
  outcome.errors.force_max = quantile(errors, 1);
}

const Curve* curve_named(const std::vector<Curve>& curves, const std::string& name) {
  const auto found = std::ranges::find(curves, name, &Curve::name);
  return found == curves.end() ? nullptr : &*found;
}

// Slope of the total energy by steps, least squares, over the largest kinetic energy.
void measure_drift(const Run& run, double largest_frequency, Outcome& outcome) {
  const Curve* total = curve_named(run.curves, "energy.total");
  const Curve* kinetic = curve_named(run.curves, "energy.kinetic");
  if (!total || !kinetic || total->value.size() < 3) return;
  double n = 0, x1 = 0, y1 = 0, xx = 0, xy = 0;
  for (size_t k = 0; k < total->value.size(); ++k)
    x1 += static_cast<double>(total->step[k]), y1 += total->value[k];
  n = static_cast<double>(total->value.size());
  x1 /= n, y1 /= n;
  for (size_t k = 0; k < total->value.size(); ++k) {
    const double x = static_cast<double>(total->step[k]) - x1;
    xx += x * x, xy += x * (total->value[k] - y1);
  }
  const double largest = *std::ranges::max_element(kinetic->value);
  if (!(largest > 0)) return;
  outcome.errors.drift_per_step = xy / xx / largest;
  if (largest_frequency > 0)
    outcome.errors.drift_per_oscillation =
        outcome.errors.drift_per_step / run.dt * 2 * std::numbers::pi / largest_frequency;
}

bool uses_energies(const Study& study) {
  return std::ranges::any_of(study.figures,
                             [](const Figure& figure) { return figure.curve.starts_with("energy."); });
}

void measure_run(const Study& study, const Truth& truth, const Truth& own, const Case& c, GpuRuns* gpu,
                 Outcome& outcome) {
  // What a rule of rounds keeps, it does not say.
  const bool pairs = c.scene.rule.rounds == nullptr;
  const bool conserves = pairs && keeps_energy(c.scene.rule, c.scene.periodic);
  const bool carries = pairs && keeps_momentum(c.scene.rule);
  RunRequest request;
  request.grid = truth.grid;
  request.curves = !study.figures.empty();
  request.energies = conserves || uses_energies(study);
  // Without figures and energies nothing is asked of what comes after the horizon.
  const bool whole = request.curves || request.energies || carries;
  request.until = whole ? truth.grid.samples : truth.grid.horizon;
  request.keep = {truth.grid.horizon};
  request.gpu = gpu;
  const Run run = run_case(c, request);
  outcome.steps = run.steps;
  if (!run.stop.empty()) {
    outcome.status = Status::unstable;
    add_reason(outcome, run.stop);
  }
  if (!run.kept.empty()) {
    check_body(own.horizon.body, c.scene);
    outcome.errors.trajectory =
        rms_distance(run.kept[0].x, own.horizon.body.x, c.scene.periodic) / length_unit(c.scene);
    if (!(outcome.errors.trajectory <= 1)) {
      outcome.status = Status::unstable;
      add_reason(outcome,
                 fmt::format("left the truth by {:.3g} pitches at the horizon", outcome.errors.trajectory));
    }
  }
  if (!run.stop.empty()) {
    outcome.errors.figures.assign(study.figures.size(), kNotMeasured);
    outcome.errors.values.assign(study.figures.size(), kNotMeasured);
    return;
  }
  compare_figures(study, truth, run, outcome);
  if (conserves) measure_drift(run, own.largest_frequency, outcome);
  if (carries && run.momentum_scale > 0)
    outcome.errors.momentum = run.momentum_change.norm() / run.momentum_scale;
}

void measure(const Study& study, const Truth& truth, const Truth& own, GpuRuns* gpu, Outcome& outcome) {
  Case c = resolve(study.base, outcome.settings);
  c.scene.rule.dt = truth.grid.fitted(c.scene.rule.dt);
  c.scene.steps = truth.grid.steps_per_sample(c.scene.rule.dt) * truth.grid.samples;
  outcome.dt = c.scene.rule.dt;
  outcome.pitch = c.scene.pitch;
  outcome.particles = static_cast<uint32_t>(c.scene.body.size());
  std::optional<Plan> plan;
  if (c.settings.arithmetic == Arithmetic::fixed) {
    plan = lattice_plan(c.scene, c.arch);
    const auto bits = [&](const FixedTable& table) {
      return static_cast<int>(table.c0.size() + table.c1.size() + table.c2.size()) *
             plan->rule.widths.strength_bits;
    };
    if (plan->program == nullptr && plan->rule.cubic()) {
      outcome.halo_bits = plan->words.halo_bits;
      outcome.table_bits = bits(plan->rule.force) + (plan->rule.damped ? bits(plan->rule.damp) : 0);
    }
  }
  outcome.cost = cost_of(c);
  compare_forces(c, plan ? &*plan : nullptr, own, gpu, outcome);
  measure_run(study, truth, own, c, gpu, outcome);
}

}  // namespace

void compare_figures(const Study& study, const Truth& truth, const Run& run, Outcome& outcome) {
  for (size_t k = 0; k < study.figures.size(); ++k) {
    double value = kNotMeasured;
    try {
      value = value_of(study.figures[k], run.curves, run.dt);
    } catch (const std::runtime_error& error) {
      add_reason(outcome, error.what());
    }
    outcome.errors.values.push_back(value);
    outcome.errors.figures.push_back(
        value == truth.figures[k] ? 0 : std::abs(value - truth.figures[k]) / std::abs(truth.figures[k]));
  }
}

Outcome answered(const Study& study, const Settings& settings, const std::function<void(Outcome&)>& measure) {
  Outcome outcome;
  outcome.settings = settings;
  try {
    measure(outcome);
  } catch (const InputError& error) {
    outcome.status = Status::refused;
    outcome.why = one_line(error.what());
  } catch (const RunError& error) {  // not even the initial state can be held
    outcome.status = Status::unstable;
    outcome.why = one_line(error.what());
  }
  outcome.errors.figures.resize(study.figures.size(), kNotMeasured);
  outcome.errors.values.resize(study.figures.size(), kNotMeasured);
  return outcome;
}

Outcome measure_errors(const Study& study, const Truth& study_truth, const Truth& own,
                       const Settings& settings, GpuRuns* gpu) {
  return answered(study, settings, [&](Outcome& outcome) { measure(study, study_truth, own, gpu, outcome); });
}

}  // namespace cuboct::study
