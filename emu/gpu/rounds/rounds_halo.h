// SPDX-License-Identifier: MIT
// Slabs of a rule of text, and what they send to one another: particles that have left, ghosts of those that
// another slab's lists reach, and after each round the numbers that later ones read of ghosts.
#pragma once

#include "emu/gpu/device/device.h"
#include "emu/gpu/engine.h"
#include "emu/gpu/rounds/rounds_kernel.h"

namespace cuboct::gpu {

// Slab s owns the planes of cells [end[s - 1], end[s]) across an axis, the first from `low`.
struct RoundsSlabs {
  int axis, count, frac;  // P+G
  int low, ring;          // ring: planes of the box where it repeats, else 0
  int end[kMostSlabs];

  CUBOCT_HD int owner(int plane) const {
    int s = 0;
    while (s + 1 < count && plane >= end[s]) ++s;
    return s;
  }
  // Whether a place in the box is within `reach` of the slab's planes. Both have P+G fractional bits.
  CUBOCT_HD bool reaches(int slab, int64_t x, int64_t reach) const {
    const int64_t from = (int64_t{slab == 0 ? low : end[slab - 1]} << frac) - reach;
    const int64_t to = (int64_t{end[slab]} << frac) + reach;
    if (x >= from && x < to) return true;
    const int64_t around = int64_t{ring} << frac;
    return ring > 0 && (x - around >= from || x + around < to);
  }
};

// What a slab sends, of its own particles: calls use(slab) for each that gets it.
struct RoundsLeavers {
  RoundsSlabs slabs;
  int self;
  const int64_t* x;  // along the axis, in the box
  template <class Use>
  CUBOCT_DEVICE void each(uint32_t i, const Use& use) const {
    const int owner = slabs.owner(static_cast<int>(x[i] >> slabs.frac));
    if (owner != self) use(owner);
  }
};
struct RoundsReached {
  RoundsSlabs slabs;
  int self;
  const int64_t* x;
  int64_t reach;
  template <class Use>
  CUBOCT_DEVICE void each(uint32_t i, const Use& use) const {
    for (int s = 0; s < slabs.count; ++s)
      if (s != self && slabs.reaches(s, x[i], reach)) use(s);
  }
};

template <class Choice>
struct RoundsCountSent {
  Choice choice;
  uint32_t* count;  // by slab
  CUBOCT_DEVICE void operator()(uint32_t i) const {
    choice.each(i, [&](int s) { atomic_add(count + s, 1u); });
  }
};
template <class Choice>
struct RoundsListSent {
  Choice choice;
  uint32_t *next, *sent;  // next: by slab, from where its first goes
  CUBOCT_DEVICE void operator()(uint32_t i) const {
    choice.each(i, [&](int s) { sent[atomic_add(next + s, 1u)] = i; });
  }
};

// Into the ring of cells.
struct RoundsWrap {
  int64_t* x;
  int64_t around;
  CUBOCT_DEVICE void operator()(uint32_t i) const { x[i] = (x[i] % around + around) % around; }
};

// All of a particle, into the memory of the slab that gets it.
struct RoundsCarry {
  const uint32_t* sent;
  uint32_t first;  // where they stand there
  RoundsView from, to;
  uint8_t* type;
  uint32_t* id;
  RoundsPlace* coarse;  // null: of a bonded program
  int guard, coarse_shift, numbers;
  CUBOCT_DEVICE void operator()(uint32_t k) const {
    const uint32_t i = sent[k], at = first + k;
    RoundsPlace place, rough{};
    for (int a = 0; a < 3; ++a) {
      const int64_t x = from.x[a][i];
      to.x[a][at] = x;
      to.v[a][at] = from.v[a][i];
      if (to.u[0] != nullptr) to.u[a][at] = from.u[a][i];
      place.x[a] = static_cast<uint32_t>(x >> guard);
      rough.x[a] = static_cast<uint32_t>(x >> (guard + coarse_shift));
    }
    place.type = from.type[i];
    if (coarse != nullptr) to.place[at] = place, coarse[at] = rough;
    for (int f = 0; f < numbers; ++f) to.fields[f][at] = from.fields[f][i];
    type[at] = from.type[i];
    id[at] = from.id[i];
  }
};

// What a round has made of the particles that another slab has ghosts of.
struct RoundsPush {
  const uint32_t* sent;
  uint32_t first;
  int columns;
  const int64_t* from[kMostNumbers + 6];
  int64_t* to[kMostNumbers + 6];
  const RoundsPlace* place_from;  // null: not of this round
  RoundsPlace* place_to;
  uint32_t number;
  const RoundsControl* control;
  CUBOCT_DEVICE void operator()(uint32_t k) const {
    if (control->doubt <= number || control->old < number) return;
    const uint32_t i = sent[k], at = first + k;
    for (int c = 0; c < columns; ++c) to[c][at] = from[c][i];
    if (place_from != nullptr) place_to[at] = place_from[i];
  }
};

}  // namespace cuboct::gpu
