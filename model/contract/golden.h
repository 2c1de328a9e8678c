// SPDX-License-Identifier: MIT
// The golden engine: the numeric contract and nothing else. It defines the bits.
#pragma once

#include <vector>

#include "model/contract/fixed_rule.h"
#include "model/contract/lattice.h"
#include "model/contract/state.h"

namespace cuboct {

class Golden {
 public:
  // `capacity`: particles that a cell holds. Throws RunError where the initial state exceeds it.
  Golden(const FixedRule& rule, const Lattice& lattice, int capacity, const State& initial);

  // Advances one step; throws RunError at the first step that breaks a width, a capacity or the lattice.
  void step();

  State state() const;  // sorted by id
  uint64_t step_count() const { return step_; }
  // Particles by cell, in the order of the cell's slots: the order that the machine keeps.
  const std::vector<std::vector<Particle>>& cells() const { return cells_; }

 private:
  struct Moving {
    Particle particle;
    std::array<int, 3> away;  // per axis: -1, 0, +1 cell still to go
  };
  RunError fault_of(Fault fault, uint32_t cell, uint32_t particle, int64_t number) const;
  void fail_if_any(const std::vector<RunError>& faults) const;
  void migrate(int axis, std::vector<std::vector<Moving>>& moving) const;

  const FixedRule& rule_;
  const Lattice& lattice_;
  int capacity_;
  uint64_t step_ = 0;
  std::vector<std::vector<Particle>> cells_;
};

}  // namespace cuboct
