// SPDX-License-Identifier: MIT
// What a netlist takes, by block. Synthesis flattens the hierarchy, as logic and memories are shared across
// its borders, but yosys names each cell after the instance whose net it drives; so every cell belongs to one
// block, and the blocks sum up to the whole.
#pragma once

#include <string>
#include <vector>

#include "synth/elaborate.h"
#include "synth/target.h"

namespace cuboct::synth {

// A block and those in it. Blocks of one source in one block are one row.
struct Block {
  std::string module;           // source name
  uint64_t instances = 1;       // in all of the unit
  Counts counts;                // with all below it
  std::vector<Block> children;  // in the order of names
};

// Reads a netlist (yosys's write_json); `root` is the module of `design` that `netlist_module` was made of.
// Throws std::runtime_error on a cell type that is not known.
Block read_netlist(const std::string& file, const std::string& netlist_module, const Design& design,
                   const std::string& root, const CostOf& cost_of);

// Cells of a whole netlist below `top`, each counted.
Counts count_all(const std::string& file, const std::string& top, const CostOf& cost_of);

}  // namespace cuboct::synth
