// SPDX-License-Identifier: MIT
// Runs a graph over blocks of lanes, node by node: golden's arithmetic. A lane is a pair, or a particle. Over
// __int128 the same text shows in tests that 64 bits lose nothing.
#pragma once

#include <algorithm>
#include <cstring>
#include <span>
#include <vector>

#include "model/graph/graph.h"
#include "model/graph/interval.h"
#include "model/graph/noise.h"
#include "model/graph/table_value.h"

namespace cuboct::graph {

// What a lane's checks found: of its faults the least, and of equal ones the first in the order of the nodes.
struct LaneFault {
  int lane = 0;
  Fault fault = Fault::none;
  int64_t number = 0;
};

template <class Int>
constexpr Int rounded_odd(Int a, int s) {
  return s == 0 ? a : (a + (Int{1} << (s - 1)) - (a < 0)) >> s;
}

template <class Int>
constexpr Int wrapped(Int a, int bits) {
  return static_cast<Int>(wrap(static_cast<int64_t>(a), bits));
}

// msb, align and shift of a value.
template <class Int>
constexpr int leading(Int a) {
  return a <= 0 ? -1 : leading_bit(static_cast<uint64_t>(a));
}
template <class Int>
constexpr Int aligned(Int a, int place, int step) {
  if (a <= 0) return 0;
  const int by = place - leading(a) / step * step;
  return by >= 0 ? a << by : a >> -by;
}
template <class Int>
constexpr Int shifted(Int a, int by) {
  return by >= 0 ? a << by : rounded_odd(a, -by);
}

template <class Int>
class Block {
 public:
  Block(const Graph& graph, size_t lanes)
      : graph_(graph), lanes_(lanes), values_(graph.nodes.size() * lanes) {
    for (size_t n = 0; n < graph.nodes.size(); ++n)
      if (graph.nodes[n].op == Op::constant)
        std::fill_n(values(static_cast<int>(n)), lanes, Int{graph.nodes[n].number});
  }

  // The lanes of a node; whoever runs the graph writes those of the inputs.
  Int* values(int node) { return values_.data() + static_cast<size_t>(node) * lanes_; }
  size_t room() const { return lanes_; }

  // Computes these nodes, in their order, in the first lanes.
  void run(std::span<const int> nodes, size_t lanes) {
    for (const int n : nodes) compute(graph_.nodes[static_cast<size_t>(n)], values(n), lanes);
  }

  // Moves the values of the chosen lanes, in ascending order, to the first ones.
  void compress(std::span<const int> nodes, std::span<const uint32_t> chosen) {
    for (const int n : nodes) {
      Int* v = values(n);
      for (size_t k = 0; k < chosen.size(); ++k) v[k] = v[chosen[k]];
    }
  }

  // Of the lanes that were run since clear_faults().
  const std::vector<LaneFault>& faults() const { return faults_; }
  void clear_faults() { faults_.clear(); }

