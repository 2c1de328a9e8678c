// SPDX-License-Identifier: MIT
// The clock of a netlist that is not placed: the delays of its cells and the average ones of its wires
// (delays.h) on its longest path from register to register, which OpenSTA finds. It writes for OpenSTA a
// library of the cells that occur (liberty), the netlist flat and with short names (Verilog), its wires'
// delays (SDF).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "synth/delays.h"
#include "synth/report.h"

namespace cuboct::synth {

// A cell of the path, and the wire into it.
struct Hop {
  std::string cell;  // with its instance's path, as the netlist names it
  std::string type;
  double wire = 0,
         delay =
             0;  // ns, of the wire before it and of itself (the first: from the clock; the last: its setup)
};

// The longest path to one register.
struct Path {
  double total = 0;  // ns, with clock to output and setup
  std::vector<Hop> hops;

  double wires() const;  // ns of `total`
};

// A cell of the flat netlist. Nets are numbers; constants are none.
struct TimedCell {
  struct Pin {
    std::string name;
    int net;
    bool input;
  };
  std::string name, type;
  const CellDelays* delays;
  std::vector<Pin> pins;
};

// The inputs of OpenSTA, and the names of what it will talk of.
class Timer {
 public:
  // `netlist`: yosys's write_json; flat from `top` on. Throws std::runtime_error where a register's cell has
  // no delays.
  Timer(const std::string& netlist, const std::string& top, const Delays& delays);

  std::string library() const;  // liberty
  std::string netlist() const;  // Verilog
  std::string wires() const;    // SDF
  // Tcl: the longest paths to `ends` different registers; the files are in the directory `out`.
  static std::string script(const std::string& out, const std::vector<std::string>& clocks, size_t ends);
  std::vector<std::string> clocks() const;
  // The paths in its log, the longest first.
  std::vector<Path> read(const std::string& log) const;

 private:
  const Delays& delays_;
  std::vector<TimedCell> cells_;
  std::vector<int> clocks_;  // nets
};

// The block that a cell stands in, by its instance below the unit ("u_core.u_pipe"; of the unit itself: "."),
// or "harness".
std::string block_of(const std::string& cell);

// Of paths as Timer::read gives them; nothing of none.
std::optional<Estimate> summary(const std::vector<Path>& paths, const Delays& delays);

}  // namespace cuboct::synth
