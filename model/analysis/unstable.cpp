// SPDX-License-Identifier: MIT
#include "model/analysis/unstable.h"

#include <cmath>

#include "model/contract/neighbours.h"

namespace cuboct {
namespace {

struct DampedBond {
  uint32_t i, j;
  Vec3 e;
  double along, across, damping;  // 1/s^2, 1/s^2, 1/s
};

std::vector<DampedBond> bonds_of(const Rule& rule, const Periodic& periodic, std::span<const Vec3> x,
                                 std::span<const uint8_t> type) {
  std::vector<DampedBond> bonds;
  CellList cells(rule.cutoff(), periodic);
  cells.build(x);
  cells.for_each_pair(x, [&](uint32_t i, uint32_t j, const Vec3& d, double r) {
    if (r >= rule.reach(type[i], type[j])) return;
    const double s = rule.strength_of(type[i], type[j]) / rule.mass;
    const PairLaw& law = rule.law_of(type[i], type[j]);
    bonds.push_back(
        {i, j, d / r, -law.slope(r) * s, -law.force(r) / r * s, rule.damping_over_r2(r) * r * r * s});
  });
  return bonds;
}

double norm2(const std::vector<Vec3>& y) {
  double sum = 0;
  for (const Vec3& a : y) sum += a.squaredNorm();
  return sum;
}

}  // namespace

double Quotient::stable_dt(double dt) const {
  // dt^2 k + 2 dt c = 4
  const double k = (law_dt2 + hold_dt2) / (dt * dt), c = (total() - law_dt2 - hold_dt2) / (2 * dt);
  return 4 / (c + std::sqrt(std::max(0.0, c * c + 4 * k)));
}

Quotient stability_quotient(const Rule& rule, const Periodic& periodic, std::span<const Vec3> x,
                            std::span<const uint8_t> type, std::vector<Vec3> y) {
  // y counts displacements times the root of the mass, so that K/m and C/m are symmetric.
  std::vector<double> root;
  for (const uint8_t t : type) root.push_back(std::sqrt(rule.relative_mass(t)));
  const std::vector<DampedBond> bonds = bonds_of(rule, periodic, x, type);
  const double dt = rule.dt;
  Quotient q;
  const auto normalise = [&] {
    for (size_t i = 0; i < y.size(); ++i)
      for (int a = 0; a < 3; ++a)
        if (rule.types[type[i]].imposed[a]) y[i][a] = 0;
    const double length = std::sqrt(norm2(y));
    if (length > 0)
      for (Vec3& a : y) a /= length;
    return length > 0;
  };
  // A few modes near the largest are enough to leave 4 behind; each iteration costs little beside the pairs.
  constexpr int kIterations = 12;
  for (int n = 0; n <= kIterations; ++n) {
    if (!normalise()) return q;
    // The shift keeps modes that are not restored, with negative eigenvalues, from winning by their size.
    constexpr double kShift = 1;
    std::vector<Vec3> next(y.size());
    q = {};
    for (size_t i = 0; i < y.size(); ++i) {
      const ParticleType& t = rule.types[type[i]];
      next[i] = kShift * y[i];
      if (!t.pd) continue;
      const double mass = rule.mass_of(type[i]), stiff = dt * dt * t.kp / mass, damp = 2 * dt * t.kd / mass;
      next[i] += (stiff + damp) * y[i];
      q.hold_dt2 += stiff * y[i].squaredNorm();
      q.hold += (stiff + damp) * y[i].squaredNorm();
    }
    for (const DampedBond& b : bonds) {
      const Vec3 w = y[b.i] / root[b.i] - y[b.j] / root[b.j];
      const double along = b.e.dot(w);
      const Vec3 stiff = dt * dt * (b.along * along * b.e + b.across * (w - along * b.e)),
                 damp = 2 * dt * b.damping * along * b.e;
      next[b.i] += (stiff + damp) / root[b.i];
      next[b.j] -= (stiff + damp) / root[b.j];
      q.law += stiff.dot(w);
      q.damping += damp.dot(w);
    }
    q.law_dt2 = q.law;
    if (n < kIterations) y = std::move(next);
  }
  for (uint32_t i = 0; i < y.size(); ++i)
    if (y[i].squaredNorm() > y[q.particle].squaredNorm()) q.particle = i;
  for (size_t i = 0; i < y.size(); ++i) y[i] *= root[i];
  q.mode = std::move(y);
  return q;
}

}  // namespace cuboct
