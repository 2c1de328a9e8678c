// SPDX-License-Identifier: MIT
#include "study/sweep/probe_run.h"

#include <optional>

#include "emu/lattice/run.h"
#include "hw/engine/scene_engine.h"
#include "model/base/steps.h"
#include "model/run/static_engine.h"
#include "study/sweep/measure_run.h"

namespace cuboct::study {

Trace probe_run(const Scene& scene, const Arch& arch, const std::string& engine, int threads) {
  cuboct::RunRequest request;
  request.steps = scene.steps;
  request.probes = every_so_often(scene.probe_every, scene.steps);
  request.until = true;
  request.hash_every = 0;
  request.last = false;
  const double cell = scene.rule.cutoff();
  std::optional<Plan> plan;
  EngineKind kind;
  if (scene.loading || engine == "reference") {
    RealOptions real;
    real.threads = threads;
    kind = scene_reference_kind(scene, scene.body, real, cell);
  } else {
    plan = lattice_plan(scene, arch);
    emu::LatticeChoice choice;
    choice.engine.threads = threads;
    kind = emu::lattice_kind(scene, *plan, choice);
  }
  Recorded recorded = record(scene, kind, request);
  if (recorded.interrupted) throw Interrupted();
  return std::move(recorded.trace);
}

uint64_t particle_steps(const Scene& scene, const Trace& trace) {
  auto rounds = static_cast<double>(trace.steps());
  if (scene.loading)
    for (const auto& [name, value] : trace.counters)
      if (name == kEvaluations) rounds = value;
  return static_cast<uint64_t>(rounds) * scene.body.size();
}

}  // namespace cuboct::study
