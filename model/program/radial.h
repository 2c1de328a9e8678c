// SPDX-License-Identifier: MIT
// What in a graph of pairs, or of bonds, depends on little: on what never changes of a bond, or on r besides.
#pragma once

#include <optional>
#include <vector>

#include "model/program/bond_classes.h"
#include "model/program/real_range.h"

namespace cuboct {

class Radial {
 public:
  // `classes`: of bonds that last; null: of pairs within reach.
  explicit Radial(const RealGraph& graph, const BondClasses* classes = nullptr);

  bool is_r2(NodeId id) const { return r2_ && *r2_ == id; }
  size_t classes() const { return values_.size(); }
  // Depends on what never changes of a bond alone.
  bool is_fixed(NodeId id) const { return fixed_[id] != 0; }
  double fixed_at(NodeId id, size_t of_class) const { return values_[of_class][place_[id]]; }
  // Fixed, and alike for all bonds of one length.
  bool is_of_length(NodeId id) const { return of_length_[id] != 0; }
  // Depends on r2, which it must, and on numbers and what is of the length.
  bool is_of_r(NodeId id) const { return of_r_[id] != 0; }
  // Of these two. At r2, m^2, of bonds of this length.
  double at(NodeId id, double r2, size_t length = 0) const;
  // Over all r2 of an interval.
  RealRange over(NodeId id, const RealRange& r2, size_t length) const;

 private:
  bool is_square(NodeId id) const;
  bool is_square_of(NodeId id, uint32_t axis) const;
  bool is_input(NodeId id, uint32_t axis) const;
  bool depends_on_r(NodeId id) const;
  void fix();

  const RealGraph& graph_;
  const BondClasses* classes_;
  std::vector<char> fixed_, of_length_, of_r_;
  std::vector<size_t> place_;                // of what is fixed, in values_
  std::vector<std::vector<double>> values_;  // [class]
  std::optional<NodeId> r2_;
};

}  // namespace cuboct
