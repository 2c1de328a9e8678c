// SPDX-License-Identifier: MIT
// From emitted SystemVerilog to a shared library: Verilator, a C++ compiler, and a cache of what they made.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace cuboct::emu {

struct Build {
  std::string top;                                     // module
  std::string verilator_flags;                         // besides those that every build has
  std::string compiler_flags;                          // likewise, for what runs in each cycle
  std::string libraries = {};                          // -lNAME
  std::vector<std::pair<std::string, int>> constants;  // -DNAME=VALUE for the sources
  std::vector<std::pair<std::string, std::string>>
      sources;                                       // name, text; the *.cpp in one unit with the model
  std::function<void(const std::string& dir)> emit;  // writes rtl/ and files.f
};

// The path of the library, compiled unless `directory` already holds the same. The name holds a hash of the
// emitted code without its comments, the sources, all flags, and what Verilator and the compiler say they
// are. What is built first gets a temporary name, so that two builders do not meet. Throws InputError where a
// tool is missing or fails; then the log stays in `directory`, under the library's name.
std::string compile(const Build& build, const std::string& directory);

}  // namespace cuboct::emu
