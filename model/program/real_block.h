// SPDX-License-Identifier: MIT
// A graph's values for many lanes at once: node by node, so that each is one loop over its lanes.
#pragma once

#include <cstddef>
#include <vector>

#include "model/program/real_graph.h"

namespace cuboct {

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
        apply(id, count);
    }
  }
  const double* of(NodeId id) const { return values_.data() + id * lanes_; }

 private:
  double* lanes_of(NodeId id) { return values_.data() + id * lanes_; }
  void reserve(size_t count);
  void apply(NodeId id, size_t count);

  const RealGraph& graph_;
  size_t lanes_ = 0;
  std::vector<double> values_;  // [node][lane]
};

}  // namespace cuboct
