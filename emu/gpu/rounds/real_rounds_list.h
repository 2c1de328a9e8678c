// SPDX-License-Identifier: MIT
// Kernels that sort particles of a rule in floats or doubles into bins and list each one's partners. Within a
// bin particles stand by id, so that no order of threads is in a sum: a run repeats to the bit.
#pragma once

#include "emu/gpu/rounds/real_rounds_halo.h"
#include "emu/gpu/rounds/real_rounds_kernel.h"

namespace cuboct::gpu {

// As wide as a list reaches, or wider; where the box repeats they cover it, else the body as it began: who is
// outside is counted at the border.
struct RealBins {
  double low[3], per_unit[3];  // units of x, or of its share of the ring
  int count[3];
  bool wraps[3];
  RealRing ring[3];

  CUBOCT_DEVICE int along(int64_t x, int a) const {
    const double at = (wraps[a] ? static_cast<double>(static_cast<uint64_t>(x) << ring[a].spare)
                                : static_cast<double>(x) - low[a]) *
                      per_unit[a];
    return at < 0 ? 0 : at >= count[a] ? count[a] - 1 : static_cast<int>(at);
  }
  CUBOCT_DEVICE uint32_t of(const int (&bin)[3]) const {
    return static_cast<uint32_t>((bin[2] * count[1] + bin[1]) * count[0] + bin[0]);
  }
  CUBOCT_DEVICE uint32_t of(const int64_t* const (&x)[3], uint32_t i) const {
    const int bin[3] = {along(x[0][i], 0), along(x[1][i], 1), along(x[2][i], 2)};
    return of(bin);
  }
};

// Of several slabs that exchange particles those that another one owns are not counted.
struct RealSettle {
  RealBins bins;
  RealCut cut;
  int self;  // -1: all are counted
  const int64_t* x[3];
  uint32_t *bin, *count;
  CUBOCT_DEVICE void operator()(uint32_t i) const {
    if (self >= 0 && cut.owner(cut.along(x[cut.axis][i])) != self) {
      bin[i] = kRealNoStep;
      return;
    }
    bin[i] = bins.of(x, i);
    atomic_add(count + bin[i], 1u);
  }
};

// A bin's particles, by id.
struct RealSort {
  const uint32_t *first, *count, *id;
  uint32_t* order;
  CUBOCT_DEVICE void operator()(uint32_t bin) const {
    uint32_t* const at = order + first[bin];
    for (uint32_t k = 1; k < count[bin]; ++k) {
      const uint32_t moved = at[k];
      uint32_t to = k;
      for (; to > 0 && id[at[to - 1]] > id[moved]; --to) at[to] = at[to - 1];
      at[to] = moved;
    }
  }
};

// In the order of bins, so that neighbours stand near in memory.
template <class Real, class Number>
struct RealGather {
  const uint32_t* order;
  RealFrame<Real, Number> frame;  // its copies of the state; all fields are in to_fields
  uint8_t* type;
  uint32_t* id;
  RealPlace<Number>*listed, *near_listed;
  int64_t* listed_x[3];
  int numbers;
  CUBOCT_DEVICE void operator()(uint32_t k) const {
    const uint32_t i = order[k];
    RealPlace<Number> place;
    for (int a = 0; a < 3; ++a) {
      const int64_t x = frame.x[a][i];
      frame.to_x[a][k] = listed_x[a][k] = x;
      place.x[a] = frame.ring[a].template place<Number>(x);
      if (frame.to_u[0] != nullptr) frame.to_u[a][k] = frame.u[a][i];
    }
    place.type = frame.type[i];
    frame.to_place[k] = listed[k] = near_listed[k] = place;
    frame.to_v[k] = frame.v[i];
    for (int f = 0; f < numbers; ++f) frame.to_fields[f][k] = frame.fields[f][i];
    type[k] = frame.type[i];
    id[k] = frame.id[i];
  }
};

// How many partners are within `reach2`; those beyond `width` rows are not kept.
template <class Real, class Number>
struct RealMakeList {
  RealBins bins;
  const int64_t* x[3];
  Real unit[3];  // of a place
  Real reach2;
  const uint32_t *first, *count;
  const uint32_t* members;  // of bins, one after the other; null: all particles in their order
  uint32_t *entries, *counts;
  uint32_t width;
  size_t stride;

  // Of the nearest image, in places: whole, as those of 32 bits have equal ones 8 to 16 reaches apart, and
  // who is outside the body as it began stands in a bin of its border.
  CUBOCT_DEVICE int64_t apart(uint32_t i, uint32_t j, int a) const {
    const uint64_t d = static_cast<uint64_t>(x[a][j]) - static_cast<uint64_t>(x[a][i]);
    return static_cast<int64_t>(d << bins.ring[a].spare) >> bins.ring[a].drop;
  }

  CUBOCT_DEVICE uint32_t operator()(uint32_t i) const {
    int home[3], from[3], to[3];
    for (int a = 0; a < 3; ++a) {
      home[a] = bins.along(x[a][i], a);
      // A ring of fewer than three: each bin once.
      from[a] = bins.wraps[a] && bins.count[a] < 3 ? 0 : -1;
      to[a] = bins.wraps[a] && bins.count[a] < 3 ? bins.count[a] - 1 : 1;
    }
    uint32_t found = 0;
    for (int z = from[2]; z <= to[2]; ++z)
      for (int y = from[1]; y <= to[1]; ++y)
        for (int w = from[0]; w <= to[0]; ++w) {
          int bin[3] = {home[0] + w, home[1] + y, home[2] + z};
          bool there = true;
          for (int a = 0; a < 3; ++a) {
            if (bins.wraps[a])
              bin[a] = bin[a] < 0 ? bin[a] + bins.count[a] : bin[a] % bins.count[a];
            else
              there = there && bin[a] >= 0 && bin[a] < bins.count[a];
          }
          if (!there) continue;
          const uint32_t at = bins.of(bin), end = first[at] + count[at];
          for (uint32_t k = first[at]; k < end; ++k) {
            const uint32_t j = members != nullptr ? members[k] : k;
            if (j == i) continue;
            Real square = 0;
            for (int a = 0; a < 3; ++a) {
              const Real d = static_cast<Real>(apart(i, j, a)) * unit[a];
              square += d * d;
            }
            if (square > reach2) continue;
            if (found < width) entries[found * stride + i] = j;
            ++found;
          }
        }
    counts[i] = found < width ? found : width;
    return found;
  }
};

struct RealReset {
  RealControl* control;
  bool near_stale;
  CUBOCT_DEVICE void operator()(uint32_t) const {
    *control = {kRealNoStep, kRealNoStep, kRealNoStep, {}};
    control->near_stale[1] = near_stale;
  }
};

}  // namespace cuboct::gpu
