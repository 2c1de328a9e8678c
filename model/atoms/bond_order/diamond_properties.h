// SPDX-License-Identifier: MIT
// What a diamond crystal of a given edge is worth under one element's Tersoff parameters, and how that
// changes with them: energy, pressure and elastic constants, all exact.
#pragma once

#include <array>
#include <cstddef>

#include "model/atoms/bond_order/tersoff_terms.h"

namespace cuboct {

// The parameters that a fit may change; m, R and D stay.
inline constexpr size_t kTersoffFree = 11;
inline constexpr std::array<const char*, kTersoffFree> kTersoffFreeNames = {
    "A", "B", "lambda1", "lambda2", "lambda3", "beta", "n", "gamma", "c", "d", "cos_theta0"};
using TersoffFree = std::array<double, kTersoffFree>;
TersoffFree free_of(const TersoffTerm<double>& term);
TersoffTerm<double> with_free(TersoffTerm<double> term, const TersoffFree& values);

// In this order everywhere. edge_slope: dE/d(edge), 0 at rest. C' = (C11 - C12)/2. C44_clamped: the
// sublattices do not shift against each other.
enum DiamondProperty : size_t { cohesive, edge_slope, bulk, c_prime, c11, c12, c44_clamped, c44 };
inline constexpr size_t kDiamondProperties = 8;

struct DiamondProperties {
  // Energy per atom, per atom and length, and per volume, in the units of the parameters.
  std::array<double, kDiamondProperties> value{};
  // d2E/du2 of an atom for a shift u of one sublattice along an axis: not positive, the lattice falls apart
  // and c44 has no meaning.
  double inner = 0;
  std::array<TersoffFree, kDiamondProperties> slopes{};  // by the parameters; 0 unless asked for
};

// `edge` in the unit of R and D, of the cubic cell of eight atoms. Second neighbours, 0.707 edges away, must
// be beyond R + D. Away from rest the constants are second derivatives of the energy by the gradients of
// equations 14 and 15 of A. Zhuravlev, K. Abgaryan and D. Reviznikov, Symmetry 13 (2021) 219, and bulk is
// V d2E/dV2.
DiamondProperties diamond_properties(const TersoffTerm<double>& term, double edge, bool slopes);

}  // namespace cuboct
