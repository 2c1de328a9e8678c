// SPDX-License-Identifier: MIT
// Bodies brought to rest.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/base/interrupt.h"
#include "model/real/balance.h"
#include "study/stability/stability.h"
#include "study/sweep/measure_run.h"

namespace cuboct::study {
namespace {

// A particle is at rest where its force would move it, against the stiffest site of the body, by less than
// this part of the cutoff: a thousandth of the smallest seed of a trial.
constexpr double kAtRest = 1e-9;
constexpr size_t kMostTypes = 256;  // a type is a byte

Balance balance_of(const Scene& scene) { return {scene.rule, scene.body, scene.periodic, 1}; }

// m/s^2, of the pair law and the PD controllers at rest, over the free axes.
std::vector<Vec3> accelerations(const Scene& scene) {
  std::vector<Vec3> a = balance_of(scene).forces();
  for (size_t i = 0; i < a.size(); ++i) a[i] /= scene.rule.mass_of(scene.body.type[i]);
  return a;
}

double largest(const std::vector<Vec3>& values) {
  double most = 0;
  for (const Vec3& value : values) most = std::max(most, value.norm());
  return most;
}

// rad^2/s^2: the stiffest site. Between a third of the largest squared frequency and all of it, in a packing.
double stiffest_site(const Scene& scene) {
  const Vibrations vibrations = vibrations_of(scene.rule, scene.body, scene.periodic);
  return vibrations.stiffness.rows() > 0 ? vibrations.stiffness.diagonal().maxCoeff() : 0.0;
}

// Whether the body came to rest.
bool relax(Scene& scene, double tolerance) {
  constexpr uint64_t kMostEvaluations = 20000;
  Balance balance = balance_of(scene);
  double left = 0;
  balance.relax(
      [&](const std::vector<Vec3>& forces) {
        if (interrupted()) throw Interrupted();
        left = 0;
        for (size_t i = 0; i < forces.size(); ++i)
          left = std::max(left, forces[i].norm() / scene.rule.mass_of(scene.body.type[i]));
        return left < tolerance;
      },
      kMostEvaluations);
  scene.body.x = balance.body().x;
  scene.body.u = balance.body().u;
  return left < 100 * tolerance;
}

// Gives each particle a type whose gravity is against its acceleration. False where that takes too many.
bool hold_still(Scene& scene, double tolerance) {
  const std::vector<Vec3> a = accelerations(scene);
  const std::vector<ParticleType> before = scene.rule.types;
  std::vector<ParticleType> types;
  std::vector<uint8_t> of;  // [new type]: the old one
  for (size_t i = 0; i < a.size(); ++i) {
    const uint8_t old = scene.body.type[i];
    size_t k = 0;
    while (k < types.size() && (of[k] != old || (types[k].gravity + a[i]).norm() > tolerance)) ++k;
    if (k == kMostTypes) return false;
    if (k == types.size()) {
      types.push_back(before[old]);
      types.back().gravity = -a[i];
      of.push_back(old);
    }
    scene.body.type[i] = static_cast<uint8_t>(k);
  }
  scene.rule.types = std::move(types);
  return true;
}

// FIRE keeps a body's symmetry, and may come to rest on a saddle: from there it is shaken, and relaxed again.
bool relax_to_minimum(Scene& scene, double tolerance) {
  constexpr int kMostShakes = 3;
  uint64_t dice = 1;
  for (int shake = 0; relax(scene, tolerance); ++shake) {
    const Limit limit = stability_limit(vibrations_of(scene.rule, scene.body, scene.periodic));
    if (shake == kMostShakes || !limit.body_unstable()) return true;
    for (size_t i = 0; i < scene.body.size(); ++i)
      for (int axis = 0; axis < 3; ++axis) {
        dice = dice * 6364136223846793005u + 1442695040888963407u;
        const double shift = 1e-3 * scene.rule.cutoff() * (static_cast<double>(dice >> 11) * 0x1p-52 - 1);
        if (scene.rule.types[scene.body.type[i]].imposed[axis]) continue;
        scene.body.x[i][axis] += shift;
        if (!scene.body.u.empty()) scene.body.u[i][axis] += shift;
      }
  }
  return false;
}

void stretch(Scene& scene, int axis, double strain) {
  for (Vec3& x : scene.body.x) x[axis] += strain * (x[axis] - scene.periodic.origin[axis]);
  scene.periodic.extent[axis] *= 1 + strain;
}

}  // namespace

Scene with_parts(Scene scene, const Parts& parts) {
  Rule& rule = scene.rule;
  if (!parts.damping) rule.damping.coefficient = 0;
  if (!parts.strengths) {
    for (auto& row : rule.strength) std::fill(row.begin(), row.end(), 1.0);
    rule.other_laws.clear();
    rule.law_index.clear();
  }
  for (ParticleType& type : rule.types) {
    if (!parts.imposed) type.imposed = {false, false, false};
    if (!parts.pd) type.pd = false, type.kp = type.kd = 0;
    if (type.pd && !parts.damping) type.kd = 0;
  }
  return scene;
}

Subject subject_of(const Scene& scene, int axis, double strain) {
  Subject out{scene, {}, "", true};
  Scene& s = out.scene;
  for (ParticleType& type : s.rule.types) type.velocity = type.gravity = type.pull = Vec3::Zero();
  std::fill(s.body.v.begin(), s.body.v.end(), Vec3::Zero());
  s.body.u.clear();
  s.steps = 0, s.probes.clear();
  s.reach_margin = Vec3::Constant(-1), s.reach = {Vec3::Zero(), Vec3::Zero()};

  const auto tolerance = [&] { return kAtRest * s.rule.cutoff() * stiffest_site(s); };
  const auto give_up = [&](const std::string& why) {
    out.note += (out.note.empty() ? "" : "; ") + why;
    out.measurable = false;
  };
  if (const double start = tolerance(); start > 0 && largest(accelerations(s)) > start) {
    const std::vector<Vec3> x = s.body.x;
    const bool rests = relax_to_minimum(s, start);
    double farthest = 0;
    for (size_t i = 0; i < x.size(); ++i) farthest = std::max(farthest, (s.body.x[i] - x[i]).norm());
    if (rests) {
      out.note = fmt::format("relaxed first: particles moved by up to {:.2g} {}", farthest / length_unit(s),
                             s.pitch > 0 ? "pitches" : "cutoffs");
    } else {
      give_up("the body does not come to rest");
    }
  }
  if (strain != 0) {
    stretch(s, axis, strain);
    if (const double now = tolerance(); now > 0 && largest(accelerations(s)) > now) {
      if (!hold_still(s, 10 * now))
        give_up(fmt::format("held as stretched it would need more than {} types", kMostTypes));
    }
  }
  out.limit = stability_limit(vibrations_of(s.rule, s.body, s.periodic));
  if (!std::isfinite(out.limit.dt))
    give_up("nothing is restored or damped");
  else if (out.limit.body_unstable())
    give_up("the body itself is unstable: no dt cures that");
  return out;
}

}  // namespace cuboct::study
