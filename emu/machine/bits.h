// SPDX-License-Identifier: MIT
// A word of up to 2048 bits: what a port or a beat carries.
#pragma once

#include <array>
#include <cstdint>

namespace cuboct::emu {

// Of a beat on a wire, with its check, at most.
inline constexpr int kBeatBits = 512;

struct Bits {
  static constexpr int kWords = 32;  // a particle with its row of bonds
  static constexpr int kWidth = 64 * kWords;
  std::array<uint64_t, kWords> word{};  // least significant first

  // Writes the low `width` bits of `value` at `lsb`; the field must hold zeros. 0 <= width <= 64, lsb + width
  // <= kWidth.
  void put(int lsb, int width, int64_t value) {
    if (width <= 0) return;
    const uint64_t v = static_cast<uint64_t>(value) & (~uint64_t{0} >> (64 - width));
    const int i = lsb >> 6, s = lsb & 63;
    word[i] |= v << s;
    if (s + width > 64) word[i + 1] |= v >> (64 - s);
  }
  uint64_t get(int lsb, int width) const {
    if (width <= 0) return 0;
    const int i = lsb >> 6, s = lsb & 63;
    uint64_t v = word[i] >> s;
    if (s + width > 64) v |= word[i + 1] << (64 - s);
    return v & (~uint64_t{0} >> (64 - width));
  }
  // Sign-extended.
  int64_t get_signed(int lsb, int width) const {
    return width == 0 ? 0 : static_cast<int64_t>(get(lsb, width) << (64 - width)) >> (64 - width);
  }
  // Bits [lsb, lsb + width) moved down to 0; bits beyond kWidth read as zeros.
  Bits slice(int lsb, int width) const {
    Bits out;
    slice(lsb, width, out);
    return out;
  }
  // The same into words that hold zeros, and no others.
  void slice(int lsb, int width, Bits& out) const {
    for (int done = 0; done < width && lsb + done < kWidth; done += 64) {
      const int part = width - done < 64 ? width - done : 64;
      const int held = kWidth - lsb - done < part ? kWidth - lsb - done : part;
      out.word[done >> 6] = get(lsb + done, held);
    }
  }
  // Adds the low `width` bits of `part` at `lsb`, where this holds zeros; what falls beyond kWidth is dropped.
  void join(int lsb, int width, const Bits& part) {
    for (int done = 0; done < width && lsb + done < kWidth; done += 64) {
      const int piece = width - done < 64 ? width - done : 64;
      const int held = kWidth - lsb - done < piece ? kWidth - lsb - done : piece;
      put(lsb + done, held, static_cast<int64_t>(part.word[done >> 6]));
    }
  }
  bool operator==(const Bits&) const = default;
};

}  // namespace cuboct::emu
