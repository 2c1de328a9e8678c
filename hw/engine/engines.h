// SPDX-License-Identifier: MIT
// The engines that cuboct has: a row each. No other place tells one from another by its name.
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

// The code of an engine that runs in the command's own process.
enum class Here : uint8_t { none, golden, lattice, reference };

struct EngineRow {
  std::string name;
  Here here = Here::none;
  bool bits = true;                          // holds those of the fixed rule
  bool text = false;                         // runs rules that are text, in integers
  bool any_cells = false;                    // takes a pair law in cells that are no cubes
  bool real = false;                         // computes in real numbers, if told to or always
  bool integrators = false;                  // has several
  bool studied = false;                      // by `cuboct explore`
  bool devices = false;                      // runs on GPUs, not on the host's threads
  bool port = false;                         // reaches its machine over a serial port
  bool links = false;                        // that may stall or fail
  bool cycles = false;                       // counts the machine's cycles, always
  bool counts_if_asked = false;              // or where --cycles asks for it
  std::vector<std::string> rule_codes = {};  // how it can run rules that are text; empty: in one way
  std::string unsaved = {};                  // why it leaves no checkpoints; empty: it does
  uint64_t hash_every = 1;                   // steps between two hashes where the user says nothing; 0: none
  std::string program = {};                  // of its own, beside cuboct, where it does not run here
  std::string ranks = {};                    // the program in which several processes share a scene
  std::string needs = {};                    // hint where the program is missing
  EngineCost cost = {};
};

const std::vector<EngineRow>& engines();
// None: an engine from elsewhere.
const EngineRow* find_engine(const std::string& name);
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
