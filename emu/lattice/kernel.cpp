// SPDX-License-Identifier: MIT
// The kernels in vectors of doubles, compiled once per instruction set. kernel_rule.h has the arithmetic.
#include "emu/lattice/kernel.h"

#include <algorithm>
#include <iterator>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "emu/lattice/kernel.cpp"
// Without a fused multiply-add the kernels do not exist; AVX3_DL would add nothing to AVX3.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL)
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cuboct::emu::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_NATIVE_FMA
using D = hn::CappedTag<double, kGroup>;
using U = hn::RebindToUnsigned<D>;
using I = hn::RebindToSigned<D>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;
constexpr D d;
constexpr hn::Rebind<int32_t, D> half;  // as many lanes of 32 bits
constexpr uint32_t kLanes = hn::MaxLanes(d);
static_assert(kGroup % kLanes == 0);

HWY_INLINE V magic() { return hn::Set(d, kMagic); }
// round_odd(a, s) for factor = rounding_factor(s).
HWY_INLINE V rounded(V a, double factor) {
  return hn::Sub(hn::MulAdd(a, hn::Set(d, factor), magic()), magic());
}

HWY_INLINE M lane_mask(uint32_t lanes) {
  const uint8_t bits[8] = {static_cast<uint8_t>(lanes)};
  return hn::LoadMaskBits(d, bits);
}
HWY_INLINE uint32_t mask_lanes(M mask) {
  uint8_t bits[8] = {};
  hn::StoreMaskBits(d, mask, bits);
  return bits[0] & ((1u << kLanes) - 1);
}

// What pairs of types may differ in: nothing, their scale, their law too.
enum class Pairs { alike, scaled, laws };

// The table's value plus `bias`. `first`: where the entries of each lane's law begin, read only where kLaws.
template <bool kSimple, bool kLaws>
HWY_INLINE V table_value(const KernelTable& table, V r2, hn::Vec<U> first) {
  constexpr U u;
  const auto two52 = hn::Set(u, uint64_t{0x4330000000000000});
  constexpr I i;
  if (kSimple) {  // uniform, degree 1, narrow
    const auto bits = hn::BitCast(u, hn::Add(r2, hn::BitCast(d, two52)));
    auto index = hn::And(hn::ShiftRightSame(bits, table.index_shift), hn::Set(u, table.index_mask));
    if (kLaws) index = hn::Add(index, first);
    const auto word = hn::GatherIndex(u, table.words.data(), hn::BitCast(i, index));
    const V t = hn::BitCast(d, hn::Or(hn::And(bits, hn::Set(u, table.t_mask)), two52));
    const V factor = hn::Set(d, table.narrow_t_factor);
    const V scaled_t = hn::MulSub(t, factor, hn::Set(d, table.narrow_t_factor * 0x1p52));
    const auto low = hn::Set(u, table.low_mask);
    const V c0 = hn::BitCast(d, hn::Or(hn::And(word, low), hn::BitCast(u, magic())));
    return hn::MulAdd(hn::BitCast(d, hn::AndNot(low, word)), scaled_t, c0);
  }
  hn::Vec<U> bits, index;
  V t;
  if (!table.octaves) {
    bits = hn::BitCast(u, hn::Add(r2, hn::BitCast(d, two52)));
    index = hn::And(hn::ShiftRightSame(bits, table.index_shift), hn::Set(u, table.index_mask));
    t = hn::Sub(hn::BitCast(d, hn::Or(hn::And(bits, hn::Set(u, table.t_mask)), two52)),
                hn::BitCast(d, two52));
  } else {
    bits = hn::BitCast(u, r2);
    const auto place =
        hn::Sub(hn::BitCast(i, hn::ShiftRightSame(bits, table.index_shift)), hn::Set(i, table.index_base));
    const auto inside = hn::Gt(place, hn::Set(i, int64_t{-1}));
    index = hn::And(hn::BitCast(u, hn::IfThenElseZero(inside, place)), hn::Set(u, table.index_mask));
    t = hn::Sub(hn::BitCast(d, hn::Or(hn::And(bits, hn::Set(u, table.t_mask)), two52)),
                hn::BitCast(d, two52));
    t = hn::IfThenElseZero(hn::RebindMask(d, inside), t);
  }
  if (kLaws) index = hn::Add(index, first);
  const auto word = hn::GatherIndex(u, table.words.data(), hn::BitCast(i, index));
  const auto low = hn::Set(u, table.low_mask);
  const V c0 = hn::BitCast(d, hn::Or(hn::And(word, low), hn::BitCast(u, magic())));
  V slope = hn::BitCast(d, hn::AndNot(low, word));
  if (table.degree == 2)
    slope = hn::Add(slope, rounded(hn::Mul(hn::GatherIndex(d, table.c2.data(), hn::BitCast(i, index)), t),
                                   table.t_factor));
  return hn::MulAdd(hn::Mul(slope, t), hn::Set(d, table.t_factor), c0);
}

