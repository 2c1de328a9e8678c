// SPDX-License-Identifier: MIT
#include "model/program/real_graph.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace cuboct {
namespace {

constexpr double kMostFactors = 12;  // of a power that is made of products
constexpr size_t kMostAddends = 32;

void add_parts(const RealGraph& graph, Addend part, std::vector<Addend>& to) {
  const RealNode& node = graph.at(part.node);
  const bool sum = node.op == RealOp::add || node.op == RealOp::subtract;
  if (to.size() > kMostAddends || (!sum && node.op != RealOp::negate)) return to.push_back(part);
  if (!sum) return add_parts(graph, {node.of[0], !part.minus}, to);
  add_parts(graph, {node.of[0], part.minus}, to);
  add_parts(graph, {node.of[1], part.minus != (node.op == RealOp::subtract)}, to);
}

}  // namespace

int arity(RealOp op) {
  switch (op) {
    case RealOp::constant:
    case RealOp::input:
      return 0;
    case RealOp::negate:
    case RealOp::square_root:
    case RealOp::exponential:
    case RealOp::logarithm:
    case RealOp::sine:
    case RealOp::cosine:
    case RealOp::error_function:
    case RealOp::absolute:
    case RealOp::inverse:
    case RealOp::curve:
    case RealOp::curve_slope:
      return 1;
    case RealOp::select:
      return 3;
    default:
      return 2;
  }
}

NodeId RealGraph::keep(const RealNode& node) {
  const auto [at, fresh] =
      known_.try_emplace({node.op, node.of, std::bit_cast<uint64_t>(node.value), node.input, node.table},
                         static_cast<NodeId>(nodes_.size()));
  if (fresh) nodes_.push_back(node);
  return at->second;
}

NodeId RealGraph::constant(double value) { return keep({RealOp::constant, {}, value, {}, nullptr}); }

NodeId RealGraph::input(RealSource source, uint32_t index) {
  return keep({RealOp::input, {}, 0, {source, index}, nullptr});
}

NodeId RealGraph::add(RealOp op, NodeId a, NodeId b, NodeId c) {
  const std::array<NodeId, 3> of{a, b, c};
  const auto used = static_cast<size_t>(arity(op));
  const auto is_constant = [&](size_t k) { return nodes_[of[k]].op == RealOp::constant; };
  bool all = true;
  for (size_t k = 0; k < used; ++k) all = all && is_constant(k);
  const auto value = [&](size_t k) { return k < used ? nodes_[of[k]].value : 0; };
  if (all) return constant(applied(op, value(0), value(1), value(2)));
  if (op == RealOp::select && is_constant(0)) return value(0) != 0 ? b : c;
  if (op == RealOp::power && is_constant(1)) {
    if (value(1) == 0.5) return add(RealOp::square_root, a);
    if (std::abs(value(1)) <= kMostFactors && value(1) == std::round(value(1)) && value(1) != 0)
      return whole_power(a, static_cast<int>(value(1)));
  }
  return keep({op, of, 0, {}, nullptr});
}

NodeId RealGraph::curve(const TableCurve& table, NodeId a, bool of_slope) {
  const RealNode node{of_slope ? RealOp::curve_slope : RealOp::curve, {a, 0, 0}, 0, {}, &table};
  const RealNode& of = nodes_[a];
  return of.op == RealOp::constant ? constant(applied(node, of.value, 0, 0)) : keep(node);
}

NodeId RealGraph::whole_power(NodeId a, int exponent) {
  if (exponent < 0) return add(RealOp::divide, constant(1), whole_power(a, -exponent));
  if (exponent == 1) return a;
  const NodeId half = whole_power(a, exponent / 2), square = add(RealOp::multiply, half, half);
  return exponent % 2 == 0 ? square : add(RealOp::multiply, square, a);
}

std::vector<Addend> addends_of(const RealGraph& graph, NodeId id) {
  std::vector<Addend> parts;
  add_parts(graph, {id, false}, parts);
  return parts.size() > kMostAddends ? std::vector<Addend>{{id, false}} : parts;
}

bool RealGraph::reads(RealSource source) const {
  return std::ranges::any_of(
      nodes_, [&](const RealNode& node) { return node.op == RealOp::input && node.input.source == source; });
}

}  // namespace cuboct
