// SPDX-License-Identifier: MIT
// The bench without the SystemC kernel: the same nodes, stalls and collector in a plain loop. For property
// tests, of which one process can run many (SystemC elaborates once per process), and as the second opinion
// on the SystemC wiring.
#pragma once

#include "emu/machine/collector.h"

namespace cuboct::emu {

struct RunResult {
  Trace trace;
  std::vector<std::vector<std::vector<uint32_t>>> order;  // [step][node] ids in slot order, if kept
  FaultCounts faults;
  FaultPlace first_fault;
};

// Throws RunError for an initial state beyond a capacity, std::runtime_error for a run that is stuck
// or whose node fails.
RunResult run_loop_bench(const Plan& plan, const State& initial, const RunOptions& options,
                         const NodeFactory& factory, const std::string& engine);

// Faces of a physical node that have a neighbour.
uint8_t links_of(const Plan& plan, uint32_t node);

// "node 3 (1,0,1)": with its cell, or the lowest one of its brick.
std::string node_text(const Plan& plan, uint32_t node);

// The text that names the waiting nodes; `doing` by node.
std::string stuck_text(const Plan& plan, uint64_t cycle, uint64_t patience,
                       const std::vector<std::string>& doing);

}  // namespace cuboct::emu
