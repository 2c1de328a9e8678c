// SPDX-License-Identifier: MIT
#include "cli/run/crosscheck_real.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/analysis/real_bounds.h"
#include "model/base/interrupt.h"
#include "model/base/process.h"
#include "model/base/steps.h"
#include "model/base/text.h"
#include "model/real/reference.h"

namespace cuboct {
namespace {

double largest(const std::vector<Vec3>& of) {
  double most = 0;
  for (const Vec3& value : of) most = std::max(most, value.norm());
  return most;
}

// What is told of a comparison: lines for people, and the same for scripts.
struct Told {
  const Answer& answer;
  std::vector<Items> errors{};
};

// The particle whose error is the largest share of its bound. Whether all are within.
template <class Bound>
bool tell(Told& told, const std::string& what, const std::vector<Vec3>& got, const std::vector<Vec3>& exact,
          Bound bound, const char* unit, const std::string& more) {
  double worst = -1, most = 0;
  size_t at = 0;
  for (size_t i = 0; i < got.size(); ++i) {
    const double error = (got[i] - exact[i]).norm();
    const double share = error > 0 || std::isnan(error) ? error / bound(i) : 0;
    most = std::max(most, error);
    if (share > worst || std::isnan(share)) worst = share, at = i;
    if (std::isnan(share)) break;
  }
  Items& items = told.errors.emplace_back();
  items.add("of", what);
  items.add("largest_error", most);
  items.add("unit", unit);
  items.add("particle", uint64_t{at});
  items.add("error", (got[at] - exact[at]).norm());
  items.add("bound", double{bound(at)});
  told.answer.say("{}: largest error {:.3g} {}{}; nearest to its bound: particle {}, {:.3g} of {:.3g} {}\n",
                  what, most, unit, more, at, (got[at] - exact[at]).norm(), bound(at), unit);
  if (worst <= 1) return true;
  told.answer.say(
      "beyond its bound: particle {} has ({:.9g}, {:.9g}, {:.9g}) {}, the reference ({:.9g}, {:.9g}, "
      "{:.9g})\n",
      at, got[at][0], got[at][1], got[at][2], unit, exact[at][0], exact[at][1], exact[at][2]);
  return false;
}

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

}  // namespace

int crosscheck_real(const Input& input, const EngineOptions& choice, std::optional<uint64_t> steps,
                    const std::string& out, const Answer& answer) {
  const Loaded loaded = load_plan(input);
  const Scene& scene = loaded.scene;
  catch_interrupts();
  const bool floats = choice.precision == "float";
  const uint64_t last = steps.value_or(std::min(scene.steps, kRealSteps));
  const Short exact(scene, floats, last);
  RunRequest request;
  request.steps = last;
  request.frames = {0, exact.step, last};
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
  bool within = check_forces(told, scene, trace.bodies.front(), floats, "at the start");
  if (last > 0)
    within &= check_forces(told, scene, trace.bodies.back(), floats, fmt::format("after {} steps", last));
  for (const RealFrame& frame : trace.bodies)
    if (frame.step == exact.step && exact.step > 0)
      within &= tell(
          told, fmt::format("positions after {} steps", exact.step), frame.x, exact.x,
          [&](size_t) { return exact.bound; }, "m",
          fmt::format(" (of the reference in floats {:.3g} m)", exact.of_floats));
  if (within)
    answer.say("within bounds: {} particles over {} steps, gpu in {} against the reference in doubles\n",
               scene.body.size(), last, floats ? "floats" : "doubles");
  return within ? end("within bounds", 0) : end("beyond bounds", 1);
}

}  // namespace cuboct
