// SPDX-License-Identifier: MIT
// A program as a device runs it: operations over registers, one after the other. All threads of a warp run
// the same one, so what an operation is costs them little.
#pragma once

#include <cstdint>
#include <vector>

#include "gpu_ref/device.h"
#include "gpu_ref/grid_view.h"
#include "model/graph/program.h"

namespace cuboct::gpu {

inline constexpr int kMostRegisters = 64;
inline constexpr int kMostInputs = 6;    // a dot of three axes
inline constexpr int kMostNumbers = 32;  // of a particle's fields; of a round's sums

struct Operation {
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
struct CodeTable {
  int shape, degree, difference_frac, index_bits, bin_bits, first_octave, fraction_bits;
  const int32_t *c0, *c1, *c2;
};

template <typename T>
struct Span {
  const T* data = nullptr;
  int count = 0;
};

// One round. `own` is fetched once a particle, `early` and `late` once a partner; the late operations are for
// pairs that count, the register `when`.
struct RoundCode {
  Span<Operation> constants, early, late, finish_constants, finish;
  Span<Fetch> own, early_fetch, late_fetch, finish_fetch;
  Span<Store> terms, writes, v, u, drift;
  const CodeTable *tables, *finish_tables;
  const int64_t *type_constants, *pair_constants;  // [constant][type], [constant][own type][other type]
  int types, when, sums;
};

// Holds what RoundCodes point to.
class ProgramOnDevice {
 public:
  // InputError where a round needs more than a thread has, or two rounds make the same field.
  ProgramOnDevice(Stream& stream, const graph::FixedProgram& program);
  const std::vector<RoundCode>& rounds() const { return rounds_; }

 private:
  template <typename T>
  Span<T> put(Stream& stream, const std::vector<T>& values, std::vector<Array<T>>& into);
  const CodeTable* put_tables(Stream& stream, const graph::Graph& graph);
  RoundCode code_of(Stream& stream, const graph::FixedProgram& program, const graph::Round& round);

  std::vector<Array<Operation>> operations_;
  std::vector<Array<Fetch>> fetches_;
  std::vector<Array<Store>> stores_;
  std::vector<Array<CodeTable>> tables_;
  std::vector<Array<int32_t>> entries_;
  std::vector<Array<int64_t>> constants_;
  const int64_t *type_constants_ = nullptr, *pair_constants_ = nullptr;
  std::vector<RoundCode> rounds_;
  std::vector<bool> written_;  // by number of a particle's fields
};

}  // namespace cuboct::gpu
