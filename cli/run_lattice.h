// SPDX-License-Identifier: MIT
// The lattice engine behind `run` and `crosscheck`: in this process, or over MPI in programs of its own.
#pragma once

#include <string>

#include "cli/command.h"
#include "emu/lattice/run.h"

namespace cuboct {

// What the command line says about the lattice engine.
struct LatticeChoice {
  int threads = 0;  // 0: as many as suit the scene
  int ranks = 1;
  uint64_t hash_every = 100;
  bool cycles = false;
  std::string checkpoint_every;
  bool resume = false;

  void add_to(CLI::App& command);  // --threads and --ranks
  bool keeps_checkpoints() const { return resume || !checkpoint_every.empty(); }
  // Throws InputError where an option is given that only the lattice engine has.
  void check_unused(const std::string& engine) const;
};

struct LatticeAnswer : emu::LatticeResult {
  std::string trouble;  // what ranks could not write
};

// `request` with the choice's threads, on one or more ranks. Throws InputError where ranks are asked for that
// this build or machine does not have.
LatticeAnswer run_on_lattice(const Input& input, const Scene& scene, const Plan& plan,
                             const LatticeChoice& choice, emu::LatticeRun request);

}  // namespace cuboct
