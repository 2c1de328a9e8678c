// SPDX-License-Identifier: MIT
// What a thread does for its particle in a round of a program: its partners' terms, then its finish. How the
// program's graphs run is left open: operation by operation (rounds_interpreter.h), or as text that is
// compiled while the engine runs (rounds_text.h). For that this file includes no header of the host's
// library.
#pragma once

#ifdef CUBOCT_ROUNDS_ALONE
#include "emu/gpu/rounds/rounds_alone.h"
#else
#include "emu/gpu/grid_view.h"
#endif
#include "emu/gpu/rounds/rounds_limits.h"
#include "emu/gpu/rounds/rounds_table.h"
#include "model/base/hash.h"

namespace cuboct::gpu {

inline constexpr uint32_t kNoStep = 0xffffffffu;
inline constexpr uint32_t kLongestBatch = 64;  // steps without the host

// What others see of a particle. Of its visible place the lowest 32 bits: as P is at most 30, a difference of
// two that are less than two cells apart is that of these numbers, wrapped.
struct alignas(16) RoundsPlace {
  uint32_t x[3];
  uint32_t type;
};
CUBOCT_DEVICE inline int32_t apart_of(const RoundsPlace& own, const RoundsPlace& other, int axis) {
  return static_cast<int32_t>(other.x[axis] - own.x[axis]);
}
// Square of the displacement, visible units.
CUBOCT_DEVICE inline double moved2_of(const RoundsPlace& before, const RoundsPlace& now) {
  double square = 0;
  for (int a = 0; a < 3; ++a) {
    const auto moved = static_cast<double>(apart_of(before, now, a));
    square += moved * moved;
  }
  return square;
}

// Particles as a step finds them, or leaves them.
struct RoundsView {
  int64_t *x[3], *v[3], *u[3];  // P+G fractional bits; x from the corner of cell (0, 0, 0), not wrapped since
                                // the last list; u: null where the rule has none
  RoundsPlace* place;
  int64_t* fields[kMostNumbers];
  const uint8_t* type;
  const uint32_t* id;
};

// Of a batch's steps, from 1; kNoStep: none.
struct RoundsControl {
  uint32_t doubt;                          // the first that was not possible here, or not certain to be
  uint32_t old;                            // the one after which the list serves no longer
  uint32_t near_stale[kLongestBatch + 2];  // whether the step finds its near lists so
};

// Cells, dense over the lattice's box: which there are, and how many particles each may have held since the
// last list. Each plane of cells across an axis is counted on one device.
struct RoundsCells {
  int low[3], extent[3], period[3];
  const uint8_t* exists;
  int axis;
  uint32_t* const* occupancy;  // by plane: of its device, dense over the whole box
  uint32_t* entered;       // by particle: of the 27 cells around that of the last list those that it was in
  const int32_t* home[3];  // by particle, the cell of the last list
  uint32_t capacity;

  // Where the particles of a cell are counted; null: there is no such cell.
  CUBOCT_DEVICE uint32_t* count_of(const int (&cell)[3]) const {
    int64_t at = 0;
    int plane = 0;
    for (int a = 2; a >= 0; --a) {
      int c = cell[a] - low[a];
      if (period[a] > 0) c = ((cell[a] % period[a]) + period[a]) % period[a] - low[a];
      if (c < 0 || c >= extent[a]) return nullptr;
      if (a == axis) plane = c;
      at = at * extent[a] + c;
    }
    return exists[at] ? occupancy[plane] + at : nullptr;
  }
};

struct RoundsList {
  const uint32_t *entries, *counts;  // [row * stride + particle]: index, and above it the image
  size_t stride;
  uint32_t shift[27][3];      // of an image, in visible units, the lowest 32 bits
  const RoundsPlace* listed;  // where particles were when the list was made
  double allowed2;            // square of the displacement that it serves for, visible units
};
inline constexpr int kPartnerBits = 27;
inline constexpr uint32_t kNoImage = 13;

// Those of a list that were within a thinner skin at a later step: most steps go over these alone. The step
// that finds them stale goes over the whole list, and leaves new ones on the way.
struct RoundsNear {
  uint32_t *entries, *counts;  // as a list's
  RoundsPlace* listed;
  double reach2, allowed2;
};

// Of a bonded program: [row * stride + particle], as its list. Each end keeps its own numbers.
struct RoundsBonds {
  bool on;
  const int64_t* from[kMostBondNumbers];
  int64_t* to[kMostBondNumbers];
  const uint32_t* kind;
  const int64_t* constants;  // [kind][constant]
  int numbers, constant_count;
  int position_frac;
  int64_t period[3];  // visible units; 0: the box does not repeat

