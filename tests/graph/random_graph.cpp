// SPDX-License-Identifier: MIT
#include "tests/graph/random_graph.h"

#include <algorithm>

namespace cuboct::test {
namespace {

using graph::Builder;
using graph::Interval;
using graph::Op;
using graph::Source;

Interval random_range(Dice& dice) {
  const int bits = dice.draw(1, 27);
  const auto high = static_cast<int64_t>(dice.bits(bits));
  if (dice.chance(30)) return {0, std::max<int64_t>(high, 1)};
  return {-static_cast<int64_t>(dice.bits(bits)), high + 1};
}

class Draw {
 public:
  explicit Draw(uint64_t seed, bool pair = false) : dice_(seed), pair_(pair) {
    tables_ = {b_.table(random_table(dice_)), b_.table(random_table(dice_))};
    if (pair_) {
      for (int k = 0; k < 2; ++k)
        for (const Source source : {Source::own_field, Source::other_field, Source::apart})
          numbers_.push_back(b_.input(source, k, 0, {-4000, 4000}));
      for (int k = 0; k < 4; k += 2) numbers_.push_back(b_.add(numbers_[0], numbers_[1]));
      numbers_.push_back(b_.sub(numbers_[3], numbers_[4]));
      truths_.push_back(b_.eq(numbers_[0], numbers_[1]));
      return;
    }
    for (int k = dice_.draw(2, 5); k > 0; --k)
      numbers_.push_back(b_.input(Source::own_field, k, 0, random_range(dice_)));
    truths_.push_back(b_.input(Source::own_field, 9, 0, {0, 1}));
  }

  Drawn drawn(int steps) {
    for (int k = 0; k < steps; ++k) {
      auto op = static_cast<Op>(dice_.draw(static_cast<int>(Op::add), static_cast<int>(Op::noise)));
      // Parity takes a step without a fault, and pairs that count.
      if (pair_ && (op == Op::check || op == Op::within)) op = Op::mul;
      try {
        add(op);
      } catch (const InputError&) {
        ++refused_[op];
      }
      if (k == steps / 2 && !pair_) count();
    }
    const int when = b_.when();
    return {b_.take(), refused_, when};
  }

 private:
  int number() { return numbers_[static_cast<size_t>(dice_.draw(0, static_cast<int>(numbers_.size()) - 1))]; }
  int truth() { return truths_[static_cast<size_t>(dice_.draw(0, static_cast<int>(truths_.size()) - 1))]; }
  void count() {
    const int below = number();
    const Interval range = b_.range(below);
    b_.counts(b_.both(truth(), b_.lt(below, b_.constant(range.low + (range.high - range.low) / 2 + 1))));
    numbers_.push_back(b_.within(below));
  }
  int shift() { return dice_.draw(0, 20); }
  std::vector<int> vector(int n) {
    std::vector<int> v;
    while (n-- > 0) v.push_back(number());
    return v;
  }

  int looked_up() {
    const int table = tables_[static_cast<size_t>(dice_.draw(0, 1))];
    const FixedTable& of = b_.graph().tables[static_cast<size_t>(table)];
    const int law = b_.clamp(number(), {0, graph::laws_of(of) - 1});
    return b_.lookup(table, b_.clamp(number(), graph::domain_of(of)), law);
  }

  void add(Op op) {
    if (op >= Op::lt && op <= Op::negate)
      truths_.push_back(made(op));
    else
      numbers_.push_back(made(op));
  }

  int made(Op op) {
    const int n = dice_.draw(1, 3);
    switch (op) {
      case Op::add:
        return b_.add(number(), number());
      case Op::sub:
        return b_.sub(number(), number());
      case Op::neg:
        return b_.neg(number());
      case Op::shl:
        return b_.shl(number(), dice_.draw(1, 8));
      case Op::round:
        return b_.round(number(), shift());
      case Op::floor:
        return b_.floor(number(), shift());
      case Op::mul:
        return b_.mul(number(), number(), shift());
      case Op::mac:
        return b_.mac(number(), number(), number(), shift());
      case Op::dot:
        return b_.dot(vector(n), vector(n), shift());
      case Op::lookup:
        return looked_up();
      case Op::lt:
        return b_.lt(number(), number());
      case Op::le:
        return b_.le(number(), number());
      case Op::eq:
        return b_.eq(number(), number());
      case Op::both:
        return b_.both(truth(), truth());
      case Op::either:
        return b_.either(truth(), truth());
      case Op::negate:
        return b_.negate(truth());
      case Op::select:
        return b_.select(truth(), number(), number());
      case Op::min:
        return b_.min(number(), number());
      case Op::max:
        return b_.max(number(), number());
      case Op::abs:
        return b_.abs(number());
      case Op::clamp:
        return b_.clamp(number(), random_range(dice_));
      case Op::within:
        return b_.within(number());
      case Op::msb:
        return b_.msb(number());
      case Op::align:
        return b_.align(number(), dice_.draw(0, 20), dice_.draw(1, 2));
      case Op::shift:
        return b_.shift(number(), b_.clamp(number(), {-9, 9}));
      case Op::check:
        return b_.check(number(), dice_.draw(2, 27), Fault::strength, truth());
      case Op::noise:
        return b_.noise(number(), number(), number(), dice_.draw(0, 99), dice_.draw(1, 27));
      default:
        return number();
    }
  }

  Dice dice_;
  bool pair_;
  Builder b_;
  std::vector<int> tables_, numbers_, truths_;
  std::map<Op, int> refused_;
};

}  // namespace

FixedTable random_table(Dice& dice) {
  FixedTable table;
  table.shape = dice.chance(50) ? TableShape::uniform : TableShape::octaves;
  table.degree = dice.draw(1, 2);
  table.difference_frac = dice.draw(4, 9);
  table.index_bits = dice.draw(3, 6);
  table.fraction_bits = dice.draw(1, 8);
  table.value_frac = dice.draw(-3, 20);
  if (table.shape == TableShape::uniform) {
    table.fraction_bits = std::min(table.fraction_bits, 2 * table.difference_frac - table.index_bits);
  } else {
    table.bin_bits = table.index_bits - 2;
    table.first_octave = 2 * table.difference_frac - dice.draw(1, 4);
  }
  const size_t entries = static_cast<size_t>(dice.draw(1, 3)) << table.index_bits;
  for (auto* c : {&table.c0, &table.c1, &table.c2})
    for (size_t k = 0; k < entries && (c != &table.c2 || table.degree == 2); ++k)
      c->push_back(static_cast<int32_t>(dice.bits(17)) - (1 << 16));
  return table;
}

Drawn random_graph(uint64_t seed, int steps) { return Draw(seed).drawn(steps); }

graph::Graph random_pair_graph(uint64_t seed, int steps) { return Draw(seed, true).drawn(steps).graph; }

int64_t random_value(Dice& dice, graph::Interval range) {
  const auto any = [&] {
    return range.low +
           static_cast<int64_t>(dice.bits(62) % static_cast<uint64_t>(range.high - range.low + 1));
  };
  const int s = dice.draw(1, 20);
  const int64_t tie = ((any() >> s) << s) + (int64_t{1} << (s - 1)),
                seam = ((any() >> s) << s) - dice.draw(0, 1);
  const int64_t choices[] = {range.low, range.high, 0, any(), tie, -tie, seam, any()};
  return std::clamp(choices[dice.draw(0, 7)], range.low, range.high);
}

}  // namespace cuboct::test
