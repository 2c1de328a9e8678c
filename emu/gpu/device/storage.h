// SPDX-License-Identifier: MIT
// Kernels that bring a slab's particles into the order of their cells and make its pair lists.
#pragma once

#include <cmath>
#include <cstdint>

#include "emu/gpu/device/device.h"
#include "emu/gpu/grid_view.h"
#include "emu/gpu/particle.h"

namespace cuboct::gpu {

inline constexpr uint32_t kGone = 0xffffffffu;  // rank of a particle that has left the slab

// The place of a particle within its cell when the list was made, in ten bits an axis: what tells how far it
// has moved since travels with its velocity.
inline constexpr int kAnchorBits = 10;
inline constexpr float kAnchorSteps = 1 << kAnchorBits;

// Half a step of the anchor along three axes, as a share of the longest edge.
inline constexpr float kAnchorError = 0.8661f / kAnchorSteps;

CUBOCT_DEVICE inline uint32_t anchor_of(const float (&place)[3], const float (&edge)[3]) {
  uint32_t anchor = 0;
  for (int a = 0; a < 3; ++a) {
    const int step = static_cast<int>(place[a] / edge[a] * kAnchorSteps);
    anchor |= static_cast<uint32_t>(step < 0 ? 0 : step > 1023 ? 1023 : step) << kAnchorBits * a;
  }
  return anchor;
}
// From the middle of the anchor's step to `place`, along one axis.
CUBOCT_DEVICE inline float moved_along(float place, uint32_t anchor, int axis, float edge) {
  const auto step = static_cast<float>(anchor >> kAnchorBits * axis & 1023u);
  return place - (step + 0.5f) * (edge / kAnchorSteps);
}

// Where a particle was when its near list was made, from its anchor's middle: eight bits an axis, of a range
// of `range` to both sides, which it does not leave while its list serves.
CUBOCT_DEVICE inline uint32_t near_anchor_of(const float (&moved)[3], float range) {
  uint32_t anchor = 0;
  for (int a = 0; a < 3; ++a) {
    const int step = static_cast<int>((moved[a] / range + 1) * 128);
    anchor |= static_cast<uint32_t>(step < 0 ? 0 : step > 255 ? 255 : step) << 8 * a;
  }
  return anchor;
}
CUBOCT_DEVICE inline float near_anchor_at(uint32_t anchor, int axis, float range) {
  return (static_cast<float>(anchor >> 8 * axis & 255u) - 127.5f) * (range / 128);
}
// Half a step along three axes, as a share of the range.
inline constexpr float kNearAnchorError = 0.8661f / 128;

template <class Policy>
struct ParticlesView {
  typename Policy::Position* x;
  typename Policy::Velocity* v;
  typename Policy::Extra* u;  // null unless the rule has PD types
  Residues<Policy::kFixed> residue;
};

// What leaves a slab for the one beside it.
template <class Policy>
struct Traveller {
  typename Policy::Position x;
  typename Policy::Velocity v;
  typename Policy::Extra u;
  Three<uint32_t> residue;
  CellAt cell;
  uint32_t id;
};

struct Planes {
  int first, planes;  // owned by a slab; 0 planes: there is no such slab
  CUBOCT_DEVICE bool has(int plane) const { return plane >= first && plane < first + planes; }
};

// Positions count from the cells in which particles are now. Those that the slab no longer owns are packed
// for their new owners; `lost` counts those for which there is no room, or whose owner is not beside.
template <class Policy>
struct Resettle {
  typename Policy::View view;
  GridView grid;
  ParticlesView<Policy> at;
  CellAt* cell;
  const uint32_t* id;
  uint32_t* rank;
  bool alone;
  Planes own, beside[2];
  Traveller<Policy>* leaving[2];
  uint32_t* leaving_count;  // of 2
  uint32_t room;
  uint32_t* lost;

