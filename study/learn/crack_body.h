// SPDX-License-Identifier: MIT
// A learned solid on the points of a grid, with a slit and bonds that break: equations 22 to 33 of the paper.
// SI units.
#pragma once

#include <memory>

#include "model/rules/lps_terms.h"
#include "study/learn/wave_operator.h"

namespace cuboct::learn {

// When a bond breaks: equation 22.
struct Breaking {
  double stretch = 0;  // s0
  double width = 0;    // eta
};

class CrackBody {
 public:
  // `slit`: m, from the lower edge along x = 0. Its bonds are there, and broken, so that equation 46 counts
  // them. InputError where the kernel is of no stable solid at an edge.
  CrackBody(const Grid& grid, const Kernel& kernel, const Breaking& breaking, double slit);

  // Of displacements, N/m^3: what the bonds do, equation 30 with the opposite sign. With `keeps` the stretch
  // of each bond counts for all that follows.
  const std::vector<Vec3>& force(const std::vector<Vec3>& u, bool keeps);
  // Equation 46 for each point, 0 to 1.
  std::vector<double> damage() const;
  // s, the largest step that is stable while no bond is broken: 2 over the highest frequency of a wave.
  double stable_step(double density) const;

 private:
  Grid grid_;
  std::vector<Vec3> home_, x_, force_;
  std::unique_ptr<LpsTerms> terms_;
  double stiffest_ = 0;  // N/m^4
};

}  // namespace cuboct::learn
