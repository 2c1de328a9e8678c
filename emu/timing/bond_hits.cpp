// SPDX-License-Identifier: MIT
#include <algorithm>

#include "emu/timing/hits.h"

namespace cuboct::emu {
namespace {

// The cells around a node in the order of its streamer, with the first of their records among the candidates.
struct Around {
  std::array<uint32_t, 27> cell, first;
  size_t cells = 0;
  uint32_t candidates = 0;
};

Around cells_around(const Filter& filter, const Places& places, uint32_t node,
                    std::array<uint32_t, kSegments>& records) {
  const auto near = [&](uint32_t of, size_t axis, size_t way) {
    return way == 0 ? of : places.neighbour[of][2 * axis + way - 1];
  };
  Around around;
  records = {};
  for (size_t wz = 0; wz < filter.test.layers; ++wz) {
    const uint32_t at_z = near(node, 2, wz);
    for (size_t wy = 0; wy < 3; ++wy) {
      const uint32_t at_y = near(at_z, 1, wy);
      for (size_t wx = 0; wx < 3; ++wx) {
        const uint32_t at = near(at_y, 0, wx), size = places.first[at + 1] - places.first[at];
        around.cell[around.cells] = at;
        around.first[around.cells++] = around.candidates;
        around.candidates += size;
        records[wz != 0 ? 4 + wz : wy != 0 ? 2 + wy : wx] += size;
      }
    }
  }
  return around;
}

}  // namespace

ForceWork filter_bonds(const Filter& filter, const Places& places, uint32_t node, HitScratch& scratch) {
  ForceWork work;
  const uint32_t first = places.first[node], n = places.first[node + 1] - first;
  const uint32_t passes = (n + filter.lanes - 1) / filter.lanes;
  const Around around = cells_around(filter, places, node, work.items);
  const auto end = around.cell.begin() + static_cast<ptrdiff_t>(around.cells);
  const size_t items = size_t{around.candidates} * passes;
  std::fill_n(scratch.items.begin(), items, uint8_t{0});
  for (uint32_t i = 0; i < n; ++i) {
    const uint32_t id = places.id[first + i];
    for (uint64_t b = places.rows->first[id]; b < places.rows->first[id + 1]; ++b) {
      const auto [at, slot] = places.where[places.rows->other[b]];
      const auto cell = std::find(around.cell.begin(), end, at);
      if (cell == end) continue;
      const uint32_t candidate = around.first[static_cast<size_t>(cell - around.cell.begin())] + slot;
      ++scratch.items[size_t{candidate} * passes + i / filter.lanes];
      ++work.pairs;
    }
  }
  for (uint32_t& records : work.items) records *= passes;
  size_t entries = 0;
  for (size_t k = 0; k < items; ++k)
    if (const uint32_t hits = scratch.items[k]; hits > 0)
      scratch.entries[entries++] = ForceWork::entry(k, (hits + filter.pipes - 1) / filter.pipes);
  work.entries = {scratch.entries.data(), entries};
  return work;
}

}  // namespace cuboct::emu
