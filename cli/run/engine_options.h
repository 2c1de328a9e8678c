// SPDX-License-Identifier: MIT
// What a command line says to engines: the same options in every command that runs one.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cli/command.h"
#include "model/real/reference.h"

namespace cuboct {

struct EngineOptions {
  int threads = 0;                   // 0: as many as suit the scene
  int ranks = 1;                     // processes, over MPI
  int gpus = 0;                      // the first so many devices; 0: one
  std::vector<int> devices;          // or these, by CUDA's ordinals
  std::string port;                  // of a board
  int baud = 0;                      // 0: the program's own
  double timeout = 0;                // s; 0 likewise
  std::string precision;             // "fixed", "float", "double"; empty: the engine's own choice
  std::string integrator = "euler";  // or "verlet"
  std::string rule_code;             // EngineRow::rule_codes; empty: the engine's own choice
  // Of `run` alone:
  uint64_t hash_every = 0;
  bool hashes_given = false, cycles = false, joules = false, resume = false;
  std::string checkpoint_every;
  uint64_t pause_after = 0;  // steps, of a program on devices that goes on later from its checkpoint; 0: none
  bool anyway = false;       // though it asks for more than the machine has
  bool quiet = false;        // programs of engines say nothing, and what they would is an error's text

  // --threads, --ranks, --gpus, --devices, --port, --baud, --port-timeout, --rule-code, --anyway
  void add_machines(Command& command);
  void add_numbers(Command& command);  // --precision, --integrator
  void add_run(Command& command);      // what is of `run` alone

  // Throws InputError where an option is given that none of the engines has, or not so, or one lacks that it
  // needs.
  void check(const std::vector<std::string>& engines, const Input& input) const;
  // The same where an option is of other scenes than the plan's.
  void check(const Plan& plan) const;

  // Whether the engine then computes in real numbers; none is named: no.
  bool is_real(const std::string& engine) const;
  RealOptions real_options() const;  // of the reference
  bool keeps_checkpoints() const { return resume || !checkpoint_every.empty(); }
};

}  // namespace cuboct
