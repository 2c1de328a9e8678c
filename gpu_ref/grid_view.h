// SPDX-License-Identifier: MIT
// A slab's cells and the entries of pair lists, as kernels see them.
#pragma once

#include <cstdint>

#include "gpu_ref/cells.h"
#include "gpu_ref/device.h"

#ifdef __CUDACC__
#define CUBOCT_DEVICE __device__
#else
#define CUBOCT_DEVICE
#endif

namespace cuboct::gpu {

struct CellAt {
  int32_t c[3];
};

struct GridView {
  int low[3], total[3], local[3];
  int axis, local_first, reach;
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
        at[a] = (at[a] % total[a] + total[a]) % total[a];
      }
    }
    at[axis] -= local_first;
    if (at[axis] < 0) at[axis] += total[axis];
    if (at[axis] >= total[axis]) at[axis] -= total[axis];
    if (at[axis] >= local[axis]) return kNoCell;
    return rank[(static_cast<size_t>(at[2]) * local[1] + at[1]) * local[0] + at[0]];
  }
};

// An entry of a pair list: the partner's place in the slab's storage, and above it by how many cells, -2 to 2 along
// each axis, its cell lies from one's own.
inline constexpr int kPlaceBits = 25;
inline constexpr uint32_t kPlaceMask = (1u << kPlaceBits) - 1;

CUBOCT_DEVICE inline uint32_t entry_of(uint32_t place, int dx, int dy, int dz) {
  return place | static_cast<uint32_t>(dz * 25 + dy * 5 + dx + 62) << kPlaceBits;
}
CUBOCT_DEVICE inline void cells_away(uint32_t entry, int (&away)[3]) {
  const int code = static_cast<int>(entry >> kPlaceBits);
  const int z = code / 25, y = code / 5;
  away[0] = code - 5 * y - 2;
  away[1] = y - 5 * z - 2;
  away[2] = z - 2;
}

struct List {
  const uint32_t* entries;  // [k * stride + particle]
  const uint32_t* count;
  size_t stride;
};

}  // namespace cuboct::gpu
