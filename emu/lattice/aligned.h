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

// A fixed number of trivially copyable elements, readable (and writable) kGroup elements beyond either end,
// so that a vector may overhang. Cache-line aligned, filled with `fill`.
template <typename T>
class PaddedArray {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  PaddedArray() = default;
  explicit PaddedArray(size_t size, T fill = T{}) : size_(size) {
    const size_t lead = std::max<size_t>(kLine / sizeof(T), kGroup);
    const size_t bytes = ((size + lead + kGroup) * sizeof(T) + kLine - 1) / kLine * kLine;
    T* raw = static_cast<T*>(std::aligned_alloc(kLine, bytes));
    if (raw == nullptr) throw std::bad_alloc();
    memory_.reset(raw);
    data_ = raw + lead;
    std::fill(raw, raw + bytes / sizeof(T), fill);
  }
  PaddedArray copy() const {
    PaddedArray result(size_);
    std::copy(data_, data_ + size_, result.data_);
    return result;
  }
  T* data() { return data_; }
  const T* data() const { return data_; }
  size_t size() const { return size_; }
  T& operator[](size_t k) { return data_[k]; }
  const T& operator[](size_t k) const { return data_[k]; }

 private:
  static constexpr size_t kLine = 64;
  struct Free {
    void operator()(T* p) const { std::free(p); }
  };
  std::unique_ptr<T, Free> memory_;
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
