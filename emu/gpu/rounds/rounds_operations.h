// SPDX-License-Identifier: MIT
// Operations over a thread's registers (rounds_code.h), of one lane or of all kTogether. Values are golden's
// (model/graph/interpret.h). Lanes of pairs that do not count may hold numbers beyond the intervals of late
// operations: what they make is anything, so sums wrap and places in tables are bounded.
#pragma once

#include <type_traits>

#include "emu/gpu/grid_view.h"
#include "emu/gpu/rounds/rounds_program.h"
#include "model/graph/graph.h"
#include "model/graph/integer_ops.h"

namespace cuboct::gpu {

// A number of each lane.
struct alignas(16) Quad {
  int32_t v[kTogether];
};
struct WideQuad {
  int64_t v[kTogether];
};

// Of a thread, in memory that its block shares: on a device local memory would be that of all threads, more
// than a cache has room for.
struct RoundsRegisters {
  Quad* first;
  uint32_t stride;

  CUBOCT_DEVICE RoundsRegisters from(uint32_t k) const { return {&at(k), stride}; }
  CUBOCT_DEVICE Quad low(uint32_t k) const { return load(&at(k)); }
  CUBOCT_DEVICE void put(uint32_t k, const Quad& value) const { store(&at(k), value); }

  CUBOCT_DEVICE WideQuad value(uint32_t k, bool wide) const {
    const Quad lower = low(k);
    WideQuad value;
    CUBOCT_UNROLL
    for (int l = 0; l < kTogether; ++l) value.v[l] = lower.v[l];
    if (!wide) return value;
    const Quad upper = low(k + 1);
    CUBOCT_UNROLL
    for (int l = 0; l < kTogether; ++l) value.v[l] = joined(upper.v[l], lower.v[l]);
    return value;
  }
  CUBOCT_DEVICE void put(uint32_t k, bool wide, const WideQuad& value) const {
    Quad half;
    CUBOCT_UNROLL
    for (int l = 0; l < kTogether; ++l) half.v[l] = static_cast<int32_t>(value.v[l]);
    put(k, half);
    if (!wide) return;
    CUBOCT_UNROLL
    for (int l = 0; l < kTogether; ++l) half.v[l] = static_cast<int32_t>(value.v[l] >> 32);
    put(k + 1, half);
  }
  CUBOCT_DEVICE void put_all(uint32_t k, bool wide, int64_t value) const {
    WideQuad all;
    CUBOCT_UNROLL
    for (int l = 0; l < kTogether; ++l) all.v[l] = value;
    put(k, wide, all);
  }

  // Of one lane.
  CUBOCT_DEVICE int64_t lane(uint32_t k, bool wide, int l) const {
    const int32_t lower = at(k).v[l];
    return wide ? joined(at(k + 1).v[l], lower) : lower;
  }
  CUBOCT_DEVICE void put_lane(uint32_t k, bool wide, int l, int64_t value) const {
    at(k).v[l] = static_cast<int32_t>(value);
    if (wide) at(k + 1).v[l] = static_cast<int32_t>(value >> 32);
  }

