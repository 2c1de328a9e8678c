// SPDX-License-Identifier: MIT
// The stages of a scene, run one after the other: each in a directory of its own, DIR/1-relax, DIR/2-load,
// and each but the first from the last state of the one before.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace cuboct {

struct StageRun {
  std::string scene;
  std::vector<std::string> names;  // of all stages, in order
  std::string only;                // the one to run; empty: all
  std::string from;     // where the first that runs begins; empty: as the scene or the stage before has it
  std::string out;      // DIR
  bool resume = false;  // finished stages stay, and the one that was cut goes on
  bool force = false;
  bool json = false;  // the summary over all
};

struct StageDirectory {
  std::string name, path, from;
  bool resume = false, force = false;
};

// `run` runs one: its exit code, and whether it came to an end that the next can begin with. Returns the exit
// code of all. Throws InputError for a stage that cannot be read before any has begun.
int run_stages(const StageRun& request,
               const std::function<std::pair<int, bool>(const StageDirectory&)>& run);

}  // namespace cuboct
