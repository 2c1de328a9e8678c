// SPDX-License-Identifier: MIT
// A body that repeats along an axis, pulled along it at rest: stress and volume against strain.
#pragma once

#include <functional>
#include <vector>

#include "model/atoms/multiscale/element_motion.h"

namespace cuboct {

struct StretchPoint {
  double strain = 0;     // of the period
  double stress = 0;     // Pa, Cauchy's along the axis, mean over the volume
  double expansion = 0;  // of the volume, a part of it
  double across = 0;     // Pa, the larger of the mean stresses across the axis: 0 where the sides are free
  int iterations = 0;    // of the search for rest
};

struct Moduli {
  double youngs = 0;  // Pa
  double poisson = 0;
};

// Initial slopes: stress and expansion are fitted by E e + q e^2 and (1 - 2 nu) e + q e^2, least squares.
// From two points on.
Moduli moduli_of(const std::vector<StretchPoint>& points);

class Stretch {
 public:
  // `body` is not strained; `axis` repeats. `precision`: at rest, forces on vertices are below this part of
  // what the stress of the strain to come puts on a face of an element.
  Stretch(ElementBody& body, int axis, double precision = 1e-4);

  // To the next strain. ElementError; std::runtime_error where the vertices find no rest.
  StretchPoint to(double strain);

 private:
  ElementBody& body_;
  int axis_;
  double precision_, face_;  // m^2, of an element of mean size
  ElementRest rest_;
};

}  // namespace cuboct
