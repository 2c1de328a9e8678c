// SPDX-License-Identifier: MIT
#include "model/run/static_engine.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <stdexcept>

#include "model/base/error.h"
#include "model/base/interrupt.h"
#include "model/rules/rounds_rule.h"
#include "model/run/bond_counters.h"
#include "model/run/reference_engine.h"

namespace cuboct {
namespace {

constexpr size_t kHeadWords = 7;  // of the memory

void add(std::vector<uint64_t>& words, const std::vector<Vec3>& values) {
  for (const Vec3& value : values)
    for (const double number : value) words.push_back(std::bit_cast<uint64_t>(number));
}

std::vector<Vec3> vectors(const std::vector<uint64_t>& words, size_t from, size_t count) {
  std::vector<Vec3> values(count);
  for (size_t i = 0; i < count; ++i)
    for (int a = 0; a < 3; ++a)
      values[i][a] = std::bit_cast<double>(words[from + 3 * i + static_cast<size_t>(a)]);
  return values;
}

}  // namespace

StaticEngine::StaticEngine(const Scene& scene, const Body& body, int threads, double cell_edge)
    : scene_(scene),
      threads_(threads),
      cell_edge_(cell_edge),
      step_(0),
      balance_(scene.rule, body, scene.box_at(0), threads) {
  const auto any = [&](const Vec3 ParticleType::*of) {
    return std::ranges::any_of(scene.rule.types,
                               [&](const ParticleType& type) { return !(type.*of).isZero(); });
  };
  const bool pulled = any(&ParticleType::gravity), moved = any(&ParticleType::velocity);
  if (scene.packed || !(pulled || moved)) return;
  balance_.load(false);
  relax();
  balance_.load(true);
  rests_ = !pulled;
}

StaticEngine::StaticEngine(const Scene& scene, const Body& body, int threads, double cell_edge, uint64_t step,
                           const std::vector<uint64_t>& own)
    : scene_(scene),
      threads_(threads),
      cell_edge_(cell_edge),
      step_(step),
      // The body stands in the box of the last load step.
      balance_(scene.rule, body, scene.box_at(step), threads) {
  const size_t n = body.size(), anchors = balance_.body().u.size();
  const size_t before = own.size() > kHeadWords ? own[6] : 0;
  if (own.size() < kHeadWords || (before != 0 && before != n) ||
      own.size() != kHeadWords + 3 * (before + anchors) + (scene.deforms() ? 1 : 0))
    throw InputError("the checkpoint is not of static loading of this scene", "begin anew with --force");
  load_steps_ = own[0], evaluations_ = own[1];
  largest_share_ = std::bit_cast<double>(own[2]), largest_residual_ = std::bit_cast<double>(own[3]);
  rests_ = own[4] != 0;
  balance_.recall({std::bit_cast<double>(own[5]), vectors(own, kHeadWords, before),
                   vectors(own, kHeadWords + 3 * before, anchors),
                   scene.deforms() ? std::bit_cast<double>(own.back()) : 0});
}

EngineMemory StaticEngine::memory() {
  const Balance::Memory memory = balance_.memory();
  std::vector<uint64_t> own{load_steps_,
                            evaluations_,
                            std::bit_cast<uint64_t>(largest_share_),
                            std::bit_cast<uint64_t>(largest_residual_),
                            uint64_t{rests_},
                            std::bit_cast<uint64_t>(memory.stiffness),
                            memory.before.size()};
  add(own, memory.before);
  add(own, memory.anchor);
  if (scene_.deforms()) own.push_back(std::bit_cast<uint64_t>(memory.box_load));
  return {{uint64_t{0}}, own};  // doubles
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
  if (steps > 0 && !rests_) relax(), rests_ = true;
  for (const uint64_t end = step_ + steps; step_ < end;) {
    const uint64_t next = (step_ / every + 1) * every;
    if (next > end) {
      step_ = end;
      return;
    }
    refuse_box(scene_, next - 1);
    if (scene_.deforms()) balance_.stretch(scene_.box_at(next));
    balance_.go_on(static_cast<double>(every) * scene_.rule.dt);
    step_ = next;
    relax();
    ++load_steps_;
    if (interrupted()) return;
  }
}

RunState StaticEngine::frame(bool forces) {
  const Body& body = balance_.body();
  const RoundsTerms* terms = balance_.reference().terms();
  return RealFrame{step_,  body.x,
                   body.v, forces ? balance_.reference().forces() : std::vector<Vec3>(),
                   body.u, terms ? terms->shown() : std::vector<std::vector<double>>()};
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
          {kEvaluations, static_cast<double>(evaluations_)}};
}

Counters StaticEngine::counters_of_state() {
  const RoundsTerms* terms = balance_.reference().terms();
  return terms ? bond_counters(scene_.rule, *terms, balance_.body().size()) : Counters();
}

Notes StaticEngine::notes() {
  return {{"precision", "double"},
          {"loading",
           fmt::format("static: at each load step {:.2g} of the load is unbalanced at most, where {:.2g} "
                       "is allowed",
                       largest_share_, scene_.loading->tolerance)}};
}

void refuse_deform(const Scene& scene, const std::string& who) {
  if (scene.deforms())
    scene.places.fail({"run.deform", "box.deform"}, fmt::format("a box that deforms is not for {}", who),
                      "--engine reference carries its particles along");
}

void refuse_static(const Scene& scene, const std::string& who) {
  if (scene.loading)
    scene.places.fail({"run.static"}, fmt::format("static loading is not for {}", who),
                      "the reference engine relaxes; 'static = false' lets the body move");
}

}  // namespace cuboct
