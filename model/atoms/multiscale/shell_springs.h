// SPDX-License-Identifier: MIT
// A pair law for samples: springs to the shells of neighbours of a crystal, each at rest in it. What elastic
// constants a pair law can have, and what it cannot.
//
// A sample without stress under any pair law has C12 = C44 as long as its atoms are nailed to the strain
// (Cauchy's relation; M. Born and K. Huang, Dynamical Theory of Crystal Lattices (1954), section 11): both
// are sums of n_x^2 n_y^2 over the same bonds. That atoms give way can only lower C44. So C44 <= C12.
#pragma once

#include <memory>
#include <vector>

#include "model/atoms/multiscale/atomic_sample.h"

namespace cuboct {

// With the distance's excess u over `rest` the force is stiffness u (1 - (u/width)^2)^2, 0 beyond `width`:
// odd, so that no strain turns the constants in first order.
struct ShellSprings {
  struct Shell {
    double rest = 0, stiffness = 0;  // angstrom, eV/angstrom^2
  };
  std::vector<Shell> shells;
  double width = 0;  // angstrom
  double cutoff() const;
};

// The constants of a pair law that are nearest to three of a cubic crystal, in Pa.
struct CauchyFit {
  double c11 = 0, c44 = 0;  // C12 = C44
};
// The least sum of the squares of relative misses: C11 is met, the other is between both.
CauchyFit cauchy_fit(double c11, double c12, double c44);

// Springs that have these constants in a crystal of cubic edge `edge` (angstrom). FCC: the two nearest
// shells. Diamond: the three nearest, the third with 11/27 of the first one's stiffness. Under a shear these
// two push the sublattices apart by as much in opposite directions, so that nothing gives way and C44 keeps
// Cauchy's value. InputError where a stiffness would not be positive.
ShellSprings springs_of(Crystal crystal, double edge, const CauchyFit& fit);

std::shared_ptr<const AtomicLaw> spring_law(ShellSprings springs);

}  // namespace cuboct
