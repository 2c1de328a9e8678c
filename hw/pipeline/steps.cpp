// SPDX-License-Identifier: MIT
#include "hw/pipeline/steps.h"

#include <algorithm>
#include <bit>

#include "hw/pipeline/step_maker.h"
#include "model/base/hash.h"
#include "model/graph/interval.h"

namespace cuboct::pipeline {
namespace {

using graph::Graph;
using graph::Interval;
using graph::Node;
using graph::Op;

// Takes the nodes one after the other.
class GraphSteps {
 public:
  GraphSteps(const Graph& graph, const std::vector<int>& outputs) : graph_(graph) {
    all_.of_node.assign(graph.nodes.size(), -1);
    for (const int n : graph::needed_by(graph, outputs)) {
      make_.begin(n);
      all_.of_node[static_cast<size_t>(n)] = value_of(n);
    }
    make_.begin(-1);
    for (const int n : outputs) all_.outputs.push_back({step(n), n});
    first_fault();
    all_.steps = make_.take();
  }
  Steps take() { return std::move(all_); }

 private:
  struct Failed {
    int is, code, number;  // steps
    Fault fault;
  };

  const Node& at(int node) const { return graph_.nodes[static_cast<size_t>(node)]; }
  int step(int node) const { return all_.of_node[static_cast<size_t>(node)]; }
  int in(const Node& node, size_t k) const { return step(node.inputs[k]); }
  Interval range(const Node& node, size_t k) const { return at(node.inputs[k]).range; }

  int value_of(int n) {
    const Node& node = at(n);
    const Form form = form_of(node.range);
    const auto a = [&] { return in(node, 0); };
    const auto b = [&] { return in(node, 1); };
    switch (node.op) {
      case Op::constant:
        return make_.constant(node.number);
      case Op::input:
        all_.inputs.push_back({make_.input(form), n});
        return all_.inputs.back().step;
      case Op::add:
        return make_.of(Kind::add, {a(), b()}, form);
      case Op::sub:
        return make_.of(Kind::sub, {a(), b()}, form);
      case Op::neg:
        return make_.of(Kind::sub, {make_.constant(0), a()}, form);
      case Op::shl:
        return make_.cast(make_.times_power(a(), node.shift), form);
      case Op::round:
        return make_.rounded(a(), node.shift, form);
      case Op::floor:
        return make_.slice(a(), node.shift, form);
      case Op::mul:
      case Op::dot:
        return make_.rounded(products(node, 0), node.shift, form);
      case Op::mac:
        return make_.rounded(products(node, 1), node.shift, form, a());
      case Op::lookup:
        return lookup(node, form);
      case Op::lt:
        return make_.of(Kind::less, {a(), b()}, {});
      case Op::le:
        return make_.of(Kind::less_equal, {a(), b()}, {});
      case Op::eq:
        return make_.of(Kind::equal, {a(), b()}, {});
      case Op::both:
        return make_.of(Kind::both, {a(), b()}, {});
      case Op::either:
        return make_.of(Kind::either, {a(), b()}, {});
      case Op::negate:
        return make_.of(Kind::negate, {a()}, {});
      case Op::select:
        return make_.of(Kind::choose, {a(), b(), in(node, 2)}, form);
      case Op::min:
        return make_.of(Kind::choose, {less(node, 0, 1), a(), b()}, form);
      case Op::max:
        return make_.of(Kind::choose, {less(node, 0, 1), b(), a()}, form);
      case Op::abs:
        return absolute(node, form);
      case Op::clamp:
        return clamped(node, form);
      case Op::within:
        return make_.cast(a(), form);
      case Op::msb:
        return leading(node, form);
      case Op::align:
        return aligned(node, form);
      case Op::shift:
        return shifted(node, form);
      case Op::check:
        return checked(node, form);
      case Op::noise:
        return noise(node, form);
    }
    return -1;
  }

