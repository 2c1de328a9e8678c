// SPDX-License-Identifier: MIT
// Runs one case in golden and in any of the cycle-accurate engines, and compares what they hold.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "emu/machine/loop_bench.h"
#include "hw/plan/setup.h"
#include "model/contract/golden.h"

namespace cuboct::test {

// Golden's run: the state and the order of the slots at each step, and the fault that stopped it.
struct GoldenRun {
  std::vector<State> states;                              // [step]
  std::vector<std::vector<std::vector<uint32_t>>> order;  // [step][cell] ids
  std::optional<RunError> fault;
};
// Of the pair law, or the rule of text that the plan has.
Golden golden_of(const Setup& setup);
GoldenRun run_golden(const Setup& setup, uint64_t steps);

// Options that keep every state and the order of the slots.
emu::RunOptions keep_all(uint64_t steps, double stall_rate = 0, uint64_t stall_seed = 1);

// What a comparison looked at.
struct Compared {
  uint64_t steps = 0, particles = 0, slots = 0, spans = 0;
  std::string difference;  // the first one; empty where all is equal
};
Compared compare(const Plan& plan, const GoldenRun& golden, const emu::RunResult& run);
// Hashes, states, order and every PhaseSpan of two cycle-accurate runs.
Compared compare_cycles(const emu::RunResult& a, const emu::RunResult& b);

}  // namespace cuboct::test
