// SPDX-License-Identifier: MIT
// What stands for a plan where no machine is built, as the scene's rule has several rounds or no integers
// hold it: a run in doubles has particles, a cell in which speeds are told, and a hash.
#pragma once

#include "hw/plan/plan.h"
#include "model/scene/scene.h"

namespace cuboct {

// It has no lattice and no formats; the hash is of the rule, the step and the body.
Plan real_plan_of(const Scene& scene, const Arch& arch);

// Whether the formats of this arch hold the scene's rule of pairs.
bool formats_hold(const Scene& scene, const Arch& arch);

}  // namespace cuboct
