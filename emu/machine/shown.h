// SPDX-License-Identifier: MIT
// Words that a machine shows of its particles, as states hold them.
#pragma once

#include <cstdint>
#include <vector>

#include "emu/machine/words.h"

namespace cuboct::emu {

struct Shown {
  Particle particle;
  std::vector<int64_t> fields;  // of a rule of text, as State::fields
  std::vector<int64_t> bonds;   // what rounds keep of the particle's bonds, as State::bonds
};

class ShownReader {
 public:
  // Keeps a reference to `plan`.
  explicit ShownReader(const Plan& plan);

  // `cell`: index into the lattice. `step`: after which it is shown. Throws std::runtime_error for a particle
  // that the plan does not have, as an unchecked link may make one, or whose row of bonds is not the one that
  // it was loaded with.
  Shown read(const Word& word, uint32_t cell, uint64_t step) const;
  uint64_t hash(const Shown& shown) const;
  // Behind the particles that the state has; in any order.
  void add(const Shown& shown, State& state) const;

 private:
  void check_bonds(const Slot& slot, uint64_t step) const;

  const Plan& plan_;
  std::vector<uint64_t> bond_begin_;  // State::bond_begin; empty where rounds write no bonds
};

// By id, with the fields of each.
void sort_by_id(State& state);

}  // namespace cuboct::emu
