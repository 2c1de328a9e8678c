// SPDX-License-Identifier: MIT
// What a thread does for its particle in a round of a rule of text in floats or doubles: its partners' terms,
// its finish, and in the last round the step. The rule's graphs are text that is compiled while the engine
// runs (real_rounds_text.h). For that this file includes no header of the host's library.
//
// A value of the rule stands as itself times a power of two, its exponent, which the text knows: SI numbers
// of atoms, and products of them, are beyond what a float holds. Lengths, velocities and masses have
// exponents, too. Only what is read back is in SI.
#pragma once

#ifdef CUBOCT_ROUNDS_ALONE
#include "emu/gpu/rounds/rounds_alone.h"
#else
#include "emu/gpu/grid_view.h"
#endif
#include "emu/gpu/rounds/real_ring.h"
#include "emu/gpu/rounds/rounds_limits.h"
#include "model/graph/integer_ops.h"

#ifndef __CUDACC__
#include <cmath>
#endif

namespace cuboct::gpu {

#ifndef __CUDACC__
using std::abs, std::cos, std::erfc, std::exp, std::log, std::pow, std::rint, std::sin, std::sqrt;
template <class Real>
Real rsqrt(Real a) {
  return 1 / sqrt(a);
}
#endif

inline constexpr uint32_t kRealNoStep = 0xffffffffu;
inline constexpr uint32_t kRealLongestBatch = 64;  // steps without the host

// Where others see a particle. Each axis is a ring: in a box that repeats the box itself, else a range far
// longer than the body. A coordinate is a share of it, of which these are the leading bits, or the bits below
// that no pair is long enough to need. So the difference of two, wrapped, is that of nearest images.
template <class Number>
struct alignas(16) RealPlace {
  Number x[3];
  uint32_t type;
};
CUBOCT_DEVICE inline int32_t signed_of(uint32_t a) { return static_cast<int32_t>(a); }
CUBOCT_DEVICE inline int64_t signed_of(uint64_t a) { return static_cast<int64_t>(a); }

template <class Real>
struct alignas(4 * sizeof(Real)) RealFour {
  Real at[4];
};
template <>
struct alignas(16) RealFour<double> {
  double at[4];
};

// What a type does to its particles in a step.
template <class Real>
struct RealKind {
  Real mass, element;
  Real kick;                  // a force's velocity
  Real gravity[3];            // velocity of a step
  Real velocity[3];           // imposed, or that of the anchor
  Real spring, drag, follow;  // of who is held by force: kp, kd, and what a velocity adds to u in a step
  uint32_t imposed;           // bit per axis
  uint32_t held;              // by force
};

// Of a batch's steps, from 1; kRealNoStep: none.
struct RealControl {
  uint32_t lost;                               // the first in which a position left all bounds
  uint32_t beyond;                             // the first that asked a table for more than it has
  uint32_t old;                                // the one after which the list serves no longer
  uint32_t near_stale[kRealLongestBatch + 2];  // whether the step finds its near lists so
};

// A round of one step, from one copy of the state; the last one makes the other copy.
template <class RealOf, class NumberOf>
struct RealFrame {
  using Real = RealOf;
  using Number = NumberOf;
  using Place = RealPlace<Number>;

  const Place* place;
  const int64_t* x[3];
  const RealFour<Real>* v;
  const Real* u[3];
  const Real* fields[kMostNumbers];
  const uint8_t* type;
  const uint32_t* id;
  Place* to_place;
  int64_t* to_x[3];
  RealFour<Real>* to_v;
  Real* to_u[3];
  Real* to_fields[kMostNumbers];  // those that the round writes

  const uint32_t *entries, *counts;  // the list, [row * stride + particle]
  size_t stride;
  const Place* listed;  // where particles were when the list was made
  // Those of the list that were within a thinner skin at a later step: most steps go over these alone. The
  // step that finds them stale goes over the whole list, and leaves new ones on the way.
  uint32_t *near_entries, *near_counts;
  Place* near_listed;
  Real allowed2, near_allowed2;  // squares of displacements that they serve for
  Real near_reach2, reach2;