 private:
  CUBOCT_DEVICE Quad& at(uint32_t k) const { return first[k * stride]; }
  CUBOCT_DEVICE static int64_t joined(int32_t upper, int32_t lower) {
    return static_cast<int64_t>(static_cast<uint64_t>(static_cast<uint32_t>(upper)) << 32 |
                                static_cast<uint32_t>(lower));
  }
};

// What wraps.
template <typename T>
CUBOCT_DEVICE T plus(T a, T b) {
  using U = std::make_unsigned_t<T>;
  return static_cast<T>(static_cast<U>(a) + static_cast<U>(b));
}
template <typename T>
CUBOCT_DEVICE T less(T a, T b) {
  using U = std::make_unsigned_t<T>;
  return static_cast<T>(static_cast<U>(a) - static_cast<U>(b));
}
template <typename T>
CUBOCT_DEVICE T shifted_left(T a, int by) {
  return static_cast<T>(static_cast<std::make_unsigned_t<T>>(a) << by);
}
CUBOCT_DEVICE inline int64_t times(int64_t a, int64_t b) {
  return static_cast<int64_t>(static_cast<uint64_t>(a) * static_cast<uint64_t>(b));
}
CUBOCT_DEVICE inline int64_t rounded(int64_t a, const Rounding& by) {
  return plus(plus(a, by.half), static_cast<int64_t>(static_cast<int32_t>(a >> 63) & by.odd)) >> by.shift;
}

CUBOCT_DEVICE inline int64_t entry_value(const CodeTable& table, uint64_t argument, uint32_t law) {
  uint32_t k, t;
  table_address(table, argument, k, t);
  k += law << table.index_bits;
  const TableEntry entry = load(table.entries + (k < table.last ? k : table.last));
  const auto fraction = static_cast<int32_t>(t);
  const Rounding by(table.fraction_bits);
  const int64_t slope = entry.c1 + round_odd(product(entry.c2, fraction), by);
  const int64_t rise = table.flat ? product(static_cast<int32_t>(slope), fraction) : slope * fraction;
  return entry.c0 + round_odd(rise, by);
}

// One operation of one lane, a function by itself: it is large, and called seldom. False where a check found
// what does not fit.
CUBOCT_APART CUBOCT_DEVICE inline bool operate(Operation o, RoundsRegisters r, int lane,
                                               const CodeTable* tables) {
  using graph::Op;
  const auto in = [&](int k) { return r.lane(o.in(k), o.wide(k), lane); };
  const int64_t a = in(0), b = o.inputs() > 1 ? in(1) : 0, c = o.inputs() > 2 ? in(2) : 0;
  bool fits = true;
  int64_t value = 0;
  switch (static_cast<Op>(o.op())) {
    case Op::constant:
    case Op::input:
      return true;
    case Op::add:
      value = plus(a, b);
      break;
    case Op::sub:
      value = less(a, b);
      break;
    case Op::neg:
      value = less(int64_t{0}, a);
      break;
    case Op::shl:
      value = shifted_left(a, o.shift());
      break;
    case Op::round:
      value = rounded(a, o.shift());
      break;
    case Op::floor:
      value = a >> o.shift();
      break;
    case Op::mul:
      value = rounded(times(a, b), o.shift());
      break;
    case Op::mac:
      value = plus(a, rounded(times(b, c), o.shift()));
      break;
    case Op::dot:
      if (o.inputs() == 2) value = times(a, b);
      if (o.inputs() == 4) value = plus(times(a, c), times(b, in(3)));
      if (o.inputs() == 6) value = plus(plus(times(a, in(3)), times(b, in(4))), times(c, in(5)));
      value = rounded(value, o.shift());
      break;
    case Op::lookup:
      value = entry_value(tables[o.table()], static_cast<uint64_t>(a), static_cast<uint32_t>(b));
      break;
    case Op::lt:
      value = a < b;
      break;
    case Op::le:
      value = a <= b;
      break;
    case Op::eq:
      value = a == b;
      break;
    case Op::both:
      value = a & b;
      break;
    case Op::either:
      value = a | b;
      break;
    case Op::negate:
      value = 1 - a;
      break;
    case Op::select:
      value = a != 0 ? b : c;
      break;
    case Op::min:
      value = a < b ? a : b;
      break;
    case Op::max:
      value = a < b ? b : a;
      break;
    case Op::abs:
      value = a < 0 ? less(int64_t{0}, a) : a;
      break;
    case Op::clamp:
    case Op::within:
      value = a < b ? b : a > c ? c : a;
      break;
    case Op::msb:
      value = graph::leading_of(a);
      break;
    case Op::align:
      value = graph::aligned_of(a, o.shift(), o.width());
      break;
    case Op::shift:
      value = b >= 0 ? shifted_left(a, static_cast<int>(b < 63 ? b : 63))
                     : rounded(a, static_cast<int>(b > -63 ? -b : 63));
      break;
    case Op::check:
      value = wrap(a, o.width());
      fits = value == a || b == 0;
      break;
    case Op::noise:
      value = graph::mixed_of(in(3), a, b, c, o.width());
      break;
  }
  r.put_lane(o.out(), o.wide_out(), lane, value);
  return fits;
}

// Operations of all lanes. Those that come often have code for all lanes at once, others go lane by lane:
// code is to fit a processor's cache of instructions.
class Lanes {
 public:
  CUBOCT_DEVICE Lanes(const RoundsRegisters& r, const CodeTable* tables) : r_(r), tables_(tables) {}

