// SPDX-License-Identifier: MIT
#include "emu/lattice/rounds/pair_parts.h"

#include <algorithm>
#include <iterator>

#include "model/graph/parity.h"

namespace cuboct::emu {
namespace {

using graph::Graph;
using graph::Node;
using graph::Op;

const Node& node_of(const Graph& graph, int n) { return graph.nodes[static_cast<size_t>(n)]; }

}  // namespace

std::vector<int> inputs_of(const Graph& graph, const std::vector<int>& nodes) {
  std::vector<int> inputs;
  std::ranges::copy_if(nodes, std::back_inserter(inputs),
                       [&](int n) { return node_of(graph, n).op == Op::input; });
  return inputs;
}

PairParts::PairParts(const graph::Round& round) : terms(terms_of(round)), outputs(pair_outputs(round)) {
  const std::vector<int> all = needed_by(round.pair, outputs);
  std::vector<int> roots{round.when};
  for (const int n : inputs_of(round.pair, all))
    if (node_of(round.pair, n).source == graph::Source::apart) roots.push_back(n);
  early = needed_by(round.pair, roots);
  std::ranges::set_difference(all, early, std::back_inserter(late));
  const std::vector<graph::Parity> parity = parities_of(round.pair);
  for (const int term : terms) signs.push_back(is_odd(parity[static_cast<size_t>(term)]) ? -1 : 1);
}

bool is_mutual(const graph::Round& round) {
  const std::vector<graph::Parity> parity = parities_of(round.pair);
  const auto mutual = [&](int node) {
    return is_odd(parity[static_cast<size_t>(node)]) || is_even(parity[static_cast<size_t>(node)]);
  };
  return mutual(round.when) && std::ranges::all_of(terms_of(round), mutual);
}

bool is_mutual(const graph::FixedProgram& program) {
  return std::ranges::all_of(program.rounds, [](const graph::Round& round) { return is_mutual(round); });
}

}  // namespace cuboct::emu
