// SPDX-License-Identifier: MIT
#include "model/run/reference_kind.h"

#include <algorithm>

#include "model/base/error.h"
#include "model/run/reference_engine.h"
#include "model/run/rounds_run.h"
#include "model/run/static_engine.h"

namespace cuboct {
namespace {

// `own`: nothing where the run begins.
std::unique_ptr<Engine> reference_at(const Scene& scene, const Body& body, const RealOptions& options,
                                     double cell_edge, uint64_t step, const std::vector<uint64_t>* own) {
  if (scene.loading && own == nullptr)
    return std::make_unique<StaticEngine>(scene, body, options.threads, cell_edge);
  if (scene.loading)
    return std::make_unique<StaticEngine>(scene, body, options.threads, cell_edge, step, *own);
  if (scene.rule.rounds != nullptr) return std::make_unique<RoundsRun>(scene, body, options, cell_edge, step);
  return std::make_unique<ReferenceEngine>(scene, body, options, cell_edge, step);
}

void check_loading(const Scene& scene, const RealOptions& options) {
  if (!scene.loading) return;
  if (options.precision == Precision::float32)
    throw InputError("static loading is in doubles: --precision float is not for it");
  if (options.integrator != Integrator::semi_implicit_euler)
    throw InputError("static loading has no motion to integrate: --integrator is not for it");
}

}  // namespace

EngineKind scene_reference_kind(const Scene& scene, const Body& start, const RealOptions& options,
                                double cell_edge) {
  check_loading(scene, options);
  EngineKind kind;
  kind.name = "reference";
  kind.deforms = true;
  kind.relaxes = scene.loading.has_value();
  kind.particles = start.size();
  kind.fixed = kind.keeps_state = false;
  kind.floats = scene.rule.rounds == nullptr && options.precision == Precision::float32;
  kind.displaced = std::ranges::any_of(scene.rule.types, &ParticleType::pd);
  kind.initial = [&scene, &start](uint32_t id) {
    return (scene.loading || scene.rule.rounds ? scene.packing() : start).x[id];
  };
  // Velocity Verlet's next step needs the forces of the last one, at its half-step velocities.
  kind.saves = options.integrator == Integrator::semi_implicit_euler;
  kind.make = [&scene, &start, options, cell_edge](CheckpointReader* from, bool) {
    if (!from) return reference_at(scene, start, options, cell_edge, 0, nullptr);
    return reference_at(scene, saved_body(*from, scene.rule, start, options.precision), options, cell_edge,
                        from->head().step, &from->head().engine.own);
  };
  return kind;
}

std::unique_ptr<Engine> scene_reference(const Scene& scene, const Body& body, const RealOptions& options,
                                        double cell_edge, uint64_t step, const std::vector<uint64_t>& own) {
  check_loading(scene, options);
  return reference_at(scene, body, options, cell_edge, step, own.empty() ? nullptr : &own);
}

}  // namespace cuboct
