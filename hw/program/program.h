// SPDX-License-Identifier: MIT
// The command line that all engines' programs share: scene and arch in, trace out.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hw/plan/plan.h"
#include "model/run/record.h"

namespace cuboct {

class Command;

// What a program's command line said.
struct ProgramOptions {
  std::string scene, arch, out;
  std::string stage, from;  // model/run/start.h
  std::optional<uint64_t> steps;
  bool bench = false;
  bool hashes_given = false;
  RunRequest run;
};

// Which of the shared options an engine has.
struct ProgramAbilities {
  bool cycles = false;  // --cycles; where `always_cycles`, phase times come without asking
  bool always_cycles = false;
  bool forces = false;       // --forces
  bool checkpoints = false;  // --checkpoint, --checkpoint-every, --resume
  bool text = false;         // rules that are text
  bool any_cells = false;    // a pair law in cells that are no cubes
  bool real_text = false;    // rules of text in real numbers, as the options say: no integers need hold them
  uint64_t steps = UINT64_MAX;  // that a machine can count
};

class EngineProgram {
 public:
  virtual ~EngineProgram() = default;

  std::string name;         // "cuboct-systemc"
  std::string description;  // one line
  ProgramAbilities abilities;
  bool silent = false;  // prints errors alone: who started the run reads its trace

  virtual void add_options(Command&) {}
  // Before the scene is read. Whether it has done all there is to do.
  virtual bool prepare(ProgramOptions&) { return false; }
  // The scene as the run begins with it.
  virtual void begin(Scene&) {}
  // The request as it will run. References are kept for the run.
  virtual EngineKind kind(Scene& scene, const Plan& plan, const ProgramOptions& options) = 0;
  // Of processes that share a run, one writes and prints.
  virtual bool leads() const { return true; }
  // An error ends this process with this exit code: it has been told.
  virtual void give_up(int) {}
  // Lines of --bench: "name value unit".
  virtual void print_bench(const Scene& scene, const Plan& plan, const Recorded& run);
  // The line that ends a run.
  virtual void print_end(const Plan& plan, const Trace& trace);
};

// Parses, runs, writes the trace. Returns the exit code: 0 done; 1 the run was stopped, interrupted or found
// wrong (a trace is written all the same); 2 the input or the command line is wrong.
int run_program(int argc, char** argv, EngineProgram& program);

// What another program says to one of these, besides what an engine alone has. `steps_file`: where a long
// list of steps may go.
std::vector<std::string> program_arguments(const std::string& scene, const std::string& arch,
                                           const RunRequest& request, const std::string& out,
                                           const std::string& steps_file);

}  // namespace cuboct
