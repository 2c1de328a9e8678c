// SPDX-License-Identifier: MIT
// A run of any engine: in this process, or in a program of its own that leaves a trace.
#pragma once

#include <exception>
#include <memory>
#include <optional>
#include <string>

#include "cli/command.h"
#include "cli/engine_options.h"
#include "model/run/record.h"

namespace cuboct {

class EngineRun {
 public:
  // A program starts at once, and its trace goes to `path`; what runs here runs in finish(). Throws
  // InputError where the program was not built. Keeps references to input, loaded and options. `passes`: the
  // trace is read once and dropped.
  EngineRun(const std::string& engine, const Input& input, const Loaded& loaded, const EngineOptions& options,
            RunRequest request, const std::string& path, bool passes);
  ~EngineRun();
  EngineRun(EngineRun&&) noexcept;

  // Waits. A program's exit code 2 throws AlreadyTold, any other failure std::runtime_error. Frames go where
  // the request keeps them.
  Recorded finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// The request's hashes as an engine's row and the options have them.
uint64_t hashes_every(const std::string& engine, const EngineOptions& options);

// The exit of a command whose engine has told its error already.
class AlreadyTold : public std::exception {
 public:
  explicit AlreadyTold(int exit_code) : exit_code(exit_code) {}
  int exit_code;
};

}  // namespace cuboct
