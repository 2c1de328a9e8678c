// SPDX-License-Identifier: MIT
// The fixed gpu engine beside golden: hashes of every step, states and faults.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "emu/gpu/engine.h"
#include "tests/support/cases.h"

namespace cuboct::test {

// Golden's run up to its fault, if it meets one.
struct GoldenPath {
  std::vector<uint64_t> hashes;  // after each step
  State last;                    // before the fault, or after all steps
  std::optional<RunError> fault;
};
GoldenPath golden_path(const Case& c);

// How a run is cut into calls of advance.
enum class Cut { whole, single, random };

// What comparisons met, summed over calls.
struct Met {
  uint64_t runs = 0, updates = 0, faults = 0, crossed = 0;
  uint64_t lists = 0, golden_steps = 0, halo = 0;
};

// All of a run: `seed` draws the cuts and what is read in between.
void compare(const Case& c, const GoldenPath& golden, const gpu::Options& options, Cut cut, uint64_t seed,
             Met& met);

// The most slabs that a plan's longest axis has the planes for, up to 4.
int most_slabs(const Plan& plan);

// A bar, most often with room for four slabs along one axis, whatever else a rule and an arch may ask for;
// InputError where they do not go together.
Case random_bar(uint64_t seed);

}  // namespace cuboct::test