  CUBOCT_DEVICE int64_t constant(int number, size_t slot) const {
    return constants[kind[slot] * static_cast<uint32_t>(constant_count) + static_cast<uint32_t>(number)];
  }
  CUBOCT_DEVICE void keep(int number, size_t slot) const { to[number][slot] = from[number][slot]; }
  // `apart` becomes that of the partner's image beside `own`. Whether their cells are neighbours: in a ring
  // of three the image that is so may be farther away than another.
  CUBOCT_DEVICE bool meet(const int64_t (&own)[3], int64_t (&apart)[3]) const {
    bool met = true;
    for (int a = 0; a < 3; ++a) {
      if (period[a] > 0) {
        const int64_t half = apart[a] + period[a] / 2;
        // Seldom so; and a division of 64 bits takes a hundred instructions.
        if (half < 0 || half >= period[a])
          apart[a] -= (half >= 0 ? half / period[a] : -((period[a] - 1 - half) / period[a])) * period[a];
      }
      int64_t cells = ((own[a] + apart[a]) >> position_frac) - (own[a] >> position_frac);
      if (period[a] > 0 && (cells < -1 || cells > 1)) {
        const int64_t ring = cells < 0 ? -period[a] : period[a];
        apart[a] -= ring;
        cells -= ring >> position_frac;
      }
      met = met && cells >= -1 && cells <= 1;
    }
    return met;
  }
};

// A pair that a thread meets.
struct RoundsPair {
  uint32_t i, j;
  uint32_t own_type, other_type;
  int64_t apart[3];  // visible units
  size_t slot;       // of a bond
};

// What a finish makes of a particle that moves.
struct RoundsMotion {
  int64_t v[3], u[3], drift[3];
};

// A round of one step, from one copy of the state; the last one makes the other copy.
struct RoundsFrame {
  RoundsView from, to;  // fields of `to`: those that the round writes
  RoundsList list;
  RoundsNear near;
  RoundsCells cells;
  RoundsBonds bonds;
  const TableEntry* entries;                       // of a program that is compiled
  const int64_t *type_constants, *pair_constants;  // [constant][type], [constant][own type][other type]
  int guard, frac;                                 // G; P+G
  bool first, last;
  uint64_t step;
  uint32_t number;  // of the step in its batch, from 1
  RoundsControl* control;
  RoundsControl* const* others;  // of the other devices
  int other_count;

  CUBOCT_DEVICE bool idle() const { return control->doubt <= number || control->old < number; }
  CUBOCT_DEVICE int64_t own_x(int axis, uint32_t i) const {
    return from.x[axis][i] & ((int64_t{1} << frac) - 1);
  }
  CUBOCT_DEVICE int64_t own_u(int axis, uint32_t i) const {
    return from.u[0] != nullptr ? from.u[axis][i] : 0;
  }
  CUBOCT_DEVICE RoundsPlace place_of(const int64_t (&x)[3], uint32_t type) const {
    RoundsPlace place;
    for (int a = 0; a < 3; ++a) place.x[a] = static_cast<uint32_t>(x[a] >> guard);
    place.type = type;
    return place;
  }