  // The sum of products of a node's factors from `first` on, before it is rounded.
  int products(const Node& node, size_t first) {
    std::vector<Interval> ranges;
    for (const int k : node.inputs) ranges.push_back(at(k).range);
    const graph::WideInterval sum = graph::product_of(node, ranges);
    Form form{1, sum.low < 0};
    while (!(form.is_signed ? sum.low >= -(graph::Wide{1} << (form.bits - 1)) &&
                                  sum.high < (graph::Wide{1} << (form.bits - 1))
                            : sum.high < (graph::Wide{1} << form.bits)))
      ++form.bits;
    std::vector<std::pair<int, int>> factors;
    const size_t count = (node.inputs.size() - first) / 2;
    for (size_t k = first; k < first + count; ++k) factors.emplace_back(in(node, k), in(node, k + count));
    return make_.sum_of_products(factors, form);
  }

  // Whether one input is less than another, where their intervals do not say so.
  int less(const Node& node, size_t a, size_t b) {
    if (range(node, a).high < range(node, b).low) return make_.constant(1);
    if (in(node, a) == in(node, b) || range(node, a).low >= range(node, b).high) return make_.constant(0);
    return make_.of(Kind::less, {in(node, a), in(node, b)}, {});
  }

  int absolute(const Node& node, Form form) {
    const int a = in(node, 0), negative = make_.of(Kind::sub, {make_.constant(0), a}, form);
    if (range(node, 0).high <= 0) return negative;
    return make_.of(Kind::choose, {make_.sign(a), negative, a}, form);
  }

  int clamped(const Node& node, Form form) {
    const Interval from = range(node, 0), to = node.range;
    const int a = in(node, 0);
    int value = make_.cast(a, form);
    if (from.high > to.high) {
      const int end = make_.constant(to.high);
      value = make_.of(Kind::choose, {make_.of(Kind::less, {end, a}, {}), end, value}, form);
    }
    if (from.low < to.low) {
      const int end = make_.constant(to.low);
      value = make_.of(Kind::choose, {make_.of(Kind::less, {a, end}, {}), end, value}, form);
    }
    return value;
  }

  // Zeros above the leading one of a value in [.., high], its bits up to that of `high` brought to a power of
  // two: at the bottom, or at the top, there by an even number of places.
  struct Leading {
    int value, zeros, bits;  // steps and the bits of `value`
  };
  Leading leading_of(int a, int64_t high, bool at_top) {
    const int width = std::bit_width(static_cast<uint64_t>(high)), bits = width + width % 2;
    const int room = std::max(2, static_cast<int>(std::bit_ceil(static_cast<unsigned>(bits))));
    int value = make_.cast(a, {bits, false});
    if (at_top) value = make_.times_power(value, room - bits);
    value = make_.cast(value, {room, false});
    const int places = std::bit_width(static_cast<unsigned>(room)) - 1;
    return {value, make_.of(Kind::leading, {value}, {places, false}), room};
  }

  int leading(const Node& node, Form form) {
    const Interval from = range(node, 0);
    const Leading l = leading_of(in(node, 0), from.high, false);
    // bits - 1 - zeros: all bits of a number below a power of two turned round.
    const Form place = {make_.bits(l.zeros), false};
    const int msb = make_.of(Kind::exclusive, {l.zeros, make_.constant(l.bits - 1)}, place);
    if (from.low > 0) return make_.cast(msb, form);
    const int positive = make_.of(Kind::less, {make_.constant(0), in(node, 0)}, {});
    return make_.of(Kind::choose, {positive, msb, make_.constant(-1)}, form);
  }

  int aligned(const Node& node, Form form) {
    const Interval from = range(node, 0);
    const Leading l = leading_of(in(node, 0), from.high, true);
    int by = l.zeros;
    // By an even number: the leading one comes to the top or to the place below.
    if (node.width == 2) {
      by = make_.bits(by) == 1 ? make_.constant(0)
                               : make_.times_power(make_.slice(by, 1, {make_.bits(by) - 1, false}), 1);
    }
    const int top = make_.of(Kind::shift_left, {l.value, by}, {l.bits, false});
    const int down = l.bits - (node.shift + node.width);
    const int value =
        down >= 0 ? make_.slice(top, down, form) : make_.cast(make_.times_power(top, -down), form);
    if (from.low >= 0) return value;
    return make_.of(Kind::choose, {make_.sign(in(node, 0)), make_.constant(0), value}, form);
  }

