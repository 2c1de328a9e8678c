// SPDX-License-Identifier: MIT
#include "study/measure_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "emu/lattice/engine.h"
#include "hw/setup.h"
#include "model/interrupt.h"
#include "model/measure.h"
#include "model/real_meter.h"
#include "model/state_meter.h"
#include "model/strain.h"

namespace cuboct::study {
namespace {

struct Sums {
  Vec3 momentum = Vec3::Zero();
  double scale = 0;
};

Sums sums_of(const Rule& rule, const Body& body) {
  Sums sums;
  for (const Vec3& v : body.v) {
    sums.momentum += rule.mass * v;
    sums.scale += rule.mass * v.norm();
  }
  return sums;
}

// What both engines share: steps from sample to sample, looking where asked.
template <class Step, class Look>
void go(const RunRequest& request, uint64_t per_sample, Run& run, Step step, Look look) {
  look(0);
  for (uint64_t sample = 1; sample <= request.until; ++sample) {
    for (uint64_t k = 0; k < per_sample; ++k) {
      if (interrupted()) throw Interrupted();
      step();
      ++run.steps;
    }
    look(sample);
  }
}

bool among(const std::vector<uint64_t>& ascending, uint64_t sample) {
  return std::binary_search(ascending.begin(), ascending.end(), sample);
}

Run run_real(const Scene& scene, const Settings& settings, const RunRequest& request, uint64_t per_sample) {
  RealOptions options;
  options.integrator = settings.integrator;
  options.precision = settings.arithmetic == Arithmetic::float32 ? Precision::float32 : Precision::float64;
  options.threads = request.threads;
  const bool half_step_back = settings.integrator == Integrator::semi_implicit_euler;
  Reference reference(scene.rule, started_body(scene, half_step_back), scene.periodic, options);
  Run run;
  run.dt = scene.rule.dt;
  RealMeter meter(scene, settings.integrator, request.curves, request.energies);
  const Sums before = sums_of(scene.rule, reference.body());
  try {
    go(
        request, per_sample, run, [&] { reference.step(); },
        [&](uint64_t sample) {
          if (request.curves || request.energies) meter.add(reference);
          if (among(request.keep, sample)) run.kept.push_back(reference.body());
        });
  } catch (const Interrupted&) {
    throw;
  } catch (const std::runtime_error& error) {
    run.stop = error.what();
  }
  const Sums after = sums_of(scene.rule, reference.body());
  run.momentum_change = after.momentum - before.momentum;
  run.momentum_scale = after.scale;
  run.curves = meter.curves();
  return run;
}

Run run_fixed(Scene scene, const Arch& arch, const RunRequest& request, uint64_t per_sample) {
  const std::vector<Vec3> initial = scene.body.x;
  scene.body = started_body(scene, true);
  const Plan plan = plan_of(scene, arch);
  const FixedRule& rule = plan.rule;
  const auto particle = [&](uint32_t id) {
    return fixed_particle(scene.body, id, rule, plan.lattice, plan.origin);
  };
  emu::LatticeOptions options;
  options.threads = request.threads;
  emu::LatticeEngine engine(plan, 0, plan.particles, particle, options);
  Scene measured = scene;
  if (!request.curves) measured.probes.clear();
  StateMeter meter(measured, rule, plan.lattice, plan.origin, particle, request.energies, request.threads);
  Run run;
  run.dt = rule.dt;
  const Int3 before = engine.momentum();
  State last = engine.state();
  try {
    go(
        request, per_sample, run, [&] { engine.step(); },
        [&](uint64_t sample) {
          last = engine.state();
          if (request.curves || request.energies) meter.add(last);
          if (among(request.keep, sample)) run.kept.push_back(to_real(last, rule, plan.lattice, plan.origin));
        });
  } catch (const RunError& error) {
    // The engine's state went with the step that failed: sums are those of the sample before it.
    run.stop = error.what();
  }
  const double unit = scene.rule.mass * rule.cell_edge / rule.dt / std::exp2(rule.widths.velocity_frac());
  const Int3 after = momentum(last);
  for (int a = 0; a < 3; ++a) run.momentum_change[a] = unit * static_cast<double>(after[a] - before[a]);
  for (const Particle& p : last.particles) {
    Vec3 v;
    for (int a = 0; a < 3; ++a) v[a] = unit * static_cast<double>(p.v[a]);
    run.momentum_scale += v.norm();
  }
  run.curves = meter.curves();
  return run;
}

}  // namespace

Body started_body(const Scene& scene, bool half_step_back) {
  Body body = scene.body;
  if (!half_step_back) return body;
  const Reference reference(scene.rule, body, scene.periodic, RealOptions{});
  const std::vector<Vec3> force = reference.forces();
  for (size_t i = 0; i < body.size(); ++i)
    body.v[i] -= scene.rule.dt / 2 * acceleration(scene.rule, scene.body, i, force[i]);
  return body;
}

Run run_case(const Case& c, const RunRequest& request) {
  Scene scene = c.scene;
  const uint64_t per_sample = request.grid.steps_per_sample(scene.rule.dt);
  scene.rule.dt = request.grid.fitted(scene.rule.dt);
  scene.steps = per_sample * request.grid.samples;
  scene.probe_every = per_sample;
  if (c.settings.arithmetic == Arithmetic::fixed) return run_fixed(std::move(scene), c.arch, request, per_sample);
  return run_real(scene, c.settings, request, per_sample);
}

double rms_distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b, const Periodic& periodic) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += nearest_image(b[i] - a[i], periodic).squaredNorm();
  return a.empty() ? 0 : std::sqrt(sum / static_cast<double>(a.size()));
}

double length_unit(const Scene& scene) {
  return scene.pitch > 0 ? scene.pitch : scene.rule.law->cutoff();
}

}  // namespace cuboct::study
