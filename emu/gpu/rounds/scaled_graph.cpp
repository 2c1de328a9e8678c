// SPDX-License-Identifier: MIT
#include "emu/gpu/rounds/scaled_graph.h"

#include <algorithm>
#include <cmath>

namespace cuboct::gpu {
namespace {

class Scaling {
 public:
  Scaling(const RealGraph& graph, const RealInputs& inputs)
      : graph_(graph), inputs_(inputs), made_(graph.nodes().size()), reciprocal_(graph.nodes().size()) {}

  ScaledGraph of(const std::vector<NodeId>& outputs) {
    std::vector<bool> needed(graph_.nodes().size());
    for (const NodeId id : outputs) needed[id] = true;
    for (NodeId id = static_cast<NodeId>(needed.size()); id-- > 0;)
      for (int k = 0; needed[id] && k < arity(graph_.at(id).op); ++k)
        needed[graph_.at(id).of[static_cast<size_t>(k)]] = true;
    for (NodeId id = 0; id < needed.size(); ++id) scope_.push_back(scope_of(graph_.at(id)));
    inverted_.resize(needed.size());
    for (NodeId id = 0; id < needed.size(); ++id)
      if (const RealNode& node = graph_.at(id); needed[id] && node.op == RealOp::divide && !inner(id))
        inverted_[node.of[1]] = true;
    for (NodeId id = 0; id < needed.size(); ++id)
      if (needed[id] && !inner(id)) made_[id] = make(id);
    for (const NodeId id : outputs) result_.outputs.push_back(read(id));
    return std::move(result_);
  }

 private:
  // Computed on the host, for each kind of bond.
  bool inner(NodeId id) const { return scope_[id] == RealScope::kind; }

  RealScope scope_of(const RealNode& node) const {
    if (node.op == RealOp::constant) return RealScope::constant;
    if (node.op == RealOp::input)
      return inputs_.constant(node.input) ? RealScope::constant : inputs_.scope(node.input);
    RealScope scope = RealScope::constant;
    for (int k = 0; k < arity(node.op); ++k) scope = both(scope, scope_[node.of[static_cast<size_t>(k)]]);
    return scope;
  }
  static RealScope both(RealScope a, RealScope b) {
    const bool apart =
        (a == RealScope::kind && b == RealScope::own) || (a == RealScope::own && b == RealScope::kind);
    return apart ? RealScope::pair : std::max(a, b);
  }

  NodeId add(ScaledNode node) {
    result_.nodes.push_back(node);
    return static_cast<NodeId>(result_.nodes.size() - 1);
  }
  // A node that others read: of a kind it becomes an input.
  NodeId read(NodeId id) {
    if (!inner(id) || made_[id]) return *made_[id];
    ScaledNode node{.op = RealOp::input, .form = RealForm::of_kind, .scope = RealScope::pair};
    node.number = static_cast<uint32_t>(result_.of_kind.size());
    node.exponent = inputs_.kind_exponent(id);
    result_.of_kind.push_back(id);
    made_[id] = add(node);
    return *made_[id];
  }
  const ScaledNode& at(NodeId id) const { return result_.nodes[id]; }

