// SPDX-License-Identifier: MIT
// Bonds that last, in integers: what of them never changes becomes constants of kinds of bonds, and what
// depends on r besides becomes tables of r2 about each length that bonds have in the body as packed.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "model/contract/fixed_rule.h"
#include "model/graph/bond_rows.h"
#include "model/graph/program.h"
#include "model/program/bond_classes.h"
#include "model/program/integers.h"
#include "model/program/real_range.h"

namespace cuboct {

// A bond's tables reach so much beyond its length in the body as packed, and below it. Beyond, a bond that
// counts is a fault.
inline constexpr double kBondStretch = 0.125;

// What all rounds of a program share. A class of bonds is a kind of BondRows.
class BondFrame {
 public:
  // InputError, about the rule, where bonds have too many lengths.
  BondFrame(const BondClasses& classes, const FixedRule& base, graph::FixedProgram& program);

  const BondClasses& classes() const { return classes_; }
  // Reads a constant of bonds, by class.
  int read(graph::Builder& b, const std::vector<int64_t>& by_class, int frac, const std::string& name);
  Scaled read(graph::Builder& b, const std::vector<double>& by_class, const std::string& name);

  double unit2() const { return unit2_; }
  int bits() const { return bits_; }
  const std::vector<int64_t>& from() const { return from_; }
  const std::vector<int64_t>& width() const { return width_; }
  template <class T>
  std::vector<T> by_class(const std::vector<T>& by_length) const {
    std::vector<T> values;
    for (size_t c = 0; c < classes_.size(); ++c) values.push_back(by_length[classes_.length_of(c)]);
    return values;
  }
  std::shared_ptr<const graph::BondRows> rows(const ReferenceBonds& bonds) const;

 private:
  const BondClasses& classes_;
  graph::FixedProgram& program_;
  double unit2_;                                 // m^2 of a unit of r2
  int bits_ = 0;                                 // of a table's argument
  std::vector<int64_t> from_, width_;            // [length]: of its window, units of r2
  std::vector<std::vector<int64_t>> constants_;  // of program_.bond_constants, by class
};

// Of one round's graph.
class BondGraph {
 public:
  BondGraph(BondFrame& frame, graph::Builder& builder, int r2) : frame_(frame), b_(builder), r2_(r2) {}

  Scaled constant(const std::vector<double>& by_class, const std::string& name = "constant") {
    return frame_.read(b_, by_class, name);
  }
  // f of r2 (m^2) and the length, in the window of that length.
  Scaled table(Integers& integers, const std::function<double(double, size_t)>& f, double unit);
  // A truth of r2 (m^2) and the length that changes once at most: at any r2. InputError if it changes more
  // often, or may: `truth` is what holds all over an interval of r2, where that can be told.
  using Truth = std::function<std::optional<bool>(const RealRange& r2, size_t length)>;
  Scaled threshold(const Truth& truth);
  // True. Where r2 is outside its window it is false, and if `counts` holds it is a fault.
  Scaled inside(int counts);

 private:
  int above_window();  // r2 less where its window begins

  BondFrame& frame_;
  graph::Builder& b_;
  int r2_;
};

}  // namespace cuboct
