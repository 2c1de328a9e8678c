// SPDX-License-Identifier: MIT
// A function of one unsigned integer, as pieces of lines or parabolas in integers.
#pragma once

#include <cstdint>
#include <vector>

namespace cuboct {

enum class TableShape : uint8_t { uniform, octaves };

// A piecewise polynomial in r2 (an integer with 2D fractional bits, 0 <= r2 < 2^(2D)):
//   uniform: k = the top index_bits of r2, t = the next fraction_bits.
//   octaves: with o = floor(log2 r2), row = o - first_octave: k = row * 2^bin_bits + the bin_bits below the
//   leading
//            one, t = the next fraction_bits (zeros where r2 has no more); r2 below 2^first_octave takes k =
//            0, t = 0.
// value = c0[k] + round_odd((c1[k] + round_odd(c2[k] * t, T)) * t, T), T = fraction_bits; c2 is empty at
// degree 1, where value = c0[k] + round_odd(c1[k] * t, T). A table of several laws holds them one after
// another: of law n the entry is that of n 2^index_bits + k.
struct FixedTable {
  TableShape shape = TableShape::uniform;
  int degree = 1;
  int difference_frac = 16;  // D
  int index_bits = 9;        // of k; entries == 2^index_bits for each law that the table holds
  int bin_bits = 0;          // octaves only
  int first_octave = 0;      // octaves only
  int fraction_bits = 17;    // T: t is unsigned and fits 18 bits signed
  int value_frac = 0;        // E: value = real value * 2^E; may be negative
  std::vector<int32_t> c0, c1, c2;
  bool operator==(const FixedTable&) const = default;

  struct Address {
    uint32_t index;
    uint32_t t;
  };
  Address address(uint64_t r2) const;
  int64_t at(uint64_t r2, uint32_t law = 0) const;
};

}  // namespace cuboct
