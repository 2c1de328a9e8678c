// SPDX-License-Identifier: MIT
#include "model/program/real_graph.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace cuboct {
namespace {

constexpr double kMostFactors = 12;  // of a power that is made of products

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

NodeId RealGraph::curve(const CubicTable& table, NodeId a, bool of_slope) {
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

bool RealGraph::reads(RealSource source) const {
  return std::ranges::any_of(
      nodes_, [&](const RealNode& node) { return node.op == RealOp::input && node.input.source == source; });
}

}  // namespace cuboct
