// SPDX-License-Identifier: MIT
// A pair's graph in the parts in which engines run it: what tells whether the pair counts, then the rest.
#pragma once

#include <vector>

#include "model/graph/program.h"

namespace cuboct::emu {

// Of a pair that stands at its lower particle: whose sums take the terms.
enum class Ends { own, other, both };

struct PairParts {
  explicit PairParts(const graph::Round& round);
  std::vector<int> terms;    // of all sums
  std::vector<int> outputs;  // terms, then what bonds take
  // Nodes that `when` needs, with the differences of positions, and those that the outputs need besides.
  std::vector<int> early, late;
  std::vector<double> signs;  // by term: of the other end, where it is odd or even
};

// Whether `when` and every term are odd or even.
bool is_mutual(const graph::Round& round);
bool is_mutual(const graph::FixedProgram& program);  // each of its rounds

std::vector<int> inputs_of(const graph::Graph& graph, const std::vector<int>& nodes);

}  // namespace cuboct::emu
