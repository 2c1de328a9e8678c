// SPDX-License-Identifier: MIT
#include "emu/lattice/code/code_table.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>

#include "emu/lattice/kernel_rule.h"

namespace cuboct::emu {
namespace {

int bits_of(const std::vector<int32_t>& values) {
  int64_t most = 0;
  for (const int32_t value : values) most = std::max(most, std::abs(int64_t{value}));
  return std::bit_width(static_cast<uint64_t>(most));
}

// Bits of a word below c1, whose mantissa takes all of its bits but the leading one. Below 51, so that what
// they hold can be added to kMagic.
int low_bits(const FixedTable& table) { return std::min(50, 52 - std::max(bits_of(table.c1) - 1, 0)); }

}  // namespace

bool is_packed(const FixedTable& table) { return bits_of(table.c0) < low_bits(table); }

void CodeTables::add(const FixedTable& table) {
  VectorTable& v = words_.emplace_back(vector_table(table));
  CodeTable code{};
  if (is_packed(table)) {
    const int low = low_bits(table);
    const int64_t half = int64_t{1} << (low - 1);
    code.low_mask = (int64_t{1} << low) - 1;
    code.bias = kMagic + static_cast<double>(half);
    for (size_t n = 0; n < table.c0.size(); ++n)
      v.words[n] = (std::bit_cast<uint64_t>(static_cast<double>(table.c1[n])) &
                    ~static_cast<uint64_t>(code.low_mask)) |
                   static_cast<uint64_t>(table.c0[n] + half);
  }
  code.words = v.words.data(), code.c2 = v.c2.data();
  code.index_shift = v.index_shift, code.index_mask = (int64_t{1} << v.index_bits) - 1;
  code.index_bits = v.index_bits, code.index_base = v.index_base;
  code.t_mask = static_cast<int64_t>(v.t_mask);
  code.factor = rounding_factor(table.fraction_bits) * v.t_unit;
  tables_.push_back(code);
}

}  // namespace cuboct::emu
