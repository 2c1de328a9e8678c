// SPDX-License-Identifier: MIT
// The end of a program's step: velocities, displacements and places of a block, as its last finish has them.
#pragma once

#include <array>

#include "emu/lattice/kernel.h"
#include "model/graph/program.h"

namespace cuboct::emu {

// By axis and index: what the last finish makes, before anything moves.
struct Moves {
  int axes = 3;
  std::array<PaddedArray<double>, 3> v, drift, u;  // u: empty where no particle has a displacement
};

// Zeros, for particles at places below `room`.
Moves moves_for(const graph::FixedProgram& program, size_t room);

// Tells the block who left its cell, and its largest speed.
void move_block(const KernelRule& rule, const Moves& moves, const Active& active, Particles& particles,
                Block& block);

}  // namespace cuboct::emu
