// SPDX-License-Identifier: MIT
// A program's rounds compiled by the host's compiler, and kept.
#pragma once

#include <string>
#include <vector>

#include "emu/lattice/code/code_table.h"
#include "emu/lattice/code/emit.h"

namespace cuboct::emu {

// Code that was compiled when the program was built: in this directory beside it (part_path).
inline constexpr const char* kKeptCode = "rules";
// `simd`: as LatticeOptions. `once`: as code_of.
bool is_kept(const graph::FixedProgram& program, bool once, const std::string& simd);
// Compiles it for each width of vectors that a machine of this kind may have. Returns what went wrong with
// one of them: runs compile it then, or interpret.
std::string keep_code(const graph::FixedProgram& program, bool once, const std::string& directory);

class CodeLibrary {
 public:
  // Loads what is kept, else compiles the code unless `directory` already has it. `program` must outlive it.
  // Throws InputError where there is no compiler, or it fails.
  CodeLibrary(const graph::FixedProgram& program, bool once, const std::string& simd,
              const std::string& directory);

  MeetCode meet(size_t round, Ends ends) const;  // null: the code has none
  FinishCode finish(size_t round) const { return finish_[round]; }
  CodeNumbers numbers() const;

 private:
  void load(const std::string& path, size_t rounds);

  Code code_;
  int types_;
  CodeTables tables_;
  std::vector<std::vector<double>> type_constants_, pair_constants_;
  std::vector<const double*> type_pointers_, pair_pointers_;
  std::vector<std::vector<MeetCode>> meet_;  // [round][ends]
  std::vector<FinishCode> finish_;           // by round
};

}  // namespace cuboct::emu
