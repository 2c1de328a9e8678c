// SPDX-License-Identifier: MIT
// What of a body's bonds never changes, in doubles: bonds that nothing of it tells apart are one class.
#pragma once

#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "model/program/program_start.h"
#include "model/program/rule_program.h"

namespace cuboct {

class BondClasses {
 public:
  BondClasses(const RuleProgram& rule, const ProgramStart& start);

  size_t size() const { return values_.size(); }
  const std::vector<uint32_t>& of_bond() const { return of_bond_; }  // [bond]: its class
  // Of each bond the classes of both its ends, in either order.
  const std::set<std::pair<uint32_t, uint32_t>>& ends() const { return ends_; }

  // Bonds of one length in the body as packed, whatever else sets them apart.
  const std::vector<double>& lengths2() const { return lengths2_; }  // m^2
  size_t length_of(size_t of) const { return length_[of]; }
  size_t of_length(size_t length) const { return first_of_length_[length]; }  // a class

  // d0, or a bond's field that no round writes.
  bool fixed(const RealInput& input) const;
  double at(size_t of, const RealInput& input) const;

 private:
  bool has_axes_ = false;                    // d0 itself is read; else r0 alone
  std::vector<char> written_;                // [number of a bond's field]
  std::vector<int> column_;                  // [number of a bond's field]: in values_; -1: written
  std::vector<std::vector<double>> values_;  // [class]: d0 by axis, then fields
  std::vector<size_t> length_, first_of_length_;
  std::vector<double> lengths2_;
  std::vector<uint32_t> of_bond_;
  std::set<std::pair<uint32_t, uint32_t>> ends_;
};

}  // namespace cuboct