  // Of a rule with bonds of its own; the list is theirs.
  const Real* bonds[kMostBondNumbers];  // numbers that rounds write, [row * stride + particle]
  Real* to_bonds[kMostBondNumbers];
  const uint32_t* bond_kind;
  const Real* kinds;  // [kind][number]: what the text makes of what never changes of a bond

  const RealFour<Real>* tables;
  const RealKind<Real>* types;
  Real unit[3];               // length of a unit of a place's difference
  Real x_unit[3], origin[3];  // of x, where the rule reads it
  Real drift[3];              // units of x that a velocity adds in a step
  Real furthest[3];           // units of x that a step may move
  int64_t bound[3];           // of x, on both sides of 0
  RealRing ring[3];
  Real* force[3];  // null: a step is made; else the state is only looked at, and here is its force
  bool first;
  int64_t time;     // of noise
  uint32_t number;  // of the step in its batch, from 1
  RealControl* control;
  RealControl* const* others;  // of the other devices
  int other_count;

  CUBOCT_DEVICE bool idle() const {
    // A step that fails runs to its end, so that all of it is told whatever the order of threads.
    return control->lost < number || control->beyond < number || control->old < number;
  }
  // That this step is the first one so: to all devices.
  CUBOCT_DEVICE void tell(uint32_t RealControl::*what) const {
    atomic_min(&(control->*what), number);
    for (int k = 0; k < other_count; ++k) atomic_min(&(others[k]->*what), number);
  }
  CUBOCT_DEVICE void tell_near_stale() const {
    control->near_stale[number + 1] = 1;
    for (int k = 0; k < other_count; ++k) others[k]->near_stale[number + 1] = 1;
  }
  CUBOCT_DEVICE Real made() const { return force[0] == nullptr ? Real(1) : Real(0); }
  CUBOCT_DEVICE Real noise(int64_t stream, uint32_t a, uint32_t b) const {
    return static_cast<Real>(2 * graph::mixed_of(stream, a, b, time, 24) + 1);
  }
  CUBOCT_DEVICE Real moved2(const Place& before, const Place& now) const {
    Real square = 0;
    for (int a = 0; a < 3; ++a) {
      const Real moved = static_cast<Real>(signed_of(now.x[a] - before.x[a])) * unit[a];
      square += moved * moved;
    }
    return square;
  }
};

// A pair that a thread meets.
template <class Real>
struct RealPair {
  uint32_t j, other_type;
  Real d[3];
  size_t slot;       // of a bond
  const Real* kind;  // of a bond
};

// A function of equal steps from 0 on (model/program/cubic_table.h), of an argument in steps: four powers.
template <class Real>
CUBOCT_DEVICE inline RealFour<Real> cubic_of(const RealFour<Real>* cubics, int bins, Real steps, Real& part) {
  const int bin =
      steps < static_cast<Real>(bins - 1) ? static_cast<int>(steps > 0 ? steps : Real(0)) : bins - 1;
  part = steps - static_cast<Real>(bin);
  if (part > 1) part = 1;
  return cubics[bin];
}
template <class Real>
CUBOCT_DEVICE inline Real cubic_value(const RealFour<Real>* cubics, int bins, Real steps) {
  Real p;
  const RealFour<Real> c = cubic_of(cubics, bins, steps, p);
  return ((c.at[3] * p + c.at[2]) * p + c.at[1]) * p + c.at[0];
}
// By a step.
template <class Real>
CUBOCT_DEVICE inline Real cubic_slope(const RealFour<Real>* cubics, int bins, Real steps) {
  Real p;
  const RealFour<Real> c = cubic_of(cubics, bins, steps, p);
  return (3 * c.at[3] * p + 2 * c.at[2]) * p + c.at[1];
}

// A function by values at places of the author's (model/program/point_table.h). Two entries a piece: where it
// begins, 1 over its width, the table's end; then four powers of the share of the width.
template <class Real>
CUBOCT_DEVICE inline Real piece_value(const RealFour<Real>* pieces, int count, Real x, bool of_slope) {
  int k = 0;
  while (k + 1 < count && x >= pieces[2 * (k + 1)].at[0]) ++k;
  const RealFour<Real> place = pieces[2 * k], c = pieces[2 * k + 1];
  const bool before = !(x >= place.at[0]), after = x >= place.at[2];
  if (of_slope && (before || after)) return 0;
  const Real s = before ? Real(0) : after ? Real(1) : (x - place.at[0]) * place.at[1];
  return of_slope ? ((3 * c.at[3] * s + 2 * c.at[2]) * s + c.at[1]) * place.at[1]
                  : ((c.at[3] * s + c.at[2]) * s + c.at[1]) * s + c.at[0];
}

// Of the operations of model/program/real_graph.h those that C++ has no sign for.
template <class Real>
CUBOCT_DEVICE inline Real least_of(Real a, Real b) {
  return b < a ? b : a;
}
template <class Real>
CUBOCT_DEVICE inline Real most_of(Real a, Real b) {
  return a < b ? b : a;
}
template <class Real>
CUBOCT_DEVICE inline Real root_by(Real square, Real inverse) {
  return square > 0 ? square * inverse : Real(0);
}

// Graphs has, all static,
//   Frame           RealFrame of its numbers
//   kBonded, kSums, kMoves  a rule with bonds of its own; how many numbers its sums have, at least 1; whether
//                   the round is the last one of a rule that moves
//   kOfKind         numbers of a kind of bond
//   Own             what all pairs of a particle share, filled in by begin(frame, i, own, fits)
//   pair(frame, i, own, pair, sums, fits)  `fits` becomes false where a table is asked for what it has not
//   finish(frame, i, sums, force, fits)  writes fields; in the last round makes the force
template <class Graphs>
struct RealStep {
  using Frame = typename Graphs::Frame;
  using Real = typename Frame::Real;
  using Place = typename Frame::Place;
  const Frame& at;

