// SPDX-License-Identifier: MIT
#include "model/graph/builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "model/base/fixed_math.h"

namespace cuboct::graph {
namespace {

constexpr int kMostShift = 62;
constexpr Wide kLeast = std::numeric_limits<int64_t>::min(), kMost = std::numeric_limits<int64_t>::max();

std::string text(Wide v) {
  if (v < 0) return "-" + text(-v);
  const auto digit = static_cast<char>('0' + static_cast<int>(v % 10));
  return (v >= 10 ? text(v / 10) : std::string()) + digit;
}

bool commutes(Op op) {
  return op == Op::add || op == Op::mul || op == Op::eq || op == Op::both || op == Op::either ||
         op == Op::min || op == Op::max || op == Op::noise;
}

// Factors of a sum of products in one order.
void sort_products(std::vector<int>& inputs) {
  const size_t n = inputs.size() / 2;
  std::vector<std::pair<int, int>> products;
  for (size_t k = 0; k < n; ++k) products.push_back(std::minmax(inputs[k], inputs[n + k]));
  std::sort(products.begin(), products.end());
  for (size_t k = 0; k < n; ++k) inputs[k] = products[k].first, inputs[n + k] = products[k].second;
}

void sort_inputs(Node& node) {
  auto& in = node.inputs;
  if (commutes(node.op) && in[0] > in[1]) std::swap(in[0], in[1]);
  if (node.op == Op::mac && in[1] > in[2]) std::swap(in[1], in[2]);
  if (node.op == Op::dot) sort_products(in);
}

int frac_of(const Node& node, const std::vector<Node>& nodes, const std::vector<FixedTable>& tables) {
  const auto of = [&](size_t k) { return nodes[static_cast<size_t>(node.inputs[k])].frac; };
  switch (node.op) {
    case Op::constant:
    case Op::input:
      return node.frac;
    case Op::shl:
      return of(0) + node.shift;
    case Op::round:
    case Op::floor:
      return of(0) - node.shift;
    case Op::mul:
      return of(0) + of(1) - node.shift;
    case Op::dot:
      return of(0) + of(node.inputs.size() / 2) - node.shift;
    case Op::lookup:
      return tables[static_cast<size_t>(node.table)].value_frac;
    case Op::select:
      return of(1);
    case Op::lt:
    case Op::le:
    case Op::eq:
    case Op::both:
    case Op::either:
    case Op::negate:
    case Op::msb:
      return 0;
    case Op::noise:
      return node.width - 1;
    default:
      return of(0);
  }
}

}  // namespace

Node Builder::made(Op op, std::vector<int> inputs, int shift, int width) const {
  for (const int input : inputs)
    if (input < 0 || input >= static_cast<int>(graph_.nodes.size()))
      throw std::logic_error(fmt::format("{} of a node that is not there", to_string(op)));
  if (shift < 0 || shift > kMostShift)
    throw std::logic_error(fmt::format("{}: a shift by {}", to_string(op), shift));
  return {.op = op, .inputs = std::move(inputs), .shift = shift, .width = width};
}

std::vector<Interval> Builder::ranges(const Node& node) const {
  std::vector<Interval> ranges;
  for (const int input : node.inputs) ranges.push_back(range(input));
  return ranges;
}

void Builder::refuse(const Node& node, WideInterval range, const char* room) const {
  std::string of;
  for (const int input : node.inputs)
    of += fmt::format("{}'{}'", of.empty() ? "" : ", ", label(graph_, input));
  throw InputError(fmt::format("{} of {} reaches from {} to {}: {}", to_string(node.op), of, text(range.low),
                               text(range.high), room));
}

// What is rounded fits 64 bits together with half a unit; so does each partial sum.
void Builder::check_product(const Node& node) const {
  const WideInterval product = product_of(node, ranges(node));
  const Wide half = node.shift > 0 ? Wide{1} << (node.shift - 1) : 0;
  bool fits = product.low >= kLeast && product.high + half <= kMost;
  if (node.op == Op::dot) {
    Wide size = half;
    const size_t n = node.inputs.size() / 2;
    for (size_t k = 0; k < n; ++k) {
      const WideInterval one = product_of(made(Op::mul, {node.inputs[k], node.inputs[n + k]}),
                                          {range(node.inputs[k]), range(node.inputs[n + k])});
      size += std::max(-one.low, one.high);
    }
    fits = size <= kMost;
  }
  if (!fits) refuse(node, product, "before its rounding a product has 64 bits");
}

int Builder::same_as_earlier(const Node& node) const {
  const auto same = [&](const Node& earlier) { return earlier.same_as(node); };
  const auto found = std::find_if(graph_.nodes.begin(), graph_.nodes.end(), same);
  return found == graph_.nodes.end() ? -1 : static_cast<int>(found - graph_.nodes.begin());
}

int Builder::added(Node node) {
  sort_inputs(node);
  check_product(node);
  const FixedTable* table = node.op == Op::lookup ? &graph_.tables[static_cast<size_t>(node.table)] : nullptr;
  const WideInterval range = range_of(node, ranges(node), table);
  if (range.low < kWidest.low || range.high > kWidest.high) refuse(node, range, "a value has 63 bits");
  const bool ranged = node.op == Op::clamp || node.op == Op::within;
  const Interval proven{static_cast<int64_t>(range.low), static_cast<int64_t>(range.high)};
  node.frac = frac_of(node, graph_.nodes, graph_.tables);
  if (proven.low == proven.high && node.op != Op::constant && node.op != Op::check)
    return constant(proven.low, node.frac);
  if (ranged && proven == this->range(node.inputs[0])) return node.inputs[0];
  node.range = proven;
  const int earlier = same_as_earlier(node);
  if (earlier >= 0) return earlier;
  graph_.nodes.push_back(std::move(node));
  return static_cast<int>(graph_.nodes.size()) - 1;
}

void Builder::need_truth(int node) const {
  if (range(node).low < 0 || range(node).high > 1)
    throw std::logic_error(fmt::format("'{}' is no truth", label(graph_, node)));
}

int Builder::constant(int64_t number, int frac) {
  return added({.op = Op::constant, .number = number, .frac = frac});
}

int Builder::input(Source source, int index, int axis, Interval range, int frac, bool symmetric,
                   bool opposite) {
  return added({.op = Op::input,
                .source = source,
                .index = index,
                .axis = axis,
                .symmetric = symmetric,
                .opposite = opposite,
                .range = range,
                .frac = frac});
}

int Builder::add(int a, int b) {
  if (is(a, 0)) return b;
  return is(b, 0) ? a : added(made(Op::add, {a, b}));
}

int Builder::sub(int a, int b) { return is(b, 0) ? a : a == b ? constant(0) : added(made(Op::sub, {a, b})); }
int Builder::neg(int a) { return at(a).op == Op::neg ? at(a).inputs[0] : added(made(Op::neg, {a})); }
int Builder::shl(int a, int shift) { return shift == 0 ? a : added(made(Op::shl, {a}, shift)); }
int Builder::round(int a, int shift) { return shift == 0 ? a : added(made(Op::round, {a}, shift)); }
int Builder::floor(int a, int shift) { return shift == 0 ? a : added(made(Op::floor, {a}, shift)); }

int Builder::mul(int a, int b, int shift) {
  if (is(b, int64_t{1} << shift)) return a;
  return is(a, int64_t{1} << shift) ? b : added(made(Op::mul, {a, b}, shift));
}

int Builder::mac(int a, int b, int c, int shift) { return added(made(Op::mac, {a, b, c}, shift)); }

int Builder::dot(const std::vector<int>& a, const std::vector<int>& b, int shift) {
  if (a.size() != b.size() || a.empty()) throw std::logic_error("dot of vectors of different lengths");
  std::vector<int> inputs = a;
  inputs.insert(inputs.end(), b.begin(), b.end());
  return added(made(Op::dot, std::move(inputs), shift));
}

int Builder::table(const FixedTable& table) {
  if (const auto at = std::ranges::find(graph_.tables, table); at != graph_.tables.end())
    return static_cast<int>(at - graph_.tables.begin());
  graph_.tables.push_back(table);
  return static_cast<int>(graph_.tables.size()) - 1;
}

int Builder::lookup(int table, int argument, int law) {
  const FixedTable& of = graph_.tables.at(static_cast<size_t>(table));
  Node node = made(Op::lookup, {argument, law < 0 ? constant(0) : law});
  node.table = table;
  const Interval domain = domain_of(of), laws = {0, laws_of(of) - 1};
  const auto inside = [](Interval a, Interval b) { return b.holds(a.low) && b.holds(a.high); };
  if (!inside(range(argument), domain) || !inside(range(node.inputs[1]), laws))
    throw std::logic_error(fmt::format("'{}' reaches beyond table {}", label(graph_, argument), table));
  return added(std::move(node));
}

int Builder::lt(int a, int b) { return added(made(Op::lt, {a, b})); }
int Builder::le(int a, int b) { return added(made(Op::le, {a, b})); }
int Builder::eq(int a, int b) { return a == b ? constant(1) : added(made(Op::eq, {a, b})); }

int Builder::chosen(Op op, int a, int b) {
  need_truth(a), need_truth(b);
  const int64_t neutral = op == Op::both ? 1 : 0;
  if (is(a, neutral) || a == b) return b;
  return is(b, neutral) ? a : added(made(op, {a, b}));
}

int Builder::both(int a, int b) { return chosen(Op::both, a, b); }
int Builder::either(int a, int b) { return chosen(Op::either, a, b); }

int Builder::negate(int a) {
  need_truth(a);
  return at(a).op == Op::negate ? at(a).inputs[0] : added(made(Op::negate, {a}));
}

int Builder::select(int truth, int a, int b) {
  need_truth(truth);
  if (is(truth, 1) || a == b) return a;
  return is(truth, 0) ? b : added(made(Op::select, {truth, a, b}));
}

int Builder::min(int a, int b) { return a == b ? a : added(made(Op::min, {a, b})); }
int Builder::max(int a, int b) { return a == b ? a : added(made(Op::max, {a, b})); }
int Builder::abs(int a) { return range(a).low >= 0 ? a : added(made(Op::abs, {a})); }

int Builder::clamp(int a, Interval range) {
  Node node = made(Op::clamp, {a});
  node.range = range;
  return added(std::move(node));
}

int Builder::msb(int a) { return added(made(Op::msb, {a})); }

int Builder::align(int a, int place, int step) {
  if (step < 1 || step > 2) throw std::logic_error("align: in steps of one bit or two");
  return added(made(Op::align, {a}, place, step));
}

int Builder::shift(int a, int by) {
  if (range(by).low < -kMostShift || range(by).high > kMostShift)
    throw std::logic_error(fmt::format("'{}' shifts by more than {}", label(graph_, by), kMostShift));
  return added(made(Op::shift, {a, by}));
}

int Builder::check(int a, int width, Fault fault, int when) {
  if (when >= 0) need_truth(when);
  if (width < 1 || width > 63) throw std::logic_error("check: a width of 1 to 63 bits");
  if (fits(range(a).low, width) && fits(range(a).high, width)) return a;
  Node node = made(Op::check, {a, when < 0 ? constant(1) : when}, 0, width);
  node.fault = fault;
  return added(std::move(node));
}

int Builder::noise(int a, int b, int c, int64_t seed, int width) {
  if (width < 1 || width > 63) throw std::logic_error("noise: a width of 1 to 63 bits");
  Node node = made(Op::noise, {a, b, c}, 0, width);
  node.number = seed;
  return added(std::move(node));
}

int Builder::named(int node, const std::string& name) {
  std::string& own = graph_.nodes[static_cast<size_t>(node)].name;
  if (own.empty()) own = name;
  return node;
}

}  // namespace cuboct::graph