struct Own {
  V x[3], v[3];
};

// One entry, or the part of it at lanes `at` on: s, zero where there is no pair, and d. Their product times
// `factor` is the kick, once rounded. Returns whether there is a pair.
template <bool kSimple, bool kDamped, Pairs kPairs>
HWY_INLINE bool pair_terms(const KernelRule& rule, const Particles& particles, const Own& own, uint32_t i,
                           const Entry& entry, uint32_t at, V& s, V dx[3], uint32_t& doubtful) {
  const ptrdiff_t j = static_cast<ptrdiff_t>(entry.first) + at;
  for (int a = 0; a < 3; ++a) {
    V x = hn::Sub(hn::LoadU(d, particles.x[a].data() + j), own.x[a]);
    if (HWY_UNLIKELY(entry.shift != kNoShift)) x = hn::Add(x, hn::Set(d, particles.shift[entry.shift][a]));
    dx[a] = rounded(x, rule.difference_factor);
  }
  const V r2 = hn::MulAdd(dx[2], dx[2], hn::MulAdd(dx[1], dx[1], hn::Mul(dx[0], dx[0])));
  M near = hn::And(lane_mask(entry.lanes >> at), hn::Lt(r2, hn::Set(d, rule.cutoff2)));
  if (HWY_UNLIKELY(hn::AllFalse(d, near))) return false;
  constexpr U u;
  auto first = hn::Zero(u);
  if (kPairs == Pairs::laws) {
    int64_t of[kLanes];
    for (uint32_t l = 0; l < kLanes; ++l)
      of[l] = rule.first[particles.type[i + l] * rule.types + particles.type[j + l]];
    first = hn::BitCast(u, hn::LoadU(I(), of));
  }
  s = hn::Sub(table_value<kSimple, kPairs == Pairs::laws>(rule.force, r2, first),
              hn::Set(d, rule.force.bias));
  if (kDamped) {
    V wd = hn::Zero(d), most = hn::Zero(d);
    for (int a = 0; a < 3; ++a) {
      const V w = rounded(hn::Sub(hn::LoadU(d, particles.v[a].data() + j), own.v[a]), rule.w_factor);
      most = hn::Max(most, hn::Abs(w));
      wd = hn::MulAdd(w, dx[a], wd);
    }
    const V q = rounded(wd, rule.q_factor);
    const V c = hn::Sub(table_value<kSimple, false>(rule.damp, r2, first), hn::Set(d, rule.damp.bias));
    s = hn::Sub(hn::NegMulAdd(hn::Mul(c, q), hn::Set(d, rule.damp_factor), hn::Add(s, magic())), magic());
    const M odd = hn::Or(hn::Ge(most, hn::Set(d, rule.w_limit)),
                         hn::Or(hn::Lt(s, hn::Set(d, rule.s_low)), hn::Ge(s, hn::Set(d, rule.s_high))));
    doubtful = mask_lanes(hn::And(odd, near));
  }
  if (kPairs != Pairs::alike) {
    double factor[kLanes];
    for (uint32_t l = 0; l < kLanes; ++l)
      factor[l] = rule.scale[particles.type[i + l] * rule.types + particles.type[j + l]];
    const V scale = hn::LoadU(d, factor);
    const M apart = hn::And(hn::Lt(scale, hn::Zero(d)), hn::Ge(r2, hn::Set(d, rule.contact2)));
    near = hn::AndNot(apart, near);
    s = rounded(hn::Mul(s, hn::Abs(scale)), rule.scale_factor);
  }
  s = hn::IfThenElseZero(near, s);
  return true;
}

