// SPDX-License-Identifier: MIT
#include "model/analysis/real_bounds.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "model/contract/neighbours.h"

namespace cuboct {
namespace {

// Half ulps that the evaluation of one pair's force loses, against the sum of the sizes of its parts:
// tests/gpu/real_rule_tests.cpp counts them law by law.
constexpr double kEvaluation = 72;
// The damping's: a product of ten roundings, and 1 - r^2 whose argument is off by 3.
constexpr double kDamping = 24;

// The sizes of the parts of a law's force, summed: what its roundings are relative to, N.
class PartsOf {
 public:
  explicit PartsOf(const PairLaw& law)
      : law_(law), form_(law.form()), jump_(std::abs(law.force(law.cutoff() * (1 - 1e-12)))) {
    for (int k = 0; k <= kSamples; ++k) {
      const double r = law.core() + (law.cutoff() - law.core()) * k / kSamples;
      largest_pull_ = std::max(largest_pull_, -law.force(r * (1 - 1e-12)));
    }
  }
  const PairLaw& law() const { return law_; }
  double jump() const { return jump_; }  // at its cutoff, N
  double at(double r) const {
    const double near = std::max(r, law_.core()), inside = std::min(r / near, 1.0);
    if (const auto* lj = std::get_if<LennardJonesForm>(&form_)) {
      const double q = std::pow(lj->sigma / near, 6);
      return inside * (24 * lj->epsilon * (2 * q * q + q) / near + std::abs(lj->offset));
    }
    return inside * (near * std::abs(law_.slope(near)) + std::abs(law_.force(near)) + largest_pull_);
  }

 private:
  static constexpr int kSamples = 1024;
  const PairLaw& law_;
  LawForm form_;
  double jump_, largest_pull_ = 0;
};

}  // namespace

Roundings gpu_roundings(const Scene& scene, bool floats) {
  const double u = floats ? 0x1p-24 : 0x1p-53, cutoff = scene.rule.cutoff();
  // Positions are at most 2.6 cutoffs long along an axis; the engine allows 32 u for a difference of two.
  return {u, std::sqrt(3) * 2.6 * u * cutoff, 32 * u * cutoff};
}

Roundings reference_roundings(const Scene& scene) {
  double farthest = 0;
  for (const Vec3& x : scene.body.x) farthest = std::max(farthest, x.norm());
  const double u = 0x1p-53, far = 2 * farthest + scene.rule.cutoff();
  return {u, u * far, 3 * u * far};
}

ForceBounds force_bounds(const Scene& scene, const std::vector<Vec3>& x, const std::vector<Vec3>& v,
                         const Roundings& of) {
  const Rule& rule = scene.rule;
  std::vector<PartsOf> laws;
  for (size_t k = 0; k < rule.laws(); ++k) laws.emplace_back(rule.law_at(k));
  const double cutoff = rule.cutoff(), margin = 2 * of.difference, u = of.unit;
  const size_t n = x.size();
  struct Sum {
    double error = 0, force = 0, stiffness = 0, friction = 0;
    int pairs = 0;
  };
  std::vector<Sum> sums(n);
  CellList cells(cutoff, scene.periodic, margin);
  cells.build(x);
  cells.for_each_pair(x, [&](uint32_t i, uint32_t j, const Vec3&, double r) {
    const int type_i = scene.body.type[i], type_j = scene.body.type[j];
    const double strength = rule.strength_of(type_i, type_j);
    const PartsOf& parts = laws[rule.law_index_of(type_i, type_j)];
    const PairLaw& law = parts.law();
    const bool touch = rule.only_touch(type_i, type_j);
    const double reach = rule.reach(type_i, type_j);
    if (touch && r > reach + margin) return;
    Sum one;
    one.pairs = 1;
    // Of both ends of what the distance may be: a joint, the core or the cutoff may lie between.
    const double end = law.cutoff() * (1 - 1e-12);
    for (const double at : {std::min(std::max(r - margin, 0.5 * r), end), std::min(r + margin, end)}) {
      if (r > law.cutoff() + margin) break;
      const double near = std::max(at, law.core());
      const double over_r = std::abs(law.force(near)) / near;
      one.stiffness = std::max({one.stiffness, std::abs(law.slope(near)), over_r});
      one.force = std::max(one.force, over_r * at);
      one.error = std::max(one.error, kEvaluation * u * parts.at(at));
    }
    one.error += one.stiffness * of.difference;
    if (std::abs(r - law.cutoff()) < margin) one.error += parts.jump();
    if (rule.damping.coefficient > 0) {
      const Vec3 w = v[j] - v[i];
      const double near = std::max(std::min(r, cutoff), rule.core()),
                   c = rule.damping_over_r2(near) * near * near;
      // c w.e e: its change by d over d is at most that of c, 4/cutoff of it at c's largest, and twice 1/r.
      const double change =
          w.norm() * (4 * rule.damping.coefficient / cutoff + 2 * c / near) / near * std::min(r, near);
      one.friction = c;
      one.stiffness += change;
      one.error += change * of.difference + kDamping * u * rule.damping.coefficient * w.norm() +
                   2 * u * c * (v[i].norm() + v[j].norm());
      // A pair that only touches is damped up to its reach, and not at all from there on.
      if (touch && r > reach - margin) one.error += c * w.norm();
      one.force += c * w.norm();
    }
    for (const uint32_t k : {i, j}) {
      sums[k].error += strength * one.error;
      sums[k].force += strength * one.force;
      sums[k].stiffness += strength * one.stiffness;
      sums[k].friction += strength * one.friction;
      ++sums[k].pairs;
    }
  });
  ForceBounds bounds;
  bounds.force.reserve(n);
  for (const Sum& sum : sums) {
    bounds.force.push_back(sum.error + sum.pairs * u * sum.force);
    // A pair's force changes with both of its ends.
    bounds.stiffness = std::max(bounds.stiffness, 2 * sum.stiffness);
    bounds.friction = std::max(bounds.friction, 2 * sum.friction);
  }
  return bounds;
}

void ErrorGrowth::step(const ForceBounds& bounds, double speed) {
  const Rule& rule = scene_.rule;
  double kp = 0, kd = 0, gravity = 0;
  for (const ParticleType& type : rule.types) {
    if (type.pd) kp = std::max(kp, type.kp), kd = std::max(kd, type.kd);
    gravity = std::max(gravity, type.gravity.norm());
  }
  if (!begun_) v_ = of_.unit * speed;
  begun_ = true;
  const double worst = bounds.force.empty() ? 0 : *std::max_element(bounds.force.begin(), bounds.force.end());
  const double gain = rule.dt / rule.mass;
  v_ += gain * (worst + (bounds.stiffness + kp) * x_ + (bounds.friction + kd) * v_) +
        of_.unit * (2 * speed + 4 * rule.dt * gravity);
  // Rounded where it is moved, and where it changes cells.
  x_ += rule.dt * v_ + 2 * of_.position;
}

}  // namespace cuboct
