// SPDX-License-Identifier: MIT
// From an emitted project to what it takes on a target: elaborate, synthesise, place, read what the tools
// say.
#pragma once

#include <string>

#include "synth/report.h"
#include "synth/tool.h"

namespace cuboct::synth {

struct Request {
  std::string directory;      // of the project
  std::string target;         // a name of targets()
  std::string unit = "node";  // node, lattice, board, or any block: "pipe", "fifo#2"
  int seed = 1;               // of the placer
  double frequency = 0;       // MHz that placing aims at; 0: the target's
  bool place = true;          // else the netlist is all: seconds instead of minutes
  std::string timing;  // a report of nextpnr, made elsewhere from the netlist that a run before this one left
  std::string liberty;    // asic: standard cells; empty: osu018 of Debian's qflow-tech-osu018
  double activity = 0.1;  // asic: changes of each net per clock, for power
};

// What is said meanwhile.
struct Told {
  Say says = [](const std::string&) {};   // what is being done; the next takes its place
  Say tells = [](const std::string&) {};  // lines that stay
};

// Where the results of a target and a unit are: DIR/synth/TARGET/UNIT.
std::string results_directory(const Request& request);

// Everything that a run leaves lies in results_directory, which appears whole at its end: report.json,
// table.txt, logs, netlists, scripts, bitstream. A tool that fails leaves what there is in UNIT.failed beside
// it. Throws InputError (a tool is missing, the unit does not fit, ...), ToolFailed, Interrupted. Stages that
// ended are kept in the user's cache directory, by all that they are made of, and not made again.
Report synthesise(const Request& request, const Told& told = {});

}  // namespace cuboct::synth
