// SPDX-License-Identifier: MIT
// Lists of plain numbers as words of 64 bits: the number of bytes, then the bytes.
#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

#include "emu/gpu/engine.h"

namespace cuboct::gpu {

template <class T>
void put(std::vector<uint64_t>& words, const std::vector<T>& list) {
  static_assert(std::is_trivially_copyable_v<T>);
  const size_t bytes = list.size() * sizeof(T), first = words.size() + 1;
  words.push_back(bytes);
  words.resize(first + (bytes + 7) / 8);
  if (bytes > 0) std::memcpy(words.data() + first, list.data(), bytes);
}

// The next list, which is to hold `size` values; DamagedMemory where it does not.
template <class T>
std::vector<T> take(std::span<const uint64_t>& words, size_t size) {
  const size_t bytes = size * sizeof(T), all = 1 + (bytes + 7) / 8;
  if (words.size() < all || words[0] != bytes) throw DamagedMemory("its lists have other lengths");
  std::vector<T> list(size);
  if (bytes > 0) std::memcpy(static_cast<void*>(list.data()), words.data() + 1, bytes);
  words = words.subspan(all);
  return list;
}

}  // namespace cuboct::gpu
