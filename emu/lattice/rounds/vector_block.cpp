// SPDX-License-Identifier: MIT
#include "emu/lattice/rounds/vector_block.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "emu/lattice/kernel_rule.h"

namespace cuboct::emu {
namespace {

using graph::Node;
using graph::Op;

VectorTable vector_table(const FixedTable& table) {
  VectorTable v;
  v.octaves = table.shape == TableShape::octaves;
  v.degree = table.degree;
  constexpr int64_t kBias = int64_t{1} << 31;
  for (size_t n = 0; n < table.c0.size(); ++n)
    v.words.push_back(static_cast<uint64_t>(table.c1[n] + kBias) << 32 |
                      static_cast<uint64_t>(table.c0[n] + kBias));
  v.c2.assign(table.c2.begin(), table.c2.end());
  // As KernelTable: a double 2^o (1 + m) has o + 1023 above the 52 bits of m.
  v.index_shift = v.octaves ? 52 - table.bin_bits : 2 * table.difference_frac - table.index_bits;
  v.index_bits = table.index_bits;
  v.index_base = v.octaves ? static_cast<int64_t>(1023 + table.first_octave) << table.bin_bits : 0;
  const int below_t = v.index_shift - table.fraction_bits;
  v.t_mask = ((uint64_t{1} << table.fraction_bits) - 1) << below_t;
  v.t_unit = std::ldexp(1.0, -below_t);
  return v;
}

bool computed(const Node& node) { return node.op != Op::constant && node.op != Op::input; }

}  // namespace

VectorBlock::VectorBlock(const graph::Graph& graph, const std::vector<std::vector<int>>& parts,
                         const std::vector<int>& outputs)
    : graph_(graph), place_(graph.nodes.size()) {
  for (const FixedTable& table : graph.tables) tables_.push_back(vector_table(table));

  // When each node is read for the last time, in the order in which all are run.
  constexpr size_t kEver = std::numeric_limits<size_t>::max();
  const auto index = [](int n) { return static_cast<size_t>(n); };
  std::vector<size_t> last(graph.nodes.size());
  std::vector<int> same(graph.nodes.size());  // whose lanes a node has
  for (size_t n = 0; n < same.size(); ++n) same[n] = static_cast<int>(n);
  size_t time = 0;
  for (size_t part = 0; part < parts.size(); ++part)
    for (const int n : parts[part]) {
      const Node& node = graph.nodes[index(n)];
      ++time;
      for (const int input : node.inputs) last[index(same[index(input)])] = time;
      if (part > 0 && node.op == Op::within) same[index(n)] = same[index(node.inputs[0])];
    }
  for (const int n : outputs) last[index(same[index(n)])] = kEver;

  // Places by number first: of those that are free the one that was used last, which is in the cache.
  std::vector<size_t> number(graph.nodes.size());
  std::vector<size_t> free;
  size_t count = 0;
  const auto take = [&](int n) {
    if (free.empty()) free.push_back(count++);
    number[index(n)] = free.back();
    free.pop_back();
  };
  for (const auto& part : parts)
    for (const int n : part)
      if (!computed(graph.nodes[index(n)])) number[index(n)] = count++;
  time = 0;
  for (const auto& part : parts)
    for (const int n : part) {
      const Node& node = graph.nodes[index(n)];
      ++time;
      if (!computed(node) || same[index(n)] != n) continue;
      take(n);
      std::vector<int> done;
      for (const int input : node.inputs) done.push_back(same[index(input)]);
      done.push_back(n);  // nobody may read it
      std::sort(done.begin(), done.end());
      done.erase(std::unique(done.begin(), done.end()), done.end());
      for (const int input : done)
        if (computed(graph.nodes[index(input)]) && last[index(input)] <= time)
          free.push_back(number[index(input)]);
    }

  memory_ = PaddedArray<double>(count * kRoom);
  for (size_t part = 0; part < parts.size(); ++part) {
    parts_.emplace_back();
    for (const int n : parts[part]) {
      const Node& node = graph.nodes[index(n)];
      place_[index(n)] =
          same[index(n)] == n ? memory_.data() + number[index(n)] * kRoom : values(same[index(n)]);
      if (node.op == Op::constant) std::fill_n(values(n), kRoom, static_cast<double>(node.number));
      if (computed(node) && same[index(n)] == n) parts_.back().push_back(step_of(n, part > 0));
    }
  }
}

VectorStep VectorBlock::step_of(int n, bool all_count) {
  const Node& node = graph_.nodes[static_cast<size_t>(n)];
  VectorStep step;
  step.op = node.op;
  step.node = n;
  step.out = values(n);
  for (const int input : node.inputs) step.in.push_back(values(input));
  step.shift = node.shift, step.width = node.width, step.number = node.number;
  step.low = static_cast<double>(node.range.low), step.high = static_cast<double>(node.range.high);
  step.rounds = node.shift > 0;
  step.scale = rounding_factor(node.shift);
  if (node.op == Op::shl) step.scale = std::ldexp(1.0, node.shift);
  if (node.op == Op::floor) step.scale = std::ldexp(1.0, -node.shift);
  if (node.op == Op::check) step.high = std::ldexp(1.0, node.width - 1), step.low = -step.high;
  if (node.op == Op::within && all_count) throw std::logic_error("within has the lanes of its input");
  if (node.op == Op::lookup) {
    step.table = &tables_[static_cast<size_t>(node.table)];
    const Node& law = graph_.nodes[static_cast<size_t>(node.inputs[1])];
    if (law.op == Op::constant && law.number == 0) step.in[1] = nullptr;
    step.shift = graph_.tables[static_cast<size_t>(node.table)].fraction_bits;
    step.scale = rounding_factor(step.shift);
  }
  return step;
}

}  // namespace cuboct::emu
