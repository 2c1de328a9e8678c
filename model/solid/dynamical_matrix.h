// SPDX-License-Identifier: MIT
// Small vibrations and elasticity of the perfect FCC packing under a pair law: lattice sums over all shells
// of neighbours inside the cutoff. `pitch` is the nearest-neighbour distance in m; the cubic cell edge is
// sqrt(2) * pitch. M. Born and K. Huang, Dynamical Theory of Crystal Lattices (1954), sections 24 and 29.
#pragma once

#include <array>
#include <vector>

#include "model/base/dense.h"
#include "model/contract/rule.h"

namespace cuboct {

// Voigt's order of pairs of axes: xx, yy, zz, yz, xz, xy.
inline constexpr std::array<std::array<int, 2>, 6> kVoigt{{{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}}};

// Of a site, at most: sums over more take seconds each, and a scene makes hundreds.
inline constexpr double kMostNeighbours = 1e5;
// Of a single sum, at most: 24 MB of neighbours.
inline constexpr double kMostOnce = 1e6;
// InputError where the ball of that radius holds more.
void check_neighbours(double pitch, double cutoff, double most = kMostNeighbours);

// The neighbours of a site nearer than `cutoff`, in cubic axes, without the site itself; if v is one, so is
// -v. InputError where there are too many.
std::vector<Vec3> fcc_neighbours(double pitch, double cutoff);

// Volume per particle, m^3: pitch^3 / sqrt(2).
double fcc_volume(double pitch);

// Potential energy per particle, J, and pressure, Pa, of the perfect packing at rest.
double fcc_energy(const PairLaw& law, double pitch);
double fcc_pressure(const PairLaw& law, double pitch);

// Squared frequencies (rad^2/s^2, ascending; negative: unstable) at wave vector q (rad/m, cubic axes).
Vec3 squared_frequencies(const PairLaw& law, double mass, double pitch, const Vec3& q);

// The largest frequency of the Brillouin zone in rad/s, `mass` in kg per particle: a grid of the reciprocal
// cell that contains X, L, W, K and U, then a refinement from its best points. A leapfrog run is stable up to
// dt = 2/that. 0 where no vibration is restored. `tolerance`: relative, of its square. The default is what
// rounding leaves; the refinement then takes nearly all of the time where bonds are thousands.
double largest_frequency(const PairLaw& law, double mass, double pitch, double tolerance = 1e-14);
// The largest of the packings that the pairs of materials would make alone.
double largest_frequency(const Rule& rule, double pitch);

// Elastic constants in Pa, Voigt order xx, yy, zz, yz, xz, xy with engineering shear strains, cubic axes.
// Convention: the stress-strain coefficients at that pitch, Cauchy stress = c * strain for small strains from
// there; where the pressure p is not 0 they contain it (C11 - p, C12 + p, C44 - p of the energy's second
// derivatives with respect to Lagrangian strain). D. C. Wallace, Thermodynamics of Crystals (1972),
// section 2.
Matrix6 elastic_constants(const PairLaw& law, double pitch);

// Young's modulus in Pa for a pull along `direction` (any length but 0) with free sides.
double youngs_modulus(const Matrix6& c, const Vec3& direction);

// The pitch nearest to `guess`, within a factor of 2, at which the pressure crosses from positive to
// negative, to the last bits. InputError where there is none. A crossing that is only the jump of a truncated
// law does not count.
double relaxed_pitch(const PairLaw& law, double guess);

}  // namespace cuboct
