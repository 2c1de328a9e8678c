// SPDX-License-Identifier: MIT
// How far a set of Tersoff parameters is from what a crystal should be: equation 13 of A. Zhuravlev,
// K. Abgaryan and D. Reviznikov, Symmetry 13 (2021) 219.
#pragma once

#include <array>
#include <vector>

#include "model/atoms/bond_order/diamond_properties.h"

namespace cuboct::bond_fit {

// eV, angstrom, eV/angstrom^3. Of edge_slope the value is 0 and the weight counts (eV/angstrom)^2.
struct Goal {
  double edge = 0;
  std::array<double, kDiamondProperties> value{}, weight{};
};

// Of one parameter; the search takes those of `logarithm` by their logarithm.
struct Bounds {
  double low = 0, high = 0;
  bool logarithm = true;
};

struct Problem {
  Goal goal;
  TersoffTerm<double> fixed;  // m, R and D
  std::array<Bounds, kTersoffFree> bounds;
};

// A point of the search: each parameter's place between its bounds, 0 to 1.
using Point = std::vector<double>;
TersoffFree parameters_at(const Problem& problem, const Point& point);
// Parameters beyond their bounds are put on them.
Point point_of(const Problem& problem, const TersoffFree& parameters);

// Of a lattice that falls apart: larger than any that a search takes.
inline constexpr double kNoLattice = 1e6;

// L of equation 13; kNoLattice where the sublattices do not hold each other, or where a number overflows.
double loss_of(const Problem& problem, const TersoffFree& parameters);
// L^2 and, unless null, its gradient by the point's components. The least L is where L^2 is least, which has
// a slope there too.
double squared_loss(const Problem& problem, const Point& point, double* gradient);

}  // namespace cuboct::bond_fit
