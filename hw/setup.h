// SPDX-License-Identifier: MIT
// From a scene and an arch to a plan and its initial state.
#pragma once

#include "hw/plan.h"
#include "model/scene.h"

namespace cuboct {

struct Setup {
  Plan plan;
  State initial;
};

// Chooses the cell edge and the reachable cells, quantises rule and body. Deterministic.
Setup make_setup(const Scene& scene, const Arch& arch);

}  // namespace cuboct
