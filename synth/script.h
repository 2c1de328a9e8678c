// SPDX-License-Identifier: MIT
// The scripts that the tools run.
#pragma once

#include <string>
#include <vector>

#include "synth/target.h"

namespace cuboct::synth {

// yosys: reads the project's modules and elaborates from `top`, into elaborated.json in the directory `out`.
std::string elaborate_script(const std::vector<std::string>& files, const std::string& top,
                             const std::string& out);

struct Synthesis {
  std::vector<std::string> files;
  std::string top;           // to elaborate from
  std::string module, unit;  // yosys's name of the unit's module, and the one it gets in the netlist
  std::string kept;          // a module to keep in the hierarchy, or empty
  bool harness = true;       // out/harness.v is around the unit
  bool counts_only = false;  // cells without names of blocks, no netlist.v, no path
  std::string out;           // directory
};
// yosys: netlist.json and netlist.v, and the longest path to the log. It reads harness.v and, for ecp5,
// read_side.v.
std::string fpga_script(const Synthesis& synthesis, const Target& target);

// yosys: the unit in the cells of a liberty file, flat. abc also puts buffers behind nets that drive much.
std::string asic_script(const Synthesis& synthesis, const std::string& liberty);
// OpenSTA (Tcl): the longest path between registers, and the power where each net changes `activity` times
// per clock.
std::string sta_script(const std::string& liberty, const std::string& netlist, const std::string& top,
                       double period, double activity);

// A 16 x 4 LUT memory of ECP5 as the LUTs that its read side is. Verilog.
std::string read_side_module();

// Shell: from netlist.json to a bitstream and timing.json with nextpnr-ecp5 and ecppack.
std::string place_script(const Target& target, const std::string& top, double frequency, int seed,
                         const std::string& pins);

}  // namespace cuboct::synth
