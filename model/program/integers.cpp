// SPDX-License-Identifier: MIT
#include "model/program/integers.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace cuboct {
namespace {

constexpr int kWide = 50;  // bits of a sum's parts beside the sign

}  // namespace

Scaled Integers::scaled(int node, int frac, double unit) {
  int exponent = 0;
  const double mantissa = std::frexp(unit, &exponent) * 2;
  return {node, 0, frac - (exponent - 1), mantissa};
}

int64_t Integers::size_of(int node) const {
  const graph::Interval range = b_.range(node);
  return std::max(range.high, -(range.low + (range.low < 0)));
}
int Integers::bits_of(const Scaled& a) const {
  return static_cast<int>(std::bit_width(static_cast<uint64_t>(size_of(a.node))));
}

Scaled Integers::narrow(const Scaled& a, int bits) {
  if (a.constant()) return a;
  const int spare = bits_of(a) - bits;
  if (spare <= 0) return a;
  return {b_.round(a.node, spare), 0, a.frac - spare, a.unit};
}

Scaled Integers::known(double number, double unit, int frac) {
  return {b_.constant(std::llround(std::ldexp(number / unit, frac)), frac), 0, frac, unit};
}

// As finely as a factor is.
int Integers::node_of(const Scaled& a) {
  if (!a.constant()) return a.node;
  if (a.number == 0) return b_.constant(0);
  int exponent = 0;
  std::frexp(a.number, &exponent);
  return known(a.number, 1, factor_ - exponent).node;
}

Scaled Integers::multiply(const Scaled& a, const Scaled& b) {
  if (a.constant() && b.constant()) return Scaled::of(a.number * b.number);
  if (b.constant()) return multiply(b, a);
  if (a.constant()) {
    if (a.number == 0) return Scaled::of(0);
    const Scaled product = scaled(b.node, b.frac, b.unit * std::abs(a.number));
    return a.number < 0 ? negate(product) : product;
  }
  // The wider one gives way first.
  const int bits_a = bits_of(a), bits_b = bits_of(b), most = 2 * factor_;
  const Scaled x = narrow(a, std::max(factor_, most - std::min(bits_b, factor_)));
  const Scaled y = narrow(b, std::max(factor_, most - std::min(bits_a, factor_)));
  return scaled(b_.mul(x.node, y.node), x.frac + y.frac, x.unit * y.unit);
}

Scaled Integers::in_unit(const Scaled& a, double unit) {
  constexpr double kSame = 1e-12;  // what products of constants leave of one unit
  const Scaled target = scaled(0, 0, unit);
  if (a.constant()) return a;
  const double ratio = a.unit / target.unit;
  const auto power = static_cast<int>(std::lround(std::log2(ratio)));
  if (std::abs(std::ldexp(ratio, -power) - 1) < kSame) return {a.node, 0, a.frac - power, target.unit};
  const Scaled x = narrow(a, factor_);
  const auto factor = std::llround(std::ldexp(ratio, factor_ - 1));
  return {b_.mul(x.node, b_.constant(factor, factor_ - 1)), 0, x.frac + factor_ - 1, target.unit};
}

int Integers::node_in(const Scaled& a, double unit, int frac) {
  const Scaled target = scaled(0, frac, unit);
  if (a.constant()) return known(a.number, target.unit, target.frac).node;
  const Scaled x = in_unit(a, unit);
  return x.frac >= target.frac ? b_.round(x.node, x.frac - target.frac)
                               : b_.shl(x.node, target.frac - x.frac);
}

// In one unit, with the fraction of the finer one where that fits.
std::pair<Scaled, Scaled> Integers::alike(const Scaled& a, const Scaled& b) {
  if (a.constant() && !b.constant()) {
    auto [y, x] = alike(b, a);
    return {x, y};
  }
  if (b.constant()) {
    Scaled x = narrow(a, kWide);
    // A constant far above the value coarsens it.
    const int over = b.number == 0 ? 0 : std::ilogb(b.number / x.unit) + x.frac + 1 - kWide;
    if (over > 0) x = {b_.round(x.node, over), 0, x.frac - over, x.unit};
    return {x, known(b.number, x.unit, x.frac)};
  }
  Scaled x = narrow(a, kWide), y = narrow(in_unit(b, a.unit), kWide);
  for (Scaled* coarse : {&x, &y}) {
    Scaled* fine = coarse == &x ? &y : &x;
    if (coarse->frac >= fine->frac) continue;
    const int room = std::min(fine->frac - coarse->frac, kWide - bits_of(*coarse));
    *coarse = {b_.shl(coarse->node, room), 0, coarse->frac + room, coarse->unit};
    *fine = {b_.round(fine->node, fine->frac - coarse->frac), 0, coarse->frac, fine->unit};
  }
  return {x, y};
}

