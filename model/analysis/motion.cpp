// SPDX-License-Identifier: MIT
#include "model/analysis/motion.h"

#include <algorithm>
#include <cmath>

#include "model/base/dense.h"
#include "model/contract/law.h"
#include "model/rules/rounds_rule.h"

namespace cuboct {
namespace {

bool moves_freely(const ParticleType& type) { return type.imposed != std::array<bool, 3>{true, true, true}; }

// Formats that a state brings along already hold its motion: the scene then adds what it would have from its
// packing, so that a run in two parts has the formats of the whole.
const Body& planned_body(const Scene& scene) { return scene.body.exact ? scene.packing() : scene.body; }

// Of the bond between nearest neighbours at rest, and their distance.
void read_bond(const Scene& scene, Motion& motion) {
  const Rule& rule = scene.whole ? *scene.whole : scene.rule;
  if (const RoundsRule* rounds = rule.rounds.get()) {
    motion.rest_distance = scene.pitch > 0 ? scene.pitch : rule.cutoff();
    motion.bond_stiffness = rounds->stiffness();
    motion.sound_speed = rounds->sound_speed(rule.mass);
    return;
  }
  const double rest = stiffest_rest_distance(rule.law_at(0));
  motion.rest_distance = scene.pitch > 0 ? scene.pitch : rest > 0 ? rest : rule.cutoff();
  if (scene.pitch > 0 || rest > 0) motion.bond_stiffness = stiffest_bond(rule, motion.rest_distance);
  if (motion.bond_stiffness == 0 &&
      scene.dt_limit > 0)  // that of a packing with this fastest vibration, sqrt(8 k/m)
    motion.bond_stiffness = rule.mass / (2 * scene.dt_limit * scene.dt_limit);
  double rate = motion.bond_stiffness / rule.mass;
  // The strongest bonds may be those of heavy particles.
  double fastest = 0;
  for (size_t k = 0; !rule.masses.empty() && k < rule.laws(); ++k)
    fastest = std::max(fastest, -rule.law_at(k).slope(motion.rest_distance) * rule.largest_rate(k));
  if (fastest > 0) rate = fastest / rule.mass;
  motion.sound_speed = motion.rest_distance * std::sqrt(rate);
}

// Root mean squares of the free particles' velocities: all, that of the rotation as a rigid body, and what is
// left.
struct Speeds {
  double all = 0, rotation = 0, left = 0;
  Vec3 mean = Vec3::Zero();
};

Speeds speeds_of(const Scene& scene) {
  const Body& body = planned_body(scene);
  const auto each_free = [&](auto see) {
    for (size_t i = 0; i < body.size(); ++i)
      if (moves_freely(scene.rule.types[body.type[i]])) see(body.x[i], body.v[i]);
  };
  Vec3 centre = Vec3::Zero(), mean = Vec3::Zero();
  double count = 0, all = 0;
  each_free([&](const Vec3& x, const Vec3& v) { centre += x, mean += v, all += v.squaredNorm(), ++count; });
  if (count == 0 || all == 0) return {};
  centre /= count, mean /= count;
  Vec3 turning = Vec3::Zero();
  Mat3 inertia = Mat3::Zero();
  each_free([&](const Vec3& x, const Vec3& v) {
    const Vec3 r = x - centre;
    turning += r.cross(v - mean);
    inertia += r.squaredNorm() * Mat3::Identity() - r * r.transpose();
  });
  const Vec3 omega = least_squares(inertia, turning);
  double rotation = 0, left = 0;
  each_free([&](const Vec3& x, const Vec3& v) {
    const Vec3 rigid = omega.cross(x - centre);
    rotation += rigid.squaredNorm();
    left += (v - mean - rigid).squaredNorm();
  });
  return {std::sqrt(all / count), std::sqrt(rotation / count), std::sqrt(left / count), mean};
}

struct Box {
  Vec3 low = Vec3::Constant(INFINITY), high = Vec3::Constant(-INFINITY);
  void add(const Vec3& x) { low = low.cwiseMin(x), high = high.cwiseMax(x); }
  bool empty() const { return low[0] > high[0]; }
};

// The largest strain by which gravity bends what reaches beyond the held particles; c and duration as c and T
// in Motion.
double bending(const Box& all, const Box& held, const Vec3& gravity, double c, double duration) {
  if (held.empty()) return 0;
  int along = 0;
  const double g = gravity.cwiseAbs().maxCoeff(&along);
  const double height = all.high[along] - all.low[along];
  double reach = 0;
  for (int a = 0; a < 3; ++a)
    if (a != along) reach = std::max({reach, held.low[a] - all.low[a], all.high[a] - held.high[a]});
  if (!(height > 0) || !(reach > height)) return 0;
  return std::min(3 * g * reach * reach / (c * c * height),
                  0.75 * height * g * duration * duration / (reach * reach));
}

// By type: what its particles span, where a force pulls them.
std::vector<Box> pulled_boxes(const Scene& scene) {
  std::vector<Box> boxes(scene.rule.types.size());
  const Body& body = planned_body(scene);
  for (size_t i = 0; i < body.size(); ++i)
    if (!scene.rule.types[body.type[i]].pull.isZero(0)) boxes[body.type[i]].add(body.x[i]);
  return boxes;
}

}  // namespace

bool driven(const ParticleType& type) { return type.pd || type.imposed != std::array<bool, 3>{}; }

Motion motion_of(const Scene& scene) {
  const Rule& rule = scene.rule;
  Motion motion;
  read_bond(scene, motion);
  const double c = motion.sound_speed, duration = scene.planned_duration();
  Box all, held;
  const Body& body = planned_body(scene);
  for (size_t i = 0; i < body.size(); ++i) {
    all.add(body.x[i]);
    if (driven(rule.types[body.type[i]])) held.add(body.x[i]);
  }
  const double length = std::max(all.empty() ? 0 : (all.high - all.low).maxCoeff(), motion.rest_distance);
  const auto strains = [&](double strain, StrainCause cause, const std::string& by) {
    strain = std::min(strain, kMostStrain);
    if (c > 0 && strain > motion.strain) motion.strain = strain, motion.cause = cause, motion.strain_of = by;
  };

  const std::vector<Box> pulled = pulled_boxes(scene);
  const bool all_driven = std::all_of(rule.types.begin(), rule.types.end(), driven);
  for (size_t t = 0; t < rule.types.size(); ++t) {
    const ParticleType& type = rule.types[t];
    const double speed = driven(type) ? type.velocity.norm() : 0;
    if (speed > 0) {
      motion.slowest_imposed = motion.slowest_imposed > 0 ? std::min(motion.slowest_imposed, speed) : speed;
      double apart = all_driven ? 0 : speed;
      for (const ParticleType& other : rule.types)
        if (driven(other)) apart = std::max(apart, (type.velocity - other.velocity).norm());
      strains(std::max(apart / c, apart * duration / length), StrainCause::imposed,
              "the velocity imposed on '" + type.name + "'");
    }
    // Of a force and a weight that balance, neither may be lost.
    if (const double g = std::max(type.gravity.norm(), type.pull.norm()); g > 0)
      motion.gravity = motion.gravity > 0 ? std::min(motion.gravity, g) : g;
    if (const double a = type.pull.norm(); a > 0) {
      // The stress is that of the pulled layer's mass: its depth counts, not the body's length.
      const Vec3 size = pulled[t].high - pulled[t].low;
      const double depth = type.pull.cwiseAbs().dot(size) / a + motion.rest_distance;
      strains(std::min(a * duration / c, a * depth / (c * c)), StrainCause::force,
              "the force on '" + type.name + "'");
    }
    const Vec3 weight = type.gravity - type.pull;
    if (const double g = weight.norm(); g > 1e-12 * type.gravity.norm()) {
      strains(std::min(g * duration / c, g * length / (c * c)), StrainCause::gravity, "gravity");
      if (!driven(type))
        strains(bending(all, held, weight, c, duration), StrainCause::bending, "gravity, which bends it");
    }
  }
  const Speeds speeds = speeds_of(scene);
  motion.initial_speed = speeds.all;
  // What rounding leaves of a fit is no motion.
  if (speeds.left > 1e-9 * speeds.all)
    strains(speeds.left / c, StrainCause::initial, "the initial velocities");
  if (speeds.all > 0)
    for (const ParticleType& type : rule.types)
      if (driven(type))
        strains((speeds.mean - type.velocity).norm() / c, StrainCause::initial, "the initial velocities");
  if (speeds.rotation > 1e-9 * speeds.all)
    strains(std::pow(speeds.rotation / c, 2), StrainCause::rotation, "the initial rotation");
  if (scene.expected_strain > 0)
    motion.strain = scene.expected_strain, motion.cause = StrainCause::said,
    motion.strain_of = "run.expected_strain";
  return motion;
}

}  // namespace cuboct
