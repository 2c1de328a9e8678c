// SPDX-License-Identifier: MIT
// The rule in doubles over the same scene: the same curves and frames, no bits to compare.
#pragma once

#include <vector>

#include "cli/command.h"
#include "cli/items.h"
#include "model/frames.h"
#include "model/trace.h"

namespace cuboct {

struct ReferenceRun {
  Trace trace;  // curves, no hashes
  std::vector<Frame> frames;
  Items summary;
  bool failed = false;  // the watch found something
};

// Semi-implicit Euler, as the fixed engines. Ctrl-C gives the run so far.
ReferenceRun run_reference(const Loaded& loaded, uint64_t steps, const std::vector<uint64_t>& frame_steps,
                           const std::vector<uint64_t>& probe_steps, bool watch);

}  // namespace cuboct
