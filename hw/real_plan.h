// SPDX-License-Identifier: MIT
// What stands for a plan where a scene's rule has several rounds: no machine is built for it, but a run has
// particles, a cell in which speeds are told, and a hash.
#pragma once

#include "hw/plan.h"
#include "model/scene/scene.h"

namespace cuboct {

// Of a scene whose rule has rounds (model/rules). It has no lattice and no formats; the hash is of the rule's
// settings, the step and the body.
Plan real_plan_of(const Scene& scene, const Arch& arch);

}  // namespace cuboct
