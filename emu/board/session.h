// SPDX-License-Identifier: MIT
// A run on a board: loads, runs, reads, and finds the step and the particle of a fault.
#pragma once

#include <cstdint>
#include <vector>

#include "emu/board/host.h"
#include "hw/plan.h"
#include "model/trace/trace.h"

namespace cuboct::emu {

struct BoardRun {
  uint64_t steps = 0;
  std::vector<uint64_t> frames;  // steps whose states are kept, ascending
  uint64_t hash_every = 1;       // steps between two hashes; 0: none. The board stops and is read out at each
  bool progress = false;         // a line per second on standard error
};

// Throws InputError where the board holds another machine than `plan`, or the lattice cannot hold `initial`;
// std::runtime_error where the line or the board fails. A fault is a trace with a stop reason. Ctrl-C gives
// the trace so far.
Trace run_on_board(Host& host, const Plan& plan, const State& initial, const BoardRun& run);

}  // namespace cuboct::emu
