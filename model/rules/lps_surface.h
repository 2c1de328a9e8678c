// SPDX-License-Identifier: MIT
// What the bonds of a particle that are left say of the surface it is at: equations 27, 32 and 33 of the
// paper in model/rules/lps.h, and its correction of the force.
#pragma once

#include <array>

#include "model/base/mat3.h"
#include "model/rules/lps.h"

namespace cuboct {

// Sums over the bonds that are left, each times w V and what is left of it; in what follows r is the bond as
// packed.
struct SurfaceSums {
  Mat3 second = Mat3::Zero();  // r r^T
  Vec3 first = Vec3::Zero();   // r
  Vec3 bare = Vec3::Zero();    // r V, without w: it points inwards, equation 33
};

// Inverse of d/m times `second`; of directions that no bond is left along the pseudo-inverse.
Mat3 shape_of(const LpsMaterial& material, double whole, const SurfaceSums& sums);

// Force density on the particle per unit of its own dilatation, in place of the bonds that are not there:
// with zero traction on a plane of normal n, lambda t + 2 mu e_nn = 0, so that
//   e_nn = -lambda t/(2 mu),  (d - 1) e_pp = t (lambda + 2 mu)/(2 mu)
// for strain that is the same along the plane, and a missing bond pulls by
//   (2 C1/m)(lambda - mu) t w V r + (C2/2m) t w V n [(lambda + 2 mu) r_n (r^2 - r_n^2)/(d - 1) - lambda
//   r_n^3]/r^2.
// In two dimensions these are the last three lines of equation 25. Odd sums over a whole neighbourhood are 0,
// so those over missing bonds are minus those over the bonds that are left: no point need stand beyond the
// surface. `third(n)` gives { sum of w V r_n^3/r^2, sum of w V r_n (r^2 - r_n^2)/r^2 } over the bonds left.
template <typename Third>
Vec3 missing_of(const LpsMaterial& material, double whole, const SurfaceSums& sums, Third third) {
  const double length = sums.bare.norm();
  const Vec3 even = -2 * material.dilatation_factor() / whole * sums.first;
  // Of a particle inside, whose bonds cancel but for rounding, the direction says nothing.
  if (!(length > 1e-9 * material.horizon * material.volume)) return even;
  const Vec3 n = -sums.bare / length;
  const std::array<double, 2> left = third(n);
  const double of_plane = (material.lambda + 2 * material.mu) * left[1] / (material.dimensions - 1);
  return even -
         material.stretch_factor() / material.mu / (2 * whole) * (of_plane - material.lambda * left[0]) * n;
}

}  // namespace cuboct
