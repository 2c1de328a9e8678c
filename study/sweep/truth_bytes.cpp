// SPDX-License-Identifier: MIT
#include "study/sweep/truth_bytes.h"

#include <cstring>

#include "model/base/error.h"

namespace cuboct::study {
namespace {

// One list of fields serves both ways: each field is put into, or taken out of, the bytes.
class Out {
 public:
  template <class T>
  void raw(T& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  size_t count(size_t size) {
    uint64_t n = size;
    raw(n);
    return size;
  }
  std::string bytes;
};

class In {
 public:
  explicit In(const std::string& bytes) : bytes_(bytes) {}
  template <class T>
  void raw(T& value) {
    if (bytes_.size() - at_ < sizeof value) throw InputError("a truth in the results is cut short");
    std::memcpy(static_cast<void*>(&value), bytes_.data() + at_, sizeof value);
    at_ += sizeof value;
  }
  size_t count(size_t) {
    uint64_t n = 0;
    raw(n);
    if (n > bytes_.size() - at_) throw InputError("a truth in the results is cut short");
    return n;
  }

 private:
  const std::string& bytes_;
  size_t at_ = 0;
};

template <class Way>
void field(Way& way, double& value) {
  way.raw(value);
}
template <class Way>
void field(Way& way, uint8_t& value) {
  way.raw(value);
}
template <class Way>
void field(Way& way, char& value) {
  way.raw(value);
}
template <class Way>
void field(Way& way, bool& value) {
  uint8_t byte = value;
  way.raw(byte);
  value = byte != 0;
}
template <class Way>
void field(Way& way, Vec3& value) {
  for (int a = 0; a < 3; ++a) way.raw(value[a]);
}
template <class Way>
void field(Way& way, std::string& value) {
  value.resize(way.count(value.size()));
  for (char& c : value) field(way, c);
}
template <class Way>
void field(Way& way, Body& body);
template <class Way>
void field(Way& way, Rung& rung);
template <class Way>
void field(Way& way, KeptState& state);
template <class Way, class T>
void field(Way& way, std::vector<T>& values) {
  values.resize(way.count(values.size()));
  for (T& value : values) field(way, value);
}
template <class Way>
void field(Way& way, Body& body) {
  field(way, body.x), field(way, body.v), field(way, body.u), field(way, body.type);
}
template <class Way>
void field(Way& way, Rung& rung) {
  field(way, rung.dt), field(way, rung.cutoff), field(way, rung.figures);
  field(way, rung.trajectory), field(way, rung.change);
}
template <class Way>
void field(Way& way, KeptState& state) {
  field(way, state.time), field(way, state.body);
}
template <class Way>
void all(Way& way, Truth& truth) {
  field(way, truth.rungs), field(way, truth.figures), field(way, truth.states), field(way, truth.horizon);
  field(way, truth.lyapunov_time), field(way, truth.floor), field(way, truth.largest_frequency);
  field(way, truth.converged);
  way.raw(truth.grid.sample), way.raw(truth.grid.samples), way.raw(truth.grid.horizon);
  field(way, truth.notes);
}

}  // namespace

std::string bytes_of(const Truth& truth) {
  Out out;
  Truth copy = truth;
  all(out, copy);
  return std::move(out.bytes);
}

Truth truth_of(const std::string& bytes) {
  In in(bytes);
  Truth truth;
  all(in, truth);
  return truth;
}

}  // namespace cuboct::study
