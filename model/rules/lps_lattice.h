// SPDX-License-Identifier: MIT
// What a linear peridynamic solid does on a perfect lattice, in closed form: moduli under even strain, and
// plane waves. `full` is the bonds of a particle (model/rules/lps.h).
#pragma once

#include <vector>

#include "model/base/mat3.h"
#include "model/rules/lps.h"

namespace cuboct {

// Of a cubic lattice along its axes, Pa.
struct CubicModuli {
  double c11 = 0, c12 = 0, c44 = 0;
  double bulk() const { return (c11 + 2 * c12) / 3; }
  double shear() const { return c44; }              // of a simple shear along the axes
  double prime() const { return (c11 - c12) / 2; }  // C', of the other shear
};

// By the energy of even strain, W = (C1 (lambda - mu)/2d) tr^2 + (C2 mu/4m) sum w V (r.E.r)^2/r^2, so
//   C_abcd = (C1 (lambda - mu)/d) I_ab I_cd + (C2 mu/2m) sum w V r_a r_b r_c r_d/r^2.
CubicModuli lattice_moduli(const LpsMaterial& material, const std::vector<Vec3>& full);

// Density times squared frequency of the three plane waves of wave vector k (1/m) is the eigenvalues of,
// Pa/m^2
//   D(k) = (C1 d (lambda - mu)/m^2) s s^T + (C2 mu/m) sum w V n n^T (1 - cos k.r),
//   s = sum w V r sin k.r, n = r/|r|.
Mat3 wave_matrix(const LpsMaterial& material, const std::vector<Vec3>& full, const Vec3& k);

// The largest eigenvalue over the wave vectors, Pa/m^2: density times the largest squared frequency. Sampled
// on a grid of `along`^3 wave vectors around the zone of the shortest bond, to a percent or so.
double largest_lps_rate(const LpsMaterial& material, const std::vector<Vec3>& full, int along = 16);

}  // namespace cuboct
