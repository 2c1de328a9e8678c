// SPDX-License-Identifier: MIT
// What a pipeline is made of, read off its schedule.
#pragma once

#include <cstdint>

#include "hw/pipeline/schedule.h"

namespace cuboct::pipeline {

struct Resources {
  int cycles = 0;
  int64_t products = 0;       // of at most 18 by 18 bits
  int64_t adder_bits = 0;     // of sums, differences and comparisons
  int64_t choice_bits = 0;    // of choices of one of two, each place of a shift among them
  int64_t register_bits = 0;  // with those behind products and memories, and with valid's
  int64_t rom_bits = 0;       // of all tables' memories
};

Resources resources_of(const graph::Graph& graph, const Schedule& schedule);

}  // namespace cuboct::pipeline
