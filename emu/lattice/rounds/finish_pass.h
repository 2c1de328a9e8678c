// SPDX-License-Identifier: MIT
// A round's finish over the particles of a block, as lanes.
#pragma once

#include <vector>

#include "emu/lattice/kernel.h"
#include "emu/lattice/rounds/move.h"
#include "emu/lattice/rounds/pair_pass.h"
#include "emu/lattice/rounds/vector_block.h"
#include "model/graph/program.h"

namespace cuboct::emu {

class FinishPass {
 public:
  // `program` and `round` must outlive it.
  FinishPass(const graph::FixedProgram& program, const graph::Round& round, const KernelRule& rule);

  // Writes fields, and, of the last round, `moves`, of the awake particles. False where something does not
  // fit.
  bool run(Particles& particles, const Block& block, const Active& active, uint64_t step, const Sums& sums,
           Moves& moves);

 private:
  void fill(const Particles& particles, uint32_t block_begin, uint32_t begin, size_t lanes, uint64_t step,
            const Sums& sums);
  bool wake(const Particles& particles, uint32_t begin, size_t lanes, const Active& active);
  void keep(const double* values, PaddedArray<double>& to, uint32_t begin, size_t lanes,
            const Particles& particles, const Active& active, bool field) const;

  const graph::FixedProgram& program_;
  const graph::Round& round_;
  const KernelRule& rule_;
  std::vector<int> nodes_, inputs_;
  VectorBlock block_;
};

}  // namespace cuboct::emu
