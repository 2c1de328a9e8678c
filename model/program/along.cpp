// SPDX-License-Identifier: MIT
#include "model/program/along.h"

#include "model/program/radial.h"

namespace cuboct {
namespace {

class Along {
 public:
  explicit Along(const RealGraph& graph) : graph_(graph), radial_(graph) {}

  bool scalar(NodeId id) const { return graph_.at(id).op == RealOp::constant || radial_.is_of_r(id); }
  bool vector(const std::array<NodeId, 3>& of) const {
    const RealNode& x = graph_.at(of[0]);
    for (const NodeId id : of)
      if (graph_.at(id).op != x.op) return false;
    switch (x.op) {
      case RealOp::input:
        for (uint32_t a = 0; a < 3; ++a)
          if (graph_.at(of[a]).input != RealInput{RealSource::difference, a}) return false;
        return true;
      case RealOp::constant:
        return x.value == 0 && of[0] == of[1] && of[1] == of[2];
      case RealOp::negate:
        return vector(parts(of, 0));
      case RealOp::add:
      case RealOp::subtract:
        return vector(parts(of, 0)) && vector(parts(of, 1));
      case RealOp::multiply:
        return (vector(parts(of, 0)) && factor(parts(of, 1))) ||
               (factor(parts(of, 0)) && vector(parts(of, 1)));
      case RealOp::divide:
        return vector(parts(of, 0)) && factor(parts(of, 1));
      case RealOp::select:
        return factor(parts(of, 0)) && vector(parts(of, 1)) && vector(parts(of, 2));
      default:
        return false;
    }
  }

 private:
  std::array<NodeId, 3> parts(const std::array<NodeId, 3>& of, size_t k) const {
    return {graph_.at(of[0]).of[k], graph_.at(of[1]).of[k], graph_.at(of[2]).of[k]};
  }
  bool factor(const std::array<NodeId, 3>& of) const {
    return of[0] == of[1] && of[1] == of[2] && scalar(of[0]);
  }

  const RealGraph& graph_;
  Radial radial_;
};

}  // namespace

bool is_radial(const RealGraph& graph, NodeId id) { return Along(graph).scalar(id); }

bool is_along(const RealGraph& graph, const std::array<NodeId, 3>& vector) {
  return Along(graph).vector(vector);
}

}  // namespace cuboct
