// SPDX-License-Identifier: MIT
// gpu_ref/device.h on the host: a device is the machine itself, a stream runs each call at once.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <new>
#include <vector>

namespace cuboct::gpu {

inline constexpr bool kHasGraphs = false;

class Event {};

class Stream {
 public:
  explicit Stream(int device = 0, bool = false) : device_(device) {}
  int device() const { return device_; }
  void record(Event&) {}
  void wait(const Event&) {}
  void synchronize() {}

 private:
  int device_;
};

class Graph {
 public:
  void begin(Stream&) {}
  void end(Stream&) {}
  void launch(Stream&) {}
  bool ready() const { return false; }
  void drop() {}
};

inline void* allocate(int, size_t bytes) {
  if (void* memory = std::malloc(bytes)) return memory;
  throw std::bad_alloc();
}
inline void release(int, void* memory) { std::free(memory); }
inline void copy(Stream&, void* to, int, const void* from, int, size_t bytes) { std::memcpy(to, from, bytes); }
inline void upload(Stream&, void* to, const void* from, size_t bytes) { std::memcpy(to, from, bytes); }
inline void download(Stream&, void* to, const void* from, size_t bytes) { std::memcpy(to, from, bytes); }
inline void clear(Stream&, void* memory, size_t bytes) { std::memset(memory, 0, bytes); }
inline void share(const std::vector<int>&) {}

template <typename T>
T atomic_add(T* at, T value) {
  const T before = *at;
  *at += value;
  return before;
}
template <typename T>
void atomic_min(T* at, T value) {
  *at = std::min(*at, value);
}

// The four numbers of a particle, in one access where the machine has one.
template <typename T>
const T& load(const T* at) {
  return *at;
}

template <class F>
void for_each(Stream&, uint32_t begin, uint32_t end, int, const F& f) {
  for (uint32_t i = begin; i < end; ++i) f(i);
}
template <class F>
void for_each_cached(Stream&, uint32_t begin, uint32_t end, int, const void* cache, size_t, const F& f) {
  if (f.idle()) return;
  for (uint32_t i = begin; i < end; ++i) f(i, cache);
}
template <class F>
void sum_each(Stream&, uint32_t begin, uint32_t end, int, const F& f, uint64_t* out) {
  if (f.idle()) return;
  for (uint32_t i = begin; i < end; ++i) *out += f(i);
}
template <class F>
void max_each(Stream&, uint32_t begin, uint32_t end, int, const F& f, uint32_t* out) {
  for (uint32_t i = begin; i < end; ++i) *out = std::max(*out, f(i));
}
inline void exclusive_sums(Stream&, const uint32_t* in, uint32_t* out, uint32_t count) {
  uint32_t sum = 0;
  for (uint32_t k = 0; k < count; ++k) out[k] = sum, sum += in[k];
}

}  // namespace cuboct::gpu
