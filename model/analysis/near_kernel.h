// SPDX-License-Identifier: MIT
// Distances of listed pairs, in vectors.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "model/contract/fixed_rule.h"

namespace cuboct {

// Pairs inside a cutoff, in the order of their list: the first `count` of each array.
struct PairDistances {
  size_t count = 0;
  std::vector<uint32_t> i, j;  // ids
  std::vector<double> r;       // m
};

// Two particles that are nearer through the seam of a periodic box, and the periods that x_j moves for it.
struct PairAcross {
  uint32_t i, j;
  std::array<int8_t, 3> image;
};

// A list's particles [begin, end): `others[first[i]]` to `others[first[i + 1]]` are those near i, of more
// than i.
struct ListedPairs {
  const Int3* x;  // by id
  std::array<int64_t, 3> period;
  size_t begin, end;
  const size_t* first;
  const uint32_t* others;
};

// Those of the pairs whose distance, `unit` (m) times that of their integers, is below `cutoff` (m); and into
// `across` those that meet through a seam, at any distance. |differences| < 2^53; those along an axis count
// `shape` units.
void near_distances(const ListedPairs& pairs, double unit, const CellShape& shape, double cutoff,
                    PairDistances& inside, std::vector<PairAcross>& across);

}  // namespace cuboct
