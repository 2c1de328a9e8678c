// SPDX-License-Identifier: MIT
// A node of a graph as a function of r: at d = (r, 0, 0).
#pragma once

#include <span>
#include <vector>

#include "model/program/real_graph.h"

namespace cuboct {

class Tape {
 public:
  // The node depends on `difference` alone. Tables must outlive the tape.
  Tape(const RealGraph& graph, NodeId root);

  void run(std::span<const double> r, std::span<double> value) const;
  double slope(double r) const;  // by r

 private:
  std::vector<RealNode> nodes_;  // those that the root needs; the last is the root
};

}  // namespace cuboct
