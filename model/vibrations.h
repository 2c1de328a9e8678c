// SPDX-License-Identifier: MIT
// Small vibrations of a body as it stands, and the largest time step at which a run about it is stable.
#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "model/rule.h"

namespace cuboct {

// Rates per unit mass of small motions about the body's positions, over the degrees of freedom that no
// constraint imposes (particle by particle, axis by axis): x'' = -stiffness x - damping x'. Symmetric. A bond
// under load counts with its geometric part -(f/r)(1 - e e^T). PD-held particles add kp/m and kd/m.
struct Vibrations {
  Eigen::SparseMatrix<double> stiffness;  // 1/s^2
  Eigen::SparseMatrix<double> damping;    // 1/s; empty (0 x 0) where nothing damps
  std::vector<uint32_t> particle;         // [degree of freedom]
  std::vector<int> axis;                  // [degree of freedom]
};
Vibrations vibrations_of(const Rule& rule, const Body& body, const Periodic& periodic);

struct Limit {
  double dt = 0;             // s; infinite where nothing is restored or damped
  double frequency = 0;      // rad/s, sqrt of the largest eigenvalue of the stiffness
  double softest = 0;        // 1/s^2, the least eigenvalue of the stiffness; below 0: the body itself is
                             // unstable, and no dt cures it
  uint32_t particle = 0;     // where the first mode to grow is largest
  double damping_share = 0;  // of 4 = dt^2 K + 2 dt C in that mode: what the damping takes
};

// Both integrators, semi-implicit Euler and velocity Verlet with damping at half steps, have the map
//   v += -dt (K x + C v),  x += dt v
// whose modes first leave the unit circle at -1, where (dt^2 K + 2 dt C) y = 4 y. So dt is the one at which
// the largest eigenvalue of the symmetric matrix dt^2 K + 2 dt C is 4; the eigenvalue by Lanczos iterations.
Limit stability_limit(const Vibrations& vibrations);

}  // namespace cuboct