// s * dx * factor comes out of one fma: what to multiply with what.
template <bool kSimple>
HWY_INLINE V kick_factor(const KernelRule& rule, V& s, V dx[3]) {
  if (kSimple) return hn::Mul(s, hn::Set(d, rule.narrow_kick_factor));
  for (int a = 0; a < 3; ++a) dx[a] = hn::Mul(s, dx[a]);
  return hn::Set(d, rule.kick_factor);
}

HWY_INLINE uint32_t awake_lanes(const uint8_t* cell_flag, const Particles& particles, uint32_t g) {
  uint32_t lanes = 0;
  const uint32_t* cell = particles.cell + size_t{g} * kGroup;
  for (uint32_t l = 0; l < kGroup; ++l) lanes |= static_cast<uint32_t>(cell_flag[cell[l]] != 0) << l;
  return lanes;
}

HWY_INLINE void prune_group(const Particles& particles, V reach2, size_t base, PairList::Group& group,
                            Entry* entries) {
  uint32_t front = group.begin;
  for (uint32_t e = group.begin; e < group.begin + group.count; ++e) {
    const Entry entry = entries[e];
    uint32_t lanes = 0;
    for (uint32_t at = 0; at < kGroup; at += kLanes) {
      V r2 = hn::Zero(d);
      for (int a = 0; a < 3; ++a) {
        const V x_j = hn::LoadU(d, particles.x[a].data() + entry.first + static_cast<ptrdiff_t>(at));
        const V x = hn::Add(hn::Sub(x_j, hn::Load(d, particles.x[a].data() + base + at)),
                            hn::Set(d, particles.shift[entry.shift][a]));
        r2 = hn::MulAdd(x, x, r2);
      }
      lanes |= mask_lanes(hn::Le(r2, reach2)) << at;
    }
    entries[e] = entries[front];
    entries[front] = entry;
    front += (lanes & entry.lanes) != 0;
  }
  group.near = front - group.begin;
}

void prune(const Particles& particles, double reach, const uint8_t* only, Block& block) {
  const V reach2 = hn::Set(d, reach * reach);
  const uint32_t first = block.first_group();
  for (uint32_t k = 0; k < block.groups(); ++k)
    if (only == nullptr || any_flag(only, particles, first + k))
      prune_group(particles, reach2, size_t{first + k} * kGroup, block.inside.groups[k],
                  block.inside.entries.data());
  for (Edge* edge : {&block.beside, &block.ghosts})
    for (uint32_t k = 0; k < edge->group.size(); ++k) {
      const uint32_t g = first + edge->group[k];
      if (only == nullptr || any_flag(only, particles, g))
        prune_group(particles, reach2, size_t{g} * kGroup, edge->pairs.groups[k], edge->pairs.entries.data());
    }
}

template <bool kDamped>
HWY_INLINE Own load_own(const Particles& particles, uint32_t i) {
  Own own;
  for (int a = 0; a < 3; ++a) {
    own.x[a] = hn::Load(d, particles.x[a].data() + i);
    if (kDamped) own.v[a] = hn::Load(d, particles.v[a].data() + i);
  }
  return own;
}

HWY_NOINLINE void report(const KernelRule& rule, const Particles& particles, uint32_t i, int32_t j,
                         uint8_t shift, uint32_t lanes, bool both, Block& block) {
  for (uint32_t l = 0; l < kLanes; ++l)
    if (lanes >> l & 1) report_pair(rule, particles, i + l, j + l, shift, both, block);
}

