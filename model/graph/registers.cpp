// SPDX-License-Identifier: MIT
#include "model/graph/registers.h"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

namespace cuboct::graph {
namespace {

size_t index(int n) { return static_cast<size_t>(n); }

// Whose value a node has: its own, or that of another.
std::vector<int> same_values(const Graph& graph, const std::vector<std::vector<int>>& parts) {
  std::vector<int> same(graph.nodes.size());
  std::iota(same.begin(), same.end(), 0);
  for (size_t part = 1; part < parts.size(); ++part)
    for (const int n : parts[part])
      if (const Node& node = graph.nodes[index(n)]; node.op == Op::within)
        same[index(n)] = same[index(node.inputs[0])];
  return same;
}

}  // namespace

Registers registers_for(const Graph& graph, const std::vector<std::vector<int>>& parts,
                        const std::vector<int>& outputs, const std::vector<int>& sizes) {
  const std::vector<int> same = same_values(graph, parts);
  std::vector<int> order;
  for (const auto& part : parts) order.insert(order.end(), part.begin(), part.end());
  // The place in `order` of who reads a value last.
  constexpr size_t kEver = std::numeric_limits<size_t>::max();
  std::vector<size_t> last(graph.nodes.size());
  for (size_t time = 0; time < order.size(); ++time)
    for (const int input : graph.nodes[index(order[time])].inputs) last[index(same[index(input)])] = time;
  for (const int n : outputs) last[index(same[index(n)])] = kEver;

  Registers registers{std::vector<int>(graph.nodes.size(), -1), 0};
  const auto size_of = [&](int n) { return sizes.empty() ? 1 : sizes[index(n)]; };
  const auto more = [&](int size) { return std::exchange(registers.count, registers.count + size); };
  for (const int n : order)
    if (!is_computed(graph.nodes[index(n)])) registers.of[index(n)] = more(size_of(n));
  std::map<int, std::vector<int>> free_of;  // by size
  for (size_t time = 0; time < order.size(); ++time) {
    const int n = order[time];
    const Node& node = graph.nodes[index(n)];
    if (!is_computed(node)) continue;
    if (same[index(n)] != n) {
      registers.of[index(n)] = registers.of[index(same[index(n)])];
      continue;
    }
    std::vector<int>& free = free_of[size_of(n)];
    if (free.empty()) free.push_back(more(size_of(n)));
    registers.of[index(n)] = free.back();
    free.pop_back();
    std::vector<int> done{n};  // nobody may read it
    for (const int input : node.inputs) done.push_back(same[index(input)]);
    std::sort(done.begin(), done.end());
    done.erase(std::unique(done.begin(), done.end()), done.end());
    for (const int input : done)
      if (is_computed(graph.nodes[index(input)]) && last[index(input)] <= time)
        free_of[size_of(input)].push_back(registers.of[index(input)]);
  }
  return registers;
}

}  // namespace cuboct::graph
