// SPDX-License-Identifier: MIT
// How far a scene strains its bonds, without running it: the body at rest under its loads, in doubles.
#pragma once

#include <span>

#include "model/scene/scene.h"

namespace cuboct {

struct ExpectedStrain {
  double stretch = 0;     // m, the largest change of a bond's length; 0: nothing strains the body, or unknown
  uint32_t particle = 0;  // an end of that bond
  double energy = 0;      // J, of all bonds
};

// Distance below which a pair is a bond of the body, m: between the first and the second shell of the
// packing, or of a crystal of bonds at rest.
double bond_range(const Scene& scene);

// Loads: gravity, and what is moved, by position or by force, over `time` s. Linear about the positions `x`,
// so only small strains are right. Parts of the body that nothing holds or leads carry no load: they fall,
// and are not strained. `x`, `type`: by id.
ExpectedStrain expected_strain(const Scene& scene, std::span<const Vec3> x, std::span<const uint8_t> type,
                               double time);

}  // namespace cuboct