  CUBOCT_DEVICE void operator()(uint32_t i) const {
    if (at.idle()) return;
    Real sums[Graphs::kSums];
    for (int k = 0; k < Graphs::kSums; ++k) sums[k] = 0;
    typename Graphs::Own own;
    bool fits = true;
    Graphs::begin(at, i, own, fits);
    if constexpr (Graphs::kBonded)
      meet_bonds(i, own, sums, fits);
    else
      meet_near(i, own, sums, fits);
    Real force[3] = {0, 0, 0};
    Graphs::finish(at, i, sums, force, fits);
    if (!fits) at.tell(&RealControl::beyond);
    if constexpr (Graphs::kMoves) {
      if (at.force[0] != nullptr) {
        for (int a = 0; a < 3; ++a) at.force[a][i] = force[a];
      } else if (!move(i, force)) {
        at.tell(&RealControl::lost);
      }
    }
  }

 private:
  using Own = typename Graphs::Own;
  using Sums = Real[Graphs::kSums];

  CUBOCT_DEVICE void difference(const Place& here, const Place& there, Real (&d)[3]) const {
    for (int a = 0; a < 3; ++a) d[a] = static_cast<Real>(signed_of(there.x[a] - here.x[a])) * at.unit[a];
  }

  CUBOCT_DEVICE void meet_bonds(uint32_t i, const Own& own, Sums& sums, bool& fits) const {
    const Place here = at.place[i];
    const uint32_t count = at.counts[i];
    RealPair<Real> pair;
    pair.slot = i;
    for (uint32_t row = 0; row < count; ++row, pair.slot += at.stride) {
      pair.j = at.entries[pair.slot];
      const Place there = at.place[pair.j];
      pair.other_type = there.type;
      pair.kind = at.kinds + static_cast<size_t>(at.bond_kind[pair.slot]) * Graphs::kOfKind;
      difference(here, there, pair.d);
      Graphs::pair(at, i, own, pair, sums, fits);
    }
  }

