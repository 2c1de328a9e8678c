// SPDX-License-Identifier: MIT
// One step of one particle, and what is read off a state.
#pragma once

#include <cstdint>

#include "emu/gpu/device/storage.h"
#include "emu/gpu/engine.h"
#include "emu/gpu/real/energy_table.h"
#include "model/base/hash.h"

namespace cuboct::gpu {

// What a slab's kernels tell the host of a batch. Steps count from 1 in a batch.
struct Control {
  uint32_t base;      // of step numbers: a graph counts its steps from 1 each time that it is launched
  uint32_t limit;     // the steps up to this one are good
  uint32_t doubt;     // the first step that may not be possible
  uint32_t crowded;   // the first step in which a cell may be too full
  uint32_t old;       // the first step after which the list serves no longer
  uint32_t near_old;  // the first step after which the near lists serve no longer
};
inline constexpr uint32_t kNever = 0xffffffffu;

// Of the other slabs.
struct Controls {
  Control* at[kMostSlabs - 1];
  int count;
};

// How full cells may be. No particle's departure is counted until the next list, nor does one count twice in
// a cell: while no cell holds more than its capacity by that count, none has done so, in whatever order
// devices count.
struct Occupancy {
  uint32_t* own;
  uint32_t *lower, *upper;  // the neighbours' counts of what this slab holds copies of
  uint32_t own_end, lower_copy_end;
  uint32_t capacity;
  uint32_t* entered;  // 27 bits a particle: which cells around that of the list's making
  CUBOCT_DEVICE uint32_t* of(uint32_t rank) const {
    if (rank < own_end) return own + rank;
    return rank < lower_copy_end ? lower + (rank - own_end) : upper + (rank - lower_copy_end);
  }
};

// Where a neighbour keeps its copies of a border: `shift` added to the border's own places.
template <class Policy>
struct Copies {
  typename Policy::Position* x;  // null: there is no neighbour
  typename Policy::Velocity* v;  // null: no rule needs it
  uint32_t first, end;           // of the border's places
  int64_t shift;
};

// From the anchor's middle, along each axis.
template <class Policy>
CUBOCT_DEVICE inline void moved_since(const typename Policy::View& view, const GridView& grid,
                                      const typename Policy::Position& x, const typename Policy::Velocity& v,
                                      float (&moved)[3]) {
  for (int a = 0; a < 3; ++a)
    moved[a] = moved_along(Policy::along(view, grid, x, a), static_cast<uint32_t>(v.last), a, grid.edge[a]);
}

// The pairs of one particle.
template <class Policy, class Variant>
struct Pairs {
  const typename Policy::View& view;
  const GridView& grid;
  const ParticlesView<Policy>& from;
  typename Variant::Cached rule;
  typename Policy::Position x;
  typename Policy::Velocity v;
  typename Policy::Sum sum{};
  bool sound = true;