  NodeId make(NodeId id) {
    const RealNode& from = graph_.at(id);
    ScaledNode node{.op = from.op, .value = from.value, .input = from.input, .table = from.table};
    node.scope = scope_[id];
    if (from.op == RealOp::input)
      if (const auto value = inputs_.constant(from.input)) node.op = RealOp::constant, node.value = *value;
    for (int k = 0; k < arity(from.op); ++k)
      node.of[static_cast<size_t>(k)] = read(from.of[static_cast<size_t>(k)]);
    if (node.op != RealOp::input && node.scope == RealScope::constant) return folded(from, node);
    if (node.op == RealOp::divide) {
      node.op = RealOp::multiply;
      node.of[1] = reciprocal_of(from.of[1]);
      const ScaledNode& over = at(node.of[0]);
      if (over.op == RealOp::constant && over.value == 1) return node.of[1];
    }
    if (node.op == RealOp::square_root && inverted_[id]) {
      ScaledNode inverse = node;
      inverse.form = RealForm::inverse_root;
      inverse.exponent = -even(at(node.of[0]).exponent) / 2;
      reciprocal_[id] = add(inverse);
      node.form = RealForm::root_by_inverse;
      node.of[1] = *reciprocal_[id];
    }
    node.exponent = exponent(node);
    return add(node);
  }
  // Of constants alone, some of which are those of the scene.
  NodeId folded(const RealNode& from, const ScaledNode& node) {
    const auto of = [&](size_t k) {
      return k < static_cast<size_t>(arity(from.op)) ? at(node.of[k]).value : 0;
    };
    ScaledNode constant{.op = RealOp::constant};
    constant.value = from.op == RealOp::constant || node.op == RealOp::constant
                         ? node.value
                         : applied(from, of(0), of(1), of(2));
    constant.exponent = exponent_of(constant.value);
    return add(constant);
  }
  NodeId reciprocal_of(NodeId id) {
    if (reciprocal_[id]) return *reciprocal_[id];
    const NodeId of = read(id);
    ScaledNode node{.op = RealOp::divide, .form = RealForm::reciprocal, .of = {of, 0, 0}};
    node.scope = at(of).scope;
    node.exponent = -at(of).exponent;
    if (at(of).op == RealOp::constant) {
      node.op = RealOp::constant, node.form = RealForm::plain;
      node.value = 1 / at(of).value;
      node.exponent = exponent_of(node.value);
    }
    reciprocal_[id] = add(node);
    return *reciprocal_[id];
  }

  int exponent(const ScaledNode& node) const {
    const auto of = [&](size_t k) { return at(node.of[k]).exponent; };
    switch (node.op) {
      case RealOp::constant:
        return exponent_of(node.value);
      case RealOp::input:
        return inputs_.exponent(node.input);
      case RealOp::add:
      case RealOp::subtract:
      case RealOp::least:
      case RealOp::most:
        return result_.common(node.of[0], node.of[1]);
      case RealOp::select:
        return result_.common(node.of[1], node.of[2]);
      case RealOp::multiply:
        return of(0) + of(1);
      case RealOp::negate:
      case RealOp::absolute:
        return of(0);
      case RealOp::square_root:
        return even(of(0)) / 2;
      case RealOp::power:
        return power_exponent(of(0), at(node.of[1]).value);
      case RealOp::curve:
        return value_exponent(*node.table);
      case RealOp::curve_slope:
        return value_exponent(*node.table) - argument_exponent(*node.table);
      default:  // functions of plain numbers, and truths
        return 0;
    }
  }

  const RealGraph& graph_;
  const RealInputs& inputs_;
  std::vector<RealScope> scope_;
  std::vector<bool> inverted_;  // something is divided by it
  std::vector<std::optional<NodeId>> made_, reciprocal_;
  ScaledGraph result_;
};

}  // namespace

int exponent_of(double value) { return value == 0 || !std::isfinite(value) ? 0 : std::ilogb(value); }

int power_exponent(int exponent, double power) { return static_cast<int>(std::lround(exponent * power)); }

int value_exponent(const TableCurve& table) {
  const auto [low, high] = table.range(false);
  return exponent_of(std::max(std::abs(low), std::abs(high)));
}
int argument_exponent(const TableCurve& table) {
  return exponent_of(std::max(std::abs(table.begin()), std::abs(table.end())));
}

int ScaledGraph::common(NodeId a, NodeId b) const {
  const auto is_zero = [&](NodeId id) { return at(id).op == RealOp::constant && at(id).value == 0; };
  if (is_zero(a)) return at(b).exponent;
  if (is_zero(b)) return at(a).exponent;
  return std::max(at(a).exponent, at(b).exponent);
}

ScaledGraph scaled(const RealGraph& graph, const std::vector<NodeId>& outputs, const RealInputs& inputs) {
  return Scaling(graph, inputs).of(outputs);
}

}  // namespace cuboct::gpu
