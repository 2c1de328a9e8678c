// SPDX-License-Identifier: MIT
// A program's tables on a device: what one place needs stands together, so that a thread loads it at once.
#pragma once

#include <cstdint>

#include "model/graph/table_value.h"

namespace cuboct::gpu {

struct alignas(16) TableEntry {
  int32_t c0, c1, c2, unused;
};

// FixedTable's numbers, known when a kernel is compiled.
template <int kShape, int kDegree, int kDifferenceFrac, int kIndexBits, int kBinBits, int kFirstOctave,
          int kFractionBits>
struct EntryTable {
  static constexpr int shape = kShape, difference_frac = kDifferenceFrac, index_bits = kIndexBits,
                       bin_bits = kBinBits, first_octave = kFirstOctave, fraction_bits = kFractionBits;

  // table_value of table_value.h. `kFlat`: no slope that it meets takes more than 32 bits.
  template <bool kFlat>
  CUBOCT_HD static int64_t value(const TableEntry* entries, uint64_t argument, uint32_t law) {
    uint32_t k, t;
    table_address(EntryTable(), argument, k, t);
    const TableEntry entry = entries[k + (law << kIndexBits)];
    const auto fraction = static_cast<int32_t>(t);
    int64_t slope = entry.c1;
    if constexpr (kDegree == 2) slope += round_odd(product(entry.c2, fraction), kFractionBits);
    if constexpr (kFlat)
      return entry.c0 + round_odd(product(static_cast<int32_t>(slope), fraction), kFractionBits);
    else
      return entry.c0 + round_odd(slope * fraction, kFractionBits);
  }
};

}  // namespace cuboct::gpu
