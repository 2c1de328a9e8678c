// SPDX-License-Identifier: MIT
// A program as a device interprets it: operations over registers, one after the other. All threads of a warp
// run the same one, for several partners of their particles at once, so what it is to fetch an operation and
// to choose among them is shared.
//
// A register holds 32 bits of each of these partners. A value whose interval fits 32 bits takes one register;
// others take two, of which the second holds the upper halves.
#pragma once

#include <cstdint>
#include <vector>

#include "emu/gpu/rounds/rounds_limits.h"
#include "model/graph/program.h"

namespace cuboct::gpu {

inline constexpr int kMostInputs = 6;  // a dot of three axes
inline constexpr uint8_t kWideOut = 0x80;

// 16 bytes, as a thread loads them.
struct alignas(16) Operation {
  uint8_t op, inputs, shift, width;  // of noise, `inputs` has the seed behind the three of the graph; of a
                                     // clamp, both ends of its range
  uint8_t table;
  uint8_t narrow;  // 32 bits hold all that happens; of mul and dot, their factors
  uint8_t wide;    // bit k: input k takes two registers; kWideOut: the result does
  uint8_t more;    // the next one has the same `op`, `inputs` and `narrow`
  uint8_t out;
  uint8_t in[kMostInputs];
};
struct Constant {
  int64_t value;
  uint8_t to, wide;
};
// A value that a thread fetches: graph::Source. Rounded by `shift`.
struct alignas(16) Fetch {
  uint8_t source, to, wide, index, axis, shift;
};
// A value into a number of a field, a sum or an axis.
struct alignas(16) Store {
  uint8_t from, wide, to;
};

// One round. `own` is fetched, and what `prepare` makes of it computed, once a particle; `early` and `late`
// are once a partner. The late operations are for pairs that count, the register `when`.
struct RoundLists {
  std::vector<Constant> constants, finish_constants;
  std::vector<Operation> prepare, early, late, finish;
  std::vector<Fetch> own, early_fetch, late_fetch, finish_fetch;
  std::vector<Store> terms, writes, v, u, drift;
  int when = -1;      // all pairs count
  int registers = 0;  // of the pair's operations, and then of the finish
  std::vector<Store> bond_writes;
  // Of a bond that is not met: whether it counts no more, the register `broken`.
  std::vector<Constant> broken_constants;
  std::vector<Operation> broken_code;
  std::vector<Fetch> broken_fetch;
  int broken = -1;  // all bonds count
  int broken_registers = 0;
};

// By round. InputError where one needs more than a thread has, or two rounds make the same
// field, of particles or of bonds.
std::vector<RoundLists> code_of(const graph::FixedProgram& program);

}  // namespace cuboct::gpu
