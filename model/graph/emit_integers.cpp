// SPDX-License-Identifier: MIT
#include "model/graph/emit_integers.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "model/graph/interval.h"

namespace cuboct::graph {
namespace {

constexpr int64_t kLeast32 = std::numeric_limits<int32_t>::min(),
                  kMost32 = std::numeric_limits<int32_t>::max();

bool fits_32(WideInterval range) { return range.low >= kLeast32 && range.high <= kMost32; }
Wide largest_of(Interval range) { return std::max(-Wide{range.low}, Wide{range.high}); }
bool is_narrow(const Node& node) { return fits_32({node.range.low, node.range.high}); }

// An expression, with what its type holds.
struct TypedText {
  std::string text;
  bool narrow;  // int32_t, else int64_t
};

TypedText widened(const TypedText& of) {
  return {of.narrow ? fmt::format("int64_t{{{}}}", of.text) : of.text, false};
}

// One node's expression.
class Expression {
 public:
  Expression(const Graph& graph, const Node& node, const Outside& outside, bool all_count)
      : graph_(graph), node_(node), outside_(outside), all_count_(all_count), narrow_(is_narrow(node)) {
    for (const int n : node.inputs) {
      ranges_.push_back(in(n).range);
      inputs_.push_back({value_text(graph, n), is_narrow(in(n))});
    }
  }

  std::string text() const {
    const std::string a = inputs_.empty() ? std::string() : inputs_[0].text;
    switch (node_.op) {
      case Op::constant:
        return value_of(node_.number);
      case Op::input:
        return outside_.input(node_);
      case Op::add:
        return sum("+", inputs_[0], inputs_[1]);
      case Op::sub:
        return sum("-", inputs_[0], inputs_[1]);
      case Op::neg:
        return "-" + as_result(0);
      case Op::shl:
        return fmt::format("{} << {}", as_result(0), node_.shift);
      case Op::round:
        return rounded(inputs_[0], {ranges_[0].low, ranges_[0].high}).text;
      case Op::floor:
        return fmt::format("{} >> {}", a, node_.shift);
      case Op::mul:
      case Op::dot:
        return rounded(products(0), product_of(node_, ranges_)).text;
      case Op::mac:
        return sum("+", inputs_[0], rounded(products(1), product_of(node_, ranges_)));
      case Op::lookup:
        return lookup();
      case Op::lt:
        return fmt::format("{} < {}", a, inputs_[1].text);
      case Op::le:
        return fmt::format("{} <= {}", a, inputs_[1].text);
      case Op::eq:
        return fmt::format("{} == {}", a, inputs_[1].text);
      case Op::both:
        return fmt::format("{} & {}", a, inputs_[1].text);
      case Op::either:
        return fmt::format("{} | {}", a, inputs_[1].text);
      case Op::negate:
        return fmt::format("1 - {}", a);
      case Op::select:
        return fmt::format("{} ? {} : {}", a, inputs_[1].text, inputs_[2].text);
      case Op::min:
        return fmt::format("{0} < {1} ? {0} : {1}", a, inputs_[1].text);
      case Op::max:
        return fmt::format("{0} < {1} ? {1} : {0}", a, inputs_[1].text);
      case Op::abs:
        return fmt::format("{0} < 0 ? -{1} : {0}", a, as_result(0));
      case Op::clamp:
        return clamped();
      case Op::within:
        return all_count_ ? a : clamped();
      case Op::msb:
        return fmt::format("graph::leading_of({})", a);
      case Op::align:
        return fmt::format("graph::aligned_of({}, {}, {})", a, node_.shift, node_.width);
      case Op::shift:
        return fmt::format("graph::shifted_of({}, {})", a, inputs_[1].text);
      case Op::check:
        return fmt::format("wrap({}, {})", a, node_.width);
      case Op::noise:
        return fmt::format("graph::mixed_of({}, {}, {}, {}, {})", value_of(node_.number), a, inputs_[1].text,
                           inputs_[2].text, node_.width);
    }
    return {};
  }

  static std::string value_of(int64_t number) {
    return number < 0 ? fmt::format("({})", number) : fmt::format("{}", number);
  }