  // Calls use(entry, partner, its velocity) for `count` entries, one in each row of `stride`. Some are loaded
  // at once, and with them the entries that follow: memory's latency is what a step waits for.
  template <class Use>
  CUBOCT_DEVICE void over(const uint32_t* at, size_t stride, uint32_t count, const Use& use) const {
    constexpr int kTogether = Policy::kTogether;
    uint32_t coming[kTogether];
    const auto fetch = [&](uint32_t first) {
      CUBOCT_UNROLL
      for (int k = 0; k < kTogether; ++k) coming[k] = first + k < count ? at[(first + k) * stride] : 0;
    };
    fetch(0);
    for (uint32_t first = 0; first < count; first += kTogether) {
      uint32_t entry[kTogether];
      typename Policy::Position x_of[kTogether];
      typename Policy::Velocity v_of[kTogether];
      CUBOCT_UNROLL
      for (int k = 0; k < kTogether; ++k) {
        entry[k] = coming[k];
        const uint32_t place = entry[k] & kPlaceMask<Policy::kReach>;  // of none: 0, which there is
        x_of[k] = load(from.x + place);
        v_of[k] = v;  // read where damped alone
        if constexpr (Variant::kDamped) v_of[k] = load(from.v + place);
      }
      fetch(first + kTogether);
      CUBOCT_UNROLL
      for (int k = 0; k < kTogether; ++k)
        if (first + k < count) use(entry[k], x_of[k], v_of[k]);
    }
  }
  template <class Use>
  CUBOCT_DEVICE void over(const List& list, uint32_t i, const Use& use) const {
    over(list.entries + i, list.stride, list.near(i), use);
    over(list.entries + i + list.stride * list.first_row(i), list.stride, list.further(i), use);
  }
  CUBOCT_DEVICE void add(uint32_t entry, const typename Policy::Position& other,
                         const typename Policy::Velocity& w) {
    int away[3];
    Entry<Policy::kReach>::away(entry, away);
    sound &= Policy::add_pair(rule, grid, x, v, other, w, away, sum);
  }
  CUBOCT_DEVICE float distance2(uint32_t entry, const typename Policy::Position& other) const {
    int away[3];
    Entry<Policy::kReach>::away(entry, away);
    float square = 0;
    for (int a = 0; a < 3; ++a) {
      const float d = Policy::along(view, grid, other, a) - Policy::along(view, grid, x, a) +
                      static_cast<float>(away[a]) * grid.edge[a];
      square += d * d;
    }
    return square;
  }
};

template <class Policy, class Variant>
CUBOCT_DEVICE inline typename Policy::Sum kick_of(const typename Policy::View& view, const void* cache,
                                                  const GridView& grid, const ParticlesView<Policy>& from,
                                                  const List& list, uint32_t i,
                                                  const typename Policy::Position& x,
                                                  const typename Policy::Velocity& v) {
  Pairs<Policy, Variant> pairs{view, grid, from, Variant::cached(view, cache), x, v};
  pairs.over(list, i, [&](uint32_t entry, const auto& other, const auto& w) { pairs.add(entry, other, w); });
  return pairs.sum;
}

// kMakesNear: goes over the whole list and leaves a new near list; else over the near list.
template <class Policy, class Variant, bool kMakesNear>
struct Step {
  typename Policy::View view;
  GridView grid;
  ParticlesView<Policy> from, to;
  List list;
  NearList near;
  float near2;         // square of what the near list reaches
  float inside2;       // square of what no interaction reaches, roundings included
  float range;         // of near anchors
  float near_allowed;  // what two may have moved together since it was made
  Copies<Policy> copies[2];
  Occupancy occupancy;
  const CellAt* cell;
  float farthest2;  // square of the displacement that the list allows
  uint32_t number;  // of the step, above the control's base
  Controls others;
  uint32_t jump_at, jump_by;  // both borders of a slab in one loop: from the one index on, places lie further
  Control* control;

  CUBOCT_DEVICE bool idle() const { return control->limit < control->base + number; }

  CUBOCT_DEVICE void operator()(uint32_t index, const void* cache) const {
    const uint32_t i = index < jump_at ? index : index + jump_by, now = control->base + number;
    auto x = load(from.x + i);
    auto v = load(from.v + i);
    const auto before = x;
    Pairs<Policy, Variant> pairs{view, grid, from, Variant::cached(view, cache), x, v};
    if constexpr (kMakesNear) {
      make_near(i, x, v, pairs);
    } else {
      const float displacement = near_displacement(x, v);
      if (2 * displacement > near_allowed && may_meet_unlisted(i, displacement)) {
        atomic_min(&control->near_old, now - 1);
        stop_after(now - 1);
        return;
      }
      go_over(i, pairs);
    }
    complete(i, now, pairs.rule, pairs.sum, pairs.sound, before, x, v, rest(i, from), to);
  }

  // What of a particle its pairs do not need.
  struct Rest {
    Three<uint32_t> residue;
    typename Policy::Extra u;
  };
  CUBOCT_DEVICE Rest rest(uint32_t i, const ParticlesView<Policy>& from) const {
    Rest rest{from.residue.load(i), {}};
    if (from.u) rest.u = from.u[i];
    return rest;
  }