  // The first round makes the near lists that others go over.
  CUBOCT_DEVICE void meet_near(uint32_t i, const Own& own, Sums& sums, bool& fits) const {
    const Place here = at.place[i];
    const bool makes = at.first && at.control->near_stale[at.number] != 0;
    const uint32_t* entries = (makes ? at.entries : at.near_entries) + i;
    const uint32_t count = makes ? at.counts[i] : at.near_counts[i];
    uint32_t kept = 0, coming = count > 0 ? entries[0] : 0;
    RealPair<Real> pair;
    pair.slot = 0, pair.kind = nullptr;
    for (uint32_t row = 0; row < count; ++row) {
      pair.j = coming;
      if (row + 1 < count) coming = entries[(row + 1) * at.stride];
      const Place there = at.place[pair.j];
      pair.other_type = there.type;
      difference(here, there, pair.d);
      const Real r2 = pair.d[0] * pair.d[0] + pair.d[1] * pair.d[1] + pair.d[2] * pair.d[2];
      if (makes) {
        if (r2 > at.near_reach2) continue;
        at.near_entries[kept++ * at.stride + i] = pair.j;
      }
      if (r2 < at.reach2) Graphs::pair(at, i, own, pair, sums, fits);
    }
    if (makes) at.near_counts[i] = kept, at.near_listed[i] = here;
  }

  // The contract of model/real/reference.h's semi-implicit Euler; x moves by whole units, exactly.
  CUBOCT_DEVICE bool move(uint32_t i, const Real (&force)[3]) const {
    const RealKind<Real> type = at.types[at.type[i]];
    RealFour<Real> v = at.v[i];
    Place place;
    place.type = at.place[i].type;
    bool sound = true;
    for (int a = 0; a < 3; ++a) {
      Real f = force[a];
      if (type.held != 0) f -= type.spring * at.u[a][i] + type.drag * (v.at[a] - type.velocity[a]);
      v.at[a] =
          (type.imposed >> a & 1u) != 0 ? type.velocity[a] : v.at[a] + (f * type.kick + type.gravity[a]);
      if (at.to_u[0] != nullptr)
        at.to_u[a][i] = at.u[a][i] + (type.held != 0 ? (v.at[a] - type.velocity[a]) * type.follow : Real(0));
      const Real drift = v.at[a] * at.drift[a];
      const bool goes = abs(drift) < at.furthest[a];
      const int64_t x = at.x[a][i] + (goes ? static_cast<int64_t>(rint(drift)) : 0);
      sound = sound && goes && x > -at.bound[a] && x < at.bound[a];
      at.to_x[a][i] = x;
      place.x[a] = at.ring[a].template place<typename Frame::Number>(x);
    }
    at.to_v[i] = v;
    at.to_place[i] = place;
    if constexpr (!Graphs::kBonded) {
      if (at.moved2(at.listed[i], place) > at.allowed2) at.tell(&RealControl::old);
      if (at.moved2(at.near_listed[i], place) > at.near_allowed2) at.tell_near_stale();
    }
    return sound;
  }
};

}  // namespace cuboct::gpu

#ifdef __CUDACC__
#define CUBOCT_REAL_ROUND(name, Graphs)                                   \
  extern "C" __global__ void __launch_bounds__(256)                       \
      name(uint32_t count, const __grid_constant__ Graphs::Frame frame) { \
    const uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;             \
    if (i < count) cuboct::gpu::RealStep<Graphs>{frame}(i);               \
  }
#else
#define CUBOCT_REAL_ROUND(name, Graphs)                                           \
  extern "C" void name(uint32_t count, const Graphs::Frame& frame) {              \
    for (uint32_t i = 0; i < count; ++i) cuboct::gpu::RealStep<Graphs>{frame}(i); \
  }
#endif
