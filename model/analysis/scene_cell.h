// SPDX-License-Identifier: MIT
// The matter of a scene as a cell that repeats.
#pragma once

#include <string>

#include "model/scene/scene.h"
#include "model/solid/crystal_cell.h"

namespace cuboct {

struct SceneCell {
  CrystalCell cell;  // types are those of the scene's rule
  std::string of;    // what it is, in words
};
// The box of a scene that repeats along all axes, with all its particles. Else the packing's own cell, of one
// particle of the material `material` (empty: the first). InputError where the scene has neither.
SceneCell cell_of(const Scene& scene, const std::string& material);

// `layers` layers of the packing's sites across z of the scene, with free faces, which repeats along x and y.
// Its extent along z is that of as many layers in the packing. InputError where the packing has no period
// along an axis.
CrystalCell slab_of(const Scene& scene, const std::string& material, int layers);

// kg/m^3
double density_of(const Rule& rule, const CrystalCell& cell);

}  // namespace cuboct
