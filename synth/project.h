// SPDX-License-Identifier: MIT
// An emitted RTL project, as its project.json describes it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace cuboct::synth {

// Cycles per step.
struct ProjectCycles {
  // Of the busiest node at the scene's start (hw/cost/cycles.h), of a pair law.
  std::optional<uint64_t> expected;
  // Exact, over the first `steps` steps; steps = 0: nobody counted.
  double mean = 0;
  uint64_t most = 0, steps = 0;

  std::optional<double> best() const { return steps > 0 ? mean : std::optional<double>(expected); }
};

struct Project {
  std::string directory;
  std::string plan;  // hash, 16 hexadecimal digits
  uint64_t nodes = 0, particles = 0;
  int capacity = 0;
  ProjectCycles cycles;
  std::vector<std::string> files;  // below the directory, in the order to read
  std::string prefix;              // of its modules, "left_" (hw/rtl/rtl_prefix.h)
};

// Throws InputError: no such directory, no project, an entry that is missing or of another kind, a file that
// is not there.
Project read_project(const std::string& directory);

// The files, top module and pins of DIR/board.
struct Board {
  std::vector<std::string> files;  // below the project's directory, all that the top needs
  std::string top;
  std::string pins;  // "board/pins.pcf", "board/pins.lpf"
};
Board read_board(const Project& project);

}  // namespace cuboct::synth
