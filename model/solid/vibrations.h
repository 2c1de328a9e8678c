// SPDX-License-Identifier: MIT
// Small vibrations of a body as it stands, and the largest time step at which a run about it is stable.
#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "model/contract/rule.h"

namespace cuboct {

// Rates per unit mass of small motions about the body's positions, over the degrees of freedom that no
// constraint imposes (particle by particle, axis by axis): x'' = -stiffness x - damping x'. Symmetric: x
// counts displacements times the root of the mass over the lightest's. A bond adds its axial part -f' e e^T
// and, under load, its geometric part -(f/r)(1 - e e^T), times the strength of its materials, which scales
// its damping c(r) e e^T as well. PD-held particles add kp/m and kd/m. Born and Huang, Dynamical Theory of
// Crystal Lattices (1954), section 24.
struct Vibrations {
  using Matrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;
  Matrix stiffness;                // 1/s^2
  Matrix damping;                  // 1/s; empty (0 x 0) where nothing damps
  std::vector<uint32_t> particle;  // [degree of freedom]
  std::vector<int> axis;           // [degree of freedom]
};
Vibrations vibrations_of(const Rule& rule, const Body& body, const Periodic& periodic);

struct Limit {
  double dt = 0;         // s; infinite where nothing is restored or damped
  double frequency = 0;  // rad/s, sqrt of the largest eigenvalue of the stiffness
  double softest = 0;    // 1/s^2, the least eigenvalue of the stiffness that Lanczos iterations found. They
                       // find no less than there is: below 0 the body itself is unstable, and no dt cures it
  uint32_t particle = 0;     // where the first mode to grow is largest
  double damping_share = 0;  // of 4 = dt^2 K + 2 dt C in that mode: what the damping takes

  // Below 0 by more than the rounding of the modes at 0, rigid motions and free particles.
  bool body_unstable() const { return softest < -1e-9 * frequency * frequency; }
};

// Both integrators, semi-implicit Euler and velocity Verlet with damping at half steps, move the positions by
//   x[n+1] - 2 x[n] + x[n-1] = -dt^2 K x[n] - dt C (x[n] - x[n-1])
// (Verlet's two half kicks between half steps are one kick). A solution z^n y has
//   Q(z) y = 0,  Q(z) = z^2 - (2 - dt^2 K - dt C) z + (1 - dt C).
// With k = y*Ky/y*y and c = y*Cy/y*y, z is a root of z^2 - (2 - dt^2 k - dt c) z + 1 - dt c, and both roots
// of a real quadratic z^2 + p z + q are inside the unit circle if and only if |q| < 1 and |p| < 1 + q: here
// dt c > 0 or a conjugate pair on the circle, dt^2 k > 0 and dt^2 k + 2 dt c < 4. So the step is stable where
// K and C have no negative eigenvalue and dt^2 K + 2 dt C < 4. It is the exact limit: beyond it Q(-1) = 4 -
// dt^2 K - 2 dt C has a negative eigenvalue and Q(-inf) has none, so that one of them passes 0 at some z <
// -1. The eigenvalue is found by Lanczos iterations with restarts (R. B. Lehoucq and D. C. Sorensen, SIAM J.
// Matrix Anal. 17 (1996) 789), dt by Newton's method: each mode's own limit is above the limit, or at it.
Limit stability_limit(const Vibrations& vibrations);

}  // namespace cuboct
