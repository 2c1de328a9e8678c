// SPDX-License-Identifier: MIT
#include "emu/lattice/kernel_rule.h"
#include "emu/lattice/rounds/vector_block.h"
#include "model/graph/interpret.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "emu/lattice/rounds/vector_steps.cpp"
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL)
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cuboct::emu::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, kGroup>;
using U = hn::RebindToUnsigned<D>;
using I = hn::RebindToSigned<D>;
using V = hn::Vec<D>;
using W = hn::Vec<U>;
constexpr D d;
constexpr U u;
constexpr I i64;
constexpr size_t kLanes = hn::MaxLanes(d);

using graph::Op;

// Without a fused multiply-add the product is rounded before kMagic is added, and a half would be lost: there
// integers round.
HWY_INLINE V rounded(V a, const VectorStep& step) {
#if HWY_NATIVE_FMA
  const V magic = hn::Set(d, kMagic);
  return hn::Sub(hn::MulAdd(a, hn::Set(d, step.scale), magic), magic);
#else
  double lanes[kLanes];
  hn::StoreU(a, d, lanes);
  for (double& lane : lanes)
    lane = static_cast<double>(graph::rounded_odd(static_cast<int64_t>(lane), step.shift));
  return hn::LoadU(d, lanes);
#endif
}
HWY_INLINE V rounded_if(V a, const VectorStep& step) { return step.rounds ? rounded(a, step) : a; }

HWY_INLINE V truth(hn::Mask<D> mask) { return hn::IfThenElseZero(mask, hn::Set(d, 1.0)); }
HWY_INLINE hn::Mask<D> holds(V truth) { return hn::Ne(truth, hn::Zero(d)); }

template <class Value>
HWY_INLINE void each(const VectorStep& step, size_t lanes, Value value) {
  for (size_t k = 0; k < lanes; k += kLanes) hn::Store(value(k), d, step.out + k);
}
template <class Value>
HWY_INLINE void of_one(const VectorStep& step, size_t lanes, Value value) {
  const double* a = step.in[0];
  for (size_t k = 0; k < lanes; k += kLanes) hn::Store(value(hn::Load(d, a + k)), d, step.out + k);
}
template <class Value>
HWY_INLINE void of_two(const VectorStep& step, size_t lanes, Value value) {
  const double *a = step.in[0], *b = step.in[1];
  for (size_t k = 0; k < lanes; k += kLanes)
    hn::Store(value(hn::Load(d, a + k), hn::Load(d, b + k)), d, step.out + k);
}
// What is rare goes lane by lane, by golden's own functions.
template <class Value>
HWY_INLINE void by_lane(const VectorStep& step, size_t lanes, Value value) {
  for (size_t k = 0; k < lanes; ++k) step.out[k] = static_cast<double>(value(k));
}
HWY_INLINE int64_t whole(const double* values, size_t k) { return static_cast<int64_t>(values[k]); }

// A whole number below 2^51 that is not negative, as an integer.
HWY_INLINE W whole(V a) {
  const V two52 = hn::Set(d, 0x1p52);
  return hn::Xor(hn::BitCast(u, hn::Add(a, two52)), hn::BitCast(u, two52));
}
// An integer of 32 bits with 2^31 added, as a double.
HWY_INLINE V from_biased(W bits) {
  return hn::Sub(hn::BitCast(d, hn::Or(bits, hn::BitCast(u, hn::Set(d, 0x1p52)))),
                 hn::Set(d, 0x1p52 + 0x1p31));
}

void dot(const VectorStep& step, size_t lanes) {
  const size_t n = step.in.size() / 2;
  each(step, lanes, [&](size_t k) {
    V sum = hn::Zero(d);
    for (size_t part = 0; part < n; ++part)
      sum = hn::MulAdd(hn::Load(d, step.in[part] + k), hn::Load(d, step.in[n + part] + k), sum);
    return rounded_if(sum, step);
  });
}

void lookup(const VectorStep& step, size_t lanes) {
  const VectorTable& table = *step.table;
  const V two52 = hn::Set(d, 0x1p52);
  const W mask = hn::Set(u, (uint64_t{1} << table.index_bits) - 1), t_mask = hn::Set(u, table.t_mask);
  const V t_unit = hn::Set(d, table.t_unit);
  each(step, lanes, [&](size_t k) {
    const V a = hn::Add(hn::Load(d, step.in[0] + k), hn::Zero(d));  // no bit of -0.0
    W index;
    V t;
    if (table.octaves) {
      const W bits = hn::BitCast(u, a);
      const auto place = hn::Sub(hn::BitCast(i64, hn::ShiftRightSame(bits, table.index_shift)),
                                 hn::Set(i64, table.index_base));
      const auto inside = hn::Gt(place, hn::Set(i64, int64_t{-1}));
      index = hn::And(hn::BitCast(u, hn::IfThenElseZero(inside, place)), mask);
      t = hn::Sub(hn::BitCast(d, hn::Or(hn::And(bits, t_mask), hn::BitCast(u, two52))), two52);
      t = hn::IfThenElseZero(hn::RebindMask(d, inside), t);
    } else {
      const W bits = hn::BitCast(u, hn::Add(a, two52));
      index = hn::And(hn::ShiftRightSame(bits, table.index_shift), mask);
      t = hn::Sub(hn::BitCast(d, hn::Or(hn::And(bits, t_mask), hn::BitCast(u, two52))), two52);
    }
    t = hn::Mul(t, t_unit);
    if (step.in[1] != nullptr)
      index = hn::Add(index, hn::ShiftLeftSame(whole(hn::Load(d, step.in[1] + k)), table.index_bits));
    const auto at = hn::BitCast(i64, index);
    const W word = hn::GatherIndex(u, table.words.data(), at);
    const V c0 = from_biased(hn::And(word, hn::Set(u, uint64_t{0xffffffff})));
    V slope = from_biased(hn::ShiftRight<32>(word));
    if (table.degree == 2)
      slope = hn::Add(slope, rounded(hn::Mul(hn::GatherIndex(d, table.c2.data(), at), t), step));
    return hn::Add(c0, rounded(hn::Mul(slope, t), step));
  });
}