  // What one device finds holds for all.
  CUBOCT_DEVICE void doubt() const {
    atomic_min(&control->doubt, number);
    for (int k = 0; k < other_count; ++k) atomic_min(&others[k]->doubt, number);
  }
  CUBOCT_DEVICE void outlive_list() const {
    if (control->old <= number) return;
    atomic_min(&control->old, number);
    for (int k = 0; k < other_count; ++k) atomic_min(&others[k]->old, number);
  }
  CUBOCT_DEVICE void outlive_near() const {
    if (control->near_stale[number + 1] != 0) return;
    control->near_stale[number + 1] = 1;
    for (int k = 0; k < other_count; ++k) others[k]->near_stale[number + 1] = 1;
  }
};

// Graphs has
//   kBonded, kSums  a program with bonds of its own; how many numbers its sums have, at least 1
//   Own             what all pairs of a particle share, filled in by begin(frame, i, own)
//   finish(frame, i, own, sums, motion, fits)  writes fields; in the last round makes the motion
// and kTogether with
//   meet(frame, i, own, fits)  for all partners, so many at once
// or, for one after the other,
//   pair(frame, own, pair, sums, fits)  whether the pair counts: then its terms are in the sums, and its
//                   bond has its new numbers; `fits` becomes false where a check found what does not fit
//   broken(frame, own, slot), keep(frame, slot)  of a bond that is not met
template <class Graphs>
struct RoundsStep : RoundsFrame, Graphs {
  CUBOCT_DEVICE void operator()(uint32_t i, typename Graphs::Own own) const {
    if (idle()) return;
    int64_t sums[Graphs::kSums];
    for (int k = 0; k < Graphs::kSums; ++k) sums[k] = 0;
    this->begin(*this, i, own);
    bool fits = true;
    if constexpr (requires { Graphs::kTogether; })
      this->meet(*this, i, own, fits);
    else if constexpr (Graphs::kBonded)
      meet_bonds(i, own, sums, fits);
    else
      meet_near(i, own, sums, fits);
    RoundsMotion motion;
    for (int a = 0; a < 3; ++a) motion.v[a] = from.v[a][i], motion.u[a] = motion.drift[a] = 0;
    this->finish(*this, i, own, sums, motion, fits);
    if (last) fits = move(i, motion) && fits;
    if (!fits) this->doubt();
  }

 private:
  using Own = typename Graphs::Own;
  using Sums = int64_t[Graphs::kSums];

  CUBOCT_DEVICE void meet_bonds(uint32_t i, Own& own, Sums& sums, bool& fits) const {
    const int64_t x[3] = {from.x[0][i] >> guard, from.x[1][i] >> guard, from.x[2][i] >> guard};
    const uint32_t count = list.counts[i];
    RoundsPair pair{};
    pair.i = i, pair.own_type = from.type[i];
    for (uint32_t row = 0; row < count; ++row) {
      pair.slot = row * list.stride + i;
      pair.j = list.entries[pair.slot] & ((1u << kPartnerBits) - 1);
      for (int a = 0; a < 3; ++a) pair.apart[a] = (from.x[a][pair.j] >> guard) - x[a];
      if (!bonds.meet(x, pair.apart)) {
        fits = fits && this->broken(*this, own, pair.slot);
        this->keep(*this, pair.slot);
        continue;
      }
      pair.other_type = from.type[pair.j];
      if (!this->pair(*this, own, pair, sums, fits)) this->keep(*this, pair.slot);
    }
  }

  // The first round makes the near lists that others go over.
  CUBOCT_DEVICE void meet_near(uint32_t i, Own& own, Sums& sums, bool& fits) const {
    const RoundsPlace here = from.place[i];
    const bool makes = first && control->near_stale[number] != 0;
    const uint32_t* entries = (makes ? list.entries : near.entries) + i;
    const uint32_t count = makes ? list.counts[i] : near.counts[i];
    uint32_t kept = 0, coming = count > 0 ? entries[0] : 0;
    RoundsPair pair{};
    pair.i = i, pair.own_type = here.type;
    for (uint32_t row = 0; row < count; ++row) {
      const uint32_t entry = coming;
      if (row + 1 < count) coming = entries[(row + 1) * list.stride];
      pair.j = entry & ((1u << kPartnerBits) - 1);
      RoundsPlace there = from.place[pair.j];
      if (const uint32_t image = entry >> kPartnerBits; image != kNoImage)
        for (int a = 0; a < 3; ++a) there.x[a] += list.shift[image][a];
      if (makes) {
        if (moved2_of(here, there) > near.reach2) continue;
        near.entries[kept++ * list.stride + i] = entry;
      }
      for (int a = 0; a < 3; ++a) pair.apart[a] = apart_of(here, there, a);
      pair.other_type = there.type;
      this->pair(*this, own, pair, sums, fits);
    }
    if (makes) near.counts[i] = kept, near.listed[i] = here;
  }

