// SPDX-License-Identifier: MIT
#include "model/program/real_range.h"

#include <algorithm>
#include <initializer_list>

namespace cuboct {
namespace {

constexpr RealRange kUncertain{0, 1};

bool is_none(const RealRange& a) { return std::isnan(a.low) && std::isnan(a.high); }
bool holds_zero(const RealRange& a) { return a.low <= 0 && a.high >= 0; }
RealRange range_of(bool truth) { return {truth ? 1.0 : 0.0, truth ? 1.0 : 0.0}; }

RealRange between(std::initializer_list<double> ends) {
  for (const double end : ends)
    if (std::isnan(end)) return RealRange::whole();
  return {std::min(ends), std::max(ends)};
}

// Of a function that grows, but for what the library rounds: less than 4 units in the last place.
RealRange nearly_between(double low, double high) {
  constexpr double kUnits = 0x1p-50;
  if (!std::isinf(low)) low -= kUnits * std::abs(low);
  if (!std::isinf(high)) high += kUnits * std::abs(high);
  return between({low, high});
}

// Of a function that is no steeper than 1 and lies in [-1, 1].
RealRange range_of_wave(double (*f)(double), const RealRange& a) {
  const double half = (a.high - a.low) / 2;
  if (!(half < 2)) return {-1, 1};
  const double middle = f(a.low + half);
  // The middle, half of the way and the function are rounded.
  const double most = half + 0x1p-50 * (1 + std::max(std::abs(a.low), std::abs(a.high)));
  return {std::max(-1.0, middle - most), std::min(1.0, middle + most)};
}

RealRange range_of_product(const RealNode& node, const RealRange& a, const RealRange& b) {
  if (node.of[0] != node.of[1])
    return between({a.low * b.low, a.low * b.high, a.high * b.low, a.high * b.high});
  const auto [least, most] = std::minmax({a.low * a.low, a.high * a.high});
  return {holds_zero(a) ? 0 : least, most};
}

RealRange range_of_comparison(RealOp op, const RealRange& a, const RealRange& b) {
  const bool equals = op == RealOp::at_most;
  if (a.high < b.low || (equals && a.high <= b.low)) return range_of(true);
  if (a.low > b.high || (!equals && a.low >= b.high)) return range_of(false);
  return kUncertain;
}

// One that is false decides `both`, one that is true `either`.
RealRange range_of_two(bool both, std::optional<bool> a, std::optional<bool> b) {
  if ((a && *a != both) || (b && *b != both)) return range_of(!both);
  return a && b ? range_of(both) : kUncertain;
}

RealRange range_of_chosen(std::optional<bool> truth, const RealRange& a, const RealRange& b) {
  if (truth) return *truth ? a : b;
  return between({a.low, a.high, b.low, b.high});
}

// What is no number makes none, and no comparison of it holds.
RealRange range_of_none(RealOp op) {
  switch (op) {
    case RealOp::below:
    case RealOp::at_most:
    case RealOp::equal:
      return range_of(false);
    case RealOp::least:
    case RealOp::most:
    case RealOp::both:
    case RealOp::either:
    case RealOp::inverse:
    case RealOp::select:
      return RealRange::whole();
    default:
      return {NAN, NAN};
  }
}

// Where a function grows, so do its doubles as IEEE rounds them: ends become ends.
RealRange range_of_parts(const RealNode& node, const RealRange& a, const RealRange& b, const RealRange& c) {
  switch (node.op) {
    case RealOp::add:
      return between({a.low + b.low, a.high + b.high});
    case RealOp::subtract:
      return between({a.low - b.high, a.high - b.low});
    case RealOp::multiply:
      return range_of_product(node, a, b);
    case RealOp::divide:
      if (holds_zero(b)) return RealRange::whole();
      return between({a.low / b.low, a.low / b.high, a.high / b.low, a.high / b.high});
    case RealOp::negate:
      return {-a.high, -a.low};
    case RealOp::square_root:
      if (a.high < 0) return {NAN, NAN};
      return between({std::sqrt(a.low), std::sqrt(a.high)});
    case RealOp::exponential:
      return nearly_between(std::exp(a.low), std::exp(a.high));
    case RealOp::logarithm:
      if (a.high < 0) return {NAN, NAN};
      return nearly_between(std::log(a.low), std::log(a.high));
    case RealOp::sine:
      return range_of_wave(std::sin, a);
    case RealOp::cosine:
      return range_of_wave(std::cos, a);
    case RealOp::error_function:
      return nearly_between(std::erfc(a.high), std::erfc(a.low));
    case RealOp::power: {
      if (a.low < 0 || !b.point()) return RealRange::whole();
      const auto [low, high] = std::minmax({std::pow(a.low, b.low), std::pow(a.high, b.low)});
      return nearly_between(low, high);
    }
    case RealOp::absolute: {
      const auto [least, most] = std::minmax({std::abs(a.low), std::abs(a.high)});
      return {holds_zero(a) ? 0 : least, most};
    }
    case RealOp::least:
      return {std::min(a.low, b.low), std::min(a.high, b.high)};
    case RealOp::most:
      return {std::max(a.low, b.low), std::max(a.high, b.high)};
    case RealOp::below:
    case RealOp::at_most:
      return range_of_comparison(node.op, a, b);
    case RealOp::equal:
      return a.high < b.low || b.high < a.low ? range_of(false) : kUncertain;
    case RealOp::both:
    case RealOp::either:
      return range_of_two(node.op == RealOp::both, certain(a), certain(b));
    case RealOp::inverse:
      return certain(a) ? range_of(!*certain(a)) : kUncertain;
    case RealOp::select:
      return range_of_chosen(certain(a), b, c);
    default:
      return RealRange::whole();
  }
}

}  // namespace

RealRange ranged(const RealNode& node, const RealRange& a, const RealRange& b, const RealRange& c) {
  bool single = true, none = false;
  for (int k = 0; k < arity(node.op); ++k) {
    const RealRange& part = k == 0 ? a : k == 1 ? b : c;
    single = single && (part.point() || is_none(part));
    none = none || is_none(part);
  }
  if (single) {
    const double value = applied(node, a.low, b.low, c.low);
    return {value, value};
  }
  return none ? range_of_none(node.op) : range_of_parts(node, a, b, c);
}

std::optional<bool> certain(const RealRange& truth) {
  if (truth.low == 0 && truth.high == 0) return false;
  if (holds_zero(truth)) return std::nullopt;
  return true;
}

}  // namespace cuboct
