// SPDX-License-Identifier: MIT
// The steps of a batch in one launch, where a device's particles are few: it waits longer for a launch than
// for such a step. Several lanes share a particle's pairs, as one after another they would take most of the
// step. Sums have the order of the list, so no bit depends on it.
#pragma once

#include "emu/gpu/step.h"

namespace cuboct::gpu {

template <class Policy, class Variant>
struct StepsTogether {
  static constexpr int kKept = 6;  // entries that a lane keeps

  Step<Policy, Variant, false> step;  // from copy `from` to copy `to` and back
  const uint32_t* id;
  bool hashes;

  // What does not change from step to step, of one lane: its particle's first entries of the list.
  struct Kept {
    uint32_t near, all, gap, most;
    uint32_t entry[kKept];
  };

  // Whether there is a step `number`: asked where all of the one before it have ended. A step that is found
  // impossible while it goes on has an end for nobody.
  CUBOCT_DEVICE bool goes_on(uint32_t number) const { return step.control->limit >= number; }

  // All lanes of a warp come here and below, those of no particle with `there` false.
  template <class Lanes>
  CUBOCT_DEVICE Kept keep(uint32_t i, bool there, const Lanes& lanes) const {
    const List& list = step.list;
    Kept kept{};
    if (there) {
      kept.near = list.near(i), kept.all = kept.near + list.further(i);
      kept.gap = list.first_row(i) - kept.near;
    }
    kept.most = lanes.most_of_warp(kept.all);
    CUBOCT_UNROLL
    for (int k = 0; k < kKept; ++k) kept.entry[k] = entry(kept, i, k * Lanes::kCount + lanes.lane);
    return kept;
  }

  // Of one particle, by its lanes. Gives the particle's part of the state's hash after the step, where hashes
  // are wanted, in its first lane.
  template <class Lanes>
  CUBOCT_DEVICE uint64_t operator()(uint32_t index, bool there, bool goes_on, const Kept& kept,
                                    const void* cache, uint32_t number, const Lanes& lanes) const {
    const bool back = number % 2 == 0;
    const ParticlesView<Policy>&from = back ? step.to : step.from, &to = back ? step.from : step.to;
    const uint32_t i = there ? index : 0;
    const auto x = load(from.x + i);
    const auto v = load(from.v + i);
    const auto rest = step.rest(i, from);
    Pairs<Policy, Variant> pairs{step.view, step.grid, from, Variant::cached(step.view, cache), x, v};
    share(i, kept, pairs, lanes);
    if (!there || !goes_on || lanes.lane != 0) return 0;
    step.complete(i, number, pairs.rule, pairs.sum, pairs.sound, x, x, v, rest, to);
    if constexpr (Policy::kFixed)
      if (hashes) return hash_of_particle<Policy>(step.view, step.grid, to, step.cell[i], id[i], i);
    return 0;
  }

 private:
  static constexpr int kRounds = Policy::kFixed ? 2 : 3;  // pairs that a lane has at a time

  CUBOCT_DEVICE uint32_t entry(const Kept& kept, uint32_t i, uint32_t k) const {
    return k < kept.all ? step.list.entries[(k < kept.near ? k : k + kept.gap) * step.list.stride + i]
                        : kNever;
  }

  template <class Lanes>
  CUBOCT_DEVICE void share(uint32_t i, const Kept& kept, Pairs<Policy, Variant>& pairs,
                           const Lanes& lanes) const {
    uint32_t entries[kRounds];
    CUBOCT_UNROLL
    for (int at = 0; at < kKept; at += kRounds) {
      if (static_cast<uint32_t>(at * Lanes::kCount) >= kept.most) break;
      CUBOCT_UNROLL
      for (int r = 0; r < kRounds; ++r) entries[r] = kept.entry[at + r];
      add(i, entries, pairs, lanes);
    }
    for (uint32_t first = kKept * Lanes::kCount; first < kept.most; first += kRounds * Lanes::kCount) {
      CUBOCT_UNROLL
      for (int r = 0; r < kRounds; ++r) entries[r] = entry(kept, i, first + r * Lanes::kCount + lanes.lane);
      add(i, entries, pairs, lanes);
    }
    if constexpr (Policy::kFixed)
      for (int a = 0; a < 3; ++a) pairs.sum.at[a] = lanes.sum(pairs.sum.at[a]);
    pairs.sound = lanes.all(pairs.sound);
  }

  template <class Lanes>
  CUBOCT_DEVICE void add(uint32_t i, const uint32_t (&entries)[kRounds], Pairs<Policy, Variant>& pairs,
                         const Lanes& lanes) const {
    typename Policy::Position other[kRounds];
    typename Policy::Velocity w[kRounds];
    typename Policy::Part part[kRounds];
    CUBOCT_UNROLL
    for (int r = 0; r < kRounds; ++r) {
      const uint32_t place = entries[r] == kNever ? i : entries[r] & kPlaceMask<Policy::kReach>;
      other[r] = load(pairs.from.x + place);
      w[r] = pairs.v;  // read where damped alone
      if constexpr (Variant::kDamped) w[r] = load(pairs.from.v + place);
    }
    CUBOCT_UNROLL
    for (int r = 0; r < kRounds; ++r) {
      part[r] = {};
      if (entries[r] != kNever && pairs.distance2(entries[r], other[r]) <= step.inside2) {
        int away[3];
        Entry<Policy::kReach>::away(entries[r], away);
        pairs.sound &=
            Policy::part_of(pairs.rule, pairs.grid, pairs.x, pairs.v, other[r], w[r], away, part[r]);
      }
    }
    CUBOCT_UNROLL
    for (int r = 0; r < kRounds; ++r)
      if constexpr (Policy::kFixed) {
        Policy::add(part[r], pairs.sum);  // in any order
      } else {
        CUBOCT_UNROLL
        for (int lane = 0; lane < Lanes::kCount; ++lane) Policy::add(lanes.from(part[r], lane), pairs.sum);
      }
  }
};

}  // namespace cuboct::gpu
