// SPDX-License-Identifier: MIT
// hash_of (model/contract/state.h) over many particles at once.
#pragma once

#include <cstdint>

#include "emu/lattice/block.h"
#include "model/contract/lattice.h"

namespace cuboct::emu {

// The sum of hash_of over the particles [begin, end), begin a multiple of kGroup; `cell` by id.
uint64_t hash_particles(const Particles& particles, const Lattice& lattice, const uint32_t* cell,
                        const Widths& widths, uint32_t begin, uint32_t end);

}  // namespace cuboct::emu
