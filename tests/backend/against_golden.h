// SPDX-License-Identifier: MIT
// The lattice engine beside golden: everything compared at each step.
#pragma once

#include <string>
#include <vector>

#include "emu/lattice/engine.h"
#include "tests/support/cases.h"

namespace cuboct::test {

// Those of this machine, the widest unit first: "portable" everywhere.
std::vector<emu::LatticeOptions> variants(const Plan& plan);

// What comparisons met, summed over calls.
struct Count {
  uint64_t updates = 0, moves = 0, faults = 0, vectors = 0;
  uint64_t resumed = 0;  // steps with cells at rest after one without
  uint64_t kicks = 0;    // sums that the engine gave before a step
  uint64_t ahead = 0;    // velocities of a program's next step
  emu::LatticeCounters lists;
};

// Runs both up to the case's steps or the fault that golden meets: state, hash, momentum, order of slots,
// number of crossings and faults at each step, and at some the kicks. With ranks each runs golden, and the
// first has all particles.
void compare(const Case& c, const emu::LatticeOptions& options, Count& count);

// The same, whose pair law is a program.
Case as_program(Case c);

// A gas, damped, that at last collides faster than its relative velocities are wide.
Case faulty_gas(uint64_t seed);

}  // namespace cuboct::test
