// SPDX-License-Identifier: MIT
// Makes the blocks' entries.
#pragma once

#include <span>

#include "emu/lattice/search.h"

namespace cuboct::emu {

// Pairs within `reach` cells in the snapshot; `place` is its places(). Writes the far lists, edge_group, the rings and
// `plain` of `block`. With `only`, by group, the others keep their entries.
void build_list(const KernelRule& rule, const Lattice& lattice, const Rows& rows, const Snapshot& snapshot,
                const std::vector<uint32_t>& place, const Particles& particles, double reach,
                const std::vector<uint8_t>* only, Block& block);

}  // namespace cuboct::emu
