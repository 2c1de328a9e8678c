// SPDX-License-Identifier: MIT
// Formulas as one graph of numbers: each node an operation on nodes before it, none there twice. Vectors are
// three nodes, truths are 0 or 1. In SI units, in doubles.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "model/program/table_curve.h"

namespace cuboct {

enum class RealOp : uint8_t {
  constant,
  input,
  add,
  subtract,
  multiply,
  divide,
  negate,
  square_root,
  exponential,
  logarithm,
  sine,
  cosine,
  error_function,  // erfc, what is left of 1
  power,           // of a constant exponent
  absolute,
  least,
  most,
  below,    // a < b
  at_most,  // a <= b
  equal,
  both,
  either,
  inverse,  // not
  select,   // a != 0 ? b : c
  curve,    // of a table: its value, its slope
  curve_slope,
};

// Where an input comes from. `own` is the particle that sums, `other` the one at the bond's far end.
enum class RealSource : uint8_t {
  difference,    // from own to other, of the nearest image; m, by axis
  packed,        // the same in the body as packed
  own_velocity,  // m/s, by axis
  other_velocity,
  own_mass,  // kg
  other_mass,
  own_field,  // index: a number of the fields, one after another
  other_field,
  bond_field,   // index: a field of bonds
  position,     // own, m, by axis
  sum,          // index: a number of the round's sums, one after another
  time_step,    // s
  own_element,  // 2^k of the k-th element of the rule's potential
  other_element,
  made,        // 1 where a step is made, 0 where the state is only looked at
  own_region,  // whether the particle stands in a region, as packed; index: which
  other_region,
  noise,  // of own and other, of a particle alone of own; index: its stream
};

struct RealInput {
  RealSource source = RealSource::difference;
  uint32_t index = 0;  // the axis, or the number
  bool operator==(const RealInput&) const = default;
  auto operator<=>(const RealInput&) const = default;
};

using NodeId = uint32_t;

struct RealNode {
  RealOp op = RealOp::constant;
  std::array<NodeId, 3> of{};
  double value = 0;                   // of a constant
  RealInput input{};                  // of an input
  const TableCurve* table = nullptr;  // of a curve
};

// How many nodes an operation takes.
int arity(RealOp op);
inline double applied(RealOp op, double a, double b, double c) {
  switch (op) {
    case RealOp::add:
      return a + b;
    case RealOp::subtract:
      return a - b;
    case RealOp::multiply:
      return a * b;
    case RealOp::divide:
      return a / b;
    case RealOp::negate:
      return -a;
    case RealOp::square_root:
      return std::sqrt(a);
    case RealOp::exponential:
      return std::exp(a);
    case RealOp::logarithm:
      return std::log(a);
    case RealOp::sine:
      return std::sin(a);
    case RealOp::cosine:
      return std::cos(a);
    case RealOp::error_function:
      return std::erfc(a);
    case RealOp::power:
      return std::pow(a, b);
    case RealOp::absolute:
      return std::abs(a);
    case RealOp::least:
      return std::min(a, b);
    case RealOp::most:
      return std::max(a, b);
    case RealOp::below:
      return a < b;
    case RealOp::at_most:
      return a <= b;
    case RealOp::equal:
      return a == b;
    case RealOp::both:
      return a != 0 && b != 0;
    case RealOp::either:
      return a != 0 || b != 0;
    case RealOp::inverse:
      return a == 0;
    case RealOp::select:
      return a != 0 ? b : c;
    case RealOp::constant:
    case RealOp::input:
    case RealOp::curve:
    case RealOp::curve_slope:
      break;
  }
  return 0;
}
inline bool is_curve(RealOp op) { return op == RealOp::curve || op == RealOp::curve_slope; }
inline double applied(const RealNode& node, double a, double b, double c) {
  if (node.op == RealOp::curve) return node.table->at(a);
  if (node.op == RealOp::curve_slope) return node.table->slope(a);
  return applied(node.op, a, b, c);
}

class RealGraph {
 public:
  // Constants are folded, and what is there already is not made again.
  NodeId constant(double value);
  NodeId input(RealSource source, uint32_t index = 0);
  NodeId add(RealOp op, NodeId a, NodeId b = 0, NodeId c = 0);
  // The table, or its slope, at a. It must outlive the graph.
  NodeId curve(const TableCurve& table, NodeId a, bool of_slope);

  const std::vector<RealNode>& nodes() const { return nodes_; }
  const RealNode& at(NodeId id) const { return nodes_[id]; }
  // Whether any node reads such an input.
  bool reads(RealSource source) const;

 private:
  NodeId keep(const RealNode& node);
  NodeId whole_power(NodeId a, int exponent);

  std::vector<RealNode> nodes_;
  std::map<std::tuple<RealOp, std::array<NodeId, 3>, uint64_t, RealInput, const TableCurve*>, NodeId> known_;
};

// A node as a sum: of a - (b - c) these are a, -b and c. A sum of very many is one part, itself.
struct Addend {
  NodeId node = 0;
  bool minus = false;
};
std::vector<Addend> addends_of(const RealGraph& graph, NodeId id);

}  // namespace cuboct
