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

// Chooses the cell edge and the reachable cells, quantises rule and body. Deterministic. InputError where the
// machine cannot hold the scene: a node too full, a particle too fast, ...
Setup make_setup(const Scene& scene, const Arch& arch);

// The same plan and errors, without a State in memory. An engine can then take the particles one by one,
//   fixed_particle(scene.body, id, plan.rule, plan.lattice, plan.origin),  id = 0 ... plan.particles - 1,
// which are make_setup's initial state, after which the body may be given up.
Plan plan_of(const Scene& scene, const Arch& arch);

}  // namespace cuboct
