// SPDX-License-Identifier: MIT
// A server that shows a run until Ctrl-C: one that is over, one of another process, or one that it starts.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cli/answer.h"
#include "cli/view/steered_scene.h"

namespace cuboct {

struct WatchAsked {
  std::string directory;              // of the run
  uint64_t every = 1, particles = 1;  // StoredRun
  uint16_t port = 0;
  bool part = false;       // `particles` was asked for
  bool opens = true;       // in a browser, where there is a display
  bool while_run = false;  // ends with the run, unless somebody has opened the page
  Answer answer;
};

// The exit code.
int watch_directory(const WatchAsked& asked);
// Two runs that are over, the other in that directory.
int watch_two(const WatchAsked& asked, const std::string& with);
// Starts `cuboct run` with these words, which is to leave its run in the directory. The exit code is that of
// the run, if it failed before its first step.
int watch_run(const WatchAsked& asked, const std::vector<std::string>& words);
// The same of a scene that is steered, part by part; `words` are to be followed by those of the stage.
int watch_steered(const WatchAsked& asked, SteeredScene& scene, const std::vector<std::string>& words);

}  // namespace cuboct
