// SPDX-License-Identifier: MIT
// Whether a step is too long for a body as it stands: a lower bound of the largest eigenvalue of
// dt^2 K + 2 dt C, which must stay below 4 (model/solid/vibrations.h has the derivation).
#pragma once

#include <span>
#include <vector>

#include "model/scene/scene.h"

namespace cuboct {

// A Rayleigh quotient y.(dt^2 K + 2 dt C)y / y.y by its parts; stable below 4. Whatever y is, it is at most
// the largest eigenvalue: above 4 it proves that a mode grows.
struct Quotient {
  double law = 0;          // dt^2 times the stiffness of the pairs
  double damping = 0;      // 2 dt times their damping
  double hold = 0;         // both, of PD controllers
  uint32_t particle = 0;   // where the mode is largest
  std::vector<Vec3> mode;  // y times the root of the mass over the lightest, y of length 1
  double total() const { return law + damping + hold; }
  double stable_dt(double dt) const;  // s: where this quotient would be 4

  double law_dt2 = 0, hold_dt2 = 0;  // the parts in dt^2 of the first and the last
};

// From the velocities y, over the degrees of freedom that no constraint imposes, sharpened by some steps of
// the power iteration. `x`, `y`, `type`: by id.
Quotient stability_quotient(const Rule& rule, const Periodic& periodic, std::span<const Vec3> x,
                            std::span<const uint8_t> type, std::vector<Vec3> y);

}  // namespace cuboct
