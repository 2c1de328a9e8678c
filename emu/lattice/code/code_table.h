// SPDX-License-Identifier: MIT
// A table as compiled code reads it.
#pragma once

#include "emu/lattice/code/job.h"
#include "emu/lattice/rounds/vector_block.h"

namespace cuboct::emu {

// Whether a word holds c1 as a double whose mantissa ends early and c0 below that (kernel_rule.h): then the
// two need no conversion. It is part of the code's shape.
bool is_packed(const FixedTable& table);

// Words of the tables stay where they are as long as the object does.
class CodeTables {
 public:
  void add(const FixedTable& table);
  const CodeTable* data() const { return tables_.data(); }

 private:
  std::vector<VectorTable> words_;
  std::vector<CodeTable> tables_;
};

}  // namespace cuboct::emu