template <bool kSimple, bool kDamped, Pairs kPairs>
void across(const KernelRule& rule, const Particles& particles, const Active& active, Edge& edge,
            Block& block) {
  for (size_t k = 0; k < edge.group.size(); ++k) {
    const uint32_t g = block.first_group() + edge.group[k];
    if (active.near != nullptr && !any_flag(active.near, particles, g)) continue;
    for (uint32_t at = 0; at < kGroup; at += kLanes) {
      const uint32_t i = g * kGroup + at;
      const Own own = load_own<kDamped>(particles, i);
      V sum[3] = {magic(), magic(), magic()};
      const PairList::Group& group = edge.pairs.groups[k];
      for (uint32_t e = group.begin; e < group.begin + group.near; ++e) {
        const Entry& entry = edge.pairs.entries[e];
        uint32_t doubtful = 0;
        V s, dx[3];
        if (!pair_terms<kSimple, kDamped, kPairs>(rule, particles, own, i, entry, at, s, dx, doubtful))
          continue;
        if (HWY_UNLIKELY(doubtful != 0))
          report(rule, particles, i, entry.first + static_cast<int32_t>(at), entry.shift, doubtful, false,
                 block);
        const V factor = kick_factor<kSimple>(rule, s, dx);
        for (int a = 0; a < 3; ++a) sum[a] = hn::NegMulAdd(dx[a], factor, sum[a]);
      }
      for (int a = 0; a < 3; ++a) hn::StoreU(sum[a], d, &edge.sum[(k * 3 + a) * kGroup + at]);
    }
  }
}

// Takes the sums of ring slots `slot` on and leaves the ring empty there.
HWY_INLINE void take_ring(Block& block, uint32_t slot, uint32_t at, V sum[3]) {
  for (int a = 0; a < 3; ++a) {
    double* ring = block.ring[a].data();
    V here = hn::Sub(hn::Load(d, ring + slot + at), magic());
    hn::Store(magic(), d, ring + slot + at);
    if (HWY_UNLIKELY(slot == 0)) {
      double* overhang = ring + block.ring_mask + 1 + at;
      here = hn::Add(here, hn::Sub(hn::Load(d, overhang), magic()));
      hn::Store(magic(), d, overhang);
    }
    sum[a] = hn::Add(sum[a], here);
  }
}

HWY_INLINE Int3 whole(const double sums[3][kLanes], uint32_t lane) {
  Int3 of;
  for (int a = 0; a < 3; ++a) of[a] = static_cast<int64_t>(sums[a][lane]);
  return of;
}

HWY_NOINLINE void leave_sums(const V sum[3], Int3* to) {
  double sums[3][kLanes];
  for (int a = 0; a < 3; ++a) hn::StoreU(sum[a], d, sums[a]);
  for (uint32_t l = 0; l < kLanes; ++l) to[l] = whole(sums, l);
}

// Lanes that are not free, or may not fit: one by one.
HWY_NOINLINE void update_each(const KernelRule& rule, Particles& particles, uint32_t i, uint32_t lanes,
                              const Active& active, const V sum[3], Block& block) {
  double sums[3][kLanes];
  for (int a = 0; a < 3; ++a) hn::StoreU(sum[a], d, sums[a]);
  for (uint32_t l = 0; l < kLanes; ++l)
    if (lanes >> l & 1) update_one(rule, particles, i + l, whole(sums, l), active, block);
}

// round_odd(sum * weight, 16) of each lane. With |sum| = h 2^16 + l the magnitude is h weight + floor(l
// weight / 2^16 + 1/2): h weight is whole, l weight < 2^32, and all of it stays below 2^52 as |sum| does, for
// weight <= 2^16.
HWY_NOINLINE void weigh(const KernelRule& rule, const Particles& particles, uint32_t i, V sum[3]) {
  constexpr double kUnit = static_cast<double>(int64_t{1} << kWeightFrac);
  double weights[kLanes];
  for (uint32_t l = 0; l < kLanes; ++l) weights[l] = rule.weight[particles.type[i + l]];
  const V weight = hn::LoadU(d, weights);
  for (int a = 0; a < 3; ++a) {
    const V size = hn::Abs(sum[a]);
    const V high = hn::Floor(hn::Mul(size, hn::Set(d, 1 / kUnit)));
    const V low = hn::NegMulAdd(high, hn::Set(d, kUnit), size);
    const V rest = hn::Floor(hn::MulAdd(hn::Mul(low, weight), hn::Set(d, 1 / kUnit), hn::Set(d, 0.5)));
    sum[a] = hn::CopySign(hn::MulAdd(high, weight, rest), sum[a]);
  }
}

