// SPDX-License-Identifier: MIT
// The pairs of a fixed rule's particles that are near each other, each once: listed with a skin, so that one
// list serves many states of a run. L. Verlet, Phys. Rev. 159 (1967) 98.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "model/analysis/near_kernel.h"
#include "model/contract/lattice.h"
#include "model/contract/state.h"

namespace cuboct {

class NearPairs {
 public:
  // References outlive it. `threads`: 0 for one per core. The order of pairs depends neither on them
  // nor on the states taken before.
  NearPairs(const FixedRule& rule, const Lattice& lattice, int threads);

  // Takes the places of a state, and makes a new list where the old one may lack a pair inside the cutoff.
  // States come in the order of their steps, of the same particles, ids 0, 1, ...
  void take(const State& state);

  // Particles by blocks: sums that are made block by block depend on no number of threads.
  static constexpr size_t kBlock = 1024;
  size_t blocks() const { return (x_.size() + kBlock - 1) / kBlock; }
  size_t first_of(size_t block) const { return std::min(x_.size(), block * kBlock); }
  // The block's pairs nearer than `cutoff` (m): its particles in order of their ids, and with each those of
  // larger id in theirs. Those that meet through a seam, at this distance or somewhat beyond, go into
  // `across`.
  void distances(size_t block, double cutoff, PairDistances& inside, std::vector<PairAcross>& across) const;

  // x_j - x_i of the nearest image, P+G fractional bits.
  Int3 difference(uint32_t i, uint32_t j) const { return between(x_[i], x_[j]); }
  const Int3& period() const { return period_; }  // P+G fractional bits; 0: none

  // What readings cost: lists so far, and pairs in the last, each of which a state's reading looks at once.
  uint64_t lists_made() const { return lists_made_; }

 private:
  // Modulo 2^64, as all that is wanted are differences over a few cells.
  Int3 between(const Int3& from, const Int3& to) const {
    Int3 d;
    for (size_t a = 0; a < 3; ++a) {
      d[a] = static_cast<int64_t>(static_cast<uint64_t>(to[a]) - static_cast<uint64_t>(from[a]));
      if (period_[a] == 0) continue;
      if (d[a] > period_[a] / 2) d[a] -= period_[a];
      if (d[a] < -(period_[a] / 2)) d[a] += period_[a];
    }
    return d;
  }
  double moved() const;
  void list();

  const Lattice& lattice_;
  int frac_, threads_;
  double unit_;  // m, of the last of P+G fractional bits of the longest edge
  CellShape shape_;
  double cutoff_;  // longest edges, as all distances here
  Int3 period_{};  // P+G fractional bits; 0: none
  double skin_ = 0;
  uint64_t states_ = 0;  // that the list has served
  uint64_t lists_made_ = 0;
  std::vector<Int3> x_;   // by id, from cell (0, 0, 0)
  std::vector<Int3> at_;  // where the list found them
  std::vector<size_t> first_;
  std::vector<uint32_t> other_;
};

}  // namespace cuboct
