// SPDX-License-Identifier: MIT
#include "model/run/static_engine.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "model/base/error.h"
#include "model/base/interrupt.h"

namespace cuboct {
StaticEngine::StaticEngine(const Scene& scene, const Body& body, int threads, double cell_edge, uint64_t step)
    : scene_(scene),
      threads_(threads),
      cell_edge_(cell_edge),
      step_(step),
      balance_(scene.rule, body, scene.periodic, threads) {
  relax();
}

void StaticEngine::relax() {
  const StaticLoading& loading = *scene_.loading;
  Unbalance left;
  FireResult result;
  try {
    result = balance_.relax(
        [&](const std::vector<Vec3>&) {
          left = balance_.unbalance();
          return left.within(loading.tolerance);
        },
        loading.evaluations);
  } catch (const std::runtime_error& error) {
    throw StepError({Fault::none, step_, 0, 0, 0, error.what()});
  }
  evaluations_ += result.evaluations;
  if (!result.at_rest)
    throw StepError(
        {Fault::none, step_, 0, 0, 0,
         fmt::format("step {}: the body finds no rest: after {} force evaluations {:.3g} N are "
                     "unbalanced, the load is {:.3g} N; is a part of it free to fall or to drift?",
                     step_, result.evaluations, left.residual, left.load)});
  if (left.residual > left.least) largest_share_ = std::max(largest_share_, left.share());
  largest_residual_ = std::max(largest_residual_, left.residual);
}

void StaticEngine::advance(uint64_t steps, std::vector<uint64_t>*) {
  const uint64_t every = scene_.loading->every;
  for (const uint64_t end = step_ + steps; step_ < end;) {
    const uint64_t next = (step_ / every + 1) * every;
    if (next > end) {
      step_ = end;
      return;
    }
    balance_.go_on(static_cast<double>(every) * scene_.rule.dt);
    step_ = next;
    relax();
    ++load_steps_;
    if (interrupted()) return;
  }
}

uint64_t StaticEngine::hash() { throw std::logic_error("states in real numbers have no hash"); }

RunState StaticEngine::frame(bool forces) {
  const Body& body = balance_.body();
  return RealFrame{step_, body.x, body.v, forces ? balance_.reference().forces() : std::vector<Vec3>(),
                   body.u};
}

Reading StaticEngine::read(const Asked& asked) {
  Reading reading = read_reference(scene_.rule, balance_.reference(), 0, asked);
  reading.step = step_;
  return reading;
}

double StaticEngine::largest_speed() {
  double most = 0;
  for (const ParticleType& type : scene_.rule.types)
    most = std::max(most, type.velocity.cwiseAbs().maxCoeff());
  return most * scene_.rule.dt / cell_edge_;
}

Counters StaticEngine::counters() {
  return {{"threads", threads_},
          {"load_steps", static_cast<double>(load_steps_)},
          {"force_evaluations", static_cast<double>(evaluations_)}};
}

Notes StaticEngine::notes() {
  return {{"precision", "double"},
          {"loading",
           fmt::format("static: at each load step {:.2g} of the load is unbalanced at most, where {:.2g} "
                       "is allowed",
                       largest_share_, scene_.loading->tolerance)}};
}

EngineKind static_kind(const Scene& scene, const Body& start, int threads, double cell_edge) {
  EngineKind kind;
  kind.name = "reference";
  kind.particles = start.size();
  kind.fixed = kind.keeps_state = false;
  kind.displaced = std::ranges::any_of(scene.rule.types, &ParticleType::pd);
  kind.relaxes = true;
  kind.initial = [&start](uint32_t id) { return start.x[id]; };
  kind.make = [&scene, &start, threads, cell_edge](CheckpointReader*, bool) {
    return std::make_unique<StaticEngine>(scene, start, threads, cell_edge);
  };
  return kind;
}

void refuse_static(const Scene& scene, const std::string& who) {
  if (scene.loading)
    throw InputError(fmt::format("{}: static loading is not for {}", scene.path, who),
                     "'cuboct run' with the reference engine relaxes; 'static = false' lets the body move");
}

}  // namespace cuboct
