// SPDX-License-Identifier: MIT
// Ports of a Verilated model as runs of 64-bit words, whatever type Verilator gave them.
#include <cstring>
#include <memory>
#include <string>

#include "abi.h"
#include "verilated.h"

namespace {

template <typename T>
struct Port {  // up to 64 bits
  static constexpr int kBits = 8 * sizeof(T);
  static void get(const T& port, uint64_t* words) { words[0] = port; }
  static void set(T& port, const uint64_t* words) { port = static_cast<T>(words[0]); }
};
template <std::size_t N>
struct Port<VlWide<N>> {  // N 32-bit words
  static void get(const VlWide<N>& port, uint64_t* words) {
    words[(N - 1) / 2] = 0;
    std::memcpy(words, port.data(), 4 * N);
  }
  static void set(VlWide<N>& port, const uint64_t* words) { std::memcpy(port.data(), words, 4 * N); }
};
template <typename T>
void get_port(const T& port, uint64_t* words) {
  Port<T>::get(port, words);
}
template <typename T>
void set_port(T& port, const uint64_t* words) {
  Port<T>::set(port, words);
}

// Words that hold `bits`, and one to spare for fields across a boundary.
constexpr int words_of(int bits) { return bits / 64 + 2; }

// Copies `width` bits; the rest of the last destination word becomes zero where `to_lsb` is 0.
inline void copy_bits(uint64_t* to, int to_lsb, const uint64_t* from, int from_lsb, int width) {
  for (int done = 0; done < width; done += 64) {
    const int part = width - done < 64 ? width - done : 64;
    const uint64_t mask = ~uint64_t{0} >> (64 - part);
    const int s = (from_lsb + done) >> 6, sb = (from_lsb + done) & 63;
    uint64_t v = from[s] >> sb;
    if (sb + part > 64) v |= from[s + 1] << (64 - sb);
    v &= mask;
    const int d = (to_lsb + done) >> 6, db = (to_lsb + done) & 63;
    to[d] = (to[d] & ~(mask << db)) | v << db;
    if (db + part > 64) to[d + 1] = (to[d + 1] & ~(mask >> (64 - db))) | v >> (64 - db);
  }
}

// A beat wider than the words of the interface carries zeros there.
constexpr int held_bits(int bits) { return bits < 64 * kCuboctWords ? bits : 64 * kCuboctWords; }

// Where the first assertion failed in this thread; empty: nowhere.
inline thread_local std::string stopped_at;

template <typename Model>
struct Instance {
  VerilatedContext context;
  std::unique_ptr<Model> model;
  std::string stopped;
  // `name...`: that of a SystemC module.
  template <typename... Name>
  explicit Instance(uint32_t seed, const Name&... name) {
    context.threads(1);  // else each context starts a pool of threads
    if (seed != 0) {
      context.randReset(2);
      context.randSeed(static_cast<int>(seed & 0x7fffffffu));
    }
    Verilated::threadContextp(&context);  // a SystemC module takes its context from here
    if constexpr (sizeof...(name) > 0)
      model = std::make_unique<Model>(name...);
    else
      model = std::make_unique<Model>(&context);
  }
  ~Instance() {
    // The model's scopes leave the thread's context, which is that of the instance made last unless told.
    Verilated::threadContextp(&context);
    model->final();
    model.reset();
  }
  // What a clock function returns.
  const char* failure() {
    stopped = std::move(stopped_at);
    stopped_at.clear();
    return stopped.empty() ? nullptr : stopped.c_str();
  }
};

}  // namespace

// Verilator's own ends the process. Called by what a failed assertion runs; the evaluation goes on.
void vl_stop(const char* file, int line, const char*) {
  if (!stopped_at.empty()) return;
  const char* slash = std::strrchr(file, '/');
  stopped_at = std::string(slash != nullptr ? slash + 1 : file) + ":" + std::to_string(line);
}
