// SPDX-License-Identifier: MIT
#include "model/graph/registers.h"

#include <algorithm>
#include <limits>
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

// Registers that nobody uses, alone and in pairs.
class Free {
 public:
  explicit Free(int& count) : count_(count) {}
  void give(int first, int size) {
    if (size > 0) (size == 1 ? alone_ : pairs_).push_back(first);
  }
  int take(int size) {
    if (size == 0) return -1;
    std::vector<int>& free = size == 1 ? alone_ : pairs_;
    if (!free.empty()) return take(free);
    if (size == 1 && !pairs_.empty()) {
      const int first = take(pairs_);
      alone_.push_back(first + 1);
      return first;
    }
    return std::exchange(count_, count_ + size);
  }

 private:
  static int take(std::vector<int>& free) {
    const int last = free.back();
    free.pop_back();
    return last;
  }
  int& count_;
  std::vector<int> alone_, pairs_;
};

// `reused`: inputs give their registers back.
Registers allocated(const Graph& graph, const std::vector<std::vector<int>>& parts,
                    const std::vector<int>& outputs, const std::vector<int>& sizes, bool reused) {
  const std::vector<int> same = same_values(graph, parts);
  // The time at which a value is read last.
  constexpr size_t kEver = std::numeric_limits<size_t>::max();
  std::vector<size_t> last(graph.nodes.size());
  size_t time = 0;
  for (const auto& part : parts)
    for (const int n : part) {
      for (const int input : graph.nodes[index(n)].inputs) last[index(same[index(input)])] = time;
      ++time;
    }
  for (const int n : outputs) last[index(same[index(n)])] = kEver;

  Registers registers{std::vector<int>(graph.nodes.size(), -1), 0};
  Free free(registers.count);
  const auto fill_in = [&](const std::vector<int>& part) {
    for (const int n : part)
      if (!is_computed(graph.nodes[index(n)])) registers.of[index(n)] = free.take(sizes[index(n)]);
  };
  if (!reused)
    for (const auto& part : parts) fill_in(part);
  time = 0;
  for (const auto& part : parts) {
    if (reused) fill_in(part);
    for (const int n : part) {
      const Node& node = graph.nodes[index(n)];
      const size_t now = time++;
      if (!is_computed(node)) continue;
      if (same[index(n)] != n) {
        registers.of[index(n)] = registers.of[index(same[index(n)])];
        continue;
      }
      registers.of[index(n)] = free.take(sizes[index(n)]);
      std::vector<int> done{n};  // nobody may read it
      for (const int input : node.inputs) done.push_back(same[index(input)]);
      std::sort(done.begin(), done.end());
      done.erase(std::unique(done.begin(), done.end()), done.end());
      for (const int input : done)
        if ((reused || is_computed(graph.nodes[index(input)])) && last[index(input)] <= now)
          free.give(registers.of[index(input)], sizes[index(input)]);
    }
  }
  return registers;
}

}  // namespace

Registers registers_for(const Graph& graph, const std::vector<std::vector<int>>& parts,
                        const std::vector<int>& outputs) {
  return allocated(graph, parts, outputs, std::vector<int>(graph.nodes.size(), 1), false);
}

Registers registers_for(const Graph& graph, const std::vector<std::vector<int>>& parts,
                        const std::vector<int>& outputs, const std::vector<int>& sizes) {
  return allocated(graph, parts, outputs, sizes, true);
}

}  // namespace cuboct::graph
