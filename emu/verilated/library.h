// SPDX-License-Identifier: MIT
// The emitted node, or the whole emitted lattice, as a library that is loaded.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "emu/verilated/abi.h"
#include "emu/verilated/compile.h"
#include "hw/plan/plan.h"

namespace cuboct::emu {

// Where compiled libraries are kept: $XDG_CACHE_HOME/cuboct, or ~/.cache/cuboct. Throws InputError where
// neither is set.
std::string default_build_directory();

// The path of the compiled node of `plan`, or of its whole lattice as a SystemC module (the process that
// loads it elaborates it, so once, and links with SystemC). `optimise`: of the C++ compiler for what runs in
// each cycle; for few cycles -O0, which compiles in a third of the time. Throws InputError, see compile.h.
std::string compile_node(const Plan& plan, const std::string& build_directory,
                         const std::string& optimise = "-O2");
std::string compile_lattice(const Plan& plan, const State& initial, const std::string& build_directory,
                            const std::string& optimise = "-O1");

// What compile_node builds, for those who change it: other sources of the RTL, other flags. Refers to `plan`.
Build node_build(const Plan& plan, const std::string& optimise = "-O2");

// The modules of the top of the board, or of the wrapper of the bus, that `project` holds, in the order to
// read; paths are from there. Throws InputError where it holds neither.
std::vector<std::string> board_files(const std::string& project);

// The path of the compiled top of the board, or of the wrapper of the bus, that `project`, a directory of
// `cuboct emit --board` or `--bus`, holds.
std::string compile_board(const std::string& project, const std::string& build_directory);

// A loaded library.
class Library {
 public:
  explicit Library(const std::string& path);
  ~Library();
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;

  void* (*create)(uint32_t seed) = nullptr;
  void (*destroy)(void*) = nullptr;
  // Of a node's library, of a lattice's, of a board's, of a bus's; null, or the assertion of the RTL that
  // failed.
  const char* (*clock)(void*, const CuboctIn*, CuboctOut*) = nullptr;
  void (*place)(void*, const uint64_t* extent, const uint64_t* exits) = nullptr;  // of a node with a brick
  const char* (*clock_lattice)(void*, const CuboctIn*, uint32_t, CuboctOut*) = nullptr;
  const char* (*clock_board)(void*, const uint8_t*, uint8_t*, int, uint8_t*) = nullptr;
  const char* (*clock_bus)(void*, const uint8_t*, int, int*, uint8_t*, int, int*, int, uint8_t*) = nullptr;

 private:
  void* handle_ = nullptr;
};

}  // namespace cuboct::emu