  // The lanes, as bits, in which a check found what does not fit.
  CUBOCT_DEVICE uint32_t run(const Operation* code, uint32_t count) {
    using graph::Op;
    wrong_ = 0;
    at_ = code, end_ = code + count;
    next_ = load(at_);
    while (at_ != end_) {
      advance();
      switch (static_cast<Op>(now_.op())) {
        case Op::add:
          two([](auto a, auto b) { return plus(a, b); });
          break;
        case Op::sub:
          two([](auto a, auto b) { return less(a, b); });
          break;
        case Op::shl:
          repeat([&] { one([&](auto a) { return shifted_left(a, now_.shift()); }); });
          break;
        case Op::round:
          repeat([&] { round(); });
          break;
        case Op::mul:
          repeat([&] { multiply(); });
          break;
        case Op::dot:
          if (now_.narrow() && now_.inputs() == kMostInputs)
            repeat([&] { dot(); });
          else
            lane_by_lane();
          break;
        case Op::lookup:
          repeat([&] { look_up(); });
          break;
        case Op::lt:
          two([](auto a, auto b) { return a < b; });
          break;
        case Op::le:
          two([](auto a, auto b) { return a <= b; });
          break;
        case Op::both:
          repeat([&] { two_low([](int32_t a, int32_t b) { return a & b; }); });
          break;
        case Op::either:
          repeat([&] { two_low([](int32_t a, int32_t b) { return a | b; }); });
          break;
        case Op::select:
          repeat([&] { three([](auto a, auto b, auto c) { return a != 0 ? b : c; }); });
          break;
        case Op::clamp:
        case Op::within:
          repeat([&] {
            three([](auto a, auto low, auto high) { return a < low ? low : a > high ? high : a; });
          });
          break;
        case Op::check:
          repeat([&] { check(); });
          break;
        default:
          lane_by_lane();
      }
    }
    return wrong_;
  }

 private:
  CUBOCT_DEVICE void advance() {
    now_ = next_;
    next_ = load(++at_);
  }
  CUBOCT_DEVICE void lane_by_lane() {
    CUBOCT_NO_UNROLL
    for (int l = 0; l < kTogether; ++l) wrong_ |= static_cast<uint32_t>(!operate(now_, r_, l, tables_)) << l;
  }
  // Of this operation, and of those behind it that are alike.
  template <class F>
  CUBOCT_DEVICE void repeat(const F& f) {
    for (;;) {
      f();
      if (!now_.more()) return;
      advance();
    }
  }
  template <class F>
  CUBOCT_DEVICE static void each(const F& f) {
    CUBOCT_UNROLL
    for (int l = 0; l < kTogether; ++l) f(l);
  }
  CUBOCT_DEVICE Quad low(int k) const { return r_.low(now_.in(k)); }
  CUBOCT_DEVICE bool is_wide(int k) const { return now_.wide(k); }
  CUBOCT_DEVICE WideQuad wide(int k) const { return r_.value(now_.in(k), is_wide(k)); }
  CUBOCT_DEVICE void put(const Quad& value) const { r_.put(now_.out(), value); }
  CUBOCT_DEVICE void put(const WideQuad& value) const { r_.put(now_.out(), now_.wide_out(), value); }

