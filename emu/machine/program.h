// SPDX-License-Identifier: MIT
// The command line that the cycle-accurate engines share: scene and arch in, trace out.
#pragma once

#include <functional>
#include <string>

#include "emu/machine/node_model.h"
#include "hw/plan/plan.h"

namespace cuboct {
class Command;
}

namespace cuboct::emu {

struct Machine {
  std::string name;         // "cuboct-systemc"
  std::string description;  // one line
  std::string engine;       // Trace::engine
  bool text = false;        // runs rules that are text
  std::function<void(Command&)> add_options = [](Command&) {};
  std::function<NodeFactory(const Plan&)> nodes;  // called once the plan is known
};

// Parses, runs the SystemC bench, writes the trace; exit codes as of run_program (hw/program/program.h), and
// 1 for a run that is stuck.
int run_machine(int argc, char** argv, const Machine& machine);

}  // namespace cuboct::emu
