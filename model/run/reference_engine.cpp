// SPDX-License-Identifier: MIT
#include "model/run/reference_engine.h"

#include <fmt/format.h>

#include <stdexcept>

#include "model/base/error.h"
#include "model/rules/rounds_rule.h"

namespace cuboct {

void refuse_box(const Scene& scene, uint64_t step) {
  if (!scene.deforms()) return;
  if (const std::string fault = box_fault(scene, step + 1); !fault.empty())
    throw StepError({Fault::none, step, 0, 0, 0, fault});
}

RealOptions from_step(RealOptions options, const Scene& scene, uint64_t step) {
  options.first_step = step;
  if (scene.deforms()) options.deform = scene.deform;
  return options;
}

ReferenceEngine::ReferenceEngine(const Scene& scene, const Body& body, const RealOptions& options,
                                 double cell_edge, uint64_t step)
    : scene_(scene),
      options_(from_step(options, scene, step)),
      cell_edge_(cell_edge),
      reference_(scene.rule, body, scene.box_at(step), options_) {}

void ReferenceEngine::advance(uint64_t steps, std::vector<uint64_t>*) {
  const uint64_t before = step_count();
  for (uint64_t done = 0; done < steps; ++done) {
    refuse_box(scene_, before + done);
    try {
      reference_.step();
    } catch (const std::runtime_error& error) {
      throw StepError({Fault::none, before + done, 0, 0, 0, error.what()});
    }
  }
}

RunState ReferenceEngine::frame(bool forces) {
  const Body& body = reference_.body();
  return RealFrame{step_count(), body.x, body.v, forces ? reference_.forces() : std::vector<Vec3>(), body.u};
}

Reading ReferenceEngine::read(const Asked& asked) {
  const bool half_step = options_.integrator == Integrator::semi_implicit_euler;
  return read_reference(scene_.rule, reference_, half_step ? scene_.rule.dt / 2 : 0, asked);
}

double ReferenceEngine::largest_speed() { return reference_.largest_speed() * scene_.rule.dt / cell_edge_; }

Notes ReferenceEngine::notes() {
  return {{"precision", options_.precision == Precision::float32 ? "float" : "double"},
          {"integrator",
           options_.integrator == Integrator::velocity_verlet ? "velocity Verlet" : "semi-implicit Euler"}};
}

Body saved_body(CheckpointReader& from, const Rule& rule, const Body& start, Precision precision) {
  if (from.head().engine.counters[0] != static_cast<uint64_t>(precision))
    throw InputError(fmt::format("{} was made with another --precision", from.path()),
                     "resume with the options of the run that wrote it");
  if (from.head().particles != start.size())
    throw InputError(fmt::format("{} holds {} particles, the scene has {}", from.path(),
                                 from.head().particles, start.size()));
  Body body;
  body.type = start.type;
  std::vector<uint64_t> kept;
  from.next(body, kept);
  body = with_bonds(rule, std::move(body), start);
  if (body.bonds) body.bonds = std::make_shared<BondState>(BondState{body.bonds->packed, std::move(kept)});
  return body;
}

}  // namespace cuboct
