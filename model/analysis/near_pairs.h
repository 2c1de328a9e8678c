// SPDX-License-Identifier: MIT
// The pairs of a fixed rule's particles that are near each other, each once: listed with a skin, so that one
// list serves many states of a run. L. Verlet, Phys. Rev. 159 (1967) 98.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

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
  // Calls see(i, j, x_j - x_i in P+G fractional bits, of the nearest image) for the block's particles i in
  // order of their ids, and for each the listed j > i in theirs: the pairs inside the cutoff, and some
  // beyond.
  template <typename See>
  void for_each(size_t block, const See& see) const {
    for (size_t i = first_of(block); i < first_of(block + 1); ++i)
      for (size_t k = first_[i]; k < first_[i + 1]; ++k)
        see(static_cast<uint32_t>(i), other_[k], between(x_[i], x_[other_[k]]));
  }

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
  double cutoff_;         // cells
  Int3 period_{};         // P+G fractional bits; 0: none
  double skin_ = 0;       // cells
  uint64_t states_ = 0;   // that the list has served
  std::vector<Int3> x_;   // by id, from cell (0, 0, 0)
  std::vector<Int3> at_;  // where the list found them
  std::vector<size_t> first_;
  std::vector<uint32_t> other_;
};

}  // namespace cuboct
