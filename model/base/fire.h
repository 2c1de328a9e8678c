// SPDX-License-Identifier: MIT
// FIRE: a minimum of an energy, from its forces alone, by damped motion that is steered downhill.
// E. Bitzek et al., Phys. Rev. Lett. 97 (2006) 170201; in the second form of J. Guenole et al., Comput.
// Mater. Sci. 175 (2020) 109584, with their parameters.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>

namespace cuboct {

struct FireOptions {
  double stiffness = 0;     // N/m, > 0: no curvature of the energy is much above it; it sets the time step
  double longest_step = 0;  // m, that a degree of freedom goes at a time; 0: no limit
  uint64_t most = 100000;   // force evaluations
};

struct FireResult {
  bool at_rest = false;
  uint64_t evaluations = 0;  // of forces
};

// Fills `f` (N) with the forces at `x` (m) and answers whether they are small enough. A degree of freedom
// without a force stays where it is.
using FireForces = std::function<bool(const Eigen::VectorXd& x, Eigen::VectorXd& f)>;

// Moves x downhill until `forces` is satisfied, whose last call is at the x that is left.
FireResult fire(Eigen::VectorXd& x, const FireForces& forces, const FireOptions& options);

}  // namespace cuboct
