// SPDX-License-Identifier: MIT
#include "emu/lattice/rounds/move.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "emu/lattice/rounds/move.cpp"
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL)
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cuboct::emu::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, kGroup>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;
constexpr D d;
constexpr hn::Rebind<int32_t, D> half;  // as many lanes of 32 bits
constexpr uint32_t kLanes = hn::MaxLanes(d);

struct Group {
  M crossed, changed;
  V speed2, before[3], after[3];  // cells
};

// The drift is exact: what the residue and the drift make together of visible units goes to x.
HWY_INLINE void move_axis(const KernelRule& rule, const Moves& moves, size_t a, uint32_t i, M mask,
                          Particles& particles, Group& group) {
  int32_t* const residue = particles.residue[a].data() + i;
  double *const x = particles.x[a].data() + i, *const v = particles.v[a].data() + i;
  const V old_x = hn::LoadU(d, x), old_v = hn::LoadU(d, v), new_v = hn::LoadU(d, moves.v[a].data() + i);
  const V old_residue = hn::PromoteTo(d, hn::LoadU(half, residue));
  const V exact = hn::Add(old_residue, hn::LoadU(d, moves.drift[a].data() + i));
  const V whole = hn::Floor(hn::Mul(exact, hn::Set(d, rule.inverse_guard)));
  const V left = hn::Sub(exact, hn::Mul(whole, hn::Set(d, rule.guard)));
  const V new_x = hn::Add(old_x, whole);
  group.before[a] = hn::Floor(hn::Mul(old_x, hn::Set(d, rule.inverse_cell)));
  group.after[a] = hn::Floor(hn::Mul(new_x, hn::Set(d, rule.inverse_cell)));
  group.crossed = hn::Or(group.crossed, hn::Ne(group.before[a], group.after[a]));
  group.changed = hn::Or(group.changed, hn::Or(hn::Ne(whole, hn::Zero(d)),
                                               hn::Or(hn::Ne(left, old_residue), hn::Ne(new_v, old_v))));
  group.speed2 = hn::MulAdd(new_v, new_v, group.speed2);
  hn::StoreU(hn::IfThenElse(mask, new_x, old_x), d, x);
  hn::StoreU(hn::IfThenElse(mask, new_v, old_v), d, v);
  hn::StoreU(hn::DemoteTo(half, hn::IfThenElse(mask, left, old_residue)), half, residue);
}

HWY_INLINE void displace(const Moves& moves, uint32_t i, M mask, Particles& particles, Group& group) {
  for (size_t a = 0; a < static_cast<size_t>(moves.axes); ++a) {
    double* const u = particles.u[a].data() + i;
    const V before = hn::LoadU(d, u),
            after = moves.u[a].size() > 0 ? hn::LoadU(d, moves.u[a].data() + i) : hn::Zero(d);
    group.changed = hn::Or(group.changed, hn::Ne(before, after));
    hn::StoreU(hn::IfThenElse(mask, after, before), d, u);
  }
}

HWY_INLINE uint32_t bits_of(M mask) {
  uint8_t bits[8] = {};
  hn::StoreMaskBits(d, mask, bits);
  return bits[0] & ((1u << kLanes) - 1);
}

void move(const KernelRule& rule, const Moves& moves, const Active& active, Particles& particles,
          Block& block) {
  V fastest2 = hn::Zero(d);
  for (uint32_t i = block.begin; i < block.end; i += kLanes) {
    uint32_t lanes = block.end - i >= kLanes ? (1u << kLanes) - 1 : (1u << (block.end - i)) - 1;
    if (active.awake != nullptr)
      for (uint32_t l = 0; l < kLanes; ++l)
        if (active.awake[particles.cell[i + l]] == 0) lanes &= ~(1u << l);
    if (lanes == 0) continue;
    const uint8_t bits[8] = {static_cast<uint8_t>(lanes)};
    const M mask = hn::LoadMaskBits(d, bits);
    const V zero = hn::Zero(d);
    Group group{hn::FirstN(d, 0), hn::FirstN(d, 0), zero, {zero, zero, zero}, {zero, zero, zero}};
    for (size_t a = 0; a < static_cast<size_t>(moves.axes); ++a)
      move_axis(rule, moves, a, i, mask, particles, group);
    if (particles.u[0].size() > 0) displace(moves, i, mask, particles, group);
    fastest2 = hn::Max(fastest2, hn::IfThenElseZero(mask, group.speed2));
    if (const uint32_t who = bits_of(hn::And(group.crossed, mask)); HWY_UNLIKELY(who != 0)) {
      double away[3][kLanes];
      for (size_t a = 0; a < 3; ++a) hn::StoreU(hn::Sub(group.after[a], group.before[a]), d, away[a]);
      for (uint32_t l = 0; l < kLanes; ++l)
        if (who >> l & 1)
          block.crossings.push_back({i + l,
                                     {static_cast<int8_t>(away[0][l]), static_cast<int8_t>(away[1][l]),
                                      static_cast<int8_t>(away[2][l])}});
    }
    if (active.changed == nullptr) continue;
    const uint32_t who = bits_of(hn::And(group.changed, mask));
    for (uint32_t l = 0; l < kLanes; ++l)
      if (who >> l & 1) active.mark(particles.cell[i + l]);
  }
  block.fastest2 = std::max(block.fastest2, hn::GetLane(hn::MaxOfLanes(d, fastest2)));
}

}  // namespace cuboct::emu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cuboct::emu {
HWY_EXPORT(move);

Moves moves_for(const graph::FixedProgram& program, size_t room) {
  Moves moves;
  moves.axes = static_cast<int>(program.motion.v.size());
  for (auto* arrays : {&moves.v, &moves.drift})
    for (auto& array : *arrays) array = PaddedArray<double>(room);
  if (!program.motion.u.empty())
    for (auto& array : moves.u) array = PaddedArray<double>(room);
  return moves;
}

void move_block(const KernelRule& rule, const Moves& moves, const Active& active, Particles& particles,
                Block& block) {
  HWY_DYNAMIC_DISPATCH(move)(rule, moves, active, particles, block);
}
}  // namespace cuboct::emu
#endif