  // a 2^(b - low) is exact, and 2^low a constant: rounding this is rounding a where b < 0, and changes
  // nothing elsewhere.
  int shifted(const Node& node, Form form) {
    const Interval by = range(node, 1);
    int value = in(node, 0);
    if (by.low < by.high) {
      const int more =
          make_.of(Kind::sub, {in(node, 1), make_.constant(by.low)}, form_of({0, by.high - by.low}));
      const Form wide{make_.bits(value) + static_cast<int>(by.high - by.low), make_.is_signed(value)};
      value = make_.of(Kind::shift_left, {value, more}, wide);
    }
    if (by.low < 0) return make_.rounded(value, static_cast<int>(-by.low), form);
    return make_.cast(make_.times_power(value, static_cast<int>(by.low)), form);
  }

  int checked(const Node& node, Form form) {
    const int a = in(node, 0), unfit = make_.unfit(a, node.width);
    const bool always = range(node, 1).low == 1;
    failed_.push_back({always ? unfit : make_.of(Kind::both, {in(node, 1), unfit}, {}),
                       make_.constant(static_cast<int64_t>(node.fault)), a, node.fault});
    return make_.cast(a, form);
  }

  // Of all faults the least; of equal ones that of the first node.
  void first_fault() {
    if (failed_.empty()) return;
    std::ranges::stable_sort(failed_, {}, &Failed::fault);
    while (failed_.size() > 1) {
      std::vector<Failed> half;
      for (size_t k = 0; k + 1 < failed_.size(); k += 2) half.push_back(sooner(failed_[k], failed_[k + 1]));
      if (failed_.size() % 2 == 1) half.push_back(failed_.back());
      failed_ = std::move(half);
    }
    all_.fault = failed_[0].is, all_.fault_code = failed_[0].code, all_.fault_number = failed_[0].number;
  }
  Failed sooner(const Failed& a, const Failed& b) {
    Failed first = a;
    first.is = make_.of(Kind::either, {a.is, b.is}, {});
    first.code = make_.chosen(a.is, a.code, b.code);
    first.number = make_.chosen(a.is, a.number, b.number);
    return first;
  }

  struct Address {
    int index, t;
  };
  Address uniform_address(const FixedTable& table, int r2) {
    const int below = 2 * table.difference_frac - table.index_bits;
    return {make_.slice(r2, below, {table.index_bits, false}),
            make_.slice(r2, below - table.fraction_bits, {table.fraction_bits, false})};
  }
  // The leading one goes to the top bit, so that index and t stand at fixed places below it.
  Address octave_address(const FixedTable& table, int r2, Interval range) {
    const Leading l = leading_of(r2, graph::domain_of(table).high, true);
    const int top = make_.of(Kind::shift_left, {l.value, l.zeros}, {l.bits, false});
    const int taken = table.bin_bits + table.fraction_bits, row_bits = table.index_bits - table.bin_bits;
    const int padded = make_.times_power(top, std::max(0, taken + 1 - l.bits));
    int all = make_.slice(padded, make_.bits(padded) - 1 - taken, {taken, false});
    if (row_bits > 0) {
      // The top bit of `value` is bit 2D - 1 of r2.
      const int row =
          make_.of(Kind::sub, {make_.constant(2 * table.difference_frac - 1 - table.first_octave), l.zeros},
                   {row_bits, false});
      all = make_.join(row, all);
    }
    const int64_t first = int64_t{1} << table.first_octave;
    int both = make_.cast(all, {table.index_bits + table.fraction_bits, false});
    if (range.low < first) {
      const int small =
          range.high < first ? make_.constant(1) : make_.of(Kind::less, {r2, make_.constant(first)}, {});
      both = make_.of(Kind::choose, {small, make_.constant(0), both}, {make_.bits(both), false});
    }
    return {make_.slice(both, table.fraction_bits, {table.index_bits, false}),
            make_.slice(both, 0, {table.fraction_bits, false})};
  }

