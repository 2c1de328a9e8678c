// SPDX-License-Identifier: MIT
// A program as a device runs it: operations over registers, one after the other. All threads of a warp run
// the same one, so what an operation is costs them little.
#pragma once

#include <cstdint>
#include <vector>

#include "emu/gpu/rounds/rounds_limits.h"
#include "model/graph/program.h"

namespace cuboct::gpu {

inline constexpr int kMostInputs = 6;  // a dot of three axes

// 16 bytes at a time.
struct alignas(16) Operation {
  int64_t low, high;  // of a clamp; of a constant both are its number, of noise low is the seed
  uint8_t op, inputs, shift, width;
  uint8_t out, table;
  uint8_t in[kMostInputs];
};
// A value that a thread fetches: graph::Source.
struct Fetch {
  uint8_t source, to, index, axis;
};
// A register into a number of a field, a sum or an axis.
struct Store {
  uint8_t from, to;
};

// One round. `own` is fetched once a particle, `early` and `late` once a partner; the late operations are for
// pairs that count, the register `when`.
struct RoundLists {
  std::vector<Operation> constants, early, late, finish_constants, finish;
  std::vector<Fetch> own, early_fetch, late_fetch, finish_fetch;
  std::vector<Store> terms, writes, v, u, drift;
  int when = 0;
  int registers = 0;  // of the pair's operations, and then of the finish
  std::vector<Store> bond_writes;
  // Of a bond that is not met: whether it counts no more, the register `broken`.
  std::vector<Operation> broken_constants, broken_code;
  std::vector<Fetch> broken_fetch;
  int broken = -1;  // all bonds count
  int broken_registers = 0;
};

// By round. InputError where one needs more than a thread has, or two rounds make the same
// field, of particles or of bonds.
std::vector<RoundLists> code_of(const graph::FixedProgram& program);

}  // namespace cuboct::gpu
