// SPDX-License-Identifier: MIT
// How far a run of a rule of text in floats or doubles may be from the reference's in doubles, if roundings
// alone part the two. Each value of the rule's graphs carries a bound of its error, to first order: what its
// inputs' errors make of it, and its own rounding in both engines. A truth that these errors could turn
// counts as uncertain, and what it chooses may be either. docs/reference/gpu.md, "Rules of text".
#pragma once

#include <optional>
#include <vector>

#include "model/contract/rule.h"
#include "model/program/near_rows.h"
#include "model/program/rule_program.h"
#include "model/rules/reference_bonds.h"

namespace cuboct {

class ProgramErrors {
 public:
  // `body`: with Body::bonds, as of the rule's reference. Keeps a reference to the rule, which is text.
  ProgramErrors(const Rule& rule, const Body& body, const Periodic& periodic, bool floats);

  // Kept numbers of particles become those of a state of the device's, where they have no error:
  // [field's number][particle].
  void place(uint32_t number, const std::vector<double>& values);

  // Of the rounds at a state, whose errors are those of the steps so far. With `makes` a step follows: fields
  // that are kept go on.
  void look(const std::vector<Vec3>& x, const std::vector<Vec3>& v, uint64_t step, bool makes = false);
  const std::vector<double>& force() const { return force_; }  // N, by particle: of the vector
  double field(uint32_t number, size_t particle) const { return shown_[number][particle].error; }

  // The step that begins in the reference's state.
  void step(const std::vector<Vec3>& x, const std::vector<Vec3>& v, uint64_t step);
  double position() const;  // m, of any particle
  // The largest error of a field over its largest value, at the last look or step.
  double field_share() const;

 private:
  struct Number {
    double value = 0, error = 0;
  };
  struct Pair {
    uint32_t i, j;
    uint64_t bond;
    Vec3 d;
    bool certain;  // not that the reach's end passes between the two engines
  };
  using Numbers = std::vector<Number>;

  void run(const RealGraph& graph, Numbers& values, const Pair& pair, const Numbers& sums) const;
  Number input(const RealInput& input, const Pair& pair, const Numbers& sums) const;
  Number result(const RealNode& node, const Numbers& values) const;
  Number curve(const RealNode& node, const Number& at) const;
  void round(const ProgramRound& round);
  void meet(const ProgramRound& round, const Pair& pair, Numbers& values, Numbers& sums, Numbers& sizes);
  Pair near_pair(uint32_t i, uint32_t j) const;

  const Rule& rule_;
  const RuleProgram& program_;
  bool floats_;
  double u_, both_;       // half an ulp of 1, of the device's numbers, and with that of doubles
  double least_;          // the least of the device's numbers above 0: what is less becomes 0
  double extent_ = 0;     // m, of all coordinates
  double unit_, places_;  // m, of a position; of a difference of two
  double grain_ = 0;
  std::vector<uint8_t> type_;
  std::vector<Vec3> packed_at_, x_, v_;
  std::vector<double> off_, fast_, away_;  // m, m/s, m: errors of x, v and u along an axis
  std::vector<double> force_;
  std::vector<double> size_;  // N
  int64_t time_ = 0;
  bool makes_ = false;
  ReferenceBonds bonds_{{0}, {}, {}};
  std::optional<NearRows> near_;
  std::vector<Numbers> fields_, shown_, bond_, bond_next_;
};

}  // namespace cuboct
