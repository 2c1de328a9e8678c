// SPDX-License-Identifier: MIT
// The steps of any program on the lattice engine: in vectors, block by block.
#pragma once

#include <memory>
#include <vector>

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
  // Partners are those of bonds, and no list grows old.
  bool bonded() const { return bonds_.rows != nullptr; }
  void build(size_t b, const Block& block, const Particles& particles, const Index& index);
  // What the rounds keep of bonds, in the order of State::bonds.
  void take_bonds(const std::vector<int64_t>& bonds);
  std::vector<int64_t> give_bonds() const { return whole(bond_numbers_); }
  // Of the step at hand, before it wrote any.
  void keep_bonds();
  std::vector<int64_t> bonds_before() const { return whole(bonds_before_); }

  // For particles stored in these blocks from now on, at places below `room`.
  void cut(size_t blocks, size_t room);
  void build(size_t b, const Block& block, const Particles& particles, Search search);
  void prune(size_t b, const Block& block, const Particles& particles, double reach);

  // Of round k, all blocks after one another: the sums of pairs, then the finish. False where something does
  // not fit.
  bool meet(size_t k, size_t b, const Block& block, const Particles& particles, const Active& active,
            uint64_t step);
  bool finish(size_t k, size_t b, const Block& block, Particles& particles, const Active& active,
              uint64_t step);
  // After the last round: velocities, displacements and places, and who left its cell.
  void move(Block& block, Particles& particles, const Active& active);

 private:
  struct Part {
    PartnerList list;
    std::vector<std::unique_ptr<PairPass>> pairs;  // by round
    std::vector<std::unique_ptr<FinishPass>> finishes;
  };
  bool move(Particles& particles, uint32_t p, Crossing& crossing, double& speed2) const;

  const graph::FixedProgram& program_;
  const KernelRule& rule_;
  bool once_;                                           // rows have each pair inside a block once
  std::vector<Part> parts_;                             // by block
  std::vector<std::vector<PaddedArray<double>>> sums_;  // by round
  Moves moves_;
  static std::vector<int64_t> whole(const BondNumbers& numbers);

  BondNumbers bond_numbers_, bonds_before_;
  PairPass::Bonds bonds_;
};

}  // namespace cuboct::emu
