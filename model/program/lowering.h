// SPDX-License-Identifier: MIT
// One graph of a rule's text, into one of integers: node by node, and only the nodes that are asked for.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "model/program/bond_graph.h"
#include "model/program/integers.h"
#include "model/program/radial.h"

namespace cuboct {

// InputError, about the rule.
[[noreturn]] void refuse_rule(const std::string& what, const std::string& hint = "engine reference runs it");

class Lowering {
 public:
  Lowering(const RealGraph& graph, graph::Builder& builder, std::function<Scaled(const RealInput&)> input,
           int factor_bits = Integers::kFactorBits);

  // v_j - v_i by axis, which has a format of its own.
  void relative(std::function<Scaled(uint32_t)> velocity) { relative_ = std::move(velocity); }
  // Of a pair: r2 as a node, and up to where it counts, m^2.
  void pairs(const Radial& radial, const Scaled& r2, double reach2);
  // The same of a bond that lasts.
  void bonds(const Radial& radial, const Scaled& r2, BondGraph& bond);

  // `unit`: that it should count in, where that costs nothing; 0: any.
  Scaled value(NodeId id, double unit = 0);
  // From here on the node is worth this.
  void replace(NodeId id, const Scaled& value) { made_[id] = value; }
  // Whether a table of a bond is part of it.
  bool needs_window(NodeId id) const { return !windowed_.empty() && windowed_[id] != 0; }
  Integers& integers() { return integers_; }

 private:
  // A product taken apart: what is constant, what depends on r alone, what of a bond never changes, and what
  // else there is.
  using Factor = std::pair<NodeId, bool>;  // true: it divides
  struct Factors {
    double constant = 1;
    std::vector<Factor> of_r, fixed, others;
  };

  bool of_r(NodeId id) const { return radial_ != nullptr && radial_->is_of_r(id); }
  bool fixed(NodeId id) const { return radial_ != nullptr && radial_->is_fixed(id); }
  bool wants(NodeId id) const;
  bool is_relative(const RealNode& node) const;
  void gather(NodeId id, bool divides, Factors& to) const;
  Scaled made(NodeId id, double unit);
  Scaled product(NodeId id, double unit);
  Scaled fixed_product(const std::vector<Factor>& factors);
  // Operations of several operands. These are lowered from the last to the first: nodes are numbered as they
  // come, and their numbers are part of a plan.
  Scaled of_several(const RealNode& node, double unit);
  Scaled of_one(const RealNode& node, const Scaled& a);
  Scaled tabled(const RealNode& node, const Scaled& a);
  Scaled table(const std::vector<Factor>& factors, double unit);
  Scaled fitted(const std::function<double(double)>& f, double unit);
  int guarded(int node, double core2);

  const RealGraph& graph_;
  graph::Builder& b_;
  Integers integers_;
  std::function<Scaled(const RealInput&)> input_;
  std::function<Scaled(uint32_t)> relative_;
  std::vector<std::optional<Scaled>> made_;
  std::map<std::pair<std::vector<Factor>, double>, Scaled> tables_;
  const Radial* radial_ = nullptr;
  BondGraph* bond_ = nullptr;  // null: pairs within reach
  std::vector<char> windowed_;
  Scaled r2_;
  double reach2_ = 0;
};

}  // namespace cuboct
