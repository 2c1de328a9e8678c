// SPDX-License-Identifier: MIT
// Prints a program's rounds as C++ for vectors (lanes.h): one statement for each node.
#pragma once

#include <string>
#include <vector>

#include "emu/lattice/rounds/pair_parts.h"

namespace cuboct::emu {

// Tables: of each round those of the pair's graph, then those of the finish.
struct Code {
  std::string text;
  std::vector<double> constants;  // CodeNumbers::constants
  std::vector<int64_t> seeds;
};

// A function that the text defines, a MeetCode: of this round, and these ends.
std::string name_of(size_t round, Ends ends);

// `once`: terms are made once for both ends, so Ends::both is there and Ends::other is not.
Code code_of(const graph::FixedProgram& program, bool once);

}  // namespace cuboct::emu
