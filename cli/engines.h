// SPDX-License-Identifier: MIT
// The engines that `cuboct` has: a row each.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cuboct {

// What a run costs on a machine of today.
struct EngineCost {
  double neighbour_time = 0;                     // s per particle, step and neighbour; 0: no rate is known
  double cell_time = 0;                          // s per cell and step
  bool threads = false;                          // that share the work
  double particle = 0, neighbour = 0, cell = 0;  // bytes
};

struct EngineRow {
  std::string name;
  bool bits = true;              // holds those of the fixed rule
  bool real = false;             // computes in real numbers, if told to or always
  bool links = false;            // that may stall or fail
  bool cycles = false;           // counts the machine's cycles, always
  bool counts_if_asked = false;  // or where --cycles asks for it
  bool saves = false;            // leaves checkpoints
  uint64_t hash_every = 1;       // steps between two hashes where the user says nothing; 0: none
  std::string program = {};      // of its own, beside cuboct; empty: runs here
  std::string needs = {};        // hint where the program is missing
  EngineCost cost = {};
};

const std::vector<EngineRow>& engines();
// InputError with the nearest spelling where no row of `allowed` has the name. `bits`: only those that hold
// the fixed rule's.
const EngineRow& engine_row(const std::string& name, bool bits = false);

// "golden, lattice or gpu": those of which it is true.
template <typename Has>
std::vector<std::string> engines_that(Has has) {
  std::vector<std::string> names;
  for (const EngineRow& row : engines())
    if (has(row)) names.push_back(row.name);
  return names;
}

}  // namespace cuboct
