// SPDX-License-Identifier: MIT
#include "emu/lattice/cut.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>

#include "model/base/error.h"

namespace cuboct::emu {
namespace {

// Gives [begin, end) of `nodes` to the ranks [first, first + ranks), cut in planes across `axis` (-1: the
// longest).
void bisect(const Lattice& lattice, const std::vector<uint16_t>& weight, std::vector<uint32_t>& nodes,
            size_t begin, size_t end, int first, int ranks, int axis, std::vector<uint16_t>& owner) {
  if (ranks == 1 || begin == end) {
    for (size_t k = begin; k < end; ++k) owner[nodes[k]] = static_cast<uint16_t>(first);
    return;
  }
  int along = axis;
  if (axis < 0) {
    Cell low, high;
    low.fill(std::numeric_limits<int32_t>::max());
    high.fill(std::numeric_limits<int32_t>::min());
    for (size_t k = begin; k < end; ++k)
      for (int a = 0; a < 3; ++a) {
        low[a] = std::min(low[a], lattice.cell(nodes[k])[a]);
        high[a] = std::max(high[a], lattice.cell(nodes[k])[a]);
      }
    // Particles are stored in rows along x: a cut across x leaves stumps of rows at the rim, so x has to be
    // twice as long.
    const auto length = [&](int a) { return (a == 0 ? 1 : 2) * (int64_t{high[a]} - low[a]); };
    along = 0;
    for (int a = 1; a < 3; ++a)
      if (length(a) >= length(along)) along = a;
  }
  std::map<int32_t, uint64_t> planes;  // coordinate, weight
  uint64_t total = 0;
  for (size_t k = begin; k < end; ++k) {
    planes[lattice.cell(nodes[k])[along]] += weight[nodes[k]];
    total += weight[nodes[k]];
  }
  // The plane below which the share of the lower ranks is met best.
  const int lower = ranks / 2;
  const double share = static_cast<double>(total) * lower / ranks;
  int32_t plane = planes.empty() ? 0 : planes.begin()->first;
  double sum = 0, best = share;
  for (const auto& [at, w] : planes) {
    sum += static_cast<double>(w);
    if (std::abs(sum - share) < best) {
      best = std::abs(sum - share);
      plane = at + 1;
    }
  }
  const auto middle = std::stable_partition(nodes.begin() + static_cast<ptrdiff_t>(begin),
                                            nodes.begin() + static_cast<ptrdiff_t>(end),
                                            [&](uint32_t n) { return lattice.cell(n)[along] < plane; });
  const auto at = static_cast<size_t>(middle - nodes.begin());
  bisect(lattice, weight, nodes, begin, at, first, lower, axis, owner);
  bisect(lattice, weight, nodes, at, end, first + lower, ranks - lower, axis, owner);
}

}  // namespace

std::vector<uint16_t> cut_nodes(const Lattice& lattice, const std::vector<uint16_t>& weight, int ranks,
                                const std::string& how) {
  const std::string axes = "xyz";
  const bool slabs = how.size() == 1 && axes.find(how) != std::string::npos;
  if (!slabs && how != "bricks")
    throw InputError(fmt::format("unknown cut '{}'", how), "one of bricks, x, y, z");
  std::vector<uint16_t> owner(lattice.size());
  std::vector<uint32_t> nodes(lattice.size());
  std::iota(nodes.begin(), nodes.end(), 0u);
  bisect(lattice, weight, nodes, 0, nodes.size(), 0, ranks, slabs ? static_cast<int>(axes.find(how)) : -1,
         owner);
  return owner;
}

}  // namespace cuboct::emu
