// SPDX-License-Identifier: MIT
#include "study/sweep/measure_run.h"

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "emu/lattice/run.h"
#include "hw/engine/scene_engine.h"
#include "study/sweep/gpu_program.h"

namespace cuboct::study {
namespace {

struct Sums {
  Vec3 momentum = Vec3::Zero();
  double scale = 0;
};

Sums sums_of(const Scene& scene, const std::vector<Vec3>& velocities) {
  Sums sums;
  for (size_t i = 0; i < velocities.size(); ++i) {
    const double mass = scene.rule.mass_of(scene.body.type[i]);
    sums.momentum += mass * velocities[i];
    sums.scale += mass * velocities[i].norm();
  }
  return sums;
}

bool among(const std::vector<uint64_t>& ascending, uint64_t sample) {
  return std::binary_search(ascending.begin(), ascending.end(), sample);
}

// A run from sample to sample; `see` takes the state at each.
Run run_engine(const Scene& scene, const EngineKind& kind, const RunRequest& request, uint64_t per_sample,
               const std::function<void(uint64_t sample, const RunState&)>& see) {
  cuboct::RunRequest asked;
  asked.integers = kind.fixed;
  asked.steps = request.until * per_sample;
  for (uint64_t step = 0; step <= asked.steps; step += per_sample) asked.frames.push_back(step);
  if (request.curves || request.energies) asked.probes = asked.frames;
  asked.energies = request.energies;
  asked.hash_every = 0;
  asked.last = false;
  asked.keep = [&](const RunState& frame) {
    see(std::visit([](const auto& state) { return state.step; }, frame) / per_sample, frame);
  };
  Scene measured = scene;
  if (!request.curves) measured.probes.clear();
  Recorded recorded = record(measured, kind, asked);
  if (recorded.interrupted) throw Interrupted();
  Run run;
  run.dt = scene.rule.dt;
  run.steps = recorded.trace.steps_done;
  run.curves = std::move(recorded.trace.curves);
  if (recorded.trace.stop) run.stop = recorded.trace.stop->text;
  return run;
}

Run run_real(const Scene& scene, const Settings& settings, const RunRequest& request, uint64_t per_sample) {
  RealOptions options;
  options.integrator = settings.integrator;
  options.precision = settings.arithmetic == Arithmetic::float32 ? Precision::float32 : Precision::float64;
  options.threads = request.threads;
  const Body start = started_body(scene, settings.integrator == Integrator::semi_implicit_euler);
  const EngineKind kind = scene_reference_kind(scene, start, options, 1);
  std::vector<Body> kept;
  std::vector<Vec3> last;
  Run run = run_engine(scene, kind, request, per_sample, [&](uint64_t sample, const RunState& frame) {
    const RealFrame& state = std::get<RealFrame>(frame);
    last = state.v;
    if (!among(request.keep, sample)) return;
    kept.push_back(start);
    kept.back().x = state.x, kept.back().v = state.v;
  });
  run.kept = std::move(kept);
  const Sums before = sums_of(scene, start.v), after = sums_of(scene, last);
  run.momentum_change = after.momentum - before.momentum;
  run.momentum_scale = after.scale;
  return run;
}

// `before`: of the start.
void add_momenta(const Scene& scene, const FixedRule& rule, const Int3& before, const State& last, Run& run) {
  const Vec3 unit = scene.rule.mass * velocity_units(rule);
  const Int3 after = momentum(rule, last);
  for (int a = 0; a < 3; ++a) run.momentum_change[a] = unit[a] * static_cast<double>(after[a] - before[a]);
  for (const Particle& p : last.particles) {
    Vec3 v;
    for (int a = 0; a < 3; ++a) v[a] = unit[a] * static_cast<double>(p.v[a]);
    run.momentum_scale += scene.rule.relative_mass(p.type) * v.norm();
  }
}

Run run_fixed(Scene scene, const Arch& arch, const RunRequest& request, uint64_t per_sample) {
  scene.body = started_body(scene, true);
  const Plan plan = lattice_plan(scene, arch);
  emu::LatticeChoice choice;
  choice.engine.threads = request.threads;
  std::vector<Body> kept;
  std::optional<Int3> before;
  State last;
  Run run = run_engine(scene, emu::lattice_kind(scene, plan, choice), request, per_sample,
                       [&](uint64_t sample, const RunState& frame) {
                         last = std::get<State>(frame);
                         if (!before) before = momentum(plan.rule, last);
                         if (among(request.keep, sample))
                           kept.push_back(to_real(last, plan.rule, plan.lattice, plan.origin));
                       });
  run.kept = std::move(kept);
  run.dt = plan.rule.dt;
  // The engine's state went with a step that failed: sums are those of the sample before it.
  if (before) add_momenta(scene, plan.rule, *before, last, run);
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
  Trace trace = run_gpu(c, started_body(scene, true), asked, request.gpu);
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
    const Plan plan = shared_plan_of(started, c.arch, {"gpu"});
    if (trace.plan_hash != plan.hash)
      throw std::runtime_error("cuboct-gpu made another plan of the same scene: build both from one source");
    for (const State& state : trace.frames)
      if (wanted(state.step)) run.kept.push_back(to_real(state, plan.rule, plan.lattice, plan.origin));
    if (!trace.frames.empty())
      add_momenta(scene, plan.rule, momentum(plan.rule, trace.frames.front()), trace.frames.back(), run);
    return run;
  }
  for (const RealFrame& frame : trace.bodies) {
    if (!wanted(frame.step)) continue;
    run.kept.push_back(scene.body);
    run.kept.back().x = frame.x, run.kept.back().v = frame.v;
  }
  if (!trace.bodies.empty()) {
    const Sums before = sums_of(scene, trace.bodies.front().v);
    const Sums after = sums_of(scene, trace.bodies.back().v);
    run.momentum_change = after.momentum - before.momentum;
    run.momentum_scale = after.scale;
  }
  return run;
}

}  // namespace

Plan lattice_plan(const Scene& scene, const Arch& arch) { return shared_plan_of(scene, arch, {"lattice"}); }

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

double length_unit(const Scene& scene) { return scene.pitch > 0 ? scene.pitch : scene.rule.cutoff(); }

}  // namespace cuboct::study
