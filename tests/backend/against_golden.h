// SPDX-License-Identifier: MIT
// The lattice engine beside golden: everything compared at each step.
#pragma once

#include <string>
#include <vector>

#include "emu/lattice/engine.h"
#include "tests/support/cases.h"

namespace cuboct::test {

struct Variant {
  std::string simd;
  int threads;
  bool quiescence;
};

// Those of this machine, the widest unit first: "portable" everywhere.
std::vector<Variant> variants(const Plan& plan);
std::string name(const Variant& v);

// What comparisons met, summed over calls.
struct Count {
  uint64_t updates = 0, moves = 0, faults = 0, vectors = 0;
  uint64_t resumed = 0;  // steps with nodes at rest after one without
  emu::LatticeCounters lists;
};

// Runs both up to the case's steps or the fault that golden meets: state, hash, momentum, order of slots,
// number of crossings and faults at each step.
void compare(const Case& c, const Variant& variant, Count& count);

}  // namespace cuboct::test
