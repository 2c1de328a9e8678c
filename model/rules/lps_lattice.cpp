// SPDX-License-Identifier: MIT
#include "model/rules/lps_lattice.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "model/base/dense.h"
#include "model/rules/lps_terms.h"

namespace cuboct {
namespace {

double weight(const LpsMaterial& m, double r) { return m.weight(r) * share_of(m, r) * m.volume; }

}  // namespace

CubicModuli lattice_moduli(const LpsMaterial& m, const std::vector<Vec3>& full) {
  const double of_stretch = m.stretch_factor() / (2 * full_weight(m, full));
  const double of_trace = m.dilatation_factor() / m.dimensions;
  CubicModuli c{of_trace, of_trace, 0};
  for (const Vec3& r : full) {
    const double w = of_stretch * weight(m, r.norm()) / r.squaredNorm();
    const double xxyy = w * r[0] * r[0] * r[1] * r[1];
    c.c11 += w * std::pow(r[0], 4);
    c.c12 += xxyy;
    c.c44 += xxyy;
  }
  return c;
}

Mat3 wave_matrix(const LpsMaterial& m, const std::vector<Vec3>& full, const Vec3& k) {
  const double whole = full_weight(m, full);
  Vec3 s = Vec3::Zero();
  Mat3 sum = Mat3::Zero();
  for (const Vec3& r : full) {
    const double w = weight(m, r.norm());
    s += w * std::sin(k.dot(r)) * r;
    sum += w * (1 - std::cos(k.dot(r))) / r.squaredNorm() * r * r.transpose();
  }
  return m.dilatation_factor() * m.dimensions / (whole * whole) * s * s.transpose() +
         m.stretch_factor() / whole * sum;
}

double largest_lps_rate(const LpsMaterial& m, const std::vector<Vec3>& full, int along) {
  double shortest = m.horizon;
  for (const Vec3& r : full) shortest = std::min(shortest, r.norm());
  // Waves beyond 2 pi over half the shortest bond repeat others, on the lattices at hand.
  const double end = 2 * std::numbers::pi / shortest;
  double most = 0;
  for (int a = 0; a <= along; ++a)  // D(-k) = D(k)
    for (int b = -along; b <= along; ++b)
      for (int c = -along; c <= along; ++c) {
        const Vec3 k = end / along * Vec3(a, b, m.dimensions == 3 ? c : 0);
        most = std::max(most, eigenvalues(wave_matrix(m, full, k))[2]);
        if (m.dimensions == 2) break;
      }
  return most;
}

}  // namespace cuboct
