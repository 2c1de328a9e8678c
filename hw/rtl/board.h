// SPDX-License-Identifier: MIT
// FPGA boards that hold a plan's lattice behind a serial line: what they are, and what host and board must
// agree on.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hw/plan/plan.h"

namespace cuboct {

struct Board {
  std::string name;    // "icebreaker"
  std::string title;   // with the FPGA
  int clock_hz = 0;    // of the board's oscillator, and of the lattice
  std::string pins;    // file name
  std::string target;  // of `cuboct synth`
  std::string build;   // commands from board/files.f to a bitstream, run in the project's directory
  std::string flash;   // commands that load it
};

// In the order of names.
const std::vector<Board>& boards();
// Throws InputError with the nearest spelling.
const Board& board_of(const std::string& name);

// The bus wrappers that can be emitted: "axi4lite", "wishbone".
const std::vector<std::string>& buses();

// What to put around the lattice: a board's top, or a bus's wrapper; empty names: nothing.
struct BoardChoice {
  std::string name;
  int baud = 1000000;
  bool velocities = true;  // a host may set those of moved_types()
  std::string bus = {};
};

// Above a fault's id and cell, of a rule of text: the port fault_stage_o of its nodes.
inline constexpr int kStageBits = 4;

// Length of a bit on the serial line in 1/16 clocks of the board; at least 4 clocks, or InputError.
int bit_clocks16(const Board& board, int baud);

// The types, ascending, whose velocity a host may set between runs: those held or moved, by place or by
// force.
std::vector<int> moved_types(const FixedRule& rule);
// Whether a host may set any: never of a rule of text, whose nodes have them as constants.
bool sets_velocities(const Plan& plan, const BoardChoice& choice);
// The plan's hash with the velocities of these types zero: equal for plans that a bitstream with such
// velocities can run.
uint64_t machine_hash(const Plan& plan);

}  // namespace cuboct
