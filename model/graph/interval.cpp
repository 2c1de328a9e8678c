// SPDX-License-Identifier: MIT
#include "model/graph/interval.h"

#include <algorithm>
#include <initializer_list>

#include "model/base/fixed_math.h"
#include "model/graph/table_value.h"

namespace cuboct::graph {
namespace {

Wide rounded(Wide a, int s) { return s == 0 ? a : (a + (Wide{1} << (s - 1)) - (a < 0 ? 1 : 0)) >> s; }

WideInterval hull(std::initializer_list<Wide> values) { return {std::min(values), std::max(values)}; }

WideInterval product(Interval a, Interval b) {
  return hull({Wide{a.low} * b.low, Wide{a.low} * b.high, Wide{a.high} * b.low, Wide{a.high} * b.high});
}

WideInterval square(Interval a) {
  WideInterval ends = hull({Wide{a.low} * a.low, Wide{a.high} * a.high});
  if (a.holds(0)) ends.low = 0;
  return ends;
}

WideInterval rounded(WideInterval a, int s) { return {rounded(a.low, s), rounded(a.high, s)}; }

int leading(int64_t a) { return a <= 0 ? -1 : leading_bit(static_cast<uint64_t>(a)); }

WideInterval aligned(const Node& node, Interval a) {
  if (a.high <= 0) return {0, 0};
  const auto down = [&](int64_t v) { return leading(v) / node.width * node.width; };
  const auto at = [&](int64_t v) {
    const int by = node.shift - down(v);
    return by >= 0 ? Wide{v} << by : Wide{v} >> -by;
  };
  if (a.low > 0 && down(a.low) == down(a.high)) return {at(a.low), at(a.high)};
  return {a.low > 0 ? Wide{1} << node.shift : 0, (Wide{1} << (node.shift + node.width)) - 1};
}

// a 2^n is monotone in a, and in n where the sign of a is known: its ends are at corners.
WideInterval shifted(Interval a, Interval n) {
  const auto at = [](int64_t v, int64_t by) {
    return by >= 0 ? Wide{v} << by : rounded(Wide{v}, static_cast<int>(-by));
  };
  return hull({at(a.low, n.low), at(a.low, n.high), at(a.high, n.low), at(a.high, n.high)});
}

WideInterval wrapped(Interval a, int width) {
  if (fits(a.low, width) && fits(a.high, width)) return {a.low, a.high};
  return {-(Wide{1} << (width - 1)), (Wide{1} << (width - 1)) - 1};
}

// Truth of "a < b" where `most` of a and `least` of b are told, and the other way round.
WideInterval truth(bool always, bool never) { return {always ? 1 : 0, never ? 0 : 1}; }

WideInterval compared(Op op, Interval a, Interval b) {
  if (op == Op::lt) return truth(a.high < b.low, a.low >= b.high);
  if (op == Op::le) return truth(a.high <= b.low, a.low > b.high);
  const bool apart = a.high < b.low || b.high < a.low;
  return truth(a == b && a.low == a.high, apart);
}

WideInterval sum(WideInterval a, WideInterval b) { return {a.low + b.low, a.high + b.high}; }

// The values of one bin for t in [t0, t1].
class BinRange {
 public:
  BinRange(const FixedTable& table, uint32_t entry) : table_(table), entry_(entry) {}
  void reach(int64_t t0, int64_t t1) {
    add(at(t0)), add(at(t1));
    if (table_.degree == 2) add_vertex(t0, t1);
  }
  static void add(WideInterval& to, Wide v) { to = {std::min(to.low, v), std::max(to.high, v)}; }
  WideInterval range{Wide{1} << 100, -(Wide{1} << 100)};

 private:
  void add(Wide v) { add(range, v); }
  Wide at(int64_t t) const {
    const int T = table_.fraction_bits;
    Wide slope = table_.c1[entry_];
    if (table_.degree == 2) slope += rounded(Wide{table_.c2[entry_]} * t, T);
    return table_.c0[entry_] + rounded(slope * t, T);
  }
  // The parabola c0 + c1 z + c2 z^2, z = t/2^T, has its vertex at z = -c1 / (2 c2), where it is c0 - c1^2 /
  // (4 c2). Two roundings, the first times z < 1, take the integer less than a unit off it.
  void add_vertex(int64_t t0, int64_t t1) {
    const Wide c1 = table_.c1[entry_], c2 = table_.c2[entry_];
    if (c2 == 0) return;
    const Wide sign = c2 < 0 ? -1 : 1, at = -sign * (c1 << table_.fraction_bits), per = 2 * sign * c2;
    if (at <= t0 * per || at >= t1 * per) return;
    const Wide least = c1 * c1 / (4 * sign * c2);  // rounded down
    add(table_.c0[entry_] - sign * (least + 1));
    add(table_.c0[entry_] - sign * (least + 2));
  }

