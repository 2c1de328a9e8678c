// SPDX-License-Identifier: MIT
// The stages of a scene, run one after the other: each in a directory of its own, DIR/1-relax, DIR/2-load,
// and each but the first from the last state of the one before.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "model/scene/scene.h"

namespace cuboct {

struct StageRun {
  std::string scene;
  std::vector<StageName> names;  // of all stages, in order
  std::string only;              // the one to run, or one whose parts are all to run; empty: all
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

// The stages to take of `names`: all, one, or the parts of one. Throws InputError where `only` is none of
// them.
struct StageRange {
  size_t first, end;
};
StageRange stages_to_take(const std::string& scene, const std::vector<StageName>& names,
                          const std::string& only);

// "2-load": of its directory, and above its summary.
std::string stage_title(const std::vector<StageName>& names, size_t k);

// The directory below `out` with whose last state stage k > 0 begins: that of the stage before, or of the
// part in which its `until` held.
std::string stage_start(const std::string& out, const std::vector<StageName>& names, size_t k);

// `run` runs one: its exit code, and whether it came to an end that the next can begin with. Returns the exit
// code of all. Throws InputError for a stage that cannot be read before any has begun.
int run_stages(const StageRun& request,
               const std::function<std::pair<int, bool>(const StageDirectory&)>& run);

}  // namespace cuboct
