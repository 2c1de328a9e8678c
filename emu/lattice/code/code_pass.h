// SPDX-License-Identifier: MIT
// A round's pair terms over the entries of a block, by compiled code: what PairPass makes.
#pragma once

#include "emu/lattice/code/library.h"
#include "emu/lattice/rounds/pair_pass.h"

namespace cuboct::emu {

class CodePass {
 public:
  // All must outlive it.
  CodePass(const CodeLibrary& library, const graph::FixedProgram& program, const BondSpace& space,
           size_t round, bool once);

  // As PairPass::run.
  bool run(const Scope& scope, BondList& bonds, Sums& sums) const;

 private:
  const CodeLibrary& library_;
  const graph::FixedProgram& program_;
  const BondSpace& space_;
  size_t round_;
  bool once_;
  std::vector<double> bond_constants_;
};

}  // namespace cuboct::emu
