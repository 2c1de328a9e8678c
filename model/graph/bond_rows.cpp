// SPDX-License-Identifier: MIT
#include "model/graph/bond_rows.h"

#include <algorithm>

namespace cuboct::graph {

uint64_t BondRows::twin(uint32_t id, uint64_t bond) const {
  const auto begin = other.begin() + static_cast<ptrdiff_t>(first[other[bond]]);
  const auto end = other.begin() + static_cast<ptrdiff_t>(first[other[bond] + 1]);
  return static_cast<uint64_t>(std::lower_bound(begin, end, id) - other.begin());
}

uint64_t BondRows::longest() const {
  uint64_t most = 0;
  for (size_t i = 0; i + 1 < first.size(); ++i) most = std::max(most, first[i + 1] - first[i]);
  return most;
}

uint32_t BondRows::kinds() const { return kind.empty() ? 1 : 1 + *std::ranges::max_element(kind); }

std::vector<uint64_t> begins_of(const BondRows& rows, int numbers) {
  std::vector<uint64_t> begins;
  for (const uint64_t first : rows.first) begins.push_back(first * static_cast<uint64_t>(numbers));
  return begins;
}

}  // namespace cuboct::graph
