// SPDX-License-Identifier: MIT
// The commands of `cuboct`. Each adds itself to the command line and leaves its exit code: 0 done, 1 the run
// found what it looks for wrong, 2 (by InputError) the input is wrong.
#pragma once

#include <string>

#include "hw/plan/setup.h"

namespace cuboct {

class Command;

void add_new(Command& app, int& exit_code);
void add_check(Command& app, int& exit_code);
void add_run(Command& app, int& exit_code);
void add_crosscheck(Command& app, int& exit_code);
void add_emit(Command& app, int& exit_code);
void add_synth(Command& app, int& exit_code);
void add_explore(Command& app, int& exit_code);
void add_fit(Command& app, int& exit_code);
void add_elastic(Command& app, int& exit_code);
void add_energy(Command& app, int& exit_code);
void add_boards(Command& app, int& exit_code);
void add_bench(Command& app, int& exit_code);
void add_curves(Command& app, int& exit_code);
void add_measure(Command& app, int& exit_code);
void add_picture(Command& app, int& exit_code);
void add_report(Command& app, int& exit_code);
void add_state(Command& app, int& exit_code);
void add_view(Command& app, int& exit_code);
void add_multiscale(Command& app, int& exit_code);
void add_pitch(Command& app, int& exit_code);
void add_stability(Command& app, int& exit_code);

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
  std::string scene_path{};     // of which `scene` is a copy; empty: of none
  std::string faults{};  // on the links of such an engine: hw/arch/link_code.h, read_fault_share; empty: none
  uint64_t fault_seed = 1;

  void add_to(Command& command);
  void add_start_to(Command& command);   // --stage, --from
  void add_stalls_to(Command& command);  // for commands that run such engines
};

// What is wrong with a value that is not of 0 ... 2^63 - 1 in decimal digits alone: of Option::check.
std::string whole_number(const std::string& text);

// A scene with its machine.
struct Loaded {
  Scene scene;
  Setup setup;
};
Loaded load(const Input& input);
// The same, with rules of text: a plan with their program, and their fields as they begin.
Loaded load_machine(const Input& input);
// InputError where no machine runs the scene's rule as the arch asks.
void check_machine(const Loaded& loaded);
// The same without `setup.initial`, for engines that take their particles one by one, and scenes of which a
// second copy would not fit; with the plan that `engine` needs, or what stands for one (scene_plan_of, as is
// `real`). None is named: the engine that the scene asks for.
Loaded load_plan(const Input& input, const std::string& engine = "", bool real = false);

}  // namespace cuboct
