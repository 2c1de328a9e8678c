// SPDX-License-Identifier: MIT
// Interprets a round's finish over the particles of a job, as lanes.
#pragma once

#include <vector>

#include "emu/lattice/code/job.h"
#include "emu/lattice/rounds/vector_block.h"
#include "model/graph/program.h"

namespace cuboct::emu {

class FinishPass {
 public:
  static constexpr uint32_t kMostGroups = VectorBlock::kRoom / kGroup;  // of a job

  // `program` and `round` must outlive it.
  FinishPass(const graph::FixedProgram& program, const graph::Round& round);

  // As a FinishCode.
  void run(const FinishJob& job);

 private:
  void write(const FinishJob& job) const;
  void fill(const FinishJob& job);

  const graph::FixedProgram& program_;
  const graph::Round& round_;
  std::vector<int> nodes_, inputs_;
  VectorBlock block_;
  std::vector<uint32_t> who_;  // by lane: indices of those awake
};

}  // namespace cuboct::emu
