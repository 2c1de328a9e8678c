// SPDX-License-Identifier: MIT
// What beats and ports carry: words of bits, least significant first.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

namespace cuboct::emu {

// Writes the low `width` bits of `value` at `lsb`; the field must hold zeros. 0 <= width <= 64.
inline void put_bits(std::span<uint64_t> word, int lsb, int width, int64_t value) {
  if (width <= 0) return;
  const uint64_t v = static_cast<uint64_t>(value) & (~uint64_t{0} >> (64 - width));
  const auto i = static_cast<size_t>(lsb >> 6);
  const int s = lsb & 63;
  word[i] |= v << s;
  if (s + width > 64) word[i + 1] |= v >> (64 - s);
}
inline uint64_t get_bits(std::span<const uint64_t> word, int lsb, int width) {
  if (width <= 0) return 0;
  const auto i = static_cast<size_t>(lsb >> 6);
  const int s = lsb & 63;
  uint64_t v = word[i] >> s;
  if (s + width > 64) v |= word[i + 1] << (64 - s);
  return v & (~uint64_t{0} >> (64 - width));
}
// Sign-extended.
inline int64_t get_signed_bits(std::span<const uint64_t> word, int lsb, int width) {
  return width == 0 ? 0 : static_cast<int64_t>(get_bits(word, lsb, width) << (64 - width)) >> (64 - width);
}

template <int kCount>
struct BitsOf {
  static constexpr int kWords = kCount;
  static constexpr int kWidth = 64 * kWords;
  std::array<uint64_t, kWords> word{};

  operator std::span<uint64_t>() { return word; }
  operator std::span<const uint64_t>() const { return word; }

  void put(int lsb, int width, int64_t value) { put_bits(word, lsb, width, value); }
  uint64_t get(int lsb, int width) const { return get_bits(word, lsb, width); }
  // The words that hold the first `width` bits become zeros.
  void clear(int width) {
    std::fill_n(word.begin(), std::min<size_t>(word.size(), static_cast<size_t>(width + 63) / 64),
                uint64_t{0});
  }
  // Bits [lsb, lsb + width) moved down to 0; bits beyond kWidth read as zeros.
  BitsOf slice(int lsb, int width) const {
    BitsOf out;
    slice(lsb, width, out);
    return out;
  }
  // The same into `out`, whose words that hold them are zeros.
  template <int kOther>
  void slice(int lsb, int width, BitsOf<kOther>& out) const {
    width = std::min(width, BitsOf<kOther>::kWidth);
    for (int done = 0; done < width && lsb + done < kWidth; done += 64) {
      const int part = width - done < 64 ? width - done : 64;
      const int held = kWidth - lsb - done < part ? kWidth - lsb - done : part;
      out.word[static_cast<size_t>(done >> 6)] = get(lsb + done, held);
    }
  }
  // Adds the low `width` bits of `part` at `lsb`, where this holds zeros; what falls beyond kWidth is
  // dropped.
  template <int kOther>
  void join(int lsb, int width, const BitsOf<kOther>& part) {
    width = std::min(width, BitsOf<kOther>::kWidth);
    for (int done = 0; done < width && lsb + done < kWidth; done += 64) {
      const int piece = width - done < 64 ? width - done : 64;
      const int held = kWidth - lsb - done < piece ? kWidth - lsb - done : piece;
      put(lsb + done, held, static_cast<int64_t>(part.word[static_cast<size_t>(done >> 6)]));
    }
  }
  bool operator==(const BitsOf&) const = default;
};

using Bits = BitsOf<8>;   // a beat
using Word = BitsOf<32>;  // a record: a particle with its row of bonds is the longest

}  // namespace cuboct::emu