  int lookup(const Node& node, Form form) {
    const FixedTable& table = graph_.tables[static_cast<size_t>(node.table)];
    Address address = table.shape == TableShape::uniform ? uniform_address(table, in(node, 0))
                                                         : octave_address(table, in(node, 0), range(node, 0));
    if (graph::laws_of(table) > 1) address.index = make_.join(in(node, 1), address.index);
    const EntryForm entry = entry_form(table);
    const int word = make_.rom(address.index, node.table, entry.bits());
    const int c0 = make_.slice(word, 0, {entry.c0, true}), c1 = make_.slice(word, entry.c0, {entry.c1, true});
    int slope = c1;
    if (table.degree == 2) {
      const int c2 = make_.slice(word, entry.c0 + entry.c1, {entry.c2, true});
      slope = rise(c2, address.t, table, c1, {std::max(entry.c1, entry.c2) + 1, true});
    }
    return rise(slope, address.t, table, c0, form);
  }
  // base + round_odd(slope t)
  int rise(int slope, int t, const FixedTable& table, int base, Form form) {
    const int product = make_.sum_of_products({{slope, t}}, {make_.bits(slope) + table.fraction_bits, true});
    return make_.rounded(product, table.fraction_bits, form, base);
  }

  // As Hash (model/base/hash.h) mixes the seed, the lesser id, the greater, and the third number.
  int noise(const Node& node, Form form) {
    const int a = in(node, 0), b = in(node, 1), a_first = less(node, 0, 1);
    int state = make_.word(Hash().add(node.number).value());
    for (const int next : {make_.chosen(a_first, a, b), make_.chosen(a_first, b, a), in(node, 2)})
      state = mixed(make_.of(Kind::exclusive, {state, next}, kWord));
    return make_.slice(state, 64 - node.width, form);
  }
  int mixed(int z) {
    z = make_.of(Kind::add, {z, make_.word(0x9e3779b97f4a7c15u)}, kWord);
    z = make_.sum_of_products({{folded(z, 30), make_.word(0xbf58476d1ce4e5b9u)}}, kWord);
    z = make_.sum_of_products({{folded(z, 27), make_.word(0x94d049bb133111ebu)}}, kWord);
    return folded(z, 31);
  }
  int folded(int z, int by) {
    return make_.of(Kind::exclusive, {z, make_.slice(z, by, {64 - by, false})}, kWord);
  }
  static constexpr Form kWord{64, false};

  const Graph& graph_;
  StepMaker make_;
  Steps all_;
  std::vector<Failed> failed_;
};

int signed_bits(const std::vector<int32_t>& entries) {
  int bits = 1;
  for (const int32_t c : entries) bits = std::max(bits, form_of({std::min(c, -1), std::max(c, 0)}).bits);
  return bits;
}

}  // namespace

Form form_of(Interval range) {
  const auto magnitude = [](int64_t v) { return std::bit_width(static_cast<uint64_t>(v < 0 ? ~v : v)); };
  if (range.low >= 0) return {std::max(1, static_cast<int>(magnitude(range.high))), false};
  return {1 + static_cast<int>(std::max(magnitude(range.low), magnitude(range.high))), true};
}

EntryForm entry_form(const FixedTable& table) {
  return {signed_bits(table.c0), signed_bits(table.c1), table.degree == 2 ? signed_bits(table.c2) : 0};
}

Steps steps_of(const Graph& graph, const std::vector<int>& outputs) {
  return GraphSteps(graph, outputs).take();
}

}  // namespace cuboct::pipeline