  CUBOCT_DEVICE bool move(uint32_t i, const RoundsMotion& motion) const {
    int64_t x[3];
    bool crosses = false;
    for (int a = 0; a < 3; ++a) {
      const int64_t before = from.x[a][i];
      x[a] = before + motion.drift[a];
      to.x[a][i] = x[a];
      to.v[a][i] = motion.v[a];
      if (to.u[0] != nullptr) to.u[a][i] = motion.u[a];
      crosses = crosses || (x[a] >> frac) != (before >> frac);
    }
    if constexpr (!Graphs::kBonded) {
      const RoundsPlace place = place_of(x, from.place[i].type);
      to.place[i] = place;
      if (moved2_of(list.listed[i], place) > list.allowed2) outlive_list();
      if (moved2_of(near.listed[i], place) > near.allowed2) outlive_near();
    }
    return !crosses || enter(i, x);
  }

  // Golden moves a particle along x, then y, then z. False: one of the cells on its way is not there, or may
  // be full.
  CUBOCT_DEVICE bool enter(uint32_t i, const int64_t (&x)[3]) const {
    int cell[3];
    for (int a = 0; a < 3; ++a) cell[a] = static_cast<int>(from.x[a][i] >> frac);
    bool fits = true;
    for (int a = 0; a < 3; ++a) {
      const int next = static_cast<int>(x[a] >> frac);
      if (next == cell[a]) continue;
      cell[a] = next;
      uint32_t* const count = cells.count_of(cell);
      if (count == nullptr) return false;
      int bit = 13;
      for (int b = 0, scale = 1; b < 3; ++b, scale *= 3) {
        const int off = cell[b] - cells.home[b][i];
        if (off < -1 || off > 1) return false;
        bit += off * scale;
      }
      const uint32_t entered = cells.entered[i];
      if (entered >> bit & 1u) continue;
      cells.entered[i] = entered | 1u << bit;
      fits = atomic_add(count, 1u) + 1 <= cells.capacity && fits;
    }
    return fits;
  }
};

// The hash of each particle (model/contract/state.h) after step `number`, where it came so far.
struct RoundsHash {
  RoundsView at;
  int period[3];
  int frac, numbers;
  RoundsBonds bonds;
  const uint32_t* counts;
  size_t stride;
  uint32_t number;
  const RoundsControl* control;
  CUBOCT_DEVICE bool idle() const { return control->doubt <= number || control->old < number; }
  CUBOCT_DEVICE uint64_t operator()(uint32_t i) const {
    Hash hash;
    hash.add(at.id[i]).add(at.type[i]);
    for (int a = 0; a < 3; ++a) {
      int64_t cell = at.x[a][i] >> frac;
      if (period[a] > 0) cell = (cell % period[a] + period[a]) % period[a];
      hash.add(cell);
    }
    for (int a = 0; a < 3; ++a)
      hash.add(at.x[a][i] & ((int64_t{1} << frac) - 1))
          .add(at.v[a][i])
          .add(at.u[0] != nullptr ? at.u[a][i] : 0);
    for (int f = 0; f < numbers; ++f) hash.add(at.fields[f][i]);
    for (uint32_t row = 0; bonds.on && row < counts[i]; ++row)
      for (int k = 0; k < bonds.numbers; ++k) hash.add(bonds.from[k][row * stride + i]);
    return hash.value();
  }
};

}  // namespace cuboct::gpu