Scaled Integers::add(const Scaled& a, const Scaled& b) {
  if (a.constant() && b.constant()) return Scaled::of(a.number + b.number);
  if (a.constant() && a.number == 0) return b;
  if (b.constant() && b.number == 0) return a;
  const auto [x, y] = alike(a, b);
  return {b_.add(x.node, y.node), 0, x.frac, x.unit};
}

Scaled Integers::negate(const Scaled& a) {
  if (a.constant()) return Scaled::of(-a.number);
  return {b_.neg(a.node), 0, a.frac, a.unit};
}

Scaled Integers::absolute(const Scaled& a) {
  if (a.constant()) return Scaled::of(std::abs(a.number));
  return {b_.abs(a.node), 0, a.frac, a.unit};
}

Scaled Integers::chosen(bool least, const Scaled& a, const Scaled& b) {
  if (a.constant() && b.constant())
    return Scaled::of(least ? std::min(a.number, b.number) : std::max(a.number, b.number));
  const auto [x, y] = alike(a, b);
  return {least ? b_.min(x.node, y.node) : b_.max(x.node, y.node), 0, x.frac, x.unit};
}

Scaled Integers::below(const Scaled& a, const Scaled& b, bool or_equal) {
  if (a.constant() && b.constant()) return Scaled::of(or_equal ? a.number <= b.number : a.number < b.number);
  const auto [x, y] = alike(a, b);
  return {or_equal ? b_.le(x.node, y.node) : b_.lt(x.node, y.node), 0, 0, 1};
}

Scaled Integers::equal(const Scaled& a, const Scaled& b) {
  if (a.constant() && b.constant()) return Scaled::of(a.number == b.number);
  const auto [x, y] = alike(a, b);
  return {b_.eq(x.node, y.node), 0, 0, 1};
}

Scaled Integers::both(const Scaled& a, const Scaled& b) {
  if (a.constant()) return a.number != 0 ? b : a;
  if (b.constant()) return both(b, a);
  return {b_.both(a.node, b.node), 0, 0, 1};
}

Scaled Integers::either(const Scaled& a, const Scaled& b) {
  if (a.constant()) return a.number != 0 ? a : b;
  if (b.constant()) return either(b, a);
  return {b_.either(a.node, b.node), 0, 0, 1};
}

Scaled Integers::inverse(const Scaled& a) {
  if (a.constant()) return Scaled::of(a.number == 0);
  return {b_.negate(a.node), 0, 0, 1};
}

Scaled Integers::select(const Scaled& truth, const Scaled& a, const Scaled& b) {
  if (truth.constant()) return truth.number != 0 ? a : b;
  if (a.constant() && b.constant()) {
    if (a.number == b.number) return a;
    const double larger = std::abs(a.number) > std::abs(b.number) ? a.number : b.number;
    int exponent = 0;
    std::frexp(larger, &exponent);
    const int frac = factor_ - exponent;
    const int other = known(b.number, 1, frac).node, one = known(a.number, 1, frac).node;
    return {b_.select(truth.node, one, other), 0, frac, 1};
  }
  const auto [x, y] = alike(a, b);
  return {b_.select(truth.node, x.node, y.node), 0, x.frac, x.unit};
}

Scaled Integers::function(const Scaled& a, const std::function<double(double)>& f, double from, double to,
                          double unit) {
  if (a.constant()) return Scaled::of(f(a.number));
  constexpr int kArgument = 44;  // bits: a table takes an even number
  const Scaled x = narrow(a, kArgument);
  const double step = std::ldexp(x.unit, -x.frac);
  const Scaled values = scaled(0, 0, unit > 0 ? unit : 1);
  const FittedTable fitted =
      fit_table({.bits = bits_of(x), .step = step, .from = from, .to = to, .unit = values.unit}, f);
  return looked_up(fitted, values.unit, x.node);
}

Scaled Integers::looked_up(const FittedTable& fitted, double unit, int argument, int law) {
  const size_t before = b_.graph().tables.size();
  const int table = b_.table(fitted.table);
  if (b_.graph().tables.size() > before)
    fits_.push_back({fitted.largest > 0 ? fitted.worst / fitted.largest : 0, fitted.table.c0.size()});
  return {b_.lookup(table, argument, law), 0, fitted.table.value_frac, unit};
}

}  // namespace cuboct
