// SPDX-License-Identifier: MIT
// Compiled code beside the interpreter, before the first step by it.
#pragma once

#include "emu/lattice/rounds/block_rounds.h"

namespace cuboct::emu {

// Runs some 4,096 random pairs and as many random particles by both, of one round: positions, velocities,
// sums and fields within their ranges, lanes that count and lanes that do not, some particles asleep. Throws
// InputError where a sum, a bond, a field, a place or a refusal differs: the compiler is not to be trusted
// with this rule. Returns how many groups of particles fitted, so that their finish was compared.
int prove(const RoundCode& code, size_t round);

}  // namespace cuboct::emu
