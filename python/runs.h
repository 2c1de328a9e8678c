// SPDX-License-Identifier: MIT
// Whole runs, in any engine: here, or in a program of its own.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/run/engine_options.h"
#include "model/run/record.h"
#include "python/page.h"
#include "python/sources.h"

namespace cuboct::python {

struct RunAsked {
  std::string engine;  // empty: the one that the scene asks for
  EngineOptions options;
  std::optional<uint64_t> steps;       // the scene's
  std::optional<uint64_t> keep_every;  // states; nothing: the last alone
  bool anyway = false;                 // though it needs more memory than is free
  std::string leave;  // a directory for the last state, where another run may begin; empty: none
};

// A state in SI, by ids.
struct Kept {
  uint64_t step = 0;
  Body body;
  Fields fields;
};

struct WholeRun {
  std::shared_ptr<const Scene> scene;
  Recorded recorded;  // without its frames
  std::vector<Kept> kept;
  double dt = 0;  // s
  std::shared_ptr<Shown> shown;
  std::string summary;  // as `cuboct run --json` prints it
};

// Throws Interrupted. A run that a fault stopped tells so in its trace.
WholeRun run(const Sources& sources, const RunAsked& asked);

struct Comparison {
  bool matched = false;
  std::string text;                                            // of one line or more
  std::optional<uint64_t> step;                                // of the first difference, where it has one
  std::optional<std::pair<std::string, std::string>> engines;  // that differ
  uint64_t updates = 0, steps = 0;                             // compared
  bool reached = false, stopped = false;  // by the scene's `until`; by a fault, all alike
};

// `leave`: as RunAsked has it, where all engines matched.
Comparison crosscheck(const Sources& sources, const std::vector<std::string>& engines,
                      const EngineOptions& options, std::optional<uint64_t> steps, const std::string& leave);

}  // namespace cuboct::python
