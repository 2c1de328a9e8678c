// SPDX-License-Identifier: MIT
// The commands of `cuboct`. Each adds itself to the command line and leaves its exit code: 0 done, 1 the run
// found what it looks for wrong, 2 (by InputError) the input is wrong.
#pragma once

#include <string>

#include "hw/setup.h"

// Its header costs each file that reads it four seconds: those that add options do.
namespace CLI {
class App;
class Validator;
}  // namespace CLI

namespace cuboct {

void add_new(CLI::App& app, int& exit_code);
void add_check(CLI::App& app, int& exit_code);
void add_run(CLI::App& app, int& exit_code);
void add_crosscheck(CLI::App& app, int& exit_code);
void add_emit(CLI::App& app, int& exit_code);
void add_synth(CLI::App& app, int& exit_code);
void add_explore(CLI::App& app, int& exit_code);
void add_fit(CLI::App& app, int& exit_code);
void add_elastic(CLI::App& app, int& exit_code);
void add_energy(CLI::App& app, int& exit_code);
void add_boards(CLI::App& app, int& exit_code);
void add_bench(CLI::App& app, int& exit_code);
void add_picture(CLI::App& app, int& exit_code);
void add_report(CLI::App& app, int& exit_code);
void add_multiscale(CLI::App& app, int& exit_code);
void add_pitch(CLI::App& app, int& exit_code);
void add_stability(CLI::App& app, int& exit_code);

// What `cuboct --version` prints.
std::string version_text();

// What every command that reads a scene takes.
struct Input {
  std::string scene;
  std::string arch;       // empty: the defaults
  double stall_rate = 0;  // share of cycles in which a link of a cycle-accurate engine passes nothing
  uint64_t stall_seed = 1;
  std::string stage{}, from{};  // model/run/start.h
  bool looks_only = false;      // the same
  std::string faults{};  // on the links of such an engine: hw/link_code.h, read_fault_share; empty: none
  uint64_t fault_seed = 1;

  void add_to(CLI::App& command);
  void add_start_to(CLI::App& command);   // --stage, --from
  void add_stalls_to(CLI::App& command);  // for commands that run such engines
};

// Accepts 0 ... 2^63 - 1, in decimal digits alone.
CLI::Validator whole_number();

// A scene with its machine.
struct Loaded {
  Scene scene;
  Setup setup;
};
Loaded load(const Input& input);
// The same without `setup.initial`: for engines that take their particles one by one, and scenes of which a
// second copy would not fit.
Loaded load_plan(const Input& input);

}  // namespace cuboct
