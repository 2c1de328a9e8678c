// SPDX-License-Identifier: MIT
// The fpga engine behind `run` and `crosscheck`: the program cuboct-fpga beside cuboct.
#pragma once

#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/engines.h"

namespace cuboct {

// What the command line says about the board.
struct FpgaChoice {
  std::string port;
  int baud = 0;        // 0: cuboct-fpga's own
  double timeout = 0;  // s; 0 likewise

  void add_to(CLI::App& command);
  // Throws InputError where an option is given that only the fpga engine has.
  void check_unused(const std::string& engine) const;
  // Throws InputError where there is no port.
  void check_used() const;
};

// The engine at work; see RunningEngine. `hash_every`: steps between two hashes of the state, 0: none.
RunningEngine start_fpga(const Input& input, const FpgaChoice& choice, const Request& request,
                         uint64_t hash_every, std::string path, bool progress);

}  // namespace cuboct
