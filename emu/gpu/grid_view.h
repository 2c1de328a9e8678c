// SPDX-License-Identifier: MIT
// A slab's cells and the entries of pair lists, as kernels see them.
#pragma once

#include <cstdint>

#include "emu/gpu/cells.h"
#include "emu/gpu/device/device.h"

#ifdef __CUDACC__
#define CUBOCT_DEVICE __device__
#define CUBOCT_UNROLL _Pragma("unroll")
#define CUBOCT_NO_UNROLL _Pragma("unroll 1")
#define CUBOCT_APART __noinline__
#else
#define CUBOCT_DEVICE
#define CUBOCT_UNROLL
#define CUBOCT_NO_UNROLL
#define CUBOCT_APART
#endif

namespace cuboct::gpu {

struct CellAt {
  int32_t c[3];
};

struct GridView {
  int low[3], total[3], local[3];
  int axis, local_first;
  bool wraps[3], folds;
  float edge[3];
  const uint32_t* rank;

  // kNoCell where the slab does not see it.
  CUBOCT_DEVICE uint32_t find(const int32_t (&cell)[3]) const {
    int at[3];
    for (int a = 0; a < 3; ++a) {
      at[a] = cell[a] - low[a];
      if (at[a] < 0 || at[a] >= total[a]) {
        if (!wraps[a] && !folds) return kNoCell;
        at[a] = modulo(at[a], total[a]);
      }
    }
    at[axis] -= local_first;
    if (at[axis] < 0) at[axis] += total[axis];
    if (at[axis] >= total[axis]) at[axis] -= total[axis];
    if (at[axis] >= local[axis]) return kNoCell;
    return rank[(static_cast<size_t>(at[2]) * local[1] + at[1]) * local[0] + at[0]];
  }
};

// An entry of a pair list: the partner's place in the slab's storage, and above it by how many cells along
// each axis its cell lies from one's own: as far as kReach.
template <int kReach>
struct Entry;

template <>
struct Entry<1> {
  static constexpr int kPlaceBits = 26;
  CUBOCT_DEVICE static uint32_t of(uint32_t place, int dx, int dy, int dz) {
    return place | static_cast<uint32_t>(dz * 16 + dy * 4 + dx + 21) << kPlaceBits;
  }
  CUBOCT_DEVICE static void away(uint32_t entry, int (&cells)[3]) {
    cells[0] = static_cast<int>(entry >> kPlaceBits & 3u) - 1;
    cells[1] = static_cast<int>(entry >> (kPlaceBits + 2) & 3u) - 1;
    cells[2] = static_cast<int>(entry >> (kPlaceBits + 4)) - 1;
  }
};

template <>
struct Entry<2> {
  static constexpr int kPlaceBits = 25;
  CUBOCT_DEVICE static uint32_t of(uint32_t place, int dx, int dy, int dz) {
    return place | static_cast<uint32_t>(dz * 25 + dy * 5 + dx + 62) << kPlaceBits;
  }
  CUBOCT_DEVICE static void away(uint32_t entry, int (&cells)[3]) {
    const int code = static_cast<int>(entry >> kPlaceBits);
    const int z = code / 25, y = code / 5;
    cells[0] = code - 5 * y - 2;
    cells[1] = y - 5 * z - 2;
    cells[2] = z - 2;
  }
};

template <int kReach>
inline constexpr uint32_t kPlaceMask = (1u << Entry<kReach>::kPlaceBits) - 1;

inline constexpr int kNearBits = 16;
inline constexpr uint32_t kNearMask = (1u << kNearBits) - 1;

// A particle's partners: those that were near when the list was made stand in the first rows of `entries`,
// the further ones in the last.
struct List {
  const uint32_t* entries;  // [row * stride + particle], `width` rows
  const uint32_t* count;    // near ones, and above kNearBits further ones
  size_t stride;
  uint32_t width;

  CUBOCT_DEVICE uint32_t near(uint32_t i) const { return count[i] & kNearMask; }
  CUBOCT_DEVICE uint32_t further(uint32_t i) const { return count[i] >> kNearBits; }
  // Of further ones.
  CUBOCT_DEVICE uint32_t first_row(uint32_t i) const { return width - further(i); }
  // Calls use(entry) for all, near ones first.
  template <class Use>
  CUBOCT_DEVICE void each(uint32_t i, const Use& use) const {
    const uint32_t near_ones = near(i), gap = first_row(i) - near_ones, all = near_ones + further(i);
    for (uint32_t k = 0; k < all; ++k) use(entries[(k < near_ones ? k : k + gap) * stride + i]);
  }
};
// Those of them that were within the near skin at a later step, in the list's order: most steps go over these
// alone.
struct NearList {
  uint32_t* entries;  // as List's, without further ones
  uint32_t* count;
};
}  // namespace cuboct::gpu
