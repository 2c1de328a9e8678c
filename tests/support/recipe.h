// SPDX-License-Identifier: MIT
// A block on a machine, told in words.
#pragma once

#include <string>

#include "tests/support/block.h"

namespace cuboct::test {

struct Recipe {
  Features features;
  Arch arch;
  Cell periodic{};    // axes that repeat
  bool lone = false;  // particle 0 flies alone along the diagonal, and crosses three faces in one step
  uint64_t steps = 0;
};

// Changes what `words` name, with spaces between them: a member by its name, `speed=0.3`, `link_bits=17`,
// `size=2x1x1`, `two_materials`; also `shared` and `serial` multipliers, a table of `octaves`, halos on
// `arrival`, `retry` and `detect` of links, `no_overlap`, `narrow` memories. Throws std::invalid_argument.
void season(Recipe& recipe, const std::string& words);

// Memories of words of a beat, and what they ask for.
void narrow(Arch& arch);

}  // namespace cuboct::test
