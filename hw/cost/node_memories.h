// SPDX-License-Identifier: MIT
// The memories of a node in RTL: words, widths, how many of each. Registers and delays are left to
// measurement.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hw/plan/plan.h"

namespace cuboct {

struct NodeMemory {
  std::string holds;   // "own particles"
  uint64_t words = 0;  // >= 1
  int bits = 0;        // of a word
  int copies = 1;
  enum class Kind : uint8_t {
    block,  // answers in the cycle after the question, and asks for a block of memory
    late,   // the same, but any memory will do
    prompt  // answers at once
  } kind = Kind::block;
  int reads = 1;  // ports

  bool operator==(const NodeMemory&) const = default;
};

// The memories of one scene's machines, whatever brick, lanes and pipes they have: of the pair law, without
// its tables, which are of the pipes.
class NodeMemories {
 public:
  // `arch` gives capacity, queue and link; wide memories only.
  NodeMemories(const FixedRule& rule, const Arch& arch, uint32_t particles);
  std::vector<NodeMemory> of(const Cell& brick, int lanes, int pipes) const;

 private:
  FixedRule rule_;  // without its tables
  Arch arch_;
  uint32_t particles_;
  int sum_bits_;  // of a pipe's exact sum of one axis
};

// Of the plan's own machine; of a rule of text with its tables.
std::vector<NodeMemory> memories_of(const Plan& plan);

}  // namespace cuboct
