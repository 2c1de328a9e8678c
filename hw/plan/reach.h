// SPDX-License-Identifier: MIT
// Which cells a scene can reach.
#pragma once

#include <vector>

#include "model/contract/fixed_rule.h"
#include "model/contract/lattice.h"
#include "model/scene/scene.h"

namespace cuboct {

inline constexpr double kMostCells = 3e7;  // about 1 GB of lattice

// The cells of these edges, cell (0,0,0) with its lower corner at `origin`, that the body, its margin, its
// driven types on their way and the scene's further box touch: for each particle, all that the box of its
// margin touches. Sorted by (z, y, x), each once, those of rings (period > 0) in [0, period). Time grows with
// the particles, memory with the cells (12 bytes each): not with both. InputError where there would be more
// cells than can be built.
// With two axes heights do not count: all is one layer of cells.
std::vector<Cell> reachable_cells(const Scene& scene, const CellEdges& edges, const Vec3& origin,
                                  const Cell& period, int axes = 3);

}  // namespace cuboct
