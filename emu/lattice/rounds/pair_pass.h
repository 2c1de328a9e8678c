// SPDX-License-Identifier: MIT
// A round's pair terms over the entries of a block: a lane is a pair, seen from its own particle's end.
//
// A term that is odd or even under a swap of own and other is made once for both ends: the sum of the other
// takes it with its sign.
#pragma once

#include <span>
#include <vector>

#include "emu/lattice/kernel.h"
#include "emu/lattice/rounds/bond_list.h"
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

// The cells across which bonds meet.
struct BondSpace {
  const graph::BondRows* rows = nullptr;  // null: the program has no bonds
  double cell = 0;                        // 2^P
  std::array<double, 3> period{};         // visible units; 0: the box does not repeat
};

class PairPass {
 public:
  // `program`, `round` and `space` must outlive it. `once`: terms are made once for both ends of a pair
  // inside the block, which only a round that is_mutual allows.
  PairPass(const graph::FixedProgram& program, const graph::Round& round, const BondSpace& space, bool once);
  static bool is_mutual(const graph::Round& round);

  // The sums of the groups that are wanted; writes what the round makes of their bonds. False where a pair
  // that counts has what does not fit, or is not met. `bonds`: of a bonded program.
  bool run(const Scope& scope, BondList& bonds, Sums& sums);

 private:
  enum class Ends { own, both };  // whose sums take the term
  void meet_pairs(const Scope& scope, Sums& sums);
  void meet_bonds(const Scope& scope, BondList& bonds, Sums& sums);
  void meet(const Scope& scope, uint32_t base, const Entry& entry);
  void turn(size_t from);
  void meet_bond(const Scope& scope, uint32_t base, const Entry& entry, uint32_t lane, size_t slot,
                 const BondList& bonds);
  bool is_met(const std::array<double, 3>& own, std::array<double, 3>& apart) const;
  bool is_broken(size_t slot, const BondList& bonds) const;
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
  std::vector<int> terms_;
  std::vector<double> signs_;  // by term: of the other end
  // Nodes that `when` needs, and those that the terms need besides; of both the inputs, and what the second
  // reads of the first.
  std::vector<int> early_, late_, early_inputs_, late_inputs_, kept_;
  VectorBlock block_;
  std::vector<std::pair<size_t, double*>> apart_;  // axis, lanes
  size_t count_ = 0;
  bool fits_ = true;
  PaddedArray<uint32_t> own_, other_, chosen_;
  PaddedArray<uint64_t> slot_;  // of a bonded program
};

}  // namespace cuboct::emu