  CUBOCT_DEVICE void operator()(uint32_t i) const {
    auto x = at.x[i];
    CellAt c = cell[i];
    for (int a = 0; a < 3; ++a) {
      const int off = Policy::cells_off(view, grid, x, a);
      if (off == 0) continue;
      Policy::take_off(view, grid, x, a, off);
      c.c[a] += off;
      if (Policy::kFixed && grid.wraps[a]) c.c[a] = grid.low[a] + modulo(c.c[a] - grid.low[a], grid.total[a]);
    }
    at.x[i] = x;
    cell[i] = c;
    rank[i] = 0;
    if (alone) return;
    const int axis = grid.axis;
    const int plane = modulo(c.c[axis] - grid.low[axis], grid.total[axis]);
    if (own.has(plane)) return;
    rank[i] = kGone;
    const int side = beside[0].has(plane) ? 0 : beside[1].has(plane) ? 1 : -1;
    if (side >= 0) {
      const uint32_t k = atomic_add(leaving_count + side, 1u);
      if (k < room) {
        Traveller<Policy> t;
        t.x = x, t.v = at.v[i], t.residue = at.residue.load(i), t.cell = c, t.id = id[i];
        if (at.u) t.u = at.u[i];
        leaving[side][k] = t;
        return;
      }
    }
    atomic_add(lost, 1u);
  }
};

struct KeepAll {
  uint32_t* rank;
  CUBOCT_DEVICE void operator()(uint32_t i) const { rank[i] = 0; }
};

template <class Policy>
struct Arrive {
  const Traveller<Policy>* from;
  ParticlesView<Policy> at;
  CellAt* cell;
  uint32_t *id, *rank;
  uint32_t first;
  CUBOCT_DEVICE void operator()(uint32_t k) const {
    const Traveller<Policy> t = from[k];
    const uint32_t i = first + k;
    at.x[i] = t.x, at.v[i] = t.v, cell[i] = t.cell, id[i] = t.id, rank[i] = 0;
    at.residue.store(i, t.residue);
    if (at.u) at.u[i] = t.u;
  }
};

struct CountByCell {
  GridView grid;
  const CellAt* cell;
  uint32_t *rank, *count;
  CUBOCT_DEVICE void operator()(uint32_t i) const {
    if (rank[i] == kGone) return;
    rank[i] = grid.find(cell[i].c);
    if (rank[i] != kNoCell) atomic_add(count + rank[i], 1u);
  }
};

// The number of particles before each of five ranks.
struct PartEnds {
  const uint32_t *first, *count;
  uint32_t* ends;
  uint32_t rank[5];
  CUBOCT_DEVICE void operator()(uint32_t) const {
    for (int k = 0; k < 5; ++k) ends[k] = rank[k] == 0 ? 0 : first[rank[k] - 1] + count[rank[k] - 1];
  }
};

struct Order {
  const uint32_t* rank;
  const uint32_t* first;
  uint32_t *taken, *order;
  CUBOCT_DEVICE void operator()(uint32_t i) const {
    if (rank[i] != kGone) order[first[rank[i]] + atomic_add(taken + rank[i], 1u)] = i;
  }
};

// By id within a cell: sums over a list then have one order, whatever order the places were taken in.
struct OrderInCell {
  const uint32_t *first, *count, *id, *rank;
  const uint32_t* order;
  uint32_t* by_id;
  CUBOCT_DEVICE void operator()(uint32_t k) const {
    const uint32_t i = order[k], key = id[i], begin = first[rank[i]], end = begin + count[rank[i]];
    uint32_t place = begin;
    for (uint32_t m = begin; m < end; ++m) place += id[order[m]] < key;
    by_id[place] = i;
  }
};

template <class Policy>
struct Gather {
  typename Policy::View view;
  GridView grid;
  const uint32_t* order;
  ParticlesView<Policy> from, to;
  const CellAt* cell;
  const uint32_t* id;
  CellAt* new_cell;
  uint32_t* new_id;
  uint32_t* entered;  // null in real engines
  CUBOCT_DEVICE void operator()(uint32_t k) const {
    const uint32_t i = order[k];
    const auto x = load(from.x + i);
    auto v = load(from.v + i);
    float place[3];
    for (int a = 0; a < 3; ++a) place[a] = Policy::along(view, grid, x, a);
    using Anchor = decltype(v.last);
    v.last = static_cast<Anchor>(anchor_of(place, grid.edge));
    to.x[k] = x, to.v[k] = v, new_cell[k] = cell[i], new_id[k] = id[i];
    to.residue.store(k, from.residue.load(i));
    if (from.u) to.u[k] = from.u[i];
    if (entered) entered[k] = 1u << 13;  // its own cell (step.h)
  }
};

struct CountEntries {
  const uint32_t* counts;
  CUBOCT_DEVICE bool idle() const { return false; }
  CUBOCT_DEVICE uint64_t operator()(uint32_t i) const {
    return (counts[i] & kNearMask) + (counts[i] >> kNearBits);
  }
};

// Distance of a place in a cell from the cell `k` away, along one axis.
CUBOCT_DEVICE inline float gap(float place, int k, float edge) {
  if (k == 0) return 0;
  return k > 0 ? static_cast<float>(k) * edge - place : place - static_cast<float>(k + 1) * edge;
}

// All others within `radius` at the time of making, those of one's own cell and of cells up to `reach` away:
// in the order of cells, and of ids in a cell. Answers how many; those beyond `width` are not kept.
template <class Policy>
struct MakeList {
  typename Policy::View view;
  GridView grid;
  float radius, near;  // what the list and its near ones reach
  const typename Policy::Position* x;
  const CellAt* cell;
  const uint32_t *first, *count;
  uint32_t* entries;
  uint32_t* counts;
  uint32_t width;
  size_t stride;

