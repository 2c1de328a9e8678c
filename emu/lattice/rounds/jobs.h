// SPDX-License-Identifier: MIT
// What one step of a block is, as interpreted and compiled rounds are given it (code/job.h).
#pragma once

#include <vector>

#include "emu/lattice/code/job.h"
#include "emu/lattice/kernel.h"
#include "emu/lattice/rounds/bond_list.h"

namespace cuboct::emu {

// Of one round by term.
using Sums = std::vector<PaddedArray<double>>;

struct RoundStep {
  Particles& particles;
  Block& block;
  const Active& active;
  uint64_t step = 0;
};

// Arrays of pointers that jobs point to: they live as long as this does.
class Jobs {
 public:
  // All must outlive it.
  Jobs(const RoundStep& step, const KernelRule& rule, const CodeNumbers& numbers, BondList& bonds);

  // Without a list, sums, groups to work on, and whom to ask.
  Job pairs() const;
  FinishJob finish() const;

 private:
  RoundStep step_;
  const KernelRule& rule_;
  CodeNumbers numbers_;
  BondList& bonds_;
  std::vector<double*> fields_, bond_numbers_;
};

std::vector<double*> pointers(Sums& arrays);

}  // namespace cuboct::emu
