// SPDX-License-Identifier: MIT
// How far the pair force in integers is from the law's, at the strain that a scene makes.
#pragma once

#include <string>

#include "model/analysis/motion.h"
#include "model/contract/fixed_rule.h"
#include "model/scene/scene.h"

namespace cuboct {

// Each part over the force of a bond at the expected strain (model/analysis/motion.h), of the pair of types
// of which their sum is largest. With L the cell edge, k the bond's stiffness and F that force:
//   table       largest difference of table and law between the strains -e and e, over F: what a bin's line
//               or parabola leaves, and the rounding of its entries to units of a strength
//   strength    half a unit of a strength over F, for each further rounding to it: of damping, and of a
//               pair's scale
//   difference  half a unit of a difference and a unit of a visible position: k L (2^-(D+1) + 2^-P)/F
//   velocity    half a unit of a kick: m L 2^-(P+G+1)/(dt^2 F)
//   damping     a unit of a relative velocity, by the damping's coefficient c at the distance at rest:
//               c L 2^-W/(dt F). w.d is kept with a bit less than w, so that its half unit is a unit of w
struct BondError {
  double strain = 0;  // that is expected; 0: none, or no bond is known, and there are no parts
  double table = 0, strength = 0, difference = 0, velocity = 0, damping = 0;
  double peak_strain = 0;  // at which the weakest law pulls most, by its stretch from rest; 0: none pulls

  // Root of the sum of squares, each part divided: they are independent.
  double together(double sections = 1, double particles = 1) const;
  // The largest part, as a noun: "the force table".
  std::string largest() const;
};

BondError bond_error(const Scene& scene, const FixedRule& rule, const Motion& motion);

}  // namespace cuboct
