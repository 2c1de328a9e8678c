// SPDX-License-Identifier: MIT
#include "emu/lattice/code/graph_text.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "emu/lattice/code/code_table.h"
#include "emu/lattice/kernel_rule.h"

namespace cuboct::emu {
namespace {

using graph::Node;
using graph::Op;

bool is_truth(const Node& node) {
  switch (node.op) {
    case Op::lt:
    case Op::le:
    case Op::eq:
    case Op::both:
    case Op::either:
    case Op::negate:
      return true;
    default:
      return false;
  }
}

}  // namespace

std::string CodeConstants::operator()(double value) {
  values_.push_back(value);
  return fmt::format("splat(K[{}])", values_.size() - 1);
}

std::string CodeConstants::seed(int64_t value) {
  seeds_.push_back(value);
  return fmt::format("job.numbers.seeds[{}]", seeds_.size() - 1);
}

std::string GraphText::statements(const std::vector<int>& nodes, bool late, const std::string& indent) const {
  std::string text;
  for (const int n : nodes) {
    const Node& node = at(n);
    if (is_truth(node))
      text += fmt::format("{}const W w{} = {};\n", indent, n, truth_text(node));
    else
      text += fmt::format("{}const V v{} = {};\n", indent, n, value_text(node, late));
  }
  return text;
}

std::string GraphText::value(int n) const {
  return is_truth(at(n)) ? fmt::format("value_of(w{})", n) : fmt::format("v{}", n);
}

std::string GraphText::truth(int n) const {
  return is_truth(at(n)) ? fmt::format("w{}", n) : fmt::format("truth_of(v{})", n);
}

GraphText::Unsigned GraphText::without_sign(int node) const {
  double sign = 1;
  for (; at(node).op == Op::neg; node = at(node).inputs[0]) sign = -sign;
  return {node, sign};
}

GraphText::Term GraphText::term(int node) const {
  const auto [n, sign] = without_sign(node);
  const Node& of = at(n);
  Term term{.rounds = of.shift > 0, .sign = sign, .product = {}, .factor = {}};
  if (term.rounds && of.op == Op::mul)
    term.product = fmt::format("{} * {}", value(of.inputs[0]), value(of.inputs[1]));
  else if (term.rounds && of.op == Op::round)
    term.product = value(of.inputs[0]);
  else
    return {.rounds = false, .sign = sign, .product = value(n), .factor = {}};
  term.factor = constant_(sign * rounding_factor(of.shift));
  return term;
}

std::vector<int> GraphText::needed_by_terms(const std::vector<int>& terms,
                                            const std::vector<int>& others) const {
  std::vector<int> roots = others;
  for (const int node : terms) {
    const int n = without_sign(node).node;
    const Node& of = at(n);
    if (of.shift > 0 && (of.op == Op::mul || of.op == Op::round))
      roots.insert(roots.end(), of.inputs.begin(), of.inputs.end());
    else
      roots.push_back(n);
  }
  return needed_by(graph_, roots);
}

std::string GraphText::truth_text(const Node& node) const {
  const auto in = [&](size_t k) { return node.inputs[k]; };
  switch (node.op) {
    case Op::lt:
      return fmt::format("{} < {}", value(in(0)), value(in(1)));
    case Op::le:
      return fmt::format("{} <= {}", value(in(0)), value(in(1)));
    case Op::eq:
      return fmt::format("{} == {}", value(in(0)), value(in(1)));
    case Op::both:
      return fmt::format("{} & {}", truth(in(0)), truth(in(1)));
    case Op::either:
      return fmt::format("{} | {}", truth(in(0)), truth(in(1)));
    default:
      return fmt::format("~{}", truth(in(0)));
  }
}

std::string GraphText::rounded(const std::string& value, int shift) const {
  if (shift == 0) return value;
  return fmt::format("rounded({}, {})", value, constant_(rounding_factor(shift)));
}

// Products and their sums are whole numbers that doubles hold, so a fused multiply-add changes none.
std::string GraphText::dot(const Node& node) const {
  const size_t count = node.inputs.size() / 2;
  std::string sum = fmt::format("{} * {}", value(node.inputs[0]), value(node.inputs[count]));
  for (size_t k = 1; k < count; ++k)
    sum = fmt::format("fused({}, {}, {})", value(node.inputs[k]), value(node.inputs[count + k]), sum);
  return rounded(sum, node.shift);
}

std::string GraphText::lookup(const Node& node) const {
  const FixedTable& table = graph_.tables[static_cast<size_t>(node.table)];
  const Node& law = at(node.inputs[1]);
  const std::string name = fmt::format("T[{}]", outside_.first_table + static_cast<size_t>(node.table));
  const bool one_law = law.op == Op::constant && law.number == 0;
  return fmt::format("lookup<{}, {}, {}>({}, {}, {})", table.shape == TableShape::octaves, table.degree,
                     is_packed(table), name, value(node.inputs[0]),
                     one_law ? "W{}" : fmt::format("law_of({}, {})", value(node.inputs[1]), name));
}

std::string GraphText::check(const Node& node) const {
  const Node& when = at(node.inputs[1]);
  const bool always = when.op == Op::constant && when.number != 0;
  return fmt::format("checked<{}>({}, {}, {}{}, bad)", outside_.both_signs, value(node.inputs[0]),
                     constant_(-std::ldexp(1.0, node.width - 1)), outside_.counts,
                     always ? "" : " & " + truth(node.inputs[1]));
}

std::string GraphText::value_text(const Node& node, bool late) const {
  const auto in = [&](size_t k) { return value(node.inputs[k]); };
  const auto range = [&](const std::string& a) {
    return fmt::format("least(most({}, {}), {})", a, constant_(static_cast<double>(node.range.low)),
                       constant_(static_cast<double>(node.range.high)));
  };
  switch (node.op) {
    case Op::constant:
      return constant_(static_cast<double>(node.number));
    case Op::input:
      return outside_.input(node);
    case Op::add:
      return fmt::format("{} + {}", in(0), in(1));
    case Op::sub:
      return fmt::format("{} - {}", in(0), in(1));
    case Op::neg:
      return fmt::format("V{{}} - {}", in(0));
    case Op::shl:
      return fmt::format("{} * {}", in(0), constant_(std::ldexp(1.0, node.shift)));
    case Op::round:
      return rounded(in(0), node.shift);
    case Op::floor:
      return fmt::format("floor_of({} * {})", in(0), constant_(std::ldexp(1.0, -node.shift)));
    case Op::mul:
      return rounded(fmt::format("{} * {}", in(0), in(1)), node.shift);
    case Op::mac:
      if (node.shift == 0) return fmt::format("fused({}, {}, {})", in(1), in(2), in(0));
      return fmt::format("fused({} * {}, {}, {} + splat(kMagic)) - splat(kMagic)", in(1), in(2),
                         constant_(rounding_factor(node.shift)), in(0));
    case Op::dot:
      return dot(node);
    case Op::lookup:
      return lookup(node);
    case Op::select:
      return fmt::format("select({}, {}, {})", truth(node.inputs[0]), in(1), in(2));
    case Op::min:
      return fmt::format("least({}, {})", in(0), in(1));
    case Op::max:
      return fmt::format("most({}, {})", in(0), in(1));
    case Op::abs:
      return fmt::format("magnitude({})", in(0));
    case Op::clamp:
      return range(in(0));
    case Op::within:
      return late ? in(0) : range(in(0));
    case Op::msb:
      return fmt::format("leading({})", in(0));
    case Op::align:
      return fmt::format("aligned({}, {}, {})", in(0), node.shift, node.width);
    case Op::shift:
      return fmt::format("shifted({}, {})", in(0), in(1));
    case Op::check:
      return check(node);
    case Op::noise:
      return fmt::format("noise({}, {}, {}, {}, {})", constant_.seed(node.number), in(0), in(1), in(2),
                         node.width);
    default:
      throw std::logic_error("a truth is no number");
  }
}

}  // namespace cuboct::emu
