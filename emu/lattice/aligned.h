// SPDX-License-Identifier: MIT
// Arrays for vector units.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>

namespace cuboct::emu {

// Particles per group: the lanes of the widest vector of doubles. Every array index that begins a group is a
// multiple of it.
inline constexpr uint32_t kGroup = 8;
// Groups that hold so many particles.
inline constexpr uint32_t groups_of(size_t particles) {
  return static_cast<uint32_t>((particles + kGroup - 1) / kGroup);
}

// A fixed number of trivially copyable elements, readable (and writable) kGroup elements and 64 bytes beyond
// either end, so that a vector may overhang. Cache-line aligned.
template <typename T>
class PaddedArray {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  PaddedArray() = default;
  // Zeros, whose memory is taken when they are first written.
  explicit PaddedArray(size_t size) : size_(size) {
    const size_t lead = std::max<size_t>(kLine / sizeof(T), kGroup);  // a vector's width
    void* raw = std::calloc((size + 2 * lead) * sizeof(T) + kLine, 1);
    if (raw == nullptr) throw std::bad_alloc();
    memory_.reset(raw);
    size_t space = (size + 2 * lead) * sizeof(T) + kLine;
    data_ = static_cast<T*>(std::align(kLine, sizeof(T), raw, space)) + lead;
  }
  PaddedArray(size_t size, T fill) : PaddedArray(size) {
    std::fill(data_ - kGroup, data_ + size + kGroup, fill);
  }
  PaddedArray copy() const {
    PaddedArray result(size_);
    std::copy(data_, data_ + size_, result.data_);
    return result;
  }
  T* data() { return data_; }
  const T* data() const { return data_; }
  size_t size() const { return size_; }
  // The lead's places lie below 0, modulo 2^64.
  T& operator[](size_t k) { return data_[static_cast<ptrdiff_t>(k)]; }
  const T& operator[](size_t k) const { return data_[static_cast<ptrdiff_t>(k)]; }

 private:
  static constexpr size_t kLine = 64;
  struct Free {
    void operator()(void* p) const { std::free(p); }
  };
  std::unique_ptr<void, Free> memory_;
  T* data_ = nullptr;
  size_t size_ = 0;
};

// Lets a vector grow without touching what it does not hold yet.
template <typename T>
struct Untouched : std::allocator<T> {
  template <typename U>
  struct rebind {
    using other = Untouched<U>;
  };
  template <typename U>
  void construct(U* at) noexcept {
    ::new (static_cast<void*>(at)) U;
  }
  template <typename U, typename... Args>
  void construct(U* at, Args&&... args) {
    ::new (static_cast<void*>(at)) U(std::forward<Args>(args)...);
  }
};

}  // namespace cuboct::emu
