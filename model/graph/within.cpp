// SPDX-License-Identifier: MIT
// What follows from the truth that a pair counts.
#include <algorithm>
#include <stdexcept>

#include "model/graph/builder.h"

namespace cuboct::graph {
namespace {

Wide root(Wide a) {  // rounded down; a < 2^126
  Wide r = 0;
  for (Wide bit = Wide{1} << 62; bit > 0; bit >>= 1)
    if ((r + bit) * (r + bit) <= a) r += bit;
  return r;
}

Wide size_of(Interval a) { return std::max(-Wide{a.low}, Wide{a.high}); }

Interval common(Interval a, Interval b) { return {std::max(a.low, b.low), std::min(a.high, b.high)}; }

// {v_0, v_1, ...} where the node is their sum of squares, as it is.
std::vector<int> squared(const Node& node) {
  if (node.shift != 0 || (node.op != Op::dot && node.op != Op::mul)) return {};
  const size_t n = node.inputs.size() / 2;
  std::vector<int> parts(node.inputs.begin(), node.inputs.begin() + static_cast<long>(n));
  return std::equal(parts.begin(), parts.end(), node.inputs.begin() + static_cast<long>(n))
             ? parts
             : std::vector<int>();
}

}  // namespace

void Builder::counts(int when) {
  need_truth(when);
  if (when_ >= 0) throw std::logic_error("a pair counts by one truth");
  when_ = when;
  learn(when);
}

void Builder::learn(int truth) {
  const Node node = at(truth);
  if (node.op == Op::both)
    for (const int part : node.inputs) learn(part);
  if (node.op == Op::lt) learn_below(node.inputs[0], node.inputs[1], 1);
  if (node.op == Op::le) learn_below(node.inputs[0], node.inputs[1], 0);
  learn(truth, {1, 1});
}

// a + gap <= b
void Builder::learn_below(int a, int b, int64_t gap) {
  learn(a, {kWidest.low, range(b).high - gap});
  learn(b, {range(a).low + gap, kWidest.high});
  learn_square(a, range(b).high - gap);
}

void Builder::learn(int node, Interval range) { facts_.push_back({bare(node), range}); }

void Builder::learn_square(int node, int64_t square) {
  const std::vector<int> parts = squared(at(bare(node)));
  if (parts.empty() || square < 0) return;
  const auto most = static_cast<int64_t>(root(square));
  for (const int part : parts) learn(part, {-most, most});
  vectors_.push_back({parts, square});
}

int Builder::bare(int node) const { return at(node).op == Op::within ? at(node).inputs[0] : node; }

// The other factors where each part of the vector is a factor once; else none.
std::vector<int> Builder::beside(const Node& dot, const Vector& vector) const {
  std::vector<int> left = vector.parts, others;
  const size_t n = dot.inputs.size() / 2;
  for (size_t k = 0; k < n; ++k) {
    int part = dot.inputs[k], other = dot.inputs[n + k];
    auto found = std::find(left.begin(), left.end(), bare(part));
    if (found == left.end()) std::swap(part, other), found = std::find(left.begin(), left.end(), bare(part));
    if (found == left.end()) return {};
    left.erase(found);
    others.push_back(other);
  }
  return left.empty() ? others : std::vector<int>();
}

// |sum a_k b_k| <= sqrt(sum a_k^2) sqrt(sum b_k^2), where one of the vectors has a known square.
Interval Builder::by_cauchy(int node) const {
  const Node& dot = at(node);
  Interval known = kWidest;
  if (dot.op != Op::dot) return known;
  for (const Vector& vector : vectors_) {
    const std::vector<int> others = beside(dot, vector);
    Wide square = 0;
    for (const int other : others) square += size_of(range(other)) * size_of(range(other));
    if (others.empty() || square >> 60 != 0) continue;
    const auto most = static_cast<int64_t>(root(square * vector.square));
    const WideInterval end = range_of({.op = Op::round, .shift = dot.shift}, {{0, most}}, nullptr);
    known = common(known, {-static_cast<int64_t>(end.high), static_cast<int64_t>(end.high)});
  }
  return known;
}

int Builder::within(int a) {
  Interval known = common(range(a), by_cauchy(a));
  for (const Fact& fact : facts_)
    if (fact.node == bare(a)) known = common(known, fact.range);
  if (known == range(a) || known.low > known.high) return a;
  Node node = made(Op::within, {a});
  node.range = known;
  return added(std::move(node));
}

}  // namespace cuboct::graph
