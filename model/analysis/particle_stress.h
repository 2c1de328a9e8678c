// SPDX-License-Identifier: MIT
// The stress of a state in real numbers, particle by particle.
#pragma once

#include <memory>
#include <vector>

#include "model/base/mat3.h"
#include "model/real/reference.h"
#include "model/scene/scene.h"

namespace cuboct {

// By the pair law in doubles at the positions, damping included. D. H. Tsai, J. Chem. Phys. 70 (1979) 1375;
// A. P. Thompson, S. J. Plimpton, W. Mattson, J. Chem. Phys. 131 (2009) 154107.
class ParticleStress {
 public:
  // InputError where the scene's rule is of several rounds: frames lack what its bonds and fields hold. Keeps
  // a reference to the scene.
  ParticleStress(const Scene& scene, int threads);
  // Of pairs. Keeps a reference to the rule.
  ParticleStress(const Rule& rule, const Periodic& box, int threads);

  // The box of the bodies from now on; at first that with which the scene begins.
  void set_box(const Periodic& box);

  // Stress times volume of each particle, J, tension positive: over its pairs the sum of f (x) d / 2, and
  // with `kinetic` less m v (x) v. Its sum over a box's volume is the box's stress, whose trace is -3 times
  // its pressure. `late`: s, from the time of the velocities to that of the positions. This is LAMMPS's
  // `compute stress/atom`.
  std::vector<Mat3> of(const Body& body, bool kinetic, double late);
  // The first part alone.
  std::vector<Mat3> virial(const Body& body);

 private:
  const Rule& rule_;
  Periodic box_;
  int threads_;
  std::unique_ptr<Reference> reference_;
};

}  // namespace cuboct
