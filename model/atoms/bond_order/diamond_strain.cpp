// SPDX-License-Identifier: MIT
#include "model/atoms/bond_order/diamond_strain.h"

namespace cuboct {

BondPath diamond_path(double edge, const Mat3& gradient, const Vec3& shift) {
  const std::array<Vec3, 4> corners = {{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}};
  BondPath path;
  for (size_t j = 0; j < 4; ++j) {
    path.at[j] = edge / 4 * corners[j];
    path.rate[j] = gradient * path.at[j] + shift;
  }
  return path;
}

// r^2 = d.d, so r r' = d.d' and r'^2 + r r'' = d'.d' for a straight path.
PathValue path_length(const BondPath& path, size_t j) {
  const Vec3 &d = path.at[j], &v = path.rate[j];
  const double r = d.norm(), slope = d.dot(v) / r;
  return {r, slope, (v.squaredNorm() - slope * slope) / r};
}

// c = s/q with s = d_j.d_k and q = r_j r_k: s = c q, s' = c' q + c q', s'' = c'' q + 2 c' q' + c q''.
PathValue path_cosine(const BondPath& path, size_t j, size_t k) {
  const PathValue a = path_length(path, j), b = path_length(path, k);
  const double q = a.value * b.value, q1 = a.slope * b.value + a.value * b.slope,
               q2 = a.curvature * b.value + 2 * a.slope * b.slope + a.value * b.curvature;
  const double s = path.at[j].dot(path.at[k]),
               s1 = path.rate[j].dot(path.at[k]) + path.at[j].dot(path.rate[k]),
               s2 = 2 * path.rate[j].dot(path.rate[k]);
  const double c = s / q, c1 = (s1 - c * q1) / q;
  return {c, c1, (s2 - 2 * c1 * q1 - c * q2) / q};
}

}  // namespace cuboct
