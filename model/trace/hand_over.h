// SPDX-License-Identifier: MIT
// Traces, states and rasters as bytes between two programs of one build: one description of each type, for
// both directions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "model/trace/left_state.h"
#include "model/trace/raster.h"
#include "model/trace/trace.h"

namespace cuboct {

// `Bytes` has move(void*, size_t), which writes or reads, and expect(count, size): called before memory for
// `count` values of `size` bytes is taken, and throws where they are too many. What is read into is empty
// before.
template <typename Bytes>
class HandOver {
 public:
  explicit HandOver(Bytes& bytes) : bytes_(bytes) {}

  template <typename... T>
  void operator()(T&... values) {
    (one(values), ...);
  }

 private:
  template <typename T>
  static constexpr bool kAsItIs = std::is_trivially_copyable_v<T> || std::is_same_v<T, Vec3>;

  template <typename T>
  void one(T& value) {
    if constexpr (kAsItIs<T>)
      bytes_.move(&value, sizeof value);
    else
      fields(*this, value);
  }
  void one(std::string& text) { row(text); }
  template <typename T>
  void one(std::vector<T>& values) {
    if constexpr (kAsItIs<T>) return row(values);
    uint64_t count = values.size();
    one(count);
    for (uint64_t k = 0; k < count; ++k) {
      if (k == values.size()) values.emplace_back();
      one(values[k]);
    }
  }
  template <typename A, typename B>
  void one(std::pair<A, B>& pair) {
    one(pair.first), one(pair.second);
  }
  template <typename T>
  void one(std::optional<T>& value) {
    if (!is_there(value.has_value())) return;
    if (!value) value.emplace();
    one(*value);
  }
  // Of an object that is only shared as const.
  template <typename T>
  void one(std::shared_ptr<const T>& value) {
    if (!is_there(value != nullptr)) return;
    if (!value) value = std::make_shared<T>();
    one(const_cast<T&>(*value));
  }

  bool is_there(uint8_t here) {
    one(here);
    return here != 0;
  }
  template <typename Row>
  void row(Row& values) {
    uint64_t count = values.size();
    one(count);
    bytes_.expect(count, sizeof(values[0]));
    values.resize(count);
    bytes_.move(values.data(), count * sizeof(values[0]));
  }

  Bytes& bytes_;
};

void fields(auto& pass, State& state) { pass(state.step, state.particles); }
void fields(auto& pass, RealFrame& frame) {
  pass(frame.step, frame.x, frame.v, frame.force, frame.u, frame.shown);
}
void fields(auto& pass, Curve& curve) { pass(curve.name, curve.unit, curve.step, curve.value); }
void fields(auto& pass, StopReason& stop) {
  pass(stop.fault, stop.step, stop.cell, stop.particle, stop.number, stop.text);
}
void fields(auto& pass, Reached& reached) {
  pass(reached.curve, reached.side, reached.step, reached.value, reached.limit);
}
void fields(auto& pass, Finding& f) {
  pass(f.failure, f.step, f.particle, f.place, f.number, f.limit, f.text);
}
// All but its frames and bodies, which come one by one.
void fields(auto& pass, Trace& t) {
  pass(t.engine, t.plan_hash, t.nodes, t.state_hash, t.hash_every, t.steps_done, t.bonds, t.curves, t.cycles,
       t.stop, t.reached, t.asked, t.findings, t.watched, t.seconds, t.counters, t.notes);
}
// What comes next of a trace.
enum class TracePart : uint8_t { end, frame, body };

void fields(auto& pass, BondState& bonds) { pass(bonds.packed, bonds.kept); }
void fields(auto& pass, ExactBody& exact) {
  pass(exact.widths, exact.cell_edge, exact.shape, exact.dt, exact.origin, exact.cell, exact.x, exact.v,
       exact.u);
}
void fields(auto& pass, Body& body) { pass(body.x, body.v, body.u, body.type, body.exact, body.bonds); }
void fields(auto& pass, LeftState& left) {
  pass(left.engine, left.step, left.first_step, left.packing, left.box_strain, left.types, left.body);
}

void fields(auto& pass, Raster& r) {
  pass(r.step, r.time, r.thickness, r.strain, r.speed, r.broken, r.outside);
}
void fields(auto& pass, Rasters& rasters) {
  pass(rasters.title, rasters.strain_axis, rasters.particle, rasters.grid, rasters.frames);
}

}  // namespace cuboct
