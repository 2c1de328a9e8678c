// SPDX-License-Identifier: MIT
// Runs a graph of integers over lanes of doubles, in vectors: golden's numbers wherever doubles hold them all
// (class A of graph::exactness_of). kernel_rule.h has the arithmetic of a rounding.
//
// Lanes have registers of their own (graph::registers_for), so a graph's values stay in the nearest cache.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "emu/lattice/aligned.h"
#include "model/graph/graph.h"

namespace cuboct::emu {

// A FixedTable as vectors read it: a word has c0 below and c1 above, 32 bits each, both plus 2^31.
struct VectorTable {
  bool octaves = false;
  int degree = 1;
  std::vector<uint64_t> words;
  std::vector<double> c2;  // degree 2
  // Of the bits of the argument plus 2^52 (uniform), or of the argument itself (octaves): index = bits >>
  // index_shift, less index_base; t 2^k = bits & t_mask. Where the index is negative, both are 0.
  int index_shift = 0, index_bits = 0;
  int64_t index_base = 0;
  uint64_t t_mask = 0;
  double t_unit = 1;  // 2^-k
};

VectorTable vector_table(const FixedTable& table);

// An operation, ready to run.
struct VectorStep {
  graph::Op op = graph::Op::constant;
  int node = 0;
  double* out = nullptr;
  std::vector<const double*> in;
  int shift = 0, width = 0;
  double scale = 1;          // 2^shift, or the factor of a rounding
  double low = 0, high = 0;  // of the range, or of what a check lets pass: low <= a < high
  const VectorTable* table = nullptr;
  int64_t number = 0;
  bool rounds = false;
  bool both_signs = false;  // of a check: -a is checked too
};

class VectorBlock {
 public:
  static constexpr size_t kRoom = 256;  // lanes

  // `parts` and `outputs` as of registers_for: in parts after the first all lanes count. The graph must
  // outlive the block. `both_signs`: a lane stands for a pair's other end as well, where odd values have the
  // other sign; then the least number of a width, whose negative does not fit, counts as one that does not.
  VectorBlock(const graph::Graph& graph, const std::vector<std::vector<int>>& parts,
              const std::vector<int>& outputs, bool both_signs = false);

  // Lanes are a multiple of kGroup: whoever writes an input repeats one of its lanes to that end.
  double* values(int node) { return place_[static_cast<size_t>(node)]; }
  const double* values(int node) const { return place_[static_cast<size_t>(node)]; }
  static size_t padded(size_t lanes) { return (lanes + kGroup - 1) / kGroup * kGroup; }

  // False where a check of these lanes found what does not fit.
  bool run(size_t part, size_t lanes) const;

 private:
  VectorStep step_of(int node);

  const graph::Graph& graph_;
  bool both_signs_;
  std::vector<VectorTable> tables_;
  std::vector<double*> place_;  // by node; null: it is not run
  PaddedArray<double> memory_;
  std::vector<std::vector<VectorStep>> parts_;
};

}  // namespace cuboct::emu
