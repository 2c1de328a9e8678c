// SPDX-License-Identifier: MIT
#include "model/program/tape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "model/program/real_block.h"

namespace cuboct {
namespace {

constexpr size_t kLanes = 8;
using Lanes = std::array<double, kLanes>;

// A value, and its slope.
struct Slope {
  double at = 0, by = 0;
};

// By the chain rule. Truths are flat.
Slope sloped(const RealNode& node, const Slope& a, const Slope& b, const Slope& c) {
  const double at = applied(node, a.at, b.at, c.at);
  // What does not move there has no slope, however steep the operation: sqrt(max(0, ...)).
  if (a.by == 0 && (node.op == RealOp::square_root || node.op == RealOp::power)) return {at, 0};
  switch (node.op) {
    case RealOp::add:
      return {at, a.by + b.by};
    case RealOp::subtract:
      return {at, a.by - b.by};
    case RealOp::multiply:
      return {at, a.by * b.at + a.at * b.by};
    case RealOp::divide:
      return {at, (a.by - at * b.by) / b.at};
    case RealOp::negate:
      return {at, -a.by};
    case RealOp::square_root:
      return {at, a.by / (2 * at)};
    case RealOp::exponential:
      return {at, at * a.by};
    case RealOp::logarithm:
      return {at, a.by / a.at};
    case RealOp::sine:
      return {at, std::cos(a.at) * a.by};
    case RealOp::cosine:
      return {at, -std::sin(a.at) * a.by};
    case RealOp::error_function:
      return {at, -2 * std::numbers::inv_sqrtpi * std::exp(-a.at * a.at) * a.by};
    case RealOp::power:  // the exponent is a constant
      return {at, b.at * std::pow(a.at, b.at - 1) * a.by};
    case RealOp::absolute:
      return {at, a.at < 0 ? -a.by : a.by};
    case RealOp::least:
      return {at, a.at <= b.at ? a.by : b.by};
    case RealOp::most:
      return {at, a.at >= b.at ? a.by : b.by};
    case RealOp::select:
      return {at, a.at != 0 ? b.by : c.by};
    case RealOp::curve:
      return {at, node.table->slope(a.at) * a.by};
    case RealOp::curve_slope: {
      const double h = 1e-5 * (node.table->end() - node.table->begin());
      return {at, (node.table->slope(a.at + h) - node.table->slope(a.at - h)) / (2 * h) * a.by};
    }
    default:
      return {at, 0};
  }
}

bool is_r(const RealNode& node) { return node.input == RealInput{RealSource::difference, 0}; }

}  // namespace

Tape::Tape(const RealGraph& graph, NodeId root) {
  std::vector<char> needed(root + 1, 0);
  needed[root] = 1;
  for (NodeId id = root + 1; id-- > 0;)
    for (int k = 0; needed[id] != 0 && k < arity(graph.at(id).op); ++k) needed[graph.at(id).of[k]] = 1;
  std::vector<NodeId> place(root + 1, 0);
  for (NodeId id = 0; id <= root; ++id) {
    if (needed[id] == 0) continue;
    place[id] = static_cast<NodeId>(nodes_.size());
    nodes_.push_back(graph.at(id));
    for (NodeId& of : nodes_.back().of) of = of <= root ? place[of] : 0;
  }
}

void Tape::run(std::span<const double> r, std::span<double> value) const {
  thread_local std::vector<Lanes> lanes;
  lanes.resize(std::max(lanes.size(), nodes_.size()));
  for (size_t first = 0; first < r.size(); first += kLanes) {
    const size_t count = std::min(kLanes, r.size() - first);
    for (size_t k = 0; k < nodes_.size(); ++k) {
      const RealNode& node = nodes_[k];
      Lanes& to = lanes[k];
      if (node.op == RealOp::constant) {
        to.fill(node.value);
      } else if (node.op == RealOp::input) {
        to.fill(0);
        if (is_r(node)) std::copy_n(r.begin() + static_cast<ptrdiff_t>(first), count, to.begin());
      } else {
        apply(node, count, to.data(), lanes[node.of[0]].data(), lanes[node.of[1]].data(),
              lanes[node.of[2]].data());
      }
    }
    std::copy_n(lanes[nodes_.size() - 1].begin(), count, value.begin() + static_cast<ptrdiff_t>(first));
  }
}

double Tape::slope(double r) const {
  std::vector<Slope> of(nodes_.size());
  for (size_t k = 0; k < nodes_.size(); ++k) {
    const RealNode& node = nodes_[k];
    if (node.op == RealOp::constant)
      of[k] = {node.value, 0};
    else if (node.op == RealOp::input)
      of[k] = is_r(node) ? Slope{r, 1} : Slope{};
    else
      of[k] = sloped(node, of[node.of[0]], of[node.of[1]], of[node.of[2]]);
  }
  return of.back().by;
}

}  // namespace cuboct
