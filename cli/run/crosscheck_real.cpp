// SPDX-License-Identifier: MIT
#include "cli/run/crosscheck_real.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <memory>

#include "cli/run/crosscheck_text.h"
#include "cli/run/told.h"
#include "hw/engine/scene_engine.h"
#include "model/analysis/real_bounds.h"
#include "model/base/interrupt.h"
#include "model/base/process.h"
#include "model/base/steps.h"
#include "model/base/text.h"
#include "model/real/reference.h"
#include "model/rules/rounds_rule.h"

namespace cuboct {
namespace {

RealOptions options_of(const Scene& scene, Precision precision) {
  RealOptions options;
  options.precision = precision;
  options.threads = reference_threads(scene.body.size());
  return options;
}

// The reference, as far as its distance from the gpu engine's run has a bound that tells something.
struct Short {
  Short(const Scene& scene, bool floats, uint64_t most);

  uint64_t step = 0;
  std::vector<Vec3> x;   // m
  double bound = 0;      // m, on the error of any particle, of both engines
  double of_floats = 0;  // m: largest error of the reference in floats
};

Short::Short(const Scene& scene, bool floats, uint64_t most) {
  Reference reference(scene.rule, scene.body, scene.periodic, options_of(scene, Precision::float64));
  Reference other(scene.rule, scene.body, scene.periodic, options_of(scene, Precision::float32));
  const Roundings mine = gpu_roundings(scene, floats), its = reference_roundings(scene);
  ErrorGrowth of_gpu(scene, mine), of_reference(scene, its);
  while (step < most && !interrupted()) {
    const Body& body = reference.body();
    const double speed = largest(body.v);
    of_gpu.step(force_bounds(scene, body.x, body.v, mine), speed);
    of_reference.step(force_bounds(scene, body.x, body.v, its), speed);
    const double next = of_gpu.position() + of_reference.position();
    if (step > 0 && next > kRealTold(floats) * scene.rule.cutoff()) break;
    bound = next;
    reference.step();
    other.step();
    ++step;
  }
  x = reference.body().x;
  for (size_t i = 0; i < x.size(); ++i) of_floats = std::max(of_floats, (other.body().x[i] - x[i]).norm());
}

bool check_forces(Told& told, const Scene& scene, const RealFrame& frame, bool floats,
                  const std::string& when) {
  Body body = scene.body;
  body.x = frame.x;
  body.v = frame.v;
  const std::vector<Vec3> exact =
      Reference(scene.rule, body, scene.periodic, options_of(scene, Precision::float64)).forces();
  const std::vector<double> mine = force_bounds(scene, body.x, body.v, gpu_roundings(scene, floats)).force;
  const std::vector<double> its = force_bounds(scene, body.x, body.v, reference_roundings(scene)).force;
  return tell(
      told, "forces " + when, frame.force, exact, [&](size_t i) { return mine[i] + its[i]; }, "N",
      fmt::format(", largest force {:.3g} N", largest(exact)));
}

// How far the reference ran, and what the engine's frames are compared with.
struct Comparison {
  uint64_t step;
  std::function<bool(Told&, const std::vector<RealFrame>&)> compare;
};

Comparison pair_comparison(const Scene& scene, bool floats, uint64_t last) {
  const auto exact = std::make_shared<Short>(scene, floats, last);
  return {exact->step, [&scene, floats, last, exact](Told& told, const std::vector<RealFrame>& frames) {
            bool within = check_forces(told, scene, frames.front(), floats, "at the start");
            if (last > 0)
              within &= check_forces(told, scene, frames.back(), floats, fmt::format("after {} steps", last));
            for (const RealFrame& frame : frames)
              if (frame.step == exact->step && exact->step > 0)
                within &= tell(
                    told, fmt::format("positions after {} steps", exact->step), frame.x, exact->x,
                    [&](size_t) { return exact->bound; }, "m",
                    fmt::format(" (of the reference in floats {:.3g} m)", exact->of_floats));
            return within;
          }};
}

Comparison text_comparison(const Scene& scene, bool floats, uint64_t last) {
  const auto exact = std::make_shared<TextComparison>(scene, floats, last);
  return {exact->step(),
          [exact](Told& told, const std::vector<RealFrame>& frames) { return exact->compare(told, frames); }};
}

}  // namespace

int crosscheck_real(const Input& input, const EngineOptions& choice, std::optional<uint64_t> steps,
                    const std::string& out, const Answer& answer) {
  const Loaded loaded = load_plan(input, "gpu", true);
  const Scene& scene = loaded.scene;
  check_runs(scene, loaded.setup.plan.arch, "gpu");
  catch_interrupts();
  const bool floats = choice.precision == "float";
  const uint64_t last = steps.value_or(std::min(scene.steps, kRealSteps));
  const Comparison comparison = scene.rule.rounds != nullptr ? text_comparison(scene, floats, last)
                                                             : pair_comparison(scene, floats, last);
  RunRequest request;
  request.steps = last;
  request.frames = {0, comparison.step, last};
  put_in_order(request.frames);
  request.hash_every = 0;
  request.forces = true;
  const Scratch scratch;
  const Trace trace = EngineRun("gpu", input, loaded, choice, request,
                                out.empty() ? scratch.path("gpu.h5") : out + "/gpu.h5", out.empty())
                          .finish()
                          .trace;
  if (interrupted()) throw Failed("interrupted");
  Told told{answer};
  const auto end = [&](const std::string& verdict, int code) {
    Items items;
    items.add("verdict", verdict);
    items.add("steps", trace.steps());
    items.add("precision", choice.precision);
    items.add_list("errors", "error", told.errors);
    if (answer.json) answer.close(items);
    return code;
  };
  if (trace.stop || trace.steps() != last) {
    const std::string why =
        trace.stop ? line_text(trace.stop->text) : fmt::format("ended at step {}", trace.steps());
    answer.say("gpu: {}\n", why);
    return end("gpu: " + why, 1);
  }
  const bool within = comparison.compare(told, trace.bodies);
  if (within)
    answer.say("within bounds: {} particles over {} steps, gpu in {} against the reference in doubles\n",
               scene.body.size(), last, floats ? "floats" : "doubles");
  return within ? end("within bounds", 0) : end("beyond bounds", 1);
}

}  // namespace cuboct
