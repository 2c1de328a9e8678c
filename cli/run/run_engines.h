// SPDX-License-Identifier: MIT
// One scene in several engines, and what is behind two hashes that differ.
#pragma once

#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/run/engine_options.h"
#include "model/run/record.h"

namespace cuboct {

// What all engines of a crosscheck share. `directory`: where programs leave their traces, <engine>.h5.
struct SharedRun {
  const Input& input;
  const EngineOptions& choice;
  const Loaded& loaded;
  std::string directory;
};

// Programs run beside the engines that run here. Lattice counts cycles where another engine does, but for
// links that stall or fail. In the order of the engines.
std::vector<Trace> run_all(const SharedRun& run, const std::vector<std::string>& engines,
                           const RunRequest& request);

// The particle and field behind two hashes that differ: both engines again, up to that step, with the states
// before and after it.
std::string explain(const SharedRun& run, const std::string& engine_a, const std::string& engine_b,
                    uint64_t step);

}  // namespace cuboct
