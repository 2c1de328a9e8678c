// SPDX-License-Identifier: MIT
// Every engine behind one call.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "cli/command.h"
#include "model/trace/trace_file.h"

namespace cuboct {

// What to run and what to keep. Steps ascend and are at most `steps`.
struct Request {
  uint64_t steps = 0;
  std::vector<uint64_t> frames;
};

// Engines that hold the bits of the fixed rule.
const std::vector<std::string>& fixed_engines();
// InputError with the nearest spelling where `name` is not in `allowed`.
void check_engine(const std::string& name, const std::vector<std::string>& allowed);

// InputError where faults are asked for wrongly, or of engines that have no links.
void check_faults(const Input& input, const std::vector<std::string>& engines);

// Golden runs here. A run that has to stop is a trace with a stop reason; Ctrl-C gives the trace so far.
// `watch` is called with each state, step 0 included; `keep` takes the frames as they come, which the trace
// holds where nobody does.
Trace run_golden(const Setup& setup, const Request& request,
                 const std::function<void(const State&)>& watch = {},
                 const std::function<void(const State&)>& keep = {});

// An engine at work in a program of its own; its trace goes to `path`.
class RunningEngine {
 public:
  // Throws InputError where the program was not built. `more`: arguments that this engine alone has.
  RunningEngine(const std::string& engine, const Input& input, const Request& request, std::string path,
                bool progress, const std::vector<std::string>& more = {});
  // Waits. Exit code 2 throws InputError (the program told the text already), any other failure
  // std::runtime_error.
  Trace finish();
  // The same, for a trace of which no two frames are to be in memory at once.
  std::unique_ptr<TraceReader> finish_reading();

 private:
  void wait();

  struct State;
  std::shared_ptr<State> state_;
};

// The exit of a command whose engine has told its error already.
class AlreadyTold : public std::exception {
 public:
  explicit AlreadyTold(int exit_code) : exit_code(exit_code) {}
  int exit_code;
};

}  // namespace cuboct
