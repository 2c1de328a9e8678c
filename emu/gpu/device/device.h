// SPDX-License-Identifier: MIT
// What kernels run on: CUDA, or, with CUBOCT_GPU_HOST, loops on the host that give the same results. A kernel
// is a function object called for each index; the rest of the engine is the same source for both.
//
// Calls on one Stream run in their order; those of different streams are ordered by events alone. All but the
// constructors throw std::runtime_error where CUDA fails.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "model/base/fixed_math.h"

#ifdef CUBOCT_GPU_HOST
#include "emu/gpu/device/device_host.h"
#else
#include "emu/gpu/device/device_cuda.h"
#endif

namespace cuboct::gpu {

// Memory of one device for `size` values.
template <typename T>
class Array {
 public:
  Array() = default;
  // `account`, where given, holds the bytes of all arrays that share it.
  explicit Array(int device, uint64_t* account = nullptr) : device_(device), account_(account) {}
  Array(const Array&) = delete;
  Array& operator=(const Array&) = delete;
  Array(Array&& other) noexcept { *this = std::move(other); }
  Array& operator=(Array&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(account_, other.account_);
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    return *this;
  }
  ~Array() {
    release(device_, data_);
    count(-static_cast<int64_t>(size_));
  }

  // What it held is lost, unless the size is the same.
  void resize(size_t size) {
    if (size == size_) return;
    release(device_, data_);
    count(-static_cast<int64_t>(size_));
    data_ = nullptr, size_ = 0;
    if (size > 0) data_ = static_cast<T*>(allocate(device_, size * sizeof(T)));
    size_ = size;
    count(static_cast<int64_t>(size));
  }
  // Room for `size` values, keeping the first `kept`.
  void grow(Stream& stream, size_t size, size_t kept) {
    if (size <= size_) return;
    Array larger(device_, account_);
    larger.resize(size);
    if (kept > 0) copy(stream, larger.data(), device_, data_, device_, kept * sizeof(T));
    stream.synchronize();
    *this = std::move(larger);
  }
  void set(Stream& stream, const std::vector<T>& values) {
    if (size_ < values.size()) resize(values.size());
    put(stream, 0, values);
  }
  void put(Stream& stream, size_t first, const std::vector<T>& values) {
    if (!values.empty()) upload(stream, data_ + first, values.data(), values.size() * sizeof(T));
  }
  void zero(Stream& stream) {
    if (size_ > 0) clear(stream, data_, size_ * sizeof(T));
  }
  // Waits for the stream.
  std::vector<T> host(Stream& stream, size_t first, size_t count) const {
    std::vector<T> values(count);
    if (count > 0) download(stream, values.data(), data_ + first, count * sizeof(T));
    return values;
  }
  T* data() const { return data_; }
  size_t size() const { return size_; }

 private:
  void count(int64_t values) {
    if (account_) *account_ += static_cast<uint64_t>(values * static_cast<int64_t>(sizeof(T)));
  }

  int device_ = 0;
  uint64_t* account_ = nullptr;
  T* data_ = nullptr;
  size_t size_ = 0;
};

}  // namespace cuboct::gpu