  const FixedTable& table_;
  uint32_t entry_;
};

// Calls visit(bin, t0, t1) for all that arguments in [low, high] reach, where c = bin 2^T + t grows with the
// argument and is a multiple of `stride`.
template <class Visit>
void bins_between(const FixedTable& table, uint64_t low, uint64_t high, uint64_t stride, Visit visit) {
  const int T = table.fraction_bits;
  FixedTable::Address first = table.address(low), last = table.address(high);
  for (uint32_t bin = first.index; bin <= last.index; ++bin) {
    const uint64_t begin = (uint64_t{bin} << T) + (bin == first.index ? first.t : 0);
    const uint64_t end = (uint64_t{bin} << T) + (bin == last.index ? last.t : (uint64_t{1} << T) - 1);
    const uint64_t c0 = (begin + stride - 1) / stride * stride, c1 = end / stride * stride;
    if (c0 > c1) continue;
    visit(bin, static_cast<int64_t>(c0 - (uint64_t{bin} << T)),
          static_cast<int64_t>(c1 - (uint64_t{bin} << T)));
  }
}

template <class Visit>
void bins_reached(const FixedTable& table, uint64_t low, uint64_t high, Visit visit) {
  if (table.shape == TableShape::uniform) return bins_between(table, low, high, 1, visit);
  if (low >> table.first_octave == 0) visit(0u, int64_t{0}, int64_t{0});
  for (int octave = std::max(table.first_octave, leading(static_cast<int64_t>(low)));
       octave <= leading(static_cast<int64_t>(high)); ++octave) {
    const uint64_t begin = uint64_t{1} << octave, end = 2 * begin - 1;
    const int padded = std::max(0, table.bin_bits + table.fraction_bits - octave);
    bins_between(table, std::max(low, begin), std::min(high, end), uint64_t{1} << padded, visit);
  }
}

}  // namespace

int64_t laws_of(const FixedTable& table) { return static_cast<int64_t>(table.c0.size() >> table.index_bits); }

Interval domain_of(const FixedTable& table) { return {0, (int64_t{1} << (2 * table.difference_frac)) - 1}; }

WideInterval range_of(const FixedTable& table, Interval argument, Interval law) {
  WideInterval all{Wide{1} << 100, -(Wide{1} << 100)};
  for (int64_t n = law.low; n <= law.high; ++n)
    bins_reached(table, static_cast<uint64_t>(argument.low), static_cast<uint64_t>(argument.high),
                 [&](uint32_t bin, int64_t t0, int64_t t1) {
                   BinRange of(table, (static_cast<uint32_t>(n) << table.index_bits) + bin);
                   of.reach(t0, t1);
                   BinRange::add(all, of.range.low), BinRange::add(all, of.range.high);
                 });
  return all;
}

WideInterval product_of(const Node& node, const std::vector<Interval>& in) {
  const auto factor = [&](size_t a, size_t b) {
    return node.inputs[a] == node.inputs[b] ? square(in[a]) : product(in[a], in[b]);
  };
  if (node.op == Op::mul) return factor(0, 1);
  if (node.op == Op::mac) return factor(1, 2);
  WideInterval all{};
  if (node.op == Op::dot)
    for (size_t k = 0; k < in.size() / 2; ++k) all = sum(all, factor(k, in.size() / 2 + k));
  return all;
}

WideInterval range_of(const Node& node, const std::vector<Interval>& in, const FixedTable* table) {
  const auto whole = [&](size_t k) { return WideInterval{in[k].low, in[k].high}; };
  switch (node.op) {
    case Op::constant:
      return {node.number, node.number};
    case Op::input:
      return {node.range.low, node.range.high};
    case Op::add:
      return sum(whole(0), whole(1));
    case Op::sub:
      return {Wide{in[0].low} - in[1].high, Wide{in[0].high} - in[1].low};
    case Op::neg:
      return {-Wide{in[0].high}, -Wide{in[0].low}};
    case Op::shl:
      return {Wide{in[0].low} << node.shift, Wide{in[0].high} << node.shift};
    case Op::round:
      return rounded(whole(0), node.shift);
    case Op::floor:
      return {Wide{in[0].low} >> node.shift, Wide{in[0].high} >> node.shift};
    case Op::mul:
    case Op::dot:
      return rounded(product_of(node, in), node.shift);
    case Op::mac:
      return sum(whole(0), rounded(product_of(node, in), node.shift));
    case Op::lookup:
      return range_of(*table, in[0], in[1]);
    case Op::lt:
    case Op::le:
    case Op::eq:
      return compared(node.op, in[0], in[1]);
    case Op::both:
      return {in[0].low & in[1].low, in[0].high & in[1].high};
    case Op::either:
      return {in[0].low | in[1].low, in[0].high | in[1].high};
    case Op::negate:
      return {1 - in[0].high, 1 - in[0].low};
    case Op::select:
      if (in[0].low == in[0].high) return whole(in[0].low ? 1 : 2);
      return {std::min(in[1].low, in[2].low), std::max(in[1].high, in[2].high)};
    case Op::min:
      return {std::min(in[0].low, in[1].low), std::min(in[0].high, in[1].high)};
    case Op::max:
      return {std::max(in[0].low, in[1].low), std::max(in[0].high, in[1].high)};
    case Op::abs: {
      const WideInterval ends = hull(
          {in[0].low < 0 ? -Wide{in[0].low} : in[0].low, in[0].high < 0 ? -Wide{in[0].high} : in[0].high});
      return {in[0].holds(0) ? 0 : ends.low, ends.high};
    }
    case Op::clamp:
    case Op::within:
      return {std::clamp(in[0].low, node.range.low, node.range.high),
              std::clamp(in[0].high, node.range.low, node.range.high)};
    case Op::msb:
      return {leading(in[0].low), leading(in[0].high)};
    case Op::align:
      return aligned(node, in[0]);
    case Op::shift:
      return shifted(in[0], in[1]);
    case Op::check:
      return wrapped(in[0], node.width);
    case Op::noise:
      return {-(Wide{1} << (node.width - 1)), (Wide{1} << (node.width - 1)) - 1};
  }
  return {};
}

}  // namespace cuboct::graph
