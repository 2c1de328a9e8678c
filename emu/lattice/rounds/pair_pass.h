// SPDX-License-Identifier: MIT
// Interprets a round's pair terms over the entries of a job: a lane is a pair, seen from its own particle's
// end.
//
// A term that is odd or even under a swap of own and other is made once for both ends: the sum of the other
// takes it with its sign.
#pragma once

#include <vector>

#include "emu/lattice/code/job.h"
#include "emu/lattice/rounds/pair_parts.h"
#include "emu/lattice/rounds/vector_block.h"
#include "model/graph/program.h"

namespace cuboct::emu {

class PairPass {
 public:
  // `program` and `round` must outlive it.
  PairPass(const graph::FixedProgram& program, const graph::Round& round);

  // As a MeetCode. Ends::both needs a round that is_mutual.
  void run(const Job& job, Ends ends);

 private:
  void meet(const Job& job, uint32_t place, uint32_t base, const Entry& entry, uint64_t slot, Ends ends);
  bool meet_bond(const Job& job, size_t k, const Entry& entry);
  void turn(size_t from);
  void fill(const Job& job, const std::vector<int>& inputs, size_t lanes);
  void flush(const Job& job, Ends ends);
  size_t choose(size_t lanes);
  void repeat_first(const std::vector<int>& nodes, size_t lanes);
  void tell_misfits(const Job& job, Ends ends, size_t lanes) const;
  void add(const Job& job, Ends ends, size_t lanes) const;
  void write_bonds(const Job& job, size_t lanes) const;

  const graph::FixedProgram& program_;
  const graph::Round& round_;
  const graph::Graph& graph_;
  int when_;
  PairParts parts_;
  std::vector<int> early_inputs_, late_inputs_;
  std::vector<int> kept_;  // what the second part reads of the first
  VectorBlock block_;
  std::vector<std::pair<size_t, double*>> apart_;  // axis, lanes
  size_t count_ = 0;
  // By lane. Places: of the ends in the sums.
  PaddedArray<uint32_t> own_, other_, own_place_, other_place_, chosen_;
  PaddedArray<uint64_t> slot_;
  std::vector<const Entry*> entry_;
};

}  // namespace cuboct::emu
