// SPDX-License-Identifier: MIT
// The command line that the cycle-accurate engines share: scene and arch in, trace out.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

#include "emu/machine/node_model.h"
#include "hw/plan.h"

namespace cuboct::emu {

struct Program {
  std::string name;         // "cuboct-systemc"
  std::string description;  // one line
  std::string engine;       // Trace::engine
  std::function<void(CLI::App&)> add_options = [](CLI::App&) {};
  std::function<NodeFactory(const Plan&)> nodes;  // called once the plan is known
};

// Parses, runs the SystemC bench, writes the trace. Returns the exit code: 0 done, 1 the run stopped on a
// fault or is stuck (a trace that stopped on a fault is written all the same), 2 the input or the command
// line is wrong.
int run_program(int argc, char** argv, const Program& program);

}  // namespace cuboct::emu