// Kick and drift of a group's lanes `at` on, all free.
HWY_INLINE void update(const KernelRule& rule, Particles& particles, uint32_t i, uint32_t lanes,
                       const Active& active, const V sum[3], Block& block, V& fastest2) {
  const M mask = lane_mask(lanes);
  const FixedType& type = rule.rule->types[particles.type[i]];
  V v[3], gain[3] = {sum[0], sum[1], sum[2]};
  if (HWY_UNLIKELY(rule.weighted)) weigh(rule, particles, i, gain);
  M odd = hn::FirstN(d, 0);
  for (int a = 0; a < 3; ++a) {
    v[a] = hn::Add(hn::Load(d, particles.v[a].data() + i),
                   hn::Add(gain[a], hn::Set(d, static_cast<double>(type.gravity[a]))));
    odd = hn::Or(odd, hn::Or(hn::Ge(hn::Abs(sum[a]), hn::Set(d, rule.sum_limit)),
                             hn::Ge(hn::Abs(v[a]), hn::Set(d, rule.v_limit))));
  }
  if (HWY_UNLIKELY(!hn::AllFalse(d, hn::And(odd, mask)))) {
    const V sums[3] = {sum[0], sum[1], sum[2]};  // only these need an address
    update_each(rule, particles, i, lanes, active, sums, block);
    return;
  }
  M crossed = hn::FirstN(d, 0), changed = hn::FirstN(d, 0);
  V before[3], after[3];
  for (int a = 0; a < 3; ++a) {
    const V x = hn::Load(d, particles.x[a].data() + i);
    const V old_v = hn::Load(d, particles.v[a].data() + i);
    // The drift is exact: what the residue and v make together of visible units goes to x.
    int32_t* const residue = particles.residue[a].data() + i;
    const V old_residue = hn::PromoteTo(d, hn::LoadU(half, residue));
    const V exact = hn::Add(old_residue, v[a]);
    const V step = hn::Floor(hn::Mul(exact, hn::Set(d, rule.inverse_guard)));
    const V left = hn::NegMulAdd(step, hn::Set(d, rule.guard), exact);
    const V new_x = hn::Add(x, step);
    before[a] = hn::Floor(hn::Mul(x, hn::Set(d, rule.inverse_cell)));
    after[a] = hn::Floor(hn::Mul(new_x, hn::Set(d, rule.inverse_cell)));
    crossed = hn::Or(crossed, hn::Ne(before[a], after[a]));
    if (active.changed != nullptr)
      changed = hn::Or(changed, hn::Or(hn::Ne(v[a], hn::Zero(d)), hn::Ne(old_v, hn::Zero(d))));
    hn::Store(hn::IfThenElse(mask, new_x, x), d, particles.x[a].data() + i);
    hn::Store(hn::IfThenElse(mask, v[a], old_v), d, particles.v[a].data() + i);
    hn::StoreU(hn::DemoteTo(half, hn::IfThenElse(mask, left, old_residue)), half, residue);
  }
  const V speed2 = hn::MulAdd(v[2], v[2], hn::MulAdd(v[1], v[1], hn::Mul(v[0], v[0])));
  fastest2 = hn::Max(fastest2, hn::IfThenElseZero(mask, speed2));
  crossed = hn::And(crossed, mask);
  if (HWY_UNLIKELY(!hn::AllFalse(d, crossed))) {
    double away[3][kLanes];
    for (int a = 0; a < 3; ++a) hn::StoreU(hn::Sub(after[a], before[a]), d, away[a]);
    const uint32_t who = mask_lanes(crossed);
    for (uint32_t l = 0; l < kLanes; ++l)
      if (who >> l & 1)
        block.crossings.push_back({i + l,
                                   {static_cast<int8_t>(away[0][l]), static_cast<int8_t>(away[1][l]),
                                    static_cast<int8_t>(away[2][l])}});
  }
  if (active.changed != nullptr) {
    const uint32_t who = mask_lanes(hn::And(changed, mask));
    for (uint32_t l = 0; l < kLanes; ++l)
      if (who >> l & 1) active.mark(particles.cell[i + l]);
  }
}

