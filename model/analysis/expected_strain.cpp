// SPDX-License-Identifier: MIT
#include "model/analysis/expected_strain.h"

#include <algorithm>
#include <cmath>

#include "model/analysis/clusters.h"
#include "model/analysis/motion.h"
#include "model/contract/law.h"
#include "model/contract/neighbours.h"

namespace cuboct {
namespace {

struct Bond {
  uint32_t i, j;
  Vec3 e;
  double stiffness;  // N/m
};

using Field = std::vector<Vec3>;

double dot(const Field& a, const Field& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
  return sum;
}

// Which particles hang, by bonds, on one that is held or led.
std::vector<char> supported(const Rule& rule, std::span<const uint8_t> type, const std::vector<Bond>& bonds) {
  Clusters parts(type.size());
  for (const Bond& b : bonds) parts.join(b.i, b.j);
  std::vector<char> held(type.size(), 0);
  for (uint32_t i = 0; i < type.size(); ++i)
    if (driven(rule.types[type[i]])) held[parts.find(i)] = 1;
  for (uint32_t i = 0; i < type.size(); ++i) held[i] = held[parts.find(i)];
  return held;
}

// The equilibrium K u = f over the axes that are free, by conjugate gradients. Bonds are springs along
// themselves alone: other shells of a packing, and what bonds under load do across themselves, are left out.
class Equilibrium {
 public:
  Equilibrium(const Rule& rule, std::span<const uint8_t> type, std::vector<Bond> bonds)
      : rule_(rule), type_(type), bonds_(std::move(bonds)) {}

  // Stiffness times u, N.
  Field times(const Field& u) const {
    Field f(u.size(), Vec3::Zero());
    for (const Bond& b : bonds_) {
      const Vec3 w = u[b.i] - u[b.j];
      const Vec3 pull = b.stiffness * b.e.dot(w) * b.e;
      f[b.i] += pull;
      f[b.j] -= pull;
    }
    for (size_t i = 0; i < u.size(); ++i)
      if (const ParticleType& t = rule_.types[type_[i]]; t.pd) f[i] += t.kp * u[i];
    return f;
  }

  // Displacements from `u`, whose imposed axes stay; false where nothing bears the load, as in a chain across
  // itself.
  bool relax(Field& u, const Field& load) const {
    // 2 10^8 bonds take some seconds; a run that is looked at took longer.
    const size_t iterations = std::min<size_t>(20 * u.size() + 100, 200'000'000 / (bonds_.size() + 1) + 10);
    Field rest = times(u);
    for (size_t i = 0; i < u.size(); ++i) rest[i] = load[i] - rest[i];
    clear_imposed(rest);
    Field direction = rest;
    double left = dot(rest, rest);
    const double enough = 1e-16 * left;
    for (size_t n = 0; n < iterations && left > enough; ++n) {
      Field pull = times(direction);
      clear_imposed(pull);
      const double stiff = dot(direction, pull);
      if (!(stiff > 0)) return false;
      const double step = left / stiff;
      for (size_t i = 0; i < u.size(); ++i) u[i] += step * direction[i], rest[i] -= step * pull[i];
      const double next = dot(rest, rest);
      for (size_t i = 0; i < u.size(); ++i) direction[i] = rest[i] + next / left * direction[i];
      left = next;
    }
    return std::isfinite(left);
  }

  const std::vector<Bond>& bonds() const { return bonds_; }

 private:
  void clear_imposed(Field& f) const {
    for (size_t i = 0; i < f.size(); ++i)
      for (int a = 0; a < 3; ++a)
        if (rule_.types[type_[i]].imposed[a]) f[i][a] = 0;
  }

  const Rule& rule_;
  std::span<const uint8_t> type_;
  std::vector<Bond> bonds_;
};

}  // namespace

double bond_range(const Scene& scene) {
  const double rest = scene.pitch > 0 ? scene.pitch : stiffest_rest_distance(scene.rule.law_at(0));
  return std::min(1.2 * rest, scene.rule.cutoff());
}

ExpectedStrain expected_strain(const Scene& scene, std::span<const Vec3> x, std::span<const uint8_t> type,
                               double time) {
  const Rule& rule = scene.rule;
  const double range = bond_range(scene);
  if (!(range > 0)) return {};
  std::vector<Bond> bonds;
  CellList cells(range, scene.periodic);
  cells.build(x);
  cells.for_each_pair(x, [&](uint32_t i, uint32_t j, const Vec3& d, double r) {
    if (rule.only_touch(type[i], type[j])) return;  // may part
    const double slope = rule.law_of(type[i], type[j]).slope(r);
    bonds.push_back({i, j, d / r, std::max(0.0, -slope) * rule.strength_of(type[i], type[j])});
  });
  const std::vector<char> held = supported(rule, type, bonds);
  const Equilibrium body(rule, type, std::move(bonds));

  Field u(x.size(), Vec3::Zero()), load(x.size(), Vec3::Zero());
  double farthest = 0;
  for (size_t i = 0; i < x.size(); ++i) {
    const ParticleType& t = rule.types[type[i]];
    if (!held[i]) continue;
    load[i] = rule.mass_of(type[i]) * t.gravity;
    if (t.pd) load[i] += t.kp * time * t.velocity;
    for (int a = 0; a < 3; ++a)
      if (t.imposed[a]) u[i][a] = time * t.velocity[a];
    farthest = std::max(farthest, time * t.velocity.norm());
  }
  if (!body.relax(u, load)) return {};
  ExpectedStrain strain;
  for (const Bond& b : body.bonds()) {
    const double stretch = std::abs(b.e.dot(u[b.i] - u[b.j]));
    strain.energy += 0.5 * b.stiffness * stretch * stretch;
    if (stretch > strain.stretch) strain.stretch = stretch, strain.particle = b.i;
  }
  // What is led as a whole is not strained, but for the rounding of its displacement.
  if (strain.stretch < 1e-6 * farthest) return {};
  return strain;
}

}  // namespace cuboct
