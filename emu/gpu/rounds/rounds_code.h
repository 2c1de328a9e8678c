// SPDX-License-Identifier: MIT
// A program as a device interprets it: operations over registers, one after the other. All threads of a warp
// run the same one, for several partners of their particles at once, so what it is to fetch an operation and
// to choose among them is shared.
//
// A register holds 32 bits of each of these partners. A value whose interval fits 32 bits takes one register;
// others take two, of which the second holds the upper halves.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "emu/gpu/rounds/rounds_limits.h"
#include "model/base/fixed_math.h"
#include "model/graph/program.h"

namespace cuboct::gpu {

inline constexpr int kMostInputs = 6;  // a dot of three axes

// In words, as a thread loads them at once and takes apart what it needs.
struct alignas(16) Operation {
  uint32_t word[4];

  CUBOCT_HD uint32_t byte(int k) const { return word[k / 4] >> (k % 4 * 8) & 0xff; }
  CUBOCT_HD void set(int k, int value) { word[k / 4] |= static_cast<uint32_t>(value) << (k % 4 * 8); }

  CUBOCT_HD uint32_t op() const { return byte(0); }
  // The result takes two registers; 32 bits hold all that happens, of mul and dot their factors; the next
  // operation has the same op, inputs and narrow.
  CUBOCT_HD bool wide_out() const { return (word[0] & kWideOut) != 0; }
  CUBOCT_HD bool narrow() const { return (word[0] & kNarrow) != 0; }
  CUBOCT_HD bool more() const { return (word[0] & kMore) != 0; }
  // Input k takes two registers.
  CUBOCT_HD bool wide(int k) const { return (word[0] >> (16 + k) & 1) != 0; }
  CUBOCT_HD uint32_t out() const { return byte(3); }
  CUBOCT_HD uint32_t in(int k) const { return byte(4 + k); }
  // Of noise the seed stands behind the three inputs of the graph; of a clamp both ends of its range do.
  CUBOCT_HD uint32_t inputs() const { return byte(10); }
  CUBOCT_HD int shift() const { return static_cast<int>(byte(11)); }
  CUBOCT_HD int width() const { return static_cast<int>(byte(12)); }
  CUBOCT_HD uint32_t table() const { return byte(13); }

  static constexpr uint32_t kWideOut = 1u << 8, kNarrow = 1u << 9, kMore = 1u << 10;
};
struct Constant {
  int64_t value;
  uint8_t to, wide;
};
// A value that a thread fetches: graph::Source. Rounded by `shift`; `narrow`: 32 bits hold all that happens.
struct alignas(16) Fetch {
  uint8_t source, to, wide, index, axis, shift, narrow;
};
inline constexpr uint8_t kNowhere = 0xff;
// A value into a number of a field, a sum or an axis.
struct alignas(16) Store {
  uint8_t from, wide, to;
};

// One round. `own` is fetched, and what `prepare` makes of it computed, once a particle; `early` and `late`
// are once a partner. The late operations are for pairs that count, the register `when`.
struct RoundLists {
  std::vector<Constant> constants, finish_constants;
  std::vector<Operation> prepare, early, late, finish;
  std::array<Fetch, 3> apart;  // by axis, what all pairs have; to kNowhere where nobody reads it
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
