// SPDX-License-Identifier: MIT
// A round's pair terms over the entries of a block, by compiled code: what PairPass makes.
#pragma once

#include "emu/lattice/code/library.h"
#include "emu/lattice/rounds/pair_pass.h"

namespace cuboct::emu {

// Of a block's groups, ascending. Where no cell is at rest all are wanted, and these are empty.
struct WantedGroups {
  WantedGroups() = default;
  WantedGroups(const Particles& particles, const Block& block, const Active& active);
  std::vector<uint32_t> near;    // pairs of some particle may be needed
  std::vector<uint32_t> awake;   // some particle is updated
  std::vector<uint8_t> is_near;  // by group
};

struct CodeScope : Scope {
  const WantedGroups& wanted;
};

class CodePass {
 public:
  // All must outlive it.
  CodePass(const CodeLibrary& library, const graph::FixedProgram& program, const BondSpace& space,
           size_t round, bool once);

  // As PairPass::run, but for the sums: kMagic is added to each (kernel_rule.h), and those of groups without
  // anyone awake are anything.
  bool run(const CodeScope& scope, BondList& bonds, Sums& sums) const;

 private:
  const CodeLibrary& library_;
  const graph::FixedProgram& program_;
  const BondSpace& space_;
  size_t round_;
  bool once_;
  std::vector<double> bond_constants_;
};

}  // namespace cuboct::emu