  // Kicks and moves the particle, and looks whether the step may be.
  template <class Cached>
  CUBOCT_DEVICE void complete(uint32_t i, uint32_t now, const Cached& rule, const typename Policy::Sum& sum,
                              bool sound, const typename Policy::Position& before,
                              typename Policy::Position x, typename Policy::Velocity v, Rest rest,
                              const ParticlesView<Policy>& to) const {
    sound &= Policy::finish(rule, sum, x, rest.residue, v, to.u ? &rest.u : nullptr);
    if (to.u) to.u[i] = rest.u;
    to.x[i] = x;
    to.v[i] = v;
    to.residue.store(i, rest.residue);
    for (const Copies<Policy>& copy : copies)
      if (copy.x && i >= copy.first && i < copy.end) {
        copy.x[i + copy.shift] = x;
        if (copy.v) copy.v[i + copy.shift] = v;
      }
    bool crowded = false;
    if constexpr (Policy::kFixed) sound &= cross(i, before, x, crowded);
    if (!sound || crowded) {
      atomic_min(crowded ? &control->crowded : &control->doubt, now);
      stop_after(now - 1);
      return;
    }
    float moved[3];
    moved_since<Policy>(view, grid, x, v, moved);
    if (moved[0] * moved[0] + moved[1] * moved[1] + moved[2] * moved[2] <= farthest2) return;
    atomic_min(&control->old, now);
    stop_after(now);
  }

  // The displacement since the near list was made.
  CUBOCT_DEVICE float near_displacement(const typename Policy::Position& x,
                                        const typename Policy::Velocity& v) const {
    float moved[3], sum = 0;
    moved_since<Policy>(view, grid, x, v, moved);
    const auto anchor = static_cast<uint32_t>(x.last >> kTypeBits);
    for (int a = 0; a < 3; ++a) {
      const float d = moved[a] - near_anchor_at(anchor, a, range);
      sum += d * d;
    }
    return sqrtf(sum);
  }
  // Whether a pair that no near list holds may have come near: two that together have moved as far as the
  // near list allows. One of them has moved half of that; few have, and they look at their partners.
  CUBOCT_DEVICE bool may_meet_unlisted(uint32_t i, float displacement) const {
    bool meets = false;
    list.each(i, [&](uint32_t entry) {
      const uint32_t place = entry & kPlaceMask<Policy::kReach>;
      meets = meets ||
              displacement + near_displacement(load(from.x + place), load(from.v + place)) > near_allowed;
    });
    return meets;
  }

  CUBOCT_DEVICE void go_over(uint32_t i, Pairs<Policy, Variant>& pairs) const {
    pairs.over(near.entries + i, list.stride, near.count[i],
               [&](uint32_t entry, const auto& other, const auto& w) { pairs.add(entry, other, w); });
  }

  CUBOCT_DEVICE void make_near(uint32_t i, typename Policy::Position& x, const typename Policy::Velocity& v,
                               Pairs<Policy, Variant>& pairs) const {
    float moved[3];
    moved_since<Policy>(view, grid, x, v, moved);
    using Last = decltype(x.last);
    x.last = static_cast<Last>(type_in(x.last)) | static_cast<Last>(near_anchor_of(moved, range))
                                                      << kTypeBits;
    uint32_t kept = 0;
    pairs.over(list, i, [&](uint32_t entry, const auto& other, const auto& w) {
      const float square = pairs.distance2(entry, other);
      if (square > near2) return;
      near.entries[kept++ * list.stride + i] = entry;
      if (square <= inside2) pairs.add(entry, other, w);
    });
    near.count[i] = kept;
  }

  // The other slabs may be a step ahead, and no more: the state after this step stays in one of their two
  // copies. They learn of it in time, as their next but one step begins after this slab's next one has.
  CUBOCT_DEVICE void stop_after(uint32_t step) const {
    atomic_min(&control->limit, step);
    for (int k = 0; k < others.count; ++k) atomic_min(&others.at[k]->limit, step + 1);
  }

