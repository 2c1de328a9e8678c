// SPDX-License-Identifier: MIT
#include "emu/gpu/cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <tuple>

#include "model/base/error.h"

namespace cuboct::gpu {
namespace {

// Neighbours in space are near in memory: bricks of this many cells a side.
constexpr int kBrick = 4;

// Appends the cells of planes [first, first + count), taken modulo the total, to the storage order.
void rank_planes(const Geometry& geometry, int axis, int first, int count, SlabCells& slab) {
  struct Place {
    std::array<int, 3> brick, within;
    size_t at;
    bool operator<(const Place& other) const {
      return std::tie(brick, within) < std::tie(other.brick, other.within);
    }
  };
  std::vector<Place> places;
  Cell size = geometry.total;
  size[axis] = slab.local_planes;
  const int to_local = first - slab.local_first;
  Cell c;
  for (int p = 0; p < count; ++p)
    for (int u = 0; u < geometry.total[(axis + 1) % 3]; ++u)
      for (int w = 0; w < geometry.total[(axis + 2) % 3]; ++w) {
        c[axis] = modulo(first + p, geometry.total[axis]);
        c[(axis + 1) % 3] = u;
        c[(axis + 2) % 3] = w;
        if (geometry.lattice && geometry.lattice->find({c[0] + geometry.low[0], c[1] + geometry.low[1],
                                                        c[2] + geometry.low[2]}) == kNoCell)
          continue;
        Cell local = c;
        local[axis] = to_local + p;
        Place place;
        for (int a = 0; a < 3; ++a) place.brick[2 - a] = c[a] / kBrick, place.within[2 - a] = c[a] % kBrick;
        place.at = (static_cast<size_t>(local[2]) * size[1] + local[1]) * size[0] + local[0];
        places.push_back(place);
      }
  std::sort(places.begin(), places.end());
  for (const Place& place : places) slab.rank[place.at] = slab.ranks++;
}

}  // namespace

std::vector<int> slab_ends(const std::vector<uint64_t>& per_plane, int slabs, int least) {
  const int planes = static_cast<int>(per_plane.size());
  const uint64_t all = std::accumulate(per_plane.begin(), per_plane.end(), uint64_t{0});
  std::vector<int> ends;
  uint64_t before = 0;
  int plane = 0;
  for (int s = 0; s < slabs; ++s) {
    const int begin = plane, latest = planes - (slabs - 1 - s) * least;
    const uint64_t goal = all * static_cast<uint64_t>(s + 1) / static_cast<uint64_t>(slabs);
    while (plane < latest && (plane < begin + least || before + per_plane[plane] / 2 < goal))
      before += per_plane[plane++];
    if (s + 1 == slabs) plane = planes;
    ends.push_back(plane);
  }
  return ends;
}

int Cells::plane(const Cell& cell) const {
  const int p = cell[axis] - geometry.low[axis];
  return geometry.wraps[axis] || geometry.folds ? modulo(p, geometry.total[axis]) : p;
}

int Cells::owner(int plane) const {
  for (size_t s = 0; s < slabs.size(); ++s)
    if (plane >= slabs[s].first && plane < slabs[s].first + slabs[s].planes) return static_cast<int>(s);
  return -1;
}

Cells make_cells(const Geometry& geometry, const std::array<std::vector<uint64_t>, 3>& per_plane, int slabs) {
  Cells cells;
  cells.geometry = geometry;
  cells.axis = static_cast<int>(std::max_element(geometry.total.begin(), geometry.total.end()) -
                                geometry.total.begin());
  const int total = geometry.total[cells.axis], reach = geometry.reach;
  // Borders of a slab must not overlap, nor its two copies.
  const int least = 2 * reach;
  if (slabs > 1 && total < slabs * least)
    throw InputError(
        fmt::format("{} slabs of {} planes of cells or more: the scene has {} along its longest axis", slabs,
                    least, total),
        "use fewer devices");
  const bool ring = geometry.wraps[cells.axis] || geometry.folds;
  const std::vector<int> ends =
      slabs > 1 ? slab_ends(per_plane[cells.axis], slabs, least) : std::vector<int>{total};
  for (int s = 0; s < slabs; ++s) {
    SlabCells slab;
    slab.first = s == 0 ? 0 : ends[s - 1];
    slab.planes = ends[s] - slab.first;
    if (slabs > 1) {
      slab.lower = s > 0 ? s - 1 : ring ? slabs - 1 : -1;
      slab.upper = s + 1 < slabs ? s + 1 : ring ? 0 : -1;
    }
    const int below = slab.lower >= 0 ? reach : 0, above = slab.upper >= 0 ? reach : 0;
    slab.local_first = slab.first - below;
    slab.local_planes = slab.planes + below + above;
    Cell size = geometry.total;
    size[cells.axis] = slab.local_planes;
    slab.rank.assign(static_cast<size_t>(size[0]) * size[1] * size[2], kNoCell);
    rank_planes(geometry, cells.axis, slab.first, below, slab);
    slab.low_end = slab.ranks;
    rank_planes(geometry, cells.axis, slab.first + below, slab.planes - below - above, slab);
    slab.inner_end = slab.ranks;
    rank_planes(geometry, cells.axis, slab.first + slab.planes - above, above, slab);
    slab.own_end = slab.ranks;
    rank_planes(geometry, cells.axis, slab.first - below, below, slab);
    slab.lower_copy_end = slab.ranks;
    rank_planes(geometry, cells.axis, slab.first + slab.planes, above, slab);
    cells.slabs.push_back(std::move(slab));
  }
  return cells;
}

}  // namespace cuboct::gpu
