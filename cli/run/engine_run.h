// SPDX-License-Identifier: MIT
// A run of any engine: in this process, or in a program of its own that leaves a trace.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "cli/command.h"
#include "cli/run/engine_options.h"
#include "hw/program/remote.h"

namespace cuboct {

class EngineRun {
 public:
  // A program starts at once, and its trace goes to `path`; what runs here runs in finish(). Throws
  // InputError where the program was not built. Keeps references to loaded and options. `once`: the trace
  // is read once and dropped.
  EngineRun(const std::string& engine, const Input& input, const Loaded& loaded, const EngineOptions& options,
            RunRequest request, const std::string& path, bool once);

  // As Remote::finish.
  Recorded finish();

 private:
  std::optional<Remote> remote_;
  std::function<Recorded()> here_;
};

// The request's hashes as an engine's row and the options have them.
uint64_t hashes_every(const std::string& engine, const EngineOptions& options);

}  // namespace cuboct