  // Golden's migration along x, then y, then z. False: not possible.
  CUBOCT_DEVICE bool cross(uint32_t i, const typename Policy::Position& before,
                           const typename Policy::Position& now, bool& crowded) const {
    int from_cell[3], to_cell[3];
    bool same = true;
    for (int a = 0; a < 3; ++a) {
      from_cell[a] = Policy::cells_off(view, grid, before, a);
      to_cell[a] = Policy::cells_off(view, grid, now, a);
      same = same && from_cell[a] == to_cell[a];
    }
    if (same) return true;
    int at[3] = {from_cell[0], from_cell[1], from_cell[2]};
    const CellAt home = cell[i];
    for (int a = 0; a < 3; ++a) {
      if (at[a] == to_cell[a]) continue;
      if (to_cell[a] - at[a] > 1 || at[a] - to_cell[a] > 1) return false;
      at[a] = to_cell[a];
      const int32_t there[3] = {home.c[0] + at[0], home.c[1] + at[1], home.c[2] + at[2]};
      const uint32_t rank = grid.find(there);
      if (rank == kNoCell) return false;
      for (int b = 0; b < 3; ++b)
        if (at[b] < -1 || at[b] > 1) return false;
      const uint32_t bit = 1u << (9 * at[2] + 3 * at[1] + at[0] + 13);
      const uint32_t entered = occupancy.entered[i];
      if (entered & bit) continue;
      occupancy.entered[i] = entered | bit;
      if (atomic_add(occupancy.of(rank), 1u) + 1 > occupancy.capacity) crowded = true;
    }
    return true;
  }
};

template <class Policy>
CUBOCT_DEVICE inline uint64_t hash_of_particle(const typename Policy::View& view, const GridView& grid,
                                               const ParticlesView<Policy>& at, const CellAt& home,
                                               uint32_t id, uint32_t i) {
  auto x = at.x[i];
  const auto residue = at.residue.load(i);
  const auto v = at.v[i];
  Hash hash;
  hash.add(id).add(type_in(x.last));
  for (int a = 0; a < 3; ++a) {
    const int off = Policy::cells_off(view, grid, x, a);
    Policy::take_off(view, grid, x, a, off);
    int c = home.c[a] + off;
    if (grid.wraps[a]) c = grid.low[a] + modulo(c - grid.low[a], grid.total[a]);
    hash.add(c);
  }
  for (int a = 0; a < 3; ++a)
    hash.add(Policy::whole(view, x, residue, a)).add(v.at[a]).add(at.u ? at.u[i].at[a] : 0);
  return hash.value();
}

// hash_of (model/contract/state.h) of the state after step `number` of a batch, where it came so far; 0: of
// the state as it is.
template <class Policy>
struct HashEach {
  typename Policy::View view;
  GridView grid;
  ParticlesView<Policy> at;
  const CellAt* cell;
  const uint32_t* id;
  uint32_t number;
  const Control* control;
  CUBOCT_DEVICE bool idle() const { return control->limit < number; }
  CUBOCT_DEVICE uint64_t operator()(uint32_t i) const {
    return hash_of_particle<Policy>(view, grid, at, cell[i], id[i], i);
  }
};

// A probed particle as it is found.
template <class Policy>
struct Found {
  typename Policy::Position x;
  Three<uint32_t> residue;
  typename Policy::Sum kick;
  double v[3];  // in the unit of velocities, at the time of the positions
  CellAt cell;
};

template <class Policy, class Variant>
struct ReadProbed {
  typename Policy::View view;
  GridView grid;
  ParticlesView<Policy> at;
  List list;
  const CellAt* cell;
  const uint32_t* id;
  const uint32_t* slot;  // of an id, kNever: not probed
  Found<Policy>* found;
  uint32_t* here;  // of a slot: 1
  CUBOCT_DEVICE bool idle() const { return false; }
  CUBOCT_DEVICE void operator()(uint32_t i, const void* cache) const {
    const uint32_t to = slot[id[i]];
    if (to == kNever) return;
    const auto x = load(at.x + i);
    const auto v = load(at.v + i);
    const auto kick = kick_of<Policy, Variant>(view, cache, grid, at, list, i, x, v);
    found[to] = {x, at.residue.load(i), kick, {}, cell[i]};
    double gain[3];
    Policy::gains(Variant::cached(view, cache), kick, v, at.u ? &at.u[i] : nullptr, type_in(x.last), gain);
    for (int a = 0; a < 3; ++a) found[to].v[a] = static_cast<double>(v.at[a]) + gain[a] / 2;
    here[to] = 1;
  }
};

// Sums over some particles; each a few at a time in a fixed order, so that they are the same on every
// machine.
struct Sums {
  double kinetic, potential, gravity;  // J
  double virial;                       // J, see Reading::virial
  double free_kinetic, flow[3];  // J, and velocities in their unit: FreeMotion of model/analysis/measure.h
  double speed;                  // largest, along an axis, in the unit of velocities
};
inline constexpr uint32_t kSummed = 64;  // particles of one Sums

template <class Policy, class Variant>
struct ReadEnergies {
  typename Policy::View view;
  GridView grid;
  ParticlesView<Policy> at;
  List list;
  const CellAt* cell;
  EnergyRule energy;
  double edge[3];    // of a cell, cutoffs
  double origin[3];  // of cell (0,0,0), cutoffs in the scene's coordinates
  double unit;       // cutoffs per unit of a whole position; cutoffs per step, of a velocity
  uint32_t count;
  Sums* sums;

