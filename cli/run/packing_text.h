// SPDX-License-Identifier: MIT
// What `cuboct check` says of a packing: its layers, and how far a section depends on where they fall.
#pragma once

#include "cli/items.h"
#include "model/scene/scene.h"

namespace cuboct {

// Lines for people, those alone that the scene has:
//   material NAME  extents, lowest corner and number of its particles, where there are several materials
//   layers         of particles along x, y and z, and the distance between two
//   section        of the body where it is thin (model/body/packing_scatter.h), and what it is elsewhere
void add_packing(Items& items, const Scene& scene);

// The same as numbers, without the materials.
void add_packing_numbers(Items& items, const Scene& scene);

}  // namespace cuboct
