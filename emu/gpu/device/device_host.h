// SPDX-License-Identifier: MIT
// emu/gpu/device/device.h on the host: a device is the machine itself, a kernel a loop.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <new>
#include <vector>

#include "emu/gpu/device/host_stream.h"

namespace cuboct::gpu {

inline constexpr bool kHasGraphs = false;

class Graph {
 public:
  void begin(Stream&) {}
  void end(Stream&) {}
  void launch(Stream&) {}
  bool ready() const { return false; }
  void drop() {}
};

// Calls for memory, by device.
inline std::map<int, uint64_t> host_allocations;
inline std::mutex host_allocations_guard;

inline void* allocate(int device, size_t bytes) {
  {
    const std::lock_guard guard(host_allocations_guard);
    ++host_allocations[device];
  }
  if (void* memory = std::malloc(bytes)) return memory;
  throw std::bad_alloc();
}
// Waits for the device, as cudaFree does.
inline void release(int device, void* memory) {
  if (memory) Stream::finish(device);
  std::free(memory);
}
// Of no bytes both may be null, which memcpy forbids.
inline void copy_bytes(void* to, const void* from, size_t bytes) {
  std::copy_n(static_cast<const char*>(from), bytes, static_cast<char*>(to));
}
inline void copy(Stream& stream, void* to, int, const void* from, int, size_t bytes) {
  stream.later([=] { copy_bytes(to, from, bytes); });
}
inline void upload(Stream& stream, void* to, const void* from, size_t bytes) {
  stream.synchronize();
  copy_bytes(to, from, bytes);
}
inline void download(Stream& stream, void* to, const void* from, size_t bytes) {
  stream.synchronize();
  copy_bytes(to, from, bytes);
}
inline void clear(Stream& stream, void* memory, size_t bytes) {
  stream.later([=] { std::memset(memory, 0, bytes); });
}
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

template <typename T>
void store(T* at, const T& value) {
  *at = value;
}

template <class F>
void for_each(Stream& stream, uint32_t begin, uint32_t end, int, const F& f) {
  stream.later([=] {
    for (uint32_t i = begin; i < end; ++i) f(i);
  });
}
template <class F>
void for_each_cached(Stream& stream, uint32_t begin, uint32_t end, int, const void* cache, size_t,
                     const F& f) {
  stream.later([=] {
    if (f.idle()) return;
    for (uint32_t i = begin; i < end; ++i) f(i, cache);
  });
}
// Where the blocks of a launch wait for each other.
struct Meeting {
  explicit Meeting(int) {}
};
// The threads that share an index.
template <int>
struct PairLanes {
  static constexpr int kCount = 1;
  int lane = 0;
  uint32_t most_of_warp(uint32_t value) const { return value; }
  template <class T>
  const T& from(const T& value, int) const {
    return value;
  }
  int64_t sum(int64_t value) const { return value; }
  uint32_t before(uint32_t) const { return 0; }
  uint32_t total(uint32_t value) const { return value; }
  bool all(bool value) const { return value; }
};
// Steps 1 to `steps` of all indices below `end`, in one launch, while f.goes_on(step). What f gives is added
// up in sums[step]. Waits for their end. False, and nothing is done: the device does not do so.
template <class Lanes, class F>
bool go_on_together(Stream& stream, uint32_t end, int, const void* cache, size_t, uint32_t steps, Meeting&,
                    uint64_t* sums, bool, const F& f) {
  stream.later([=] {
    for (uint32_t number = 1; number <= steps && f.goes_on(number); ++number)
      for (uint32_t i = 0; i < end; ++i)
        sums[number] += f(i, true, f.goes_on(number), f.keep(i, true, Lanes{}), cache, number, Lanes{});
  });
  stream.synchronize();
  return true;
}
struct Block {
  template <class F>
  void each(uint32_t count, const F& f) const {
    for (uint32_t k = 0; k < count; ++k) f(k);
  }
};
template <class F>
void for_each_block(Stream& stream, uint32_t count, int, size_t bytes, const F& f) {
  stream.later([=] {
    std::vector<std::max_align_t> memory(bytes / sizeof(std::max_align_t) + 1);
    for (uint32_t i = 0; i < count; ++i) f(i, Block{}, memory.data());
  });
}
template <class F>
void sum_each(Stream& stream, uint32_t begin, uint32_t end, int, const F& f, uint64_t* out) {
  stream.later([=] {
    if (f.idle()) return;
    for (uint32_t i = begin; i < end; ++i) *out += f(i);
  });
}
template <class F>
void max_each(Stream& stream, uint32_t begin, uint32_t end, int, const F& f, uint32_t* out) {
  stream.later([=] {
    for (uint32_t i = begin; i < end; ++i) *out = std::max(*out, f(i));
  });
}
// The most that f(index, whether there is one, lanes) answers, of all indices below `end`, each of some
// lanes.
template <class Lanes, class F>
void max_shared(Stream& stream, uint32_t end, int, const F& f, uint32_t* out) {
  stream.later([=] {
    for (uint32_t i = 0; i < end; ++i) *out = std::max(*out, f(i, true, Lanes{}));
  });
}
inline void exclusive_sums(Stream& stream, const uint32_t* in, uint32_t* out, uint32_t count) {
  stream.later([=] {
    uint32_t sum = 0;
    for (uint32_t k = 0; k < count; ++k) out[k] = sum, sum += in[k];
  });
}

}  // namespace cuboct::gpu
