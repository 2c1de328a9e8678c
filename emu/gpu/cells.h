// SPDX-License-Identifier: MIT
// The cells in which particles are stored, and how slabs of them are shared between devices.
//
// A slab owns a range of planes of cells across one axis. It stores its particles by cell: first the planes
// that its lower neighbour sees, then the inner ones, then those that its upper neighbour sees, then copies
// of what the neighbours own and it sees. A border and its copy are in the same order, so that a copy is one
// block of memory.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "model/base/fixed_math.h"
#include "model/base/vec.h"
#include "model/contract/lattice.h"

namespace cuboct::gpu {

// In [0, n).
CUBOCT_HD constexpr int modulo(int a, int n) {
  const int rest = a % n;
  return rest < 0 ? rest + n : rest;
}

struct Geometry {
  Cell low{};                   // lowest cell
  Cell total{};                 // cells along each axis
  std::array<bool, 3> wraps{};  // the box repeats
  bool folds = false;  // cells outside share the storage of those inside, modulo `total`; else there are none
  std::array<double, 3> edge{1, 1, 1};  // in the unit of lengths of the lists
  int reach = 1;                        // cells that a pair list may span along an axis, at most 2
  const Lattice* lattice = nullptr;     // where given: only its cells are
};

// One slab's storage order.
struct SlabCells {
  int first = 0, planes = 0;              // owned, along the axis, from the lowest
  int lower = -1, upper = -1;             // the slabs beside it; -1: none
  int local_first = 0, local_planes = 0;  // with the copies
  // Ranks [0, low_end) are the lower border, then come inner cells, the upper border and the two copies.
  uint32_t low_end = 0, inner_end = 0, own_end = 0, lower_copy_end = 0, ranks = 0;
  std::vector<uint32_t> rank;  // of local cells, x fastest, kNoCell where there is none
};

struct Cells {
  Geometry geometry;
  int axis = 0;
  std::vector<SlabCells> slabs;

  // Which slab owns a plane, -1: none does.
  int owner(int plane) const;
  // Number of the plane of `cell`, folded or wrapped into the range; may lie outside where the box is open.
  int plane(const Cell& cell) const;
};

// Ends of `slabs` ranges of planes with about equal numbers of particles, each of `least` planes or more.
std::vector<int> slab_ends(const std::vector<uint64_t>& per_plane, int slabs, int least);

// `per_plane[a]`: particles by plane of cells across axis a; slabs get equal shares of them. InputError where
// there are fewer planes than the slabs need.
Cells make_cells(const Geometry& geometry, const std::array<std::vector<uint64_t>, 3>& per_plane, int slabs);

}  // namespace cuboct::gpu
