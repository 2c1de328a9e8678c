// SPDX-License-Identifier: MIT
// A round's finish by compiled code: what FinishPass makes, and of the last round what moves.
#pragma once

#include "emu/lattice/code/code_pass.h"
#include "emu/lattice/kernel.h"
#include "emu/lattice/rounds/pair_pass.h"

namespace cuboct::emu {

class FinishCodePass {
 public:
  // All must outlive it.
  FinishCodePass(const CodeLibrary& library, const KernelRule& rule, size_t round)
      : library_(library), rule_(rule), round_(round) {}

  // `sums`: of CodePass.
  struct Step {
    const Active& active;
    uint64_t step;
    const WantedGroups& wanted;
    const Sums& sums;
  };
  // Of a round but the last: writes fields. False where something does not fit.
  bool run(Particles& particles, Block& block, const Step& step) const;
  // Of the last round: whether all fits; then moves, with all that it writes.
  bool fits(Particles& particles, Block& block, const Step& step) const;
  void move(Particles& particles, Block& block, const Step& step) const { run(particles, block, step); }

 private:
  bool call(FinishCode code, Particles& particles, Block& block, const Step& step) const;

  const CodeLibrary& library_;
  const KernelRule& rule_;
  size_t round_;
};

}  // namespace cuboct::emu
