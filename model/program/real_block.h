// SPDX-License-Identifier: MIT
// A graph's values for many lanes at once: node by node, so that each is one loop over its lanes.
#pragma once

#include <cstddef>
#include <vector>

#include "model/program/real_graph.h"

namespace cuboct {

// An operation on `count` lanes.
void apply(const RealNode& node, size_t count, double* to, const double* a, const double* b, const double* c);

class RealBlock {
 public:
  // Keeps a reference to the graph.
  explicit RealBlock(const RealGraph& graph) : graph_(graph) {}

  // `fill(input, to)` writes the values of an input for `count` lanes.
  template <class Fill>
  void run(size_t count, Fill&& fill) {
    reserve(count);
    for (NodeId id = 0; id < graph_.nodes().size(); ++id) {
      const RealNode& node = graph_.at(id);
      if (node.op == RealOp::input)
        fill(node.input, lanes_of(id));
      else if (node.op != RealOp::constant)
        apply(node, count, lanes_of(id), of(node.of[0]), of(node.of[1]), of(node.of[2]));
    }
  }
  const double* of(NodeId id) const { return values_.data() + id * lanes_; }

 private:
  double* lanes_of(NodeId id) { return values_.data() + id * lanes_; }
  void reserve(size_t count);

  const RealGraph& graph_;
  size_t lanes_ = 0;
  std::vector<double> values_;  // [node][lane]
};

}  // namespace cuboct
