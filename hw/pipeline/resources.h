// SPDX-License-Identifier: MIT
// What a pipeline is made of, read off its schedule.
#pragma once

#include <cstdint>
#include <vector>

#include "hw/pipeline/schedule.h"

namespace cuboct::pipeline {

struct Factors {
  int a = 0, b = 0;  // bits of the factors
  bool operator==(const Factors&) const = default;
};

struct Rom {
  int64_t words = 0;
  int bits = 0;
  bool operator==(const Rom&) const = default;
};

struct Resources {
  int cycles = 0;
  std::vector<Factors> products;  // of at most 18 by 18 bits
  int64_t adder_bits = 0;         // of sums, differences and comparisons
  int64_t choice_bits = 0;        // of choices of one of two, each place of a shift among them
  int64_t register_bits = 0;      // with those behind products and memories, and with valid's
  std::vector<Rom> roms;          // the tables' memories

  int64_t rom_bits() const;  // of all of them
};

Resources resources_of(const graph::Graph& graph, const Schedule& schedule);

}  // namespace cuboct::pipeline
