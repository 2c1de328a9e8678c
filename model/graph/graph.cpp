// SPDX-License-Identifier: MIT
#include "model/graph/graph.h"

#include <fmt/format.h>

#include <algorithm>

#include "model/graph/interval.h"

namespace cuboct::graph {
namespace {

constexpr const char* kOps[] = {"constant", "input",  "add",    "sub",    "neg",  "shl", "round", "floor",
                                "mul",      "mac",    "dot",    "lookup", "lt",   "le",  "eq",    "both",
                                "either",   "negate", "select", "min",    "max",  "abs", "clamp", "within",
                                "msb",      "align",  "shift",  "check",  "noise"};
static_assert(std::size(kOps) == static_cast<size_t>(Op::noise) + 1);

constexpr const char* kSources[] = {"apart",     "own_x",        "own_v",          "other_v",
                                    "own_u",     "own_constant", "other_constant", "pair_constant",
                                    "own_field", "other_field",  "bond_field",     "bond_constant",
                                    "sum",       "own_id",       "other_id",       "step"};
static_assert(std::size(kSources) == static_cast<size_t>(Source::step) + 1);

bool below(Wide low, Wide high, int bits) {
  const Wide limit = Wide{1} << bits;
  return -limit < low && high < limit;
}

std::vector<Interval> ranges_of(const Graph& graph, const Node& node) {
  std::vector<Interval> ranges;
  for (const int k : node.inputs) ranges.push_back(graph.nodes[static_cast<size_t>(k)].range);
  return ranges;
}

// The products of a table: of an entry of 32 bits, or the sum of two, and T bits.
bool table_is_exact(const FixedTable& table) { return 32 + table.degree - 1 + table.fraction_bits <= 52; }

// Doubles add the products of a dot one after another: each sum on the way is exact too.
bool partial_sums_are_exact(const Node& node, const std::vector<Interval>& ranges) {
  const size_t count = node.inputs.size() / 2;
  for (size_t k = 1; k < count; ++k) {
    Node first{.op = Op::dot};
    std::vector<Interval> of_first;
    for (const size_t half : {size_t{0}, count})
      for (size_t n = half; n < half + k; ++n)
        first.inputs.push_back(node.inputs[n]), of_first.push_back(ranges[n]);
    const WideInterval sum = product_of(first, of_first);
    if (!below(sum.low, sum.high, 53)) return false;
  }
  return true;
}

bool is_exact(const Graph& graph, const Node& node) {
  if (node.op == Op::dot && !partial_sums_are_exact(node, ranges_of(graph, node))) return false;
  const WideInterval product = product_of(node, ranges_of(graph, node));
  if (node.op == Op::lookup && !table_is_exact(graph.tables[static_cast<size_t>(node.table)])) return false;
  return below(product.low, product.high, 52) && below(node.range.low, node.range.high, 51);
}

}  // namespace

const char* to_string(Op op) { return kOps[static_cast<size_t>(op)]; }
const char* to_string(Source source) { return kSources[static_cast<size_t>(source)]; }

bool Node::same_as(const Node& o) const {
  const bool ranged = op == Op::clamp || op == Op::within;
  return op == o.op && inputs == o.inputs && number == o.number && shift == o.shift && width == o.width &&
         table == o.table && fault == o.fault && source == o.source && index == o.index && axis == o.axis &&
         (!ranged || range == o.range);
}

std::string label(const Graph& graph, int node) {
  const Node& n = graph.nodes[static_cast<size_t>(node)];
  return n.name.empty() ? fmt::format("{} {}", to_string(n.op), node) : n.name;
}

std::vector<int> needed_by(const Graph& graph, const std::vector<int>& nodes) {
  std::vector<bool> needed(graph.nodes.size());
  for (const int n : nodes) needed[static_cast<size_t>(n)] = true;
  std::vector<int> all;
  for (size_t n = graph.nodes.size(); n-- > 0;) {
    if (!needed[n]) continue;
    all.push_back(static_cast<int>(n));
    for (const int input : graph.nodes[n].inputs) needed[static_cast<size_t>(input)] = true;
  }
  std::reverse(all.begin(), all.end());
  return all;
}

Exactness exactness_of(const Graph& graph) {
  for (size_t n = 0; n < graph.nodes.size(); ++n)
    if (!is_exact(graph, graph.nodes[n])) return {false, static_cast<int>(n)};
  return {};
}

}  // namespace cuboct::graph
