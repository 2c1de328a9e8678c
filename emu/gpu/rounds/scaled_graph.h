// SPDX-License-Identifier: MIT
// A rule's graph of real numbers, made ready to be printed for a device: each value stands as itself times
// 2^-exponent, so that floats hold what SI numbers of atoms and their products are; quotients are products
// with reciprocals, of which a denominator has one; and each value is told by what it depends on, so that it
// is computed no more often than that changes.
//
// Exponents of inputs and constants are those of their sizes, products add them, and what is added is brought
// to one: a multiplication by a power of two, which rounds nothing and costs nothing beside an addition.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "model/program/real_graph.h"

namespace cuboct::gpu {

// What a value depends on: on nothing; on what never changes of a bond; on the particle; on the pair.
enum class RealScope : uint8_t { constant, kind, own, pair };

// Beyond RealOp: what stands in the place of quotients and of what never changes of a bond.
enum class RealForm : uint8_t { plain, reciprocal, inverse_root, root_by_inverse, of_kind };

struct ScaledNode {
  RealOp op = RealOp::constant;
  RealForm form = RealForm::plain;
  std::array<NodeId, 3> of{};
  double value = 0;
  RealInput input{};
  const TableCurve* table = nullptr;
  uint32_t number = 0;  // of_kind: which of ScaledGraph::of_kind
  RealScope scope = RealScope::constant;
  int exponent = 0;
};

// What is known of a graph's inputs.
struct RealInputs {
  std::function<std::optional<double>(const RealInput&)> constant;  // the same for all: its value
  std::function<RealScope(const RealInput&)> scope;
  std::function<int(const RealInput&)> exponent;
  std::function<int(NodeId)> kind_exponent;  // of a value of RealScope::kind
};

// floor(log2 |value|); 0 of 0 and of what is not finite.
int exponent_of(double value);
// The even one at or below: half of it is a root's.
inline int even(int exponent) { return exponent - (exponent & 1); }
// Of what has this exponent, to a power.
int power_exponent(int exponent, double power);
// Of a table's values, and of the arguments in which its entries count.
int value_exponent(const TableCurve& table);
int argument_exponent(const TableCurve& table);

struct ScaledGraph {
  std::vector<ScaledNode> nodes;
  std::vector<NodeId> outputs;  // in the order in which they were asked for
  std::vector<NodeId> of_kind;  // of the graph: values of RealScope::kind that others read

  const ScaledNode& at(NodeId id) const { return nodes[id]; }
  // To which both of an addition are brought. A zero has any exponent.
  int common(NodeId a, NodeId b) const;
};
ScaledGraph scaled(const RealGraph& graph, const std::vector<NodeId>& outputs, const RealInputs& inputs);

}  // namespace cuboct::gpu
