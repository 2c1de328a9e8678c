// SPDX-License-Identifier: MIT
// The steps of any program on the lattice engine: in vectors, block by block.
#pragma once

#include <memory>
#include <vector>

#include "emu/lattice/code/code_pass.h"
#include "emu/lattice/rounds/finish_pass.h"
#include "emu/lattice/rounds/pair_pass.h"

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
  std::vector<int64_t> give_bonds() const { return whole(&BondList::numbers); }
  // Of the step at hand, before it wrote any.
  void keep_bonds();
  std::vector<int64_t> bonds_before() const { return whole(&BondList::before); }

  // Runs the pairs by code of the host's compiler from now on (CodeLibrary), once it has proven itself.
  void compile(const std::string& simd, const std::string& directory);
  bool compiled() const { return library_ != nullptr; }

  // For particles stored in these blocks from now on, at places below `room`.
  void cut(const std::vector<Block>& blocks, size_t room);
  size_t bond_entries(size_t b) const { return parts_[b].bonds.entries.size(); }
  // Of a bonded program, once.
  void list_bonds(size_t b, const Block& block, const Particles& particles, const Index& index);

  // Of round k, all blocks after one another: the sums of pairs, then the finish. False where something does
  // not fit.
  bool meet(size_t k, size_t b, const Scope& scope);
  bool finish(size_t k, size_t b, const Block& block, Particles& particles, const Active& active,
              uint64_t step);
  // After the last round: velocities, displacements and places, and who left its cell.
  void move(Block& block, Particles& particles, const Active& active);
  // What that will do, of the particles that are awake.
  const Moves& moves() const { return moves_; }

 private:
  struct Part {
    std::vector<std::unique_ptr<PairPass>> pairs;  // by round
    std::vector<std::unique_ptr<FinishPass>> finishes;
    std::vector<Sums> sums;
    BondList bonds;
    bool lost = false;  // a bond that counts has its partner too far away
  };
  std::vector<int64_t> whole(std::vector<PaddedArray<double>> BondList::*numbers) const;

  const graph::FixedProgram& program_;
  const KernelRule& rule_;
  bool once_;  // terms are made once for both ends
  BondSpace space_;
  std::vector<Part> parts_;  // by block
  Moves moves_;
  std::vector<int64_t> bonds_;            // as they were given
  std::unique_ptr<CodeLibrary> library_;  // null: pairs are interpreted
  std::vector<CodePass> code_;            // by round
};

}  // namespace cuboct::emu
