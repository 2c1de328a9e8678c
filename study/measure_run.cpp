// SPDX-License-Identifier: MIT
#include "study/measure_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "emu/lattice/engine.h"
#include "hw/setup.h"
#include "model/analysis/measure.h"
#include "model/analysis/real_meter.h"
#include "model/analysis/state_meter.h"
#include "model/analysis/strain.h"
#include "model/base/interrupt.h"
#include "study/gpu_program.h"

namespace cuboct::study {
namespace {

struct Sums {
  Vec3 momentum = Vec3::Zero();
  double scale = 0;
};

Sums sums_of(const Rule& rule, const std::vector<Vec3>& velocities) {
  Sums sums;
  for (const Vec3& v : velocities) {
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
  const Sums before = sums_of(scene.rule, reference.body().v);
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
  const Sums after = sums_of(scene.rule, reference.body().v);
  run.momentum_change = after.momentum - before.momentum;
  run.momentum_scale = after.scale;
  run.curves = meter.curves();
  return run;
}

// `before`: of the start.
void add_momenta(const Scene& scene, const FixedRule& rule, const Int3& before, const State& last, Run& run) {
  const double unit = scene.rule.mass * rule.cell_edge / rule.dt / std::exp2(rule.widths.velocity_frac());
  const Int3 after = momentum(last);
  for (int a = 0; a < 3; ++a) run.momentum_change[a] = unit * static_cast<double>(after[a] - before[a]);
  for (const Particle& p : last.particles) {
    Vec3 v;
    for (int a = 0; a < 3; ++a) v[a] = unit * static_cast<double>(p.v[a]);
    run.momentum_scale += v.norm();
  }
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
  add_momenta(scene, rule, before, last, run);
  run.curves = meter.curves();
  return run;
}

// In the program of the GPU engine. States of a run that stopped: those up to there.
Run run_on_gpu(const Case& c, const Scene& scene, const RunRequest& request, uint64_t per_sample) {
  GpuRequest asked;
  asked.dt = scene.rule.dt;
  asked.scene_steps = scene.steps;
  asked.steps = request.until * per_sample;
  asked.energies = request.energies;
  asked.probe_every = request.curves || request.energies ? per_sample : 0;
  asked.keep = {0};
  for (const uint64_t sample : request.keep) asked.keep.push_back(sample * per_sample);
  asked.keep.push_back(asked.steps);
  Trace trace = run_gpu(c, started_body(scene, true), asked);
  Run run;
  run.dt = scene.rule.dt;
  run.steps = trace.steps();
  run.curves = std::move(trace.curves);
  if (trace.stop) run.stop = trace.stop->text;
  const auto wanted = [&](uint64_t step) {
    return step % per_sample == 0 && among(request.keep, step / per_sample);
  };
  if (c.settings.arithmetic == Arithmetic::fixed) {
    Scene started = scene;
    started.body = started_body(scene, true);
    const Plan plan = plan_of(started, c.arch);
    if (trace.plan_hash != plan.hash)
      throw std::runtime_error("cuboct-gpu made another plan of the same scene: build both from one source");
    for (const State& state : trace.frames)
      if (wanted(state.step)) run.kept.push_back(to_real(state, plan.rule, plan.lattice, plan.origin));
    if (!trace.frames.empty())
      add_momenta(scene, plan.rule, momentum(trace.frames.front()), trace.frames.back(), run);
    return run;
  }
  for (const RealFrame& frame : trace.bodies) {
    if (!wanted(frame.step)) continue;
    run.kept.push_back(scene.body);
    run.kept.back().x = frame.x, run.kept.back().v = frame.v;
  }
  if (!trace.bodies.empty()) {
    const Sums before = sums_of(scene.rule, trace.bodies.front().v);
    const Sums after = sums_of(scene.rule, trace.bodies.back().v);
    run.momentum_change = after.momentum - before.momentum;
    run.momentum_scale = after.scale;
  }
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
  if (on_gpu(c.settings)) return run_on_gpu(c, scene, request, per_sample);
  if (c.settings.arithmetic == Arithmetic::fixed)
    return run_fixed(std::move(scene), c.arch, request, per_sample);
  return run_real(scene, c.settings, request, per_sample);
}

double rms_distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b, const Periodic& periodic) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += nearest_image(b[i] - a[i], periodic).squaredNorm();
  return a.empty() ? 0 : std::sqrt(sum / static_cast<double>(a.size()));
}

double length_unit(const Scene& scene) { return scene.pitch > 0 ? scene.pitch : scene.rule.law->cutoff(); }

}  // namespace cuboct::study
