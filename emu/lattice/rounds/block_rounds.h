// SPDX-License-Identifier: MIT
// The rounds of a block, interpreted or by compiled code.
//
// A round works on stretches of groups in ascending order. When the pairs of a stretch are met, its own sums
// are complete and nobody needs its old values (block.h), so its finish follows at once, in place: a step
// passes through memory once. Sums of particles further on wait in rings.
#pragma once

#include <memory>
#include <vector>

#include "emu/lattice/code/library.h"
#include "emu/lattice/rounds/finish_pass.h"
#include "emu/lattice/rounds/jobs.h"
#include "emu/lattice/rounds/misfits.h"
#include "emu/lattice/rounds/pair_pass.h"

namespace cuboct::emu {

// Of a block's groups, ascending. Where no cell is at rest all are wanted, and these are empty.
struct WantedGroups {
  std::vector<uint32_t> near;    // pairs of some particle may be needed
  std::vector<uint32_t> awake;   // some particle is updated
  std::vector<uint8_t> is_near;  // by group
  void find(const Particles& particles, const Block& block, const Active& active);
};

// What runs a program's rounds.
struct RoundCode {
  const graph::FixedProgram& program;
  const KernelRule& rule;
  const BondSpace& space;
  bool once;                             // terms are made once for both ends
  const std::vector<double>& constants;  // of the kinds of bonds
  const CodeLibrary* library = nullptr;  // null: interpreted
};

class BlockRounds {
 public:
  BondList& bonds() { return bonds_; }
  const BondList& bonds() const { return bonds_; }
  // Bonds that count, whose partners are too far away to be known to this rank: own, id of the other.
  std::vector<std::pair<uint32_t, uint32_t>> lost;

  // Round k, all blocks after one another: first pairs whose other end is in another block, then those inside
  // and the finish. What does not fit is among the block's faults; its state is lost then.
  void across(const RoundCode& code, size_t k, const RoundStep& step);
  void inside(const RoundCode& code, size_t k, const RoundStep& step);

 private:
  static constexpr uint32_t kStretch = FinishPass::kMostGroups;

  // A list of pairs between blocks.
  struct Side {
    const std::vector<uint32_t>* group = nullptr;
    const std::vector<EntryGroup>* groups = nullptr;
    const Entry* entries = nullptr;
    Sums sums;
    size_t next = 0;  // the first group that `inside` has not come to
  };
  struct Owner;

  void find_sides(const RoundCode& code, const Block& block);
  void make_rings(const RoundCode& code, const Block& block);
  void meet(const RoundCode& code, size_t k, Ends ends, const Job& job);
  void meet_inside(const RoundCode& code, size_t k, const Block& block, Job& job);
  void finish(const RoundCode& code, size_t k, const FinishJob& job);
  void add_sides(Sums& ring, uint32_t begin, uint32_t end, bool some_rest);
  void clear(Sums& ring, uint32_t begin, uint32_t end) const;

  BondList bonds_;
  WantedGroups wanted_;
  std::vector<Side> sides_;
  std::vector<Sums> rings_;  // by round
  uint32_t mask_ = 0, window_ = 0;
  std::vector<std::unique_ptr<PairPass>> pairs_;  // by round, where it is interpreted
  std::vector<std::unique_ptr<FinishPass>> finishes_;
};

}  // namespace cuboct::emu