  CUBOCT_DEVICE bool idle() const { return false; }
  CUBOCT_DEVICE void operator()(uint32_t chunk, const void* cache) const {
    const auto rule = Variant::cached(view, cache);
    Sums sum{};
    const uint32_t begin = chunk * kSummed, end = begin + kSummed < count ? begin + kSummed : count;
    for (uint32_t i = begin; i < end; ++i) {
      const auto x = load(at.x + i);
      const auto v = load(at.v + i);
      typename Policy::Sum kick{};
      double place[3];
      const auto residue = at.residue.load(i);
      for (int a = 0; a < 3; ++a) place[a] = static_cast<double>(Policy::whole(view, x, residue, a)) * unit;
      list.each(i, [&](uint32_t entry) {
        int away[3];
        Entry<Policy::kReach>::away(entry, away);
        const uint32_t from = entry & kPlaceMask<Policy::kReach>;
        const auto other = load(at.x + from);
        const auto below = at.residue.load(from);
        auto w = v;
        if constexpr (Variant::kDamped) w = load(at.v + from);
        typename Policy::Sum one{};
        Policy::add_pair(rule, grid, x, v, other, w, away, one);
        double s = 0;
        for (int a = 0; a < 3; ++a) {
          const double d =
              static_cast<double>(Policy::whole(view, other, below, a)) * unit - place[a] + away[a] * edge[a];
          s += d * d;
          kick.at[a] += one.at[a];
          // Each pair is met from both sides, and mass (cutoff/dt)^2 is twice energy.kinetic.
          sum.virial -= energy.kinetic * unit * static_cast<double>(one.at[a]) * d;
        }
        sum.potential += pair_energy(energy, s, type_in(x.last), type_in(other.last)) / 2;
      });
      const double scene[3] = {origin[0] + cell[i].c[0] * edge[0] + place[0],
                               origin[1] + cell[i].c[1] * edge[1] + place[1],
                               origin[2] + cell[i].c[2] * edge[2] + place[2]};
      double gain[3];
      Policy::gains(rule, kick, v, at.u ? &at.u[i] : nullptr, type_in(x.last), gain);
      for (int a = 0; a < 3; ++a) {
        const double late = static_cast<double>(v.at[a]) + gain[a] / 2, now = late * unit;
        const double mass = energy.mass[type_in(x.last)];
        const double kinetic = energy.kinetic * mass * now * now, free = energy.free[3 * type_in(x.last) + a];
        sum.kinetic += kinetic;
        sum.free_kinetic += free * kinetic;
        sum.flow[a] += free * mass * late;
        sum.gravity -= energy.weight[3 * type_in(x.last) + a] * scene[a];
        const double speed = v.at[a] < 0 ? -static_cast<double>(v.at[a]) : static_cast<double>(v.at[a]);
        if (speed > sum.speed) sum.speed = speed;
      }
    }
    sums[chunk] = sum;
  }
};

}  // namespace cuboct::gpu
