// SPDX-License-Identifier: MIT
// The radial pair laws. docs/reference/physics.md has the formulas and a plot of the presets.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "model/contract/rule.h"

namespace cuboct {

// All laws: lengths in m, forces in N (positive repels), energies in J. A law is
//   r <  core            force(r) = r * force(core)/core
//   core <= r < cutoff   the law proper
//   r >= cutoff          0
// with energy(r) = integral of the force from r to the cutoff, exact for every law here. The force is
// continuous at the core; its slope is not. The makers throw InputError, with the numbers, where an argument
// makes no such law: something not finite, epsilon, sigma, pitch or stiffness not above 0, or not 0 < core <
// cutoff.

// How a law of infinite range ends at its cutoff. The energy is 0 there either way.
enum class Smoothing : uint8_t {
  none,    // truncated: the force jumps to 0
  linear,  // the force at the cutoff is taken off everywhere, so that it does not jump (its slope does);
           // LAMMPS's lj/smooth/linear. S. Toxvaerd and J. C. Dyre, J. Chem. Phys. 134 (2011) 081102:
           // "shifted forces".
};

// Lennard-Jones 12-6.
std::shared_ptr<const PairLaw> lennard_jones(double epsilon, double sigma, double cutoff, double core,
                                             Smoothing smoothing = Smoothing::none);

enum class Interpolation {
  // Through the points: C1 cubics whose slopes keep each stretch between two points monotone; an extremum of
  // the law
  // is always one of the points. F. N. Fritsch and J. Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300, the
  // method of
  // SLATEC's PCHIM; it improves F. N. Fritsch and R. E. Carlson, SIAM J. Numer. Anal. 17 (1980) 238.
  monotone_cubic,
  // The points are the control polygon of a plane curve (r(t), f(t)), a clamped uniform B-spline of order 3
  // (degree
  // 2): it starts in the first point and ends in the last, along the polygon, and passes the middle of each
  // inner
  // leg along that leg. As r rises from point to point, so it does along the curve, and f is a function of r.
  b_spline,
};

// A law through, or drawn by, the points (r[k], f[k]): at least 2 (b_spline: 3), r rising, r[0] <= core. The
// last r is the cutoff; where the last f is not 0 the force jumps there.
std::shared_ptr<const PairLaw> spline_law(std::vector<double> r, std::vector<double> f,
                                          Interpolation interpolation, double core);

// The presets, for a packing of that pitch: "elastic", "brittle", "ductile", "viscous". Each is 0 at the
// pitch with slope -stiffness (N/m) and without curvature, levels off towards its core at half the pitch,
// restores above the pitch up to a peak, and ends with 0 force and 0 slope at sqrt(2) * pitch, where the
// second neighbours of the packing stand; all but viscous repel before they end. So the undeformed packing is
// at rest, its linear elasticity is that of its nearest neighbours, and second neighbours resist only what
// brings them closer ("hardness").
// `range`, in (0, 1]: beyond the pitch, distances from it and forces are this much of that. The stiffness is
// the same, the energy of the bond range^2 as much; the law ends at pitch (1 + range (sqrt(2) - 1)).
std::shared_ptr<const PairLaw> preset_law(const std::string& name, double pitch, double stiffness_N_per_m,
                                          double range = 1);

// Whether both give the same force at every distance; laws of no form are the same only if they are one
// object.
bool same_law(const PairLaw& one, const PairLaw& other);

// The largest of -strength df/dr over the pairs of materials, N/m, for bonds of length r; 0 where none
// restores.
double stiffest_bond(const Rule& rule, double r);

// Of the distances beyond the core at which the force turns from push to pull, that of the stiffest bond, in
// m to 1/4096 of the law's range; 0 where there is none.
double stiffest_rest_distance(const PairLaw& law);

// Where the push of the stiffest bond ends, in m to a rounding of r: bodies that only touch part there. The
// cutoff of a law that never pulls.
double push_end(const PairLaw& law);

}  // namespace cuboct
