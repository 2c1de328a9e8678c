// SPDX-License-Identifier: MIT
// The steps of a batch in one launch, where a device's particles are few: it waits longer for a launch than
// for such a step. Several lanes share a particle's pairs, as one after another they would take most of the
// step. Sums have the order of the list, so no bit depends on it.
#pragma once

#include "emu/gpu/step.h"

namespace cuboct::gpu {

template <class Policy, class Variant>
struct StepsTogether {
  Step<Policy, Variant, false> step;  // from copy `from` to copy `to` and back
  const uint32_t* id;
  bool hashes;

  // Whether there is a step `number`: asked where all of the one before it has ended.
  CUBOCT_DEVICE bool goes_on(uint32_t number) const { return step.control->limit >= number; }

  // Of one particle, by its lanes; all lanes of a warp come, those of no particle with `there` false. Gives
  // the particle's part of the state's hash after the step, where hashes are wanted, in its first lane.
  CUBOCT_DEVICE uint64_t operator()(uint32_t index, bool there, const void* cache, uint32_t number,
                                    const PairLanes& lanes) const {
    const bool back = number % 2 == 0;
    const ParticlesView<Policy>&from = back ? step.to : step.from, &to = back ? step.from : step.to;
    const uint32_t i = there ? index : 0;
    const auto x = load(from.x + i);
    const auto v = load(from.v + i);
    Pairs<Policy, Variant> pairs{step.view, step.grid, from, Variant::cached(step.view, cache), x, v};
    share(i, there, pairs, lanes);
    if (!there || lanes.lane != 0) return 0;
    step.complete(i, number, pairs.rule, pairs.sum, pairs.sound, x, x, v, from, to);
    if constexpr (Policy::kFixed)
      if (hashes) return hash_of_particle<Policy>(step.view, step.grid, to, step.cell[i], id[i], i);
    return 0;
  }

 private:
  static constexpr int kRounds = Policy::kFixed ? 2 : 3;  // pairs that a lane has at a time

  CUBOCT_DEVICE void share(uint32_t i, bool there, Pairs<Policy, Variant>& pairs,
                           const PairLanes& lanes) const {
    const List& list = step.list;
    const uint32_t near_ones = there ? list.near(i) : 0, all = near_ones + (there ? list.further(i) : 0),
                   gap = there ? list.first_row(i) - near_ones : 0, most = lanes.most_of_warp(all);
    for (uint32_t first = 0; first < most; first += kRounds * PairLanes::kCount) {
      uint32_t entry[kRounds];
      typename Policy::Position other[kRounds];
      typename Policy::Velocity w[kRounds];
      typename Policy::Part part[kRounds];
      CUBOCT_UNROLL
      for (int r = 0; r < kRounds; ++r) {
        const uint32_t k = first + r * PairLanes::kCount + lanes.lane;
        entry[r] = k < all ? list.entries[(k < near_ones ? k : k + gap) * list.stride + i] : kNever;
      }
      CUBOCT_UNROLL
      for (int r = 0; r < kRounds; ++r) {
        const uint32_t place = entry[r] == kNever ? i : entry[r] & kPlaceMask<Policy::kReach>;
        other[r] = load(pairs.from.x + place);
        w[r] = pairs.v;  // read where damped alone
        if constexpr (Variant::kDamped) w[r] = load(pairs.from.v + place);
      }
      CUBOCT_UNROLL
      for (int r = 0; r < kRounds; ++r) {
        part[r] = {};
        if (entry[r] != kNever && pairs.distance2(entry[r], other[r]) <= step.inside2) {
          int away[3];
          Entry<Policy::kReach>::away(entry[r], away);
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
          for (int lane = 0; lane < PairLanes::kCount; ++lane)
            Policy::add(lanes.from(part[r], lane), pairs.sum);
        }
    }
    if constexpr (Policy::kFixed)
      for (int a = 0; a < 3; ++a) pairs.sum.at[a] = lanes.sum(pairs.sum.at[a]);
    pairs.sound = lanes.all(pairs.sound);
  }
};

}  // namespace cuboct::gpu