template <bool kSimple, bool kDamped, Pairs kPairs>
void inside(const KernelRule& rule, Particles& particles, const Active& active, Block& block) {
  double* const ring[3] = {block.ring[0].data(), block.ring[1].data(), block.ring[2].data()};
  V fastest2 = hn::Zero(d);
  uint32_t written = 0;  // the ring holds sums of particles below this
  EdgeSums beside_sums(block.beside), ghost_sums(block.ghosts);
  for (uint32_t k = 0; k < block.groups(); ++k) {
    const uint32_t g = block.first_group() + k;
    const uint32_t base = g * kGroup;
    const double* const edges[2] = {beside_sums.next(k), ghost_sums.next(k)};
    const uint32_t slot = (k * kGroup) & block.ring_mask;
    const bool work = active.near == nullptr || any_flag(active.near, particles, g);
    if (!work && base >= written) continue;
    uint32_t lanes = base + kGroup <= block.end ? 0xffu : (1u << (block.end - base)) - 1;
    if (!work)
      lanes = 0;
    else if (active.awake != nullptr)
      lanes &= awake_lanes(active.awake, particles, g);
    const bool asleep = lanes == 0;
    for (uint32_t at = 0; at < kGroup; at += kLanes) {
      const uint32_t i = base + at;
      V sum[3] = {magic(), magic(), magic()};
      if (work) {
        const Own own = load_own<kDamped>(particles, i);
        const PairList::Group& group = block.inside.groups[k];
        const Entry* const end = block.inside.entries.data() + group.begin + group.near;
        for (const Entry* e = block.inside.entries.data() + group.begin; e != end; ++e) {
          if (asleep && !any_flag(active.awake, particles, static_cast<uint32_t>(e->first) / kGroup) &&
              !any_flag(active.awake, particles, (static_cast<uint32_t>(e->first) + kGroup - 1) / kGroup))
            continue;
          uint32_t doubtful = 0;
          V s, dx[3];
          if (!pair_terms<kSimple, kDamped, kPairs>(rule, particles, own, i, *e, at, s, dx, doubtful))
            continue;
          if (HWY_UNLIKELY(doubtful != 0))
            report(rule, particles, i, e->first + static_cast<int32_t>(at), e->shift, doubtful, true, block);
          written = std::max(written, static_cast<uint32_t>(e->first) + kGroup);
          const uint32_t to = ((static_cast<uint32_t>(e->first) - block.begin) & block.ring_mask) + at;
          const V factor = kick_factor<kSimple>(rule, s, dx);
          for (int a = 0; a < 3; ++a) {
            sum[a] = hn::NegMulAdd(dx[a], factor, sum[a]);
            hn::StoreU(hn::MulAdd(dx[a], factor, hn::LoadU(d, ring[a] + to)), d, ring[a] + to);
          }
        }
      }
      for (int a = 0; a < 3; ++a) {
        sum[a] = hn::Sub(sum[a], magic());
        for (const double* edge : edges)
          if (edge != nullptr && work)
            sum[a] = hn::Add(sum[a], hn::Sub(hn::LoadU(d, edge + a * kGroup + at), magic()));
      }
      take_ring(block, slot, at, sum);
      const uint32_t mine = lanes >> at & ((1u << kLanes) - 1);
      if (mine == 0) continue;
      if (HWY_UNLIKELY(active.sums != nullptr)) {
        const V sums[3] = {sum[0], sum[1], sum[2]};  // only these need an address
        leave_sums(sums, active.sums + i);
      } else if (HWY_LIKELY(block.plain[k] != 0)) {
        update(rule, particles, i, mine, active, sum, block, fastest2);
      } else {
        const V sums[3] = {sum[0], sum[1], sum[2]};  // only these need an address
        update_each(rule, particles, i, mine, active, sums, block);
      }
    }
  }
  block.fastest2 = std::max(block.fastest2, hn::GetLane(hn::MaxOfLanes(d, fastest2)));
}

