// SPDX-License-Identifier: MIT
#include "study/sweep/truth_bytes.h"

#include <algorithm>

#include "model/base/error.h"
#include "model/trace/hand_over.h"

namespace cuboct::study {
namespace {

struct Out {
  void move(const void* from, size_t size) { bytes.append(static_cast<const char*>(from), size); }
  void expect(uint64_t, size_t) {}
  std::string bytes;
};

struct In {
  void move(void* to, size_t size) {
    expect(size, 1);
    std::copy_n(bytes.data() + at, size, static_cast<char*>(to));
    at += size;
  }
  void expect(uint64_t count, size_t size) {
    if (count > (bytes.size() - at) / size) throw InputError("a truth in the results is cut short");
  }
  const std::string& bytes;
  size_t at = 0;
};

void fields(auto& pass, Rung& rung) {
  pass(rung.dt, rung.cutoff, rung.figures, rung.trajectory, rung.change);
}
void fields(auto& pass, KeptState& state) {
  pass(state.time, state.body.x, state.body.v, state.body.u, state.body.type);
}
void fields(auto& pass, Truth& truth) {
  uint8_t converged = truth.converged ? 1 : 0;  // a byte of a file may be no bool
  pass(truth.rungs, truth.figures, truth.states, truth.horizon, truth.lyapunov_time, truth.floor,
       truth.largest_frequency, converged, truth.grid.sample, truth.grid.samples, truth.grid.horizon,
       truth.notes);
  truth.converged = converged != 0;
}

}  // namespace

std::string bytes_of(const Truth& truth) {
  Out out;
  Truth copy = truth;
  HandOver pass(out);
  pass(copy);
  return std::move(out.bytes);
}

Truth truth_of(const std::string& bytes) {
  In in{bytes};
  Truth truth;
  HandOver pass(in);
  pass(truth);
  return truth;
}

}  // namespace cuboct::study
