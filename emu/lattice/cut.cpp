// SPDX-License-Identifier: MIT
#include "emu/lattice/cut.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>

#include "hw/arch/cell_box.h"
#include "model/base/error.h"

namespace cuboct::emu {
namespace {

// Gives [begin, end) of `cells` to the ranks [first, first + ranks), cut in planes across `axis` (-1: the
// longest).
void bisect(const Lattice& lattice, const std::vector<uint16_t>& weight, std::vector<uint32_t>& cells,
            size_t begin, size_t end, int first, int ranks, int axis, std::vector<uint16_t>& owner) {
  if (ranks == 1 || begin == end) {
    for (size_t k = begin; k < end; ++k) owner[cells[k]] = static_cast<uint16_t>(first);
    return;
  }
  int along = axis;
  if (axis < 0) {
    CellBox box;
    for (size_t k = begin; k < end; ++k) box.add(lattice.cell(cells[k]));
    // Particles are stored in rows along x: a cut across x leaves stumps of rows at the rim, so x has to be
    // twice as long.
    const auto length = [&](int a) { return (a == 0 ? 1 : 2) * (box.extent(a) - 1); };
    along = 0;
    for (int a = 1; a < 3; ++a)
      if (length(a) >= length(along)) along = a;
  }
  std::map<int32_t, uint64_t> planes;  // coordinate, weight
  uint64_t total = 0;
  for (size_t k = begin; k < end; ++k) {
    planes[lattice.cell(cells[k])[along]] += weight[cells[k]];
    total += weight[cells[k]];
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
  const auto middle = std::stable_partition(cells.begin() + static_cast<ptrdiff_t>(begin),
                                            cells.begin() + static_cast<ptrdiff_t>(end),
                                            [&](uint32_t n) { return lattice.cell(n)[along] < plane; });
  const auto at = static_cast<size_t>(middle - cells.begin());
  bisect(lattice, weight, cells, begin, at, first, lower, axis, owner);
  bisect(lattice, weight, cells, at, end, first + lower, ranks - lower, axis, owner);
}

}  // namespace

std::vector<uint16_t> cut_cells(const Lattice& lattice, const std::vector<uint16_t>& weight, int ranks,
                                const std::string& how) {
  const std::string axes = "xyz";
  const bool slabs = how.size() == 1 && axes.find(how) != std::string::npos;
  if (!slabs && how != "bricks")
    throw InputError(fmt::format("unknown cut '{}'", how), "one of bricks, x, y, z");
  std::vector<uint16_t> owner(lattice.size());
  std::vector<uint32_t> cells(lattice.size());
  std::iota(cells.begin(), cells.end(), 0u);
  bisect(lattice, weight, cells, 0, cells.size(), 0, ranks, slabs ? static_cast<int>(axes.find(how)) : -1,
         owner);
  return owner;
}

}  // namespace cuboct::emu
