// SPDX-License-Identifier: MIT
#include "cli/run_reference.h"

#include <algorithm>
#include <chrono>

#include "model/interrupt.h"
#include "cli/outputs.h"
#include "cli/summary.h"
#include "model/progress.h"
#include "model/measure.h"
#include "model/reference.h"
#include "model/strain.h"

namespace cuboct {
namespace {

// Kinetic energy at the time of the positions: v + a dt/2, as v lives half a step earlier.
double kinetic_energy(const Rule& rule, const Body& body, const std::vector<Vec3>& force) {
  double sum = 0;
  for (size_t i = 0; i < body.size(); ++i) {
    const ParticleType& type = rule.types[body.type[i]];
    for (int axis = 0; axis < 3; ++axis) {
      const double a = type.imposed[axis] ? 0 : force[i][axis] / rule.mass + type.gravity[axis];
      const double v = body.v[i][axis] + 0.5 * a * rule.dt;
      sum += 0.5 * rule.mass * v * v;
    }
  }
  return sum;
}

}  // namespace

ReferenceRun run_reference(const Loaded& loaded, uint64_t steps, const std::vector<uint64_t>& frame_steps,
                           const std::vector<uint64_t>& probe_steps, bool watch) {
  using Clock = std::chrono::steady_clock;
  const Scene& scene = loaded.scene;
  Reference reference(scene.rule, scene.body, scene.periodic, Integrator::semi_implicit_euler);
  ReferenceRun run;
  run.trace.engine = "reference";
  run.trace.plan_hash = loaded.setup.plan.hash;
  run.trace.nodes = loaded.setup.plan.lattice.size();
  ProbeMeter probes(scene.probes, scene.periodic, scene.body.x);
  const StrainMeter strains = strain_meter(scene, scene.body.x);
  const int axis = strain_axis(scene);
  Curve kinetic{"energy.kinetic", "J", {}, {}}, potential{"energy.potential", "J", {}, {}};
  double fastest = 0;
  Watch detectors(scene, 0);

  const auto record = [&](uint64_t step, bool last) {
    const Body& body = reference.body();
    for (const Vec3& v : body.v) fastest = std::max(fastest, v.cwiseAbs().maxCoeff());
    if (last || std::binary_search(probe_steps.begin(), probe_steps.end(), step)) {
      const std::vector<Vec3> force = reference.forces();
      probes.add({step, body.x, force});
      kinetic.step.push_back(step);
      kinetic.value.push_back(kinetic_energy(scene.rule, body, force));
      potential.step.push_back(step);
      potential.value.push_back(reference.potential_energy());
      if (watch) detectors.see(step, body, force, kinetic.value.back(), potential.value.back());
    }
    if (last || std::binary_search(frame_steps.begin(), frame_steps.end(), step)) {
      Frame frame{step, static_cast<double>(step) * scene.rule.dt, body.x, body.v, body.type, {}};
      for (const LocalStrain& strain : strains.measure(body.x)) frame.strain.push_back(strain.axial(axis));
      run.frames.push_back(std::move(frame));
    }
  };

  Progress progress("reference", steps, scene.body.size());
  const Vec3 before = reference.momentum();
  uint64_t step = 0;
  record(0, steps == 0);
  while (step < steps) {
    const auto begin = Clock::now();
    reference.step();
    run.trace.seconds += std::chrono::duration<double>(Clock::now() - begin).count();
    ++step;
    record(step, step == steps || interrupted());
    if (interrupted()) break;
    progress.at(step);
  }
  run.trace.curves = probes.curves();
  run.trace.curves.push_back(kinetic);
  run.trace.curves.push_back(potential);

  Items& items = run.summary;
  items.add("engine", "reference");
  items.add("scene", scene.path);
  items.add("particles", static_cast<uint64_t>(scene.body.size()));
  items.add("steps", step);
  items.add("simulated time", static_cast<double>(step) * scene.rule.dt, "s");
  items.add("host time", run.trace.seconds, "s");
  if (run.trace.seconds > 0)
    items.add("speed", static_cast<double>(step * scene.body.size()) / run.trace.seconds, "particle-steps/s");
  items.add("momentum change", (reference.momentum() - before).norm(), "kg m/s",
            keeps_momentum(scene.rule) ? "" : "held or driven from outside");
  items.add("energy", kinetic.value.back() + potential.value.back(), "J", "kinetic and pairs");
  items.add("energy change",
            kinetic.value.back() + potential.value.back() - kinetic.value.front() - potential.value.front(),
            "J");
  items.add("largest speed", fastest * scene.rule.dt / loaded.setup.plan.rule.cell_edge, "node/step");
  if (watch) add_findings(items, detectors.findings());
  run.failed = !detectors.findings().empty();
  return run;
}

}  // namespace cuboct
