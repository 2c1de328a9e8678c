// SPDX-License-Identifier: MIT
// What does not fit, to the letter: golden's own functions (model/contract/program_run.h) on the pair or the
// particle where a check failed. Rare, so that no speed is asked of it.
#pragma once

#include "emu/lattice/rounds/jobs.h"
#include "model/contract/state.h"
#include "model/graph/program.h"

namespace cuboct::emu {

class Misfits {
 public:
  // All must outlive it. `bonds`: empty but for a bonded program.
  Misfits(const graph::FixedProgram& program, const graph::Round& round, const KernelRule& rule,
          const BondSpace& space, const BondList& bonds, const RoundStep& step);

  // Adds to the block's pair faults those of a pair, as it is seen from `own` and, where `both`, from the
  // other end too.
  void add_pair(uint32_t own, uint32_t other, const Entry& entry, uint64_t slot, bool both) const;
  // A bond that counts is not met.
  void add_lost(uint32_t own, uint32_t other, bool both) const;
  // Adds to the block's update faults those of the awake ones among so many particles of the job.
  void add_finish(const FinishJob& job, uint32_t first, uint32_t count) const;

 private:
  Particle particle(uint32_t p) const;
  std::vector<int64_t> fields(uint32_t p) const;
  void add_end(uint32_t own, uint32_t other, const std::array<double, 3>& apart, uint64_t slot,
               uint64_t bond) const;

  const graph::FixedProgram& program_;
  const graph::Round& round_;
  const KernelRule& rule_;
  const BondSpace& space_;
  const BondList& bonds_;
  const RoundStep& step_;
};

}  // namespace cuboct::emu