void update_block(const KernelRule& rule, Particles& particles, const Active& active, const Int3* sums,
                  Block& block) {
  V fastest2 = hn::Zero(d);
  for (uint32_t k = 0; k < block.groups(); ++k) {
    const uint32_t g = block.first_group() + k, base = g * kGroup;
    if (active.near != nullptr && !any_flag(active.near, particles, g)) continue;
    uint32_t lanes = base + kGroup <= block.end ? 0xffu : (1u << (block.end - base)) - 1;
    if (active.awake != nullptr) lanes &= awake_lanes(active.awake, particles, g);
    for (uint32_t at = 0; at < kGroup; at += kLanes) {
      const uint32_t mine = lanes >> at & ((1u << kLanes) - 1);
      if (mine == 0) continue;
      double summed[3][kLanes];
      for (uint32_t l = 0; l < kLanes; ++l)
        for (int a = 0; a < 3; ++a) summed[a][l] = static_cast<double>(sums[base + at + l][a]);
      const V sum[3] = {hn::LoadU(d, summed[0]), hn::LoadU(d, summed[1]), hn::LoadU(d, summed[2])};
      if (block.plain[k] != 0)
        update(rule, particles, base + at, mine, active, sum, block, fastest2);
      else
        update_each(rule, particles, base + at, mine, active, sum, block);
    }
  }
  block.fastest2 = std::max(block.fastest2, hn::GetLane(hn::MaxOfLanes(d, fastest2)));
}

template <bool kSimple>
Kernels kernels_for(const KernelRule& rule, const char* name) {
  const auto of = [&]<Pairs kPairs>() {
    return rule.damped ? Kernels{name, prune, across<kSimple, true, kPairs>, inside<kSimple, true, kPairs>,
                                 update_block}
                       : Kernels{name, prune, across<kSimple, false, kPairs>, inside<kSimple, false, kPairs>,
                                 update_block};
  };
  if (!rule.first.empty()) return of.template operator()<Pairs::laws>();
  return rule.scaled ? of.template operator()<Pairs::scaled>() : of.template operator()<Pairs::alike>();
}
#endif

void vector_kernels(const KernelRule& rule, std::vector<Kernels>& out) {
#if HWY_NATIVE_FMA
  const auto uniform1 = [](const KernelTable& t) { return !t.octaves && t.degree == 1; };
  const bool simple = rule.narrow && uniform1(rule.force) && (!rule.damped || uniform1(rule.damp));
  const char* name = kLanes == 8 ? "avx512" : kLanes == 4 ? "avx2" : "128-bit";
  out.push_back(simple ? kernels_for<true>(rule, name) : kernels_for<false>(rule, name));
#else
  static_cast<void>(rule);
  static_cast<void>(out);
#endif
}

}  // namespace cuboct::emu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cuboct::emu {

HWY_EXPORT(vector_kernels);
Kernels scalar_kernels();

std::vector<Kernels> kernels_here(const KernelRule& rule) {
  std::vector<Kernels> kernels;
  if (rule.fits) {
    // Every vector unit of this machine, by its place in the table: the choice that HWY_DYNAMIC_DISPATCH
    // reads is the whole process's, and threads beside this one rely on it.
    static const std::vector<int64_t> targets = hwy::SupportedAndGeneratedTargets();
    const auto& table = HWY_DISPATCH_TABLE(vector_kernels);
    for (const int64_t target : targets) {
      hwy::ChosenTarget choice;
      choice.Update(target);
      // A program compiled for one target alone has a table of one.
      table[std::size(table) == 1 ? 0 : choice.GetIndex()](rule, kernels);
    }
    std::stable_sort(kernels.begin(), kernels.end(),
                     [](const Kernels& a, const Kernels& b) { return a.name.size() > b.name.size(); });
  }
  kernels.push_back(scalar_kernels());
  return kernels;
}

}  // namespace cuboct::emu
#endif
