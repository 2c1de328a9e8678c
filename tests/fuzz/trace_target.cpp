// SPDX-License-Identifier: MIT
// Traces, states and rasters as HDF5 holds them, and as they come from the program that reads them.
#include <cstring>
#include <string>

#include "model/base/error.h"
#include "model/trace/hand_over.h"
#include "model/trace/left_state.h"
#include "model/trace/raster.h"
#include "model/trace/trace.h"
#include "tests/fuzz/targets.h"

namespace cuboct::fuzz {
namespace {

class Taker {
 public:
  explicit Taker(Bytes input) : left_(input) {}
  bool ended() const { return left_.empty(); }

  void move(void* to, size_t bytes) {
    if (bytes > left_.size()) throw InputError("it ends early");
    if (bytes > 0) std::memcpy(to, left_.data(), bytes);
    left_ = left_.subspan(bytes);
  }
  void expect(uint64_t count, size_t size) {
    if (count > left_.size() / size) throw InputError("it takes more memory than is free");
  }

 private:
  Bytes left_;
};

template <typename T>
void hand_over(Bytes input) {
  refusing([&] {
    Taker from(input);
    HandOver pass(from);
    T value;
    pass(value);
    if constexpr (std::is_same_v<T, Trace>)
      for (TracePart part{}; pass(part), part != TracePart::end;) {
        if (part == TracePart::frame)
          pass(value.frames.emplace_back());
        else
          pass(value.bodies.emplace_back());
      }
  });
}

}  // namespace

void take_trace(Bytes input) {
  const std::string path = file_of(input, "trace.h5");
  refusing([&] { read_trace(path); });
  refusing([&] { read_left_state(path); });
  refusing([&] { read_rasters(path); });
}

void take_hand_over(Bytes input) {
  if (input.empty()) return;
  const Bytes rest = input.subspan(1);
  switch (input[0] % 3) {
    case 0:
      return hand_over<Trace>(rest);
    case 1:
      return hand_over<LeftState>(rest);
    default:
      return hand_over<Rasters>(rest);
  }
}

}  // namespace cuboct::fuzz
