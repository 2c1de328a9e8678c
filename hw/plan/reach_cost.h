// SPDX-License-Identifier: MIT
// Whether a scene's [reach] has more cells than its motion asks for, and what fewer would take.
#pragma once

#include <cstdint>
#include <string>

#include "hw/plan/plan.h"
#include "model/scene/scene.h"

namespace cuboct {

// Cells in which a particle is as the run begins.
uint64_t cells_with_matter(const Scene& scene, const Plan& plan);

// Of lattices with more than 20 cells to each that holds matter, 10,000 and more, where margin = "auto" has
// less than half of them: what the margin along each axis costs, and which lengths the motion asks for
// (largest_beyond in model/analysis/motion_reach.h, and a cell edge). Else empty. Scenes of this repository
// have up to 15 cells to each with matter where the margin fits the motion, and 44 where it does not; small
// lattices cost nothing.
std::string reach_warning(const Scene& scene, const Plan& plan);

// The line "reach" of a scene with margin = "auto", else empty.
std::string reach_line(const Scene& scene, const Plan& plan);

}  // namespace cuboct
