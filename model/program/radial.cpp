// SPDX-License-Identifier: MIT
#include "model/program/radial.h"

namespace cuboct {

Radial::Radial(const RealGraph& graph, const BondClasses* classes)
    : graph_(graph),
      classes_(classes),
      fixed_(graph.nodes().size(), 0),
      of_length_(graph.nodes().size(), 0),
      of_r_(graph.nodes().size(), 0),
      place_(graph.nodes().size(), 0) {
  if (classes_ != nullptr) fix();
  for (NodeId id = 0; id < graph.nodes().size(); ++id) {
    if (is_square(id)) r2_ = id;
    of_r_[id] = is_r2(id) || depends_on_r(id);
  }
}

void Radial::fix() {
  values_.resize(classes_->size());
  size_t places = 0;
  for (NodeId id = 0; id < graph_.nodes().size(); ++id) {
    const RealNode& node = graph_.at(id);
    bool any = node.op == RealOp::input && classes_->fixed(node.input), all = true;
    const auto parts = static_cast<size_t>(arity(node.op));
    for (size_t k = 0; k < parts; ++k) {
      any = any || fixed_[node.of[k]] != 0;
      all = all && (fixed_[node.of[k]] != 0 || graph_.at(node.of[k]).op == RealOp::constant);
    }
    if (!any || !all) continue;
    fixed_[id] = 1;
    place_[id] = places++;
    for (size_t c = 0; c < values_.size(); ++c) {
      std::array<double, 3> of{};
      for (size_t k = 0; k < parts; ++k)
        of[k] = fixed_[node.of[k]] != 0 ? fixed_at(node.of[k], c) : graph_.at(node.of[k]).value;
      values_[c].push_back(node.op == RealOp::input ? classes_->at(c, node.input)
                                                    : applied(node, of[0], of[1], of[2]));
    }
    of_length_[id] = 1;
    for (size_t c = 0; c < values_.size(); ++c)
      if (values_[c].back() != values_[classes_->of_length(classes_->length_of(c))].back())
        of_length_[id] = 0;
  }
}

double Radial::at(NodeId id, double r2, size_t length) const {
  std::vector<double> values(id + 1, 0);
  for (NodeId k = 0; k <= id; ++k) {
    const RealNode& node = graph_.at(k);
    if (node.op == RealOp::constant) values[k] = node.value;
    if (is_r2(k))
      values[k] = r2;
    else if (of_length_[k] != 0)
      values[k] = fixed_at(k, classes_->of_length(length));
    else if (of_r_[k] != 0)
      values[k] = applied(node, values[node.of[0]], values[node.of[1]], values[node.of[2]]);
  }
  return values[id];
}

RealRange Radial::over(NodeId id, const RealRange& r2, size_t length) const {
  std::vector<RealRange> values(id + 1);
  for (NodeId k = 0; k <= id; ++k) {
    const RealNode& node = graph_.at(k);
    const auto single = [](double value) { return RealRange{value, value}; };
    if (node.op == RealOp::constant) values[k] = single(node.value);
    if (is_r2(k))
      values[k] = r2;
    else if (of_length_[k] != 0)
      values[k] = single(fixed_at(k, classes_->of_length(length)));
    else if (of_r_[k] != 0)
      values[k] = ranged(node, values[node.of[0]], values[node.of[1]], values[node.of[2]]);
  }
  return values[id];
}

bool Radial::is_input(NodeId id, uint32_t axis) const {
  const RealNode& node = graph_.at(id);
  return node.op == RealOp::input && node.input == RealInput{RealSource::difference, axis};
}

bool Radial::is_square_of(NodeId id, uint32_t axis) const {
  const RealNode& node = graph_.at(id);
  return node.op == RealOp::multiply && is_input(node.of[0], axis) && is_input(node.of[1], axis);
}

// (x x + y y) + z z
bool Radial::is_square(NodeId id) const {
  const RealNode& node = graph_.at(id);
  if (node.op != RealOp::add || !is_square_of(node.of[1], 2)) return false;
  const RealNode& xy = graph_.at(node.of[0]);
  return xy.op == RealOp::add && is_square_of(xy.of[0], 0) && is_square_of(xy.of[1], 1);
}

bool Radial::depends_on_r(NodeId id) const {
  const RealNode& node = graph_.at(id);
  bool any = false;
  for (size_t k = 0; k < static_cast<size_t>(arity(node.op)); ++k) {
    const NodeId of = node.of[k];
    if (of_r_[of] != 0)
      any = true;
    else if (graph_.at(of).op != RealOp::constant && of_length_[of] == 0)
      return false;
  }
  return any;
}

}  // namespace cuboct
