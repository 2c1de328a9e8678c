// SPDX-License-Identifier: MIT
// A round's pair terms over the rows of a block: lanes are pairs of one particle after another.
//
// A term that is odd or even under a swap of own and other is made once for both ends: the sum of the other
// takes it with its sign.
#pragma once

#include <vector>

#include "emu/lattice/kernel.h"
#include "emu/lattice/rounds/partner_list.h"
#include "emu/lattice/rounds/vector_block.h"
#include "model/graph/program.h"

namespace cuboct::emu {

class PairPass {
 public:
  // `program` and `round` must outlive it. `once`: rows have each pair inside the block once, which only a
  // round that is_mutual takes.
  PairPass(const graph::FixedProgram& program, const graph::Round& round, bool once);
  static bool is_mutual(const graph::Round& round);

  // Of a bonded program: its bonds, and the cells across which they meet.
  struct Bonds {
    const graph::BondRows* rows = nullptr;  // null: the program has none
    BondNumbers* numbers = nullptr;
    double cell = 0;                 // 2^P
    std::array<double, 3> period{};  // visible units; 0: the box does not repeat
  };
  // sums[component of all sums][index], of the particles of the block that are wanted (by cell; null: all).
  // Writes what the round makes of their bonds. False where a pair that counts has what does not fit, or is
  // not met.
  bool run(const Particles& particles, const PartnerList& list, const Block& block, const Active& active,
           uint64_t step, std::vector<PaddedArray<double>>& sums, const Bonds& bonds);

 private:
  void meet(const Particles& particles, uint32_t own, uint32_t partner);
  void meet_bond(const Particles& particles, uint32_t own, uint32_t other, uint64_t bond, const Bonds& bonds);
  bool is_broken(uint64_t bond, const Bonds& bonds);
  void write_bonds(size_t lanes, const Particles& particles, const Active& active, const Bonds& bonds);
  void fill(const std::vector<int>& inputs, const Particles& particles, size_t lanes, uint64_t step,
            const Bonds& bonds);
  void flush(const Particles& particles, const Block& block, const Active& active, uint64_t step,
             std::vector<PaddedArray<double>>& sums, const Bonds& bonds);
  size_t choose(size_t lanes);
  void repeat_first(const std::vector<int>& nodes, size_t lanes);
  void add(size_t lanes, const Block& block, std::vector<PaddedArray<double>>& sums);

  const graph::FixedProgram& program_;
  const graph::Round& round_;
  const graph::Graph& graph_;
  int when_;
  std::vector<int> terms_;
  std::vector<double> signs_;  // by term: of the other end; empty: that has a row of its own
  // Nodes that `when` needs, and those that the terms need besides; of both the inputs, and what the second
  // reads of the first.
  std::vector<int> early_, late_, early_inputs_, late_inputs_, kept_;
  VectorBlock block_;
  std::vector<std::pair<size_t, double*>> apart_;  // axis, lanes
  size_t count_ = 0;
  bool fits_ = true;
  PaddedArray<uint32_t> own_, other_, chosen_;
  PaddedArray<uint64_t> bond_;  // of a bonded program
};

}  // namespace cuboct::emu
