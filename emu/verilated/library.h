// SPDX-License-Identifier: MIT
// From emitted RTL to a shared library: Verilator, a C++ compiler, and a cache of what they made.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "emu/verilated/abi.h"
#include "hw/plan.h"

namespace cuboct::emu {

// Where compiled libraries are kept: $XDG_CACHE_HOME/cuboct, or ~/.cache/cuboct. Throws InputError where
// neither is set.
std::string default_build_directory();

// The node of `plan`, or the whole lattice, emitted and compiled unless `build_directory` already holds the
// same. Returns the path of the library. What is built first gets a temporary name, so that two builders do
// not meet. Throws InputError where a tool is missing or fails; the log stays in the build directory.
std::string compile_node(const Plan& plan, const std::string& build_directory);
std::string compile_lattice(const Plan& plan, const State& initial, const std::string& build_directory);

// A loaded library.
class Library {
 public:
  explicit Library(const std::string& path);
  ~Library();
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;

  void* (*create)(uint32_t seed) = nullptr;
  void (*destroy)(void*) = nullptr;
  void (*clock)(void*, const CuboctIn*, CuboctOut*) = nullptr;                    // of a node's library
  void (*clock_lattice)(void*, const CuboctIn*, uint32_t, CuboctOut*) = nullptr;  // of a lattice's library

 private:
  void* handle_ = nullptr;
};

}  // namespace cuboct::emu
