// SPDX-License-Identifier: MIT
// The steps of any program on the lattice engine: in vectors, block by block.
#pragma once

#include <memory>
#include <vector>

#include "emu/lattice/rounds/block_rounds.h"

namespace cuboct::emu {

class Rounds {
 public:
  // Both must outlive it. InputError where a value needs more than doubles hold.
  // `rows`: of a bonded program; else null.
  Rounds(const graph::FixedProgram& program, const KernelRule& rule, const Lattice& lattice,
         const graph::BondRows* rows);

  const graph::FixedProgram& program() const { return program_; }
  // Whether some value depends on the number of the step: then nothing is ever at rest.
  bool knows_time() const;
  // Of neighbours: whether some round reads their velocities; numbers of fields that round k reads.
  bool reads_velocities() const;
  std::vector<size_t> read_of_others(size_t k) const;
  // Partners are those of bonds, and no list grows old.
  bool bonded() const { return space_.rows != nullptr; }

  // What the rounds keep of bonds, in the order of State::bonds.
  void take_bonds(const std::vector<int64_t>& bonds) { bonds_ = bonds; }
  std::vector<int64_t> give_bonds() const;
  // The same as the blocks hold them.
  std::vector<Sums> copy_bonds() const;
  void swap_bonds(std::vector<Sums>& with);

  // Whether the code was compiled with the program: then nothing is compiled here.
  bool has_kept_code(const std::string& simd) const;
  // Runs by compiled code from now on (CodeLibrary), once it has proven itself.
  void compile(const std::string& simd, const std::string& directory);
  bool compiled() const { return library_ != nullptr; }

  // For so many blocks from now on.
  void cut(size_t blocks);
  size_t bond_entries(size_t b) const { return blocks_[b].bonds().entries.size(); }
  // Of a bonded program, once.
  void list_bonds(size_t b, const Block& block, const Particles& particles, const Index& index);

  // As of BlockRounds.
  void across(size_t k, size_t b, const RoundStep& step) { blocks_[b].across(code(), k, step); }
  void inside(size_t k, size_t b, const RoundStep& step) { blocks_[b].inside(code(), k, step); }

 private:
  RoundCode code() const { return {program_, rule_, space_, once_, bond_constants_, library_.get()}; }

  const graph::FixedProgram& program_;
  const KernelRule& rule_;
  bool once_;  // terms are made once for both ends
  BondSpace space_;
  std::vector<double> bond_constants_;  // of the kinds of bonds
  std::vector<BlockRounds> blocks_;
  std::vector<int64_t> bonds_;            // as they were given
  std::unique_ptr<CodeLibrary> library_;  // null: rounds are interpreted
};

}  // namespace cuboct::emu