  template <class F>
  CUBOCT_DEVICE void one(const F& f) const {
    const WideQuad a = wide(0);
    WideQuad value;
    each([&](int l) { value.v[l] = f(a.v[l]); });
    put(value);
  }
  template <class F>
  CUBOCT_DEVICE void two_low(const F& f) const {
    const Quad a = low(0), b = low(1);
    Quad value;
    each([&](int l) { value.v[l] = f(a.v[l], b.v[l]); });
    put(value);
  }
  template <class F>
  CUBOCT_DEVICE void two(const F& f) {
    if (now_.narrow()) return repeat([&] { two_low(f); });
    repeat([&] {
      const WideQuad a = wide(0), b = wide(1);
      WideQuad value;
      each([&](int l) { value.v[l] = f(a.v[l], b.v[l]); });
      put(value);
    });
  }
  template <class F>
  CUBOCT_DEVICE void three(const F& f) const {
    if (now_.narrow()) {
      const Quad a = low(0), b = low(1), c = low(2);
      Quad value;
      each([&](int l) { value.v[l] = f(a.v[l], b.v[l], c.v[l]); });
      return put(value);
    }
    const WideQuad a = wide(0), b = wide(1), c = wide(2);
    WideQuad value;
    each([&](int l) { value.v[l] = f(a.v[l], b.v[l], c.v[l]); });
    put(value);
  }

  CUBOCT_DEVICE void round() const {
    if (now_.narrow()) {
      const Quad a = low(0);
      const int32_t half = int32_t{1} << (now_.shift() - 1);
      Quad value;
      each([&](int l) { value.v[l] = plus(plus(a.v[l], half), a.v[l] >> 31) >> now_.shift(); });
      return put(value);
    }
    const Rounding by(now_.shift());
    one([&](int64_t a) { return rounded(a, by); });
  }
  CUBOCT_DEVICE WideQuad product_low(int j, int k) const {
    const Quad a = low(j), b = low(k);
    WideQuad value;
    each([&](int l) { value.v[l] = product(a.v[l], b.v[l]); });
    return value;
  }
  CUBOCT_DEVICE void put_rounded(WideQuad value) const {
    if (now_.shift() > 0) {
      const Rounding by(now_.shift());
      each([&](int l) { value.v[l] = rounded(value.v[l], by); });
    }
    put(value);
  }
  CUBOCT_DEVICE void multiply() const {
    if (now_.narrow()) return put_rounded(product_low(0, 1));
    const WideQuad a = wide(0), b = wide(1);
    WideQuad value;
    each([&](int l) { value.v[l] = times(a.v[l], b.v[l]); });
    put_rounded(value);
  }
  // Of three axes.
  CUBOCT_DEVICE void dot() const {
    WideQuad sum = product_low(0, 3);
    const WideQuad y = product_low(1, 4), z = product_low(2, 5);
    each([&](int l) { sum.v[l] = plus(sum.v[l], plus(y.v[l], z.v[l])); });
    put_rounded(sum);
  }
  CUBOCT_DEVICE void look_up() const {
    const CodeTable& table = tables_[now_.table()];
    const WideQuad argument = wide(0);
    const Quad law = low(1);
    WideQuad value;
    each([&](int l) {
      value.v[l] = entry_value(table, static_cast<uint64_t>(argument.v[l]), static_cast<uint32_t>(law.v[l]));
    });
    put(value);
  }
  CUBOCT_DEVICE void check() {
    const Quad when = low(1);
    const WideQuad a = wide(0);
    WideQuad value;
    each([&](int l) {
      value.v[l] = wrap(a.v[l], now_.width());
      wrong_ |= static_cast<uint32_t>(value.v[l] != a.v[l] && when.v[l] != 0) << l;
    });
    put(value);
  }

  const RoundsRegisters r_;
  const CodeTable* const tables_;
  const Operation *at_ = nullptr, *end_ = nullptr;
  Operation now_, next_;
  uint32_t wrong_ = 0;
};

}  // namespace cuboct::gpu
