// SPDX-License-Identifier: MIT
// A rule of text in floats or doubles as C++: for each of its rounds the Graphs of RealStep
// (real_rounds_kernel.h) and a kernel, for a compiler that the engine calls (nvrtc.h). The graphs are those
// that the reference runs, a statement for each node.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "model/contract/rule.h"
#include "model/program/program_start.h"
#include "model/program/rule_program.h"

namespace cuboct::gpu {

// Powers of two that a device's numbers are to be multiplied by: real_rounds_kernel.h.
struct RealExponents {
  int length = 0, time = 0, velocity = 0, mass = 0, force = 0;
  std::vector<int> field, bond;  // by number
};

// Bonds that have the same numbers that never change are of one kind.
struct RealBondKinds {
  std::vector<uint32_t> of;                // by bond
  std::vector<Vec3> packed;                // by kind, m
  std::vector<std::vector<double>> field;  // [number][kind], of those that no round writes
};
RealBondKinds bond_kinds_of(const RuleProgram& program, const ProgramStart& start);

struct RealRoundsText {
  std::string source;                                   // includes files of round_headers()
  std::vector<std::string> names;                       // of the kernels, by round
  std::vector<std::array<double, 4>> tables;            // RealFrame::tables
  std::vector<std::vector<std::vector<double>>> kinds;  // [round][kind][number]: RealFrame::kinds
  RealExponents exponents;
};

struct RealTextOptions {
  bool doubles = false;
  bool wide = false;  // places of 64 bits
  size_t frame_bytes =
      0;  // of the RealFrame that the engine passes; the compiler checks that it is the kernel's
};
// InputError where the rule has more numbers than a thread of the engine has room for, or two rounds make the
// same field.
RealRoundsText real_text_of(const RuleProgram& program, const Rule& rule, const ProgramStart& start,
                            const RealBondKinds& kinds, const RealTextOptions& options);

// What rounds write.
std::vector<bool> written_bonds(const RuleProgram& program);

}  // namespace cuboct::gpu