// Whether all lanes fit where their truth holds.
bool check(const VectorStep& step, size_t lanes) {
  const V low = hn::Set(d, step.low), high = hn::Set(d, step.high);
  auto broken = hn::FirstN(d, 0);
  each(step, lanes, [&](size_t k) {
    const V a = hn::Load(d, step.in[0] + k);
    const auto outside = hn::Or(hn::Lt(a, low), hn::Ge(a, high));
    const auto misfit = step.both_signs ? hn::Or(outside, hn::Eq(a, low)) : outside;
    broken = hn::Or(broken, hn::And(misfit, holds(hn::Load(d, step.in[1] + k))));
    // What does not fit is wrapped, exactly: divisions by powers of two.
    const V laps = hn::Floor(hn::Mul(hn::Sub(a, low), hn::Set(d, 1 / (2 * step.high))));
    return hn::IfThenElse(outside, hn::NegMulAdd(laps, hn::Set(d, 2 * step.high), a), a);
  });
  return hn::AllFalse(d, broken);
}

bool run_step(const VectorStep& step, size_t lanes) {
  const std::vector<const double*>& in = step.in;
  const V scale = hn::Set(d, step.scale), low = hn::Set(d, step.low), high = hn::Set(d, step.high);
  switch (step.op) {
    case Op::constant:
    case Op::input:
      break;
    case Op::within:
    case Op::clamp:
      of_one(step, lanes, [&](V a) { return hn::Min(hn::Max(a, low), high); });
      break;
    case Op::add:
      of_two(step, lanes, [](V a, V b) { return hn::Add(a, b); });
      break;
    case Op::sub:
      of_two(step, lanes, [](V a, V b) { return hn::Sub(a, b); });
      break;
    case Op::neg:
      of_one(step, lanes, [](V a) { return hn::Sub(hn::Zero(d), a); });
      break;
    case Op::shl:
      of_one(step, lanes, [&](V a) { return hn::Mul(a, scale); });
      break;
    case Op::round:
      of_one(step, lanes, [&](V a) { return rounded_if(a, step); });
      break;
    case Op::floor:
      of_one(step, lanes, [&](V a) { return hn::Floor(hn::Mul(a, scale)); });
      break;
    case Op::mul:
      of_two(step, lanes, [&](V a, V b) { return rounded_if(hn::Mul(a, b), step); });
      break;
    case Op::mac:
      each(step, lanes, [&](size_t k) {
        const V product = hn::Mul(hn::Load(d, in[1] + k), hn::Load(d, in[2] + k));
        return hn::Add(hn::Load(d, in[0] + k), rounded_if(product, step));
      });
      break;
    case Op::dot:
      dot(step, lanes);
      break;
    case Op::lookup:
      lookup(step, lanes);
      break;
    case Op::lt:
      of_two(step, lanes, [](V a, V b) { return truth(hn::Lt(a, b)); });
      break;
    case Op::le:
      of_two(step, lanes, [](V a, V b) { return truth(hn::Le(a, b)); });
      break;
    case Op::eq:
      of_two(step, lanes, [](V a, V b) { return truth(hn::Eq(a, b)); });
      break;
    case Op::both:
      of_two(step, lanes, [](V a, V b) { return hn::And(a, b); });
      break;
    case Op::either:
      of_two(step, lanes, [](V a, V b) { return hn::Or(a, b); });
      break;
    case Op::negate:
      of_one(step, lanes, [](V a) { return hn::Sub(hn::Set(d, 1.0), a); });
      break;
    case Op::select:
      each(step, lanes, [&](size_t k) {
        return hn::IfThenElse(holds(hn::Load(d, in[0] + k)), hn::Load(d, in[1] + k), hn::Load(d, in[2] + k));
      });
      break;
    case Op::min:
      of_two(step, lanes, [](V a, V b) { return hn::Min(a, b); });
      break;
    case Op::max:
      of_two(step, lanes, [](V a, V b) { return hn::Max(a, b); });
      break;
    case Op::abs:
      of_one(step, lanes, [](V a) { return hn::Abs(a); });
      break;
    case Op::msb:
      by_lane(step, lanes, [&](size_t k) { return graph::leading(whole(in[0], k)); });
      break;
    case Op::align:
      by_lane(step, lanes, [&](size_t k) { return graph::aligned(whole(in[0], k), step.shift, step.width); });
      break;
    case Op::shift:
      by_lane(step, lanes,
              [&](size_t k) { return graph::shifted(whole(in[0], k), static_cast<int>(whole(in[1], k))); });
      break;
    case Op::check:
      return check(step, lanes);
    case Op::noise:
      by_lane(step, lanes, [&](size_t k) {
        return graph::noise_of(step.number, whole(in[0], k), whole(in[1], k), whole(in[2], k), step.width);
      });
      break;
  }
  return true;
}

bool run_steps(const std::vector<VectorStep>& steps, size_t lanes) {
  bool fits = true;
  for (const VectorStep& step : steps) fits = run_step(step, lanes) && fits;
  return fits;
}

}  // namespace cuboct::emu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cuboct::emu {
HWY_EXPORT(run_steps);

bool VectorBlock::run(size_t part, size_t lanes) const {
  return HWY_DYNAMIC_DISPATCH(run_steps)(parts_[part], padded(lanes));
}
}  // namespace cuboct::emu
#endif
