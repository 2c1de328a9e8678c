// SPDX-License-Identifier: MIT
// Kernels that sort particles into bins and list each one's partners. Bins are as wide as a list reaches, or
// wider, and cover the lattice's box; where the box repeats they do, too.
#pragma once

#include "emu/gpu/device/storage.h"
#include "emu/gpu/rounds/rounds_halo.h"
#include "emu/gpu/rounds/rounds_kernel.h"

namespace cuboct::gpu {

struct RoundsBins {
  int64_t low[3], length[3];  // of the box, visible units
  int count[3];
  bool wraps[3];

  CUBOCT_DEVICE int along(int64_t x, int a) const {
    const auto at =
        static_cast<int>(static_cast<double>(x - low[a]) * count[a] / static_cast<double>(length[a]));
    return at < 0 ? 0 : at >= count[a] ? count[a] - 1 : at;
  }
  CUBOCT_DEVICE uint32_t of(const int (&bin)[3]) const {
    return static_cast<uint32_t>((bin[2] * count[1] + bin[1]) * count[0] + bin[0]);
  }
};

// A particle goes back into the ring of cells, and is counted in its bin and its cell. Of several slabs that
// exchange particles those that another one owns are not.
struct RoundsSettle {
  RoundsView at;
  RoundsBins bins;
  RoundsCells cells;
  RoundsSlabs slabs;
  int self;  // -1: particles stay with their slab
  int guard, frac;
  uint32_t *bin, *count;
  CUBOCT_DEVICE void operator()(uint32_t i) const {
    int place[3], cell[3];
    for (int a = 0; a < 3; ++a) {
      int64_t x = at.x[a][i];
      if (cells.period[a] > 0) {
        const int64_t ring = int64_t{cells.period[a]} << frac;
        x = (x % ring + ring) % ring;
        at.x[a][i] = x;
      }
      cell[a] = static_cast<int>(x >> frac);
      place[a] = bins.along(x >> guard, a);
    }
    if (self >= 0 && slabs.owner(cell[slabs.axis]) != self) {
      bin[i] = kNoStep;
      return;
    }
    bin[i] = bins.of(place);
    atomic_add(count + bin[i], 1u);
    atomic_add(cells.count_of(cell), 1u);
  }
};

struct RoundsOrder {
  const uint32_t *bin, *first;
  uint32_t *taken, *order;
  CUBOCT_DEVICE void operator()(uint32_t i) const {
    if (bin[i] != kNoStep) order[first[bin[i]] + atomic_add(taken + bin[i], 1u)] = i;
  }
};

// Own particles and ghosts, where they stand.
struct RoundsBinAll {
  const int64_t* x[3];
  RoundsBins bins;
  int guard;
  uint32_t *bin, *count;
  CUBOCT_DEVICE void operator()(uint32_t i) const {
    int place[3];
    for (int a = 0; a < 3; ++a) place[a] = bins.along(x[a][i] >> guard, a);
    bin[i] = bins.of(place);
    atomic_add(count + bin[i], 1u);
  }
};

// In the order of bins, so that neighbours stand near in memory.
struct RoundsGather {
  const uint32_t* order;
  RoundsView from, to;
  uint8_t* type;
  uint32_t *id, *entered;
  RoundsPlace *listed, *coarse;
  int32_t* home[3];
  int guard, frac, coarse_shift, numbers;
  CUBOCT_DEVICE void operator()(uint32_t k) const {
    const uint32_t i = order[k];
    RoundsPlace place, rough{};
    for (int a = 0; a < 3; ++a) {
      const int64_t x = from.x[a][i];
      to.x[a][k] = x;
      to.v[a][k] = from.v[a][i];
      if (to.u[0] != nullptr) to.u[a][k] = from.u[a][i];
      place.x[a] = static_cast<uint32_t>(x >> guard);
      rough.x[a] = static_cast<uint32_t>(x >> (guard + coarse_shift));
      home[a][k] = static_cast<int32_t>(x >> frac);
    }
    place.type = from.type[i];
    to.place[k] = listed[k] = place;
    coarse[k] = rough;
    for (int f = 0; f < numbers; ++f) to.fields[f][k] = from.fields[f][i];
    type[k] = from.type[i];
    id[k] = from.id[i];
    entered[k] = 1u << 13;
  }
};

// Where particles stay in their order: the cells that they start from.
struct RoundsMark {
  RoundsView at;
  uint32_t* entered;
  int32_t* home[3];
  int frac;
  CUBOCT_DEVICE void operator()(uint32_t i) const {
    for (int a = 0; a < 3; ++a) home[a][i] = static_cast<int32_t>(at.x[a][i] >> frac);
    entered[i] = 1u << 13;
  }
};

// How many partners are within `reach2`; those beyond `width` rows are not kept.
struct RoundsMakeList {
  RoundsBins bins;
  const int64_t* x[3];  // P+G fractional bits
  int guard;
  const RoundsPlace* coarse;  // in units of 2^shift visible ones, in which two bins' widths fit 31 bits
  int coarse_shift;
  const uint32_t *first, *count;
  const uint32_t* members;  // of bins, one after the other; null: all particles in their order
  uint64_t reach2;          // of the coarse units
  uint32_t *entries, *counts;
  uint32_t width;
  size_t stride;

