// SPDX-License-Identifier: MIT
// What a tensor of elastic constants says, in the directions that one asks for. J. F. Nye, Physical
// Properties of Crystals (1957), chapter VIII. All take constants in Pa, Voigt order
// (model/solid/dynamical_matrix.h), of a body that is stable: positive definite.
#pragma once

#include <utility>

#include "model/base/mat3.h"
#include "model/solid/dynamical_matrix.h"

namespace cuboct {

// The least eigenvalue of the constants in Pa, with shears counted as tensors: not above 0, the body gives
// way.
double softest_strain(const Matrix6& c);

// The constants in axes that are the columns of `axes`.
Matrix6 in_axes(const Matrix6& c, const Mat3& axes);

// Pa, of a slab that repeats along x and y: pulled along x, free along y. The constants of z are not read.
double plane_modulus(const Matrix6& c);

// Poisson's ratio under a pull along `direction`: the smallest and the largest over the lateral directions.
std::pair<double, double> poissons_ratio(const Matrix6& c, const Vec3& direction);

// m/s, ascending, of plane waves along `direction`: Christoffel's equation. `density` in kg/m^3.
Vec3 wave_speeds(const Matrix6& c, double density, const Vec3& direction);

// Of all directions that of the least and that of the largest Young's modulus: unit length, the first
// component that is not 0 positive.
std::pair<Vec3, Vec3> extreme_directions(const Matrix6& c);

// 2 C44/(C11 - C12) by the means over cubic axes: 1 where a cubic body is isotropic.
double zener_ratio(const Matrix6& cubic);

// Means over all orientations: Voigt's bound, Reuss's, and Hill's mean of the two.
struct Isotropic {
  double bulk = 0, shear = 0;  // Pa
  double youngs() const { return 9 * bulk * shear / (3 * bulk + shear); }
  double poisson() const { return (3 * bulk - 2 * shear) / (2 * (3 * bulk + shear)); }
};
Isotropic voigt_mean(const Matrix6& c);
Isotropic reuss_mean(const Matrix6& c);
Isotropic hill_mean(const Matrix6& c);

// 0 where the body is isotropic. S. I. Ranganathan and M. Ostoja-Starzewski, Phys. Rev. Lett. 101 (2008)
// 055504.
double universal_anisotropy(const Matrix6& c);

}  // namespace cuboct
