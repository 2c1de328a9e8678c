// SPDX-License-Identifier: MIT
// Builds the near-list entries of each block.
#pragma once

#include <span>

#include "emu/lattice/search.h"

namespace cuboct::emu {

// Pairs within the reach of `search`, around the places that the snapshot has: all groups anew. Writes the
// lists, the ring and `plain` of `block`. Particles from `ghosts` on are those of other ranks.
void build_list(const KernelRule& rule, const Particles& particles, uint32_t ghosts, Search search,
                Block& block);

// The same for the groups of `only` (by group, of all blocks); the others keep their entries. All of a
// group's entries come out near. Not with ghosts.
void mend_list(const Particles& particles, const Snapshot& snapshot, Search search,
               const std::vector<uint8_t>& only, Block& block);

}  // namespace cuboct::emu