 private:
  const Node& in(int n) const { return graph_.nodes[static_cast<size_t>(n)]; }
  // An input, as wide as the result.
  std::string as_result(size_t k) const { return narrow_ ? inputs_[k].text : widened(inputs_[k]).text; }

  // Nothing overflows on the way: a sum of two of 32 bits is taken in 32 where it fits them.
  std::string sum(const char* op, const TypedText& a, const TypedText& b) const {
    return fmt::format("{} {} {}", narrow_ ? a.text : widened(a).text, op, b.text);
  }

  // Of the inputs from `first` on: the first half times the second.
  TypedText products(size_t first) const {
    const size_t n = (inputs_.size() - first) / 2;
    Wide largest = 0;  // of any sum of some of the products
    bool narrow = true;
    for (size_t k = first; k < first + n; ++k) {
      largest += largest_of(ranges_[k]) * largest_of(ranges_[k + n]);
      narrow = narrow && inputs_[k].narrow && inputs_[k + n].narrow;
    }
    narrow = narrow && largest <= kMost32;
    std::string all;
    for (size_t k = first; k < first + n; ++k) {
      const TypedText &a = inputs_[k], &b = inputs_[k + n];
      if (!all.empty()) all += " + ";
      if (!narrow && a.narrow && b.narrow)
        all += fmt::format("product({}, {})", a.text, b.text);
      else
        all += fmt::format("{} * {}", narrow ? a.text : widened(a).text, b.text);
    }
    return {n > 1 ? "(" + all + ")" : all, narrow};
  }

  // Of a value in `range`, by the node's shift.
  TypedText rounded(const TypedText& of, WideInterval range) const {
    const int s = node_.shift;
    if (s == 0) return of;
    const Wide half = Wide{1} << (s - 1);
    const bool narrow = of.narrow && fits_32({range.low - 1, range.high + half}) && s < 32;
    const TypedText wide = narrow ? of : widened(of);
    if (range.low >= 0)
      return {fmt::format("(({} + {}) >> {})", wide.text, value_of(static_cast<int64_t>(half)), s), narrow};
    return {fmt::format("{}({}, {})", narrow ? "graph::round_odd_32" : "round_odd", wide.text, s), narrow};
  }

  // The ends that the input may pass.
  std::string clamped() const {
    const std::string& a = inputs_[0].text;
    std::string text = a;
    if (ranges_[0].high > node_.range.high)
      text =
          fmt::format("{} > {} ? {} : {}", a, value_of(node_.range.high), value_of(node_.range.high), text);
    if (ranges_[0].low < node_.range.low)
      text = fmt::format("{} < {} ? {} : {}", a, value_of(node_.range.low), value_of(node_.range.low), text);
    return text;
  }

  std::string lookup() const {
    // What is not negative is widened by zeros, which a compiler may narrow again.
    const std::string& a = inputs_[0].text;
    const std::string argument = inputs_[0].narrow ? fmt::format("uint64_t{{static_cast<uint32_t>({})}}", a)
                                                   : fmt::format("static_cast<uint64_t>({})", a);
    return outside_.lookup(node_, argument, inputs_[1].text);
  }

  const Graph& graph_;
  const Node& node_;
  const Outside& outside_;
  bool all_count_, narrow_;
  std::vector<Interval> ranges_;
  std::vector<TypedText> inputs_;
};

}  // namespace

const char* type_text(const Node& node) { return is_narrow(node) ? "int32_t" : "int64_t"; }

std::string value_text(const Graph& graph, int node) {
  const Node& of = graph.nodes[static_cast<size_t>(node)];
  return of.op == Op::constant ? Expression::value_of(of.number) : fmt::format("n{}", node);
}

std::string statements(const Graph& graph, const std::vector<int>& nodes, const Outside& outside,
                       bool all_count) {
  std::string text;
  for (const int n : nodes) {
    const Node& node = graph.nodes[static_cast<size_t>(n)];
    if (node.op == Op::constant) continue;
    text += fmt::format("const {0} n{1} = static_cast<{0}>({2});\n", type_text(node), n,
                        Expression(graph, node, outside, all_count).text());
    if (node.op == Op::check)
      text += fmt::format("fits = fits && ({} == 0 || n{} == {});\n", value_text(graph, node.inputs[1]), n,
                          value_text(graph, node.inputs[0]));
  }
  return text;
}

}  // namespace cuboct::graph
