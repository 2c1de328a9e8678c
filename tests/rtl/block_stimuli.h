// SPDX-License-Identifier: MIT
// What the blocks are driven with, and what the model says of it. Candidates are drawn at random, more
// densely where something changes; from millions of them those are kept that fill the classes, beside
// ordinary ones.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "hw/plan/plan.h"

namespace cuboct::test {

// A pair that passes the planar test, and what the pipe's stages have to hold of it.
struct PairStimulus {
  Int3 x_i{}, v_i{}, x_j{}, v_j{};
  int type_i = 0, type_j = 0;
  Int3 d{};
  uint64_t r2 = 0;
  int64_t q = 0, force = 0, damped = 0, s = 0;  // inside only
  PairResult result;
};

struct UpdateStimulus {
  Int3 sum{}, x{}, v{}, u{};
  Int3 seen{};  // the leading P bits of x
  int type = 0;
  FinishResult result;
};

// How many stimuli show what; a stimulus may show several things.
using Classes = std::map<std::string, uint64_t>;

struct PairStimuli {
  std::vector<PairStimulus> list;
  Classes count;                     // of every class that the plan can show
  std::vector<uint64_t> force_bins;  // pairs inside per entry of the table, as far as the cutoff
  std::vector<uint64_t> damp_bins;   // likewise; empty if undamped
};
PairStimuli pair_stimuli(const FixedRule& rule, uint64_t seed);

struct UpdateStimuli {
  std::vector<UpdateStimulus> list;
  Classes count;
};
// `sum_bits`: of the exact sum that comes in.
UpdateStimuli update_stimuli(const FixedRule& rule, int sum_bits, uint64_t seed);

// r2 of each entry's first and last place, of halves between, and random ones.
std::vector<uint64_t> table_stimuli(const FixedTable& table, uint64_t seed);

// Whether n is a sum of three squares (Legendre): not 4^a (8b + 7).
bool three_squares(uint64_t n);

}  // namespace cuboct::test