 private:
  void compute(const Node& node, Int* __restrict out, size_t lanes) {
    const Int* in[3] = {};
    for (size_t k = 0; k < std::min<size_t>(node.inputs.size(), 3); ++k) in[k] = values(node.inputs[k]);
    const Int *a = in[0], *b = in[1], *c = in[2];
    const int s = node.shift;
    const Int low = node.range.low, high = node.range.high;
    const auto each = [&](auto value) {
      for (size_t k = 0; k < lanes; ++k) out[k] = value(k);
    };
    switch (node.op) {
      case Op::constant:
      case Op::input:
        return;
      case Op::add:
        return each([&](size_t k) { return a[k] + b[k]; });
      case Op::sub:
        return each([&](size_t k) { return a[k] - b[k]; });
      case Op::neg:
        return each([&](size_t k) { return -a[k]; });
      case Op::shl:
        return each([&](size_t k) { return a[k] << s; });
      case Op::round:
        return each([&](size_t k) { return rounded_odd(a[k], s); });
      case Op::floor:
        return each([&](size_t k) { return a[k] >> s; });
      case Op::mul:
        return each([&](size_t k) { return rounded_odd(a[k] * b[k], s); });
      case Op::mac:
        return each([&](size_t k) { return a[k] + rounded_odd(b[k] * c[k], s); });
      case Op::dot:
        return dot(node, out, lanes);
      case Op::lookup:
        return lookup(node, out, lanes);
      case Op::lt:
        return each([&](size_t k) { return Int{a[k] < b[k]}; });
      case Op::le:
        return each([&](size_t k) { return Int{a[k] <= b[k]}; });
      case Op::eq:
        return each([&](size_t k) { return Int{a[k] == b[k]}; });
      case Op::both:
        return each([&](size_t k) { return a[k] & b[k]; });
      case Op::either:
        return each([&](size_t k) { return a[k] | b[k]; });
      case Op::negate:
        return each([&](size_t k) { return 1 - a[k]; });
      case Op::select:
        return each([&](size_t k) { return a[k] ? b[k] : c[k]; });
      case Op::min:
        return each([&](size_t k) { return std::min(a[k], b[k]); });
      case Op::max:
        return each([&](size_t k) { return std::max(a[k], b[k]); });
      case Op::abs:
        return each([&](size_t k) { return a[k] < 0 ? -a[k] : a[k]; });
      case Op::clamp:
      case Op::within:
        return each([&](size_t k) { return std::clamp(a[k], low, high); });
      case Op::msb:
        return each([&](size_t k) { return Int{leading(a[k])}; });
      case Op::align:
        return each([&](size_t k) { return aligned(a[k], s, node.width); });
      case Op::shift:
        return each([&](size_t k) { return shifted(a[k], static_cast<int>(b[k])); });
      case Op::check:
        return check(node, out, lanes);
      case Op::noise:
        return each([&](size_t k) {
          return Int{noise_of(node.number, static_cast<int64_t>(a[k]), static_cast<int64_t>(b[k]),
                              static_cast<int64_t>(c[k]), node.width)};
        });
    }
  }

  void dot(const Node& node, Int* __restrict out, size_t lanes) {
    const size_t n = node.inputs.size() / 2;
    std::fill_n(out, lanes, Int{0});
    for (size_t part = 0; part < n; ++part) {
      const Int *a = values(node.inputs[part]), *b = values(node.inputs[n + part]);
      for (size_t k = 0; k < lanes; ++k) out[k] += a[k] * b[k];
    }
    if (node.shift > 0)
      for (size_t k = 0; k < lanes; ++k) out[k] = rounded_odd(out[k], node.shift);
  }

  void lookup(const Node& node, Int* __restrict out, size_t lanes) {
    const FixedTable& table = graph_.tables[static_cast<size_t>(node.table)];
    const Int *argument = values(node.inputs[0]), *law = values(node.inputs[1]);
    for (size_t k = 0; k < lanes; ++k)
      out[k] = table_value(table, static_cast<uint64_t>(argument[k]),
                           static_cast<uint32_t>(law[k]) << table.index_bits);
  }

  void check(const Node& node, Int* __restrict out, size_t lanes) {
    const Int *a = values(node.inputs[0]), *when = values(node.inputs[1]);
    Int broken = 0;
    for (size_t k = 0; k < lanes; ++k) {
      out[k] = wrapped(a[k], node.width);
      broken |= (out[k] ^ a[k]) & -when[k];
    }
    for (size_t k = 0; broken != 0 && k < lanes; ++k)
      if (when[k] && out[k] != a[k]) report(static_cast<int>(k), node.fault, static_cast<int64_t>(a[k]));
  }

  void report(int lane, Fault fault, int64_t number) {
    const auto own = std::find_if(faults_.begin(), faults_.end(), [&](auto& f) { return f.lane == lane; });
    if (own == faults_.end())
      faults_.push_back({lane, fault, number});
    else if (fault < own->fault)
      *own = {lane, fault, number};
  }

  const Graph& graph_;
  size_t lanes_;
  std::vector<Int> values_;
  std::vector<LaneFault> faults_;
};

}  // namespace cuboct::graph
