// SPDX-License-Identifier: MIT
#include "emu/lattice/rounds/vector_block.h"

#include <algorithm>
#include <cmath>

#include "emu/lattice/kernel_rule.h"
#include "model/graph/registers.h"

namespace cuboct::emu {

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

VectorBlock::VectorBlock(const graph::Graph& graph, const std::vector<std::vector<int>>& parts,
                         const std::vector<int>& outputs, bool both_signs)
    : graph_(graph), both_signs_(both_signs), place_(graph.nodes.size()) {
  for (const FixedTable& table : graph.tables) tables_.push_back(vector_table(table));
  const graph::Registers registers = registers_for(graph, parts, outputs);
  memory_ = PaddedArray<double>(static_cast<size_t>(registers.count) * kRoom);
  for (size_t n = 0; n < place_.size(); ++n)
    if (registers.of[n] >= 0) place_[n] = memory_.data() + static_cast<size_t>(registers.of[n]) * kRoom;
  for (size_t part = 0; part < parts.size(); ++part) {
    parts_.emplace_back();
    for (const int n : parts[part]) {
      const Node& node = graph.nodes[static_cast<size_t>(n)];
      if (node.op == Op::constant) std::fill_n(values(n), kRoom, static_cast<double>(node.number));
      if (is_computed(node) && !(part > 0 && node.op == Op::within)) parts_.back().push_back(step_of(n));
    }
  }
}

VectorStep VectorBlock::step_of(int n) {
  const Node& node = graph_.nodes[static_cast<size_t>(n)];
  VectorStep step;
  step.op = node.op;
  step.node = n;
  step.out = values(n);
  for (const int input : node.inputs) step.in.push_back(values(input));
  step.shift = node.shift, step.width = node.width, step.number = node.number;
  step.low = static_cast<double>(node.range.low), step.high = static_cast<double>(node.range.high);
  step.rounds = node.shift > 0;
  step.both_signs = both_signs_;
  step.scale = rounding_factor(node.shift);
  if (node.op == Op::shl) step.scale = std::ldexp(1.0, node.shift);
  if (node.op == Op::floor) step.scale = std::ldexp(1.0, -node.shift);
  if (node.op == Op::check) step.high = std::ldexp(1.0, node.width - 1), step.low = -step.high;
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
