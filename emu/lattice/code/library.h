// SPDX-License-Identifier: MIT
// A program's rounds compiled by the host's compiler, and kept.
#pragma once

#include <string>
#include <vector>

#include "emu/lattice/code/emit.h"
#include "emu/lattice/code/job.h"
#include "emu/lattice/rounds/vector_block.h"

namespace cuboct::emu {

class CodeLibrary {
 public:
  // Compiles the code unless `directory` already has it, and loads it. `simd`: as LatticeOptions. `program`
  // must outlive it. Throws InputError where there is no compiler, or it fails.
  CodeLibrary(const graph::FixedProgram& program, bool once, const std::string& simd,
              const std::string& directory);

  MeetCode meet(size_t round, Ends ends) const;  // null: the code has none
  // The job's constants, tables, and numbers of types.
  void give_numbers(Job& job) const;

 private:
  void load(const std::string& path, size_t rounds);

  Code code_;
  int types_;
  std::vector<VectorTable> vector_tables_;
  std::vector<CodeTable> tables_;
  std::vector<std::vector<double>> type_constants_, pair_constants_;
  std::vector<const double*> type_pointers_, pair_pointers_;
  std::vector<std::vector<MeetCode>> meet_;  // [round][ends]
};

}  // namespace cuboct::emu