  static constexpr int kSide = 2 * Policy::kReach + 1, kCells = kSide * kSide * kSide;

  struct Found {
    uint32_t near = 0, further = 0;
  };

  CUBOCT_DEVICE uint32_t operator()(uint32_t i) const {
    const Seen seen = look(i);
    Found found;
    for (int k = 0; k < kCells; ++k) in_cell(i, seen, k, Keep{*this, i, found});
    counts[i] = found.near | found.further << kNearBits;
    return found.near + found.further;
  }

  // By several lanes, each of which looks into a cell; they come all, those of no particle with `there`
  // false. First how many a cell has, then where its own stand behind those of the cells before it.
  template <class Lanes>
  CUBOCT_DEVICE uint32_t operator()(uint32_t index, bool there, const Lanes& lanes) const {
    const uint32_t i = there ? index : 0;
    const Seen seen = look(i);
    Found all;
    for (int from = 0; from < kCells; from += Lanes::kCount) {
      const int k = from + lanes.lane;
      Found here;
      if (k < kCells) in_cell(i, seen, k, Count{*this, here});
      Found before{all.near + lanes.before(here.near), all.further + lanes.before(here.further)};
      if (there && k < kCells) in_cell(i, seen, k, Keep{*this, i, before});
      all.near += lanes.total(here.near), all.further += lanes.total(here.further);
    }
    if (!there) return 0;
    if (lanes.lane == 0) counts[i] = all.near | all.further << kNearBits;
    return all.near + all.further;
  }

 private:
  struct Seen {
    float own[3];
    CellAt home;
  };
  CUBOCT_DEVICE Seen look(uint32_t i) const {
    Seen seen{{}, cell[i]};
    for (int a = 0; a < 3; ++a) seen.own[a] = Policy::along(view, grid, x[i], a);
    return seen;
  }

  struct Count {
    const MakeList& list;
    Found& found;
    CUBOCT_DEVICE void operator()(uint32_t, float square, int, int, int) const {
      ++(square <= list.near * list.near ? found.near : found.further);
    }
  };
  struct Keep {
    const MakeList& list;
    uint32_t i;
    Found& found;
    CUBOCT_DEVICE void operator()(uint32_t j, float square, int dx, int dy, int dz) const {
      const uint32_t row = square <= list.near * list.near ? found.near++ : list.width - 1 - found.further++;
      if (row < list.width) list.entries[row * list.stride + i] = Entry<Policy::kReach>::of(j, dx, dy, dz);
    }
  };

  // Calls use(particle, square of its distance, where its cell lies) for those of cell number k that are
  // near.
  template <class Use>
  CUBOCT_DEVICE void in_cell(uint32_t i, const Seen& seen, int k, const Use& use) const {
    const int dx = k % kSide - Policy::kReach, dy = k / kSide % kSide - Policy::kReach,
              dz = k / (kSide * kSide) - Policy::kReach;
    const float(&own)[3] = seen.own;
    const float limit = radius * radius;
    const float gx = gap(own[0], dx, grid.edge[0]), gy = gap(own[1], dy, grid.edge[1]),
                gz = gap(own[2], dz, grid.edge[2]);
    if (gx * gx + gy * gy + gz * gz > limit) return;
    const int32_t at[3] = {seen.home.c[0] + dx, seen.home.c[1] + dy, seen.home.c[2] + dz};
    const uint32_t c = grid.find(at);
    if (c == kNoCell) return;
    const uint32_t end = first[c] + count[c];
    for (uint32_t j = first[c]; j < end; ++j) {
      if (j == i && dx == 0 && dy == 0 && dz == 0) continue;
      bool same = true;  // others share the cell's storage where it folds
      if (grid.folds)
        for (int a = 0; a < 3; ++a) same = same && (grid.wraps[a] || cell[j].c[a] == at[a]);
      if (!same) continue;
      const auto other = x[j];
      const float ex = Policy::along(view, grid, other, 0) - own[0] + static_cast<float>(dx) * grid.edge[0];
      const float ey = Policy::along(view, grid, other, 1) - own[1] + static_cast<float>(dy) * grid.edge[1];
      const float ez = Policy::along(view, grid, other, 2) - own[2] + static_cast<float>(dz) * grid.edge[2];
      const float square = ex * ex + ey * ey + ez * ez;
      if (square <= limit) use(j, square, dx, dy, dz);
    }
  }
};

}  // namespace cuboct::gpu