  CUBOCT_DEVICE uint32_t operator()(uint32_t i) const {
    const int64_t own[3] = {x[0][i] >> guard, x[1][i] >> guard, x[2][i] >> guard};
    const int home[3] = {bins.along(own[0], 0), bins.along(own[1], 1), bins.along(own[2], 2)};
    const RoundsPlace here = coarse[i];
    uint32_t found = 0;
    for (int z = -1; z <= 1; ++z)
      for (int y = -1; y <= 1; ++y)
        for (int w = -1; w <= 1; ++w) {
          const int off[3] = {w, y, z};
          int bin[3];
          uint32_t shift[3];
          uint32_t image = 0;
          bool there = true;
          for (int a = 2; a >= 0; --a) {
            bin[a] = home[a] + off[a];
            int ring = 0;
            if (bin[a] < 0)
              ring = -1, bin[a] += bins.count[a];
            else if (bin[a] >= bins.count[a])
              ring = 1, bin[a] -= bins.count[a];
            there = there && (ring == 0 || bins.wraps[a]);
            shift[a] = static_cast<uint32_t>(ring * (bins.length[a] >> coarse_shift));
            image = 3 * image + static_cast<uint32_t>(ring + 1);
          }
          if (!there) continue;
          const uint32_t at = bins.of(bin), end = first[at] + count[at];
          for (uint32_t k = first[at]; k < end; ++k) {
            const uint32_t j = members != nullptr ? members[k] : k;
            if (j == i) continue;
            const RoundsPlace other = coarse[j];
            uint64_t square = 0;
            for (int a = 0; a < 3; ++a) {
              const auto apart = static_cast<int32_t>(other.x[a] + shift[a] - here.x[a]);
              square += static_cast<uint64_t>(product(apart, apart));
            }
            if (square > reach2) continue;
            if (found < width) entries[found * stride + i] = j | image << kPartnerBits;
            ++found;
          }
        }
    counts[i] = found < width ? found : width;
    return found;
  }
};

struct RoundsCount {
  const uint32_t* counts;
  CUBOCT_DEVICE bool idle() const { return false; }
  CUBOCT_DEVICE uint64_t operator()(uint32_t i) const { return counts[i]; }
};
struct RoundsZero {
  uint64_t* sum;
  CUBOCT_DEVICE void operator()(uint32_t) const { *sum = 0; }
};

// Runs a kernel that makes a list until the rows hold all that it found. The most partners of a particle.
template <class Make>
uint32_t fill_list(Stream& stream, uint32_t count, int block, Make make, Array<uint32_t>& most,
                   Array<uint32_t>& entries, uint32_t& width) {
  for (;;) {
    most.zero(stream);
    make.entries = entries.data(), make.width = width;
    max_each(stream, 0, count, block, make, most.data());
    const uint32_t found = most.host(stream, 0, 1)[0];
    if (found <= width) return found;
    width = (found + 7) / 8 * 8;
    entries.resize(size_t{width} * count);
  }
}

// Before a batch. `near_stale`: whether its first step finds its near lists so.
struct RoundsReset {
  RoundsControl* control;
  bool near_stale;
  CUBOCT_DEVICE void operator()(uint32_t) const {
    *control = {kNoStep, kNoStep, {}};
    control->near_stale[1] = near_stale;
  }
};

}  // namespace cuboct::gpu
