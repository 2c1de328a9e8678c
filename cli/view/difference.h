// SPDX-License-Identifier: MIT
// Where two runs of one body first differ, of the frames that both kept.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cli/view/stored_run.h"

namespace cuboct {

struct RunDifference {
  // What was compared with what: "integers, bit by bit", ...
  std::string how;
  // The first difference, by frame, id and field; none: all frames are equal.
  struct First {
    size_t frame = 0;  // of those that are shown
    uint64_t step = 0;
    uint32_t particle = 0;
    std::string field;             // "position x"
    std::string unit;              // "1" in reduced units
    std::string si_a, si_b;        // empty: a number without a meaning in SI
    std::string bits_a, bits_b;    // in groups of four
    std::string words_a, words_b;  // the same as decimal numbers, with the cell of a place; empty of doubles
  };
  std::optional<First> first;
  std::vector<size_t> particles;  // of each frame those that differ
  // What is recorded besides: the first state hash that differs, steps done, a fault, cycles; empty: nothing
  // differs.
  std::string besides;
  uint64_t hashes = 0;  // steps at which both runs hashed their states, and were compared
  std::string json() const;
};

// InputError where the two are no runs of one body, with one time step.
void check_comparable(const StoredRun& a, const StoredRun& b);
// Of two whose frames are of the same steps.
RunDifference difference_of(const StoredRun& a, const StoredRun& b);

}  // namespace cuboct
