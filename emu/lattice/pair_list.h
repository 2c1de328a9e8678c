// SPDX-License-Identifier: MIT
// Makes the blocks' entries.
#pragma once

#include <span>

#include "emu/lattice/search.h"

namespace cuboct::emu {

// Pairs within `reach` cells in the snapshot. Writes the far lists, edge_group, the rings and `plain` of `block`.
void build_list(const KernelRule& rule, const Lattice& lattice, const Rows& rows, const Snapshot& snapshot,
                const Particles& particles, double reach, Block& block);

}  // namespace cuboct::emu
