// SPDX-License-Identifier: MIT
// Slabs of a rule of text in floats or doubles, and what they send to one another: particles that have left,
// ghosts of those that another slab's lists reach, and after each round the numbers that later ones read of
// ghosts.
#pragma once

#include "emu/gpu/engine.h"
#include "emu/gpu/rounds/real_rounds_kernel.h"

namespace cuboct::gpu {

// Slab s owns what lies in [end[s - 1], end[s]) along an axis. A place is a share of the box that repeats,
// else of the body as it began: the first and the last slab own what lies outside.
struct RealCut {
  int axis, count;
  bool wraps;
  RealRing ring;
  double low, per_unit;  // units of x
  double end[kMostSlabs];

  CUBOCT_HD double along(int64_t x) const {
    return wraps ? static_cast<double>(static_cast<uint64_t>(x) << ring.spare) * 0x1p-64
                 : (static_cast<double>(x) - low) * per_unit;
  }
  CUBOCT_HD int owner(double at) const {
    int s = 0;
    while (s + 1 < count && at >= end[s]) ++s;
    return s;
  }
  // Whether a place is within `reach`, a share too, of what the slab owns.
  CUBOCT_HD bool reaches(int slab, double at, double reach) const {
    const bool first = slab == 0, last = slab + 1 == count;
    const double from = (first ? 0 : end[slab - 1]) - reach, to = (last ? 1 : end[slab]) + reach;
    if (!wraps) return (first || at >= from) && (last || at <= to);
    return (at >= from && at <= to) || at - 1 >= from || at + 1 <= to;
  }
};

// What a slab sends, of its own particles: calls use(slab) for each that gets it.
struct RealLeavers {
  RealCut cut;
  int self;
  const int64_t* x;  // along the axis
  template <class Use>
  CUBOCT_DEVICE void each(uint32_t i, const Use& use) const {
    const int owner = cut.owner(cut.along(x[i]));
    if (owner != self) use(owner);
  }
};
struct RealReached {
  RealCut cut;
  int self;
  const int64_t* x;
  double reach;
  template <class Use>
  CUBOCT_DEVICE void each(uint32_t i, const Use& use) const {
    const double at = cut.along(x[i]);
    for (int s = 0; s < cut.count; ++s)
      if (s != self && cut.reaches(s, at, reach)) use(s);
  }
};

// All of a particle, into the memory of the slab that gets it.
template <class Real, class Number>
struct RealCarry {
  const uint32_t* sent;
  uint32_t first;                 // where they stand there
  RealFrame<Real, Number> frame;  // from its copies of the state; all fields are in to_fields
  uint8_t* type;
  uint32_t* id;
  int numbers;
  CUBOCT_DEVICE void operator()(uint32_t k) const {
    const uint32_t i = sent[k], at = first + k;
    for (int a = 0; a < 3; ++a) {
      frame.to_x[a][at] = frame.x[a][i];
      if (frame.to_u[0] != nullptr) frame.to_u[a][at] = frame.u[a][i];
    }
    frame.to_place[at] = frame.place[i];
    frame.to_v[at] = frame.v[i];
    for (int f = 0; f < numbers; ++f) frame.to_fields[f][at] = frame.fields[f][i];
    type[at] = frame.type[i];
    id[at] = frame.id[i];
  }
};

// What a round has made of the particles that another slab has ghosts of.
template <class Real, class Number>
struct RealPush {
  const uint32_t* sent;
  uint32_t first;
  int columns;
  const Real* from[kMostNumbers];
  Real* to[kMostNumbers];
  const RealPlace<Number>* place_from;  // null: not of this round
  RealPlace<Number>* place_to;
  const RealFour<Real>* v_from;  // likewise
  RealFour<Real>* v_to;
  uint32_t number;
  const RealControl* control;
  CUBOCT_DEVICE void operator()(uint32_t k) const {
    if (control->lost < number || control->beyond < number || control->old < number) return;
    const uint32_t i = sent[k], at = first + k;
    for (int c = 0; c < columns; ++c) to[c][at] = from[c][i];
    if (place_from != nullptr) place_to[at] = place_from[i];
    if (v_from != nullptr) v_to[at] = v_from[i];
  }
};

}  // namespace cuboct::gpu
