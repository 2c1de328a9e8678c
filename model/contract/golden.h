// SPDX-License-Identifier: MIT
// The golden engine: it runs a program as it stands, pair by pair. It defines the bits.
#pragma once

#include <memory>
#include <vector>

#include "model/contract/fixed_rule.h"
#include "model/contract/lattice.h"
#include "model/contract/program_run.h"
#include "model/contract/state.h"
#include "model/graph/bond_rows.h"
#include "model/graph/program.h"

namespace cuboct {

class Golden {
 public:
  // `capacity`: particles that a cell holds. Throws RunError where the initial state exceeds it.
  Golden(const FixedRule& rule, const Lattice& lattice, int capacity, const State& initial);
  // Any program; one that is bonded has rows for all ids. A state without fields, or bonds, begins with each
  // field at zero, or at the end of its range that is next to zero.
  Golden(graph::FixedProgram program, const Lattice& lattice, int capacity, const State& initial,
         std::shared_ptr<const graph::BondRows> rows = nullptr);

  // Advances one step; throws RunError at the first step that breaks a width, a capacity or the lattice. The
  // state before it stands.
  void step();

  State state() const;  // sorted by id
  // Velocities that the rounds of the next step give, by id; the state stays. Empty where a round cannot be
  // done.
  std::vector<Int3> next_velocities() const;
  uint64_t step_count() const { return step_; }
  // Particles by cell, in the order of the cell's slots: the order that the machine keeps.
  const std::vector<std::vector<Particle>>& cells() const { return cells_; }

 private:
  struct Moving {
    Particle particle;
    std::array<int, 3> away;  // per axis: -1, 0, +1 cell still to go
  };
  using Sums = std::vector<std::vector<int64_t>>;  // by cell: of each particle all components of all sums

  void add_fields(const State& initial);
  Seen seen(const Particle& particle) const;
  std::vector<Seen> neighbours(uint32_t cell) const;
  std::vector<Seen> bonded(uint32_t cell, uint32_t id, const std::vector<Seen>& near,
                           std::vector<RunError>& faults);
  Sums meet(const graph::Round& round);
  void finish(const graph::Round& round, const Sums& sums, std::vector<std::vector<Moving>>& moving);
  void keep(const graph::Round& round, FinishRun& run, size_t lane, uint32_t id);
  Moving moved(const Particle& particle, FinishRun& run, size_t lane) const;
  RunError fault_of(Fault fault, uint32_t cell, uint32_t particle, int64_t number) const;
  void fail_if_any(const std::vector<RunError>& faults) const;
  void migrate(int axis, std::vector<std::vector<Moving>>& moving) const;

  std::shared_ptr<const graph::FixedProgram> program_;
  const Lattice& lattice_;
  int capacity_;
  uint64_t step_ = 0;
  std::vector<std::vector<Particle>> cells_;
  std::vector<int64_t> fields_;                  // the program's numbers of each particle
  std::vector<uint32_t> row_of_id_;              // where they are; empty where there are none
  std::shared_ptr<const graph::BondRows> rows_;  // null: all that is near is a partner
  std::vector<int64_t> bonds_;                   // the program's numbers of each bond
};

}  // namespace cuboct
