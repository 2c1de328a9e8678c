// SPDX-License-Identifier: MIT
// A round's pair terms over the entries of a block: a lane is a pair, seen from its own particle's end.
//
// A term that is odd or even under a swap of own and other is made once for both ends: the sum of the other
// takes it with its sign.
#pragma once

#include <vector>

#include "emu/lattice/kernel.h"
#include "emu/lattice/rounds/bond_list.h"
#include "emu/lattice/rounds/pair_parts.h"
#include "emu/lattice/rounds/vector_block.h"
#include "model/graph/program.h"

namespace cuboct::emu {

// A step of a block.
struct Scope {
  const Particles& particles;
  const Block& block;
  const Active& active;
  uint64_t step = 0;
};

// Of one round by term: [index - block.begin].
using Sums = std::vector<PaddedArray<double>>;

class PairPass {
 public:
  // `program`, `round` and `space` must outlive it. `once`: terms are made once for both ends of a pair
  // inside the block, which only a round that is_mutual allows.
  PairPass(const graph::FixedProgram& program, const graph::Round& round, const BondSpace& space, bool once);

  // The sums of the groups that are wanted; writes what the round makes of their bonds. False where a pair
  // that counts has what does not fit, or is not met. `bonds`: of a bonded program.
  bool run(const Scope& scope, BondList& bonds, Sums& sums);

 private:
  void meet_pairs(const Scope& scope, Sums& sums);
  void meet_bonds(const Scope& scope, BondList& bonds, Sums& sums);
  void meet(const Scope& scope, uint32_t base, const Entry& entry);
  void turn(size_t from);
  void meet_bond(const Scope& scope, uint32_t base, const Entry& entry, uint32_t lane, size_t slot,
                 const BondList& bonds);
  void write_bonds(const Scope& scope, size_t lanes, BondList& bonds);
  void fill(const Scope& scope, const std::vector<int>& inputs, size_t lanes, const BondList& bonds);
  void flush(const Scope& scope, Ends ends, BondList& bonds, Sums& sums);
  size_t choose(size_t lanes);
  void repeat_first(const std::vector<int>& nodes, size_t lanes);
  void add(const Scope& scope, Ends ends, size_t lanes, Sums& sums);

  const graph::FixedProgram& program_;
  const graph::Round& round_;
  const graph::Graph& graph_;
  const BondSpace& space_;
  bool once_;
  int when_;
  PairParts parts_;
  std::vector<int> early_inputs_, late_inputs_;
  std::vector<int> kept_;  // what the second part reads of the first
  VectorBlock block_;
  std::vector<std::pair<size_t, double*>> apart_;  // axis, lanes
  size_t count_ = 0;
  bool fits_ = true;
  PaddedArray<uint32_t> own_, other_, chosen_;
  PaddedArray<uint64_t> slot_;  // of a bonded program
};

}  // namespace cuboct::emu
