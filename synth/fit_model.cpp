// SPDX-License-Identifier: MIT
#include "synth/fit_model.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "model/base/integer_math.h"

namespace cuboct::synth {
namespace {

struct BlockShape {
  uint64_t bits, words;
};

uint64_t blocks(std::span<const BlockShape> shapes, const NodeMemory& m) {
  uint64_t least = UINT64_MAX;
  for (const BlockShape& s : shapes)
    least = std::min(least, ceil_div(static_cast<uint64_t>(m.bits), s.bits) * ceil_div(m.words, s.words));
  return least;
}

// From the makers' data sheets.
constexpr std::array<BlockShape, 4> kRam40{{{16, 256}, {8, 512}, {4, 1024}, {2, 2048}}};
constexpr std::array<BlockShape, 6> kDp16{
    {{36, 512}, {18, 1024}, {9, 2048}, {4, 4096}, {2, 8192}, {1, 16384}}};

bool is_brick(const FitPoint& p) { return cells_of(p.brick) > 1; }

double apart(const FitPoint& a, const FitPoint& b) {
  const auto steps = [](double x, double y) { return std::abs(std::log2(x / y)); };
  return steps(cells_of(a.brick), cells_of(b.brick)) + steps(a.lanes, b.lanes) + steps(a.pipes, b.pipes);
}

}  // namespace

FitAmounts amounts_of(const Counts& counts) {
  FitAmounts amounts;
  for (size_t r = 0; r < kFitted.size(); ++r) amounts[r] = counts[kFitted[r]];
  return amounts;
}

FitAmounts room_of(const Target& target) {
  FitAmounts room;
  for (size_t r = 0; r < kFitted.size(); ++r)
    room[r] = kFitted[r] == Resource::cell
                  ? target.family == Family::ice40 ? target.holds[Resource::lut] : UINT64_MAX
                  : static_cast<uint64_t>(planned_share(target, kFitted[r]) *
                                          static_cast<double>(target.holds[kFitted[r]]));
  return room;
}

// What yosys' memory_libmap weighs: a block, and the LUTs that hold so many bits of so many words, for each
// port to read; without such, a bit in a flip-flop costs 1. From its share/*/brams.txt, lutrams.txt.
struct Weights {
  std::span<const BlockShape> blocks;
  uint64_t block;
  uint64_t bits, words, luts, lut_memory;  // 0: LUTs hold none
};

Weights weights_of(Family family) {
  switch (family) {
    case Family::ice40:
      return {kRam40, 64, 0, 0, 0, 0};
    case Family::ecp5:
      return {kDp16, 128, 4, 16, 4, 4};
    case Family::xc7:
      return {kDp16, 129, 6, 32, 4, 8};  // blocks of 18 kbit
    case Family::asic:
      break;
  }
  return {{}, 0, 0, 0, 0, 0};
}

Counts memory_counts(Family family, const NodeMemory& m) {
  const Weights w = weights_of(family);
  const auto bits = static_cast<uint64_t>(m.bits), copies = static_cast<uint64_t>(m.copies),
             reads = static_cast<uint64_t>(m.reads);
  const uint64_t in_blocks = reads * blocks(w.blocks, m);
  const uint64_t pieces = w.bits == 0 ? 0 : reads * ceil_div(bits, w.bits) * ceil_div(m.words, w.words);
  const uint64_t soft = w.bits == 0 ? bits * m.words : pieces * w.lut_memory;
  Counts counts;
  if (m.kind == NodeMemory::Kind::block ||
      (m.kind == NodeMemory::Kind::late && in_blocks * w.block <= soft)) {
    counts[Resource::bram] = copies * in_blocks;
  } else if (w.bits > 0) {
    counts[Resource::lut] = copies * pieces * w.luts;
  } else {
    // Each bit has a flip-flop; for each port that is at once there, a LUT chooses among some of them.
    counts[Resource::ff] = copies * soft;
    counts[Resource::lut] = copies * soft * reads;
    counts[Resource::cell] = counts[Resource::ff] + counts[Resource::lut];
  }
  return counts;
}

void FitModel::add(const FitPoint& point, const FitAmounts& memories, const FitAmounts& measured) {
  Point p{point, {}};
  for (size_t r = 0; r < measured.size(); ++r)
    p.rest[r] = static_cast<double>(measured[r]) - static_cast<double>(memories[r]);
  points_.push_back(p);
  for (const bool bricks : {false, true}) lines_[bricks] = line_through(bricks);
}

// Slopes: between the first two points that differ in lanes alone, in pipes alone. Nodes that nobody measured
// are taken for the other kind.
FitModel::Line FitModel::line_through(bool bricks) const {
  std::vector<const Point*> kind;
  for (const Point& p : points_)
    if (is_brick(p.at) == bricks) kind.push_back(&p);
  if (kind.empty())
    for (const Point& p : points_) kind.push_back(&p);
  Line line{kind[0]->at, kind[0]->rest, {}, {}};
  bool lanes = false, pipes = false;
  for (const Point* a : kind)
    for (const Point* b : kind) {
      if (a->at.brick != b->at.brick) continue;
      const int more_lanes = b->at.lanes - a->at.lanes, more_pipes = b->at.pipes - a->at.pipes;
      const auto slope = [&](int by) {
        Values values;
        for (size_t r = 0; r < values.size(); ++r) values[r] = (b->rest[r] - a->rest[r]) / by;
        return values;
      };
      if (!lanes && more_lanes > 0 && more_pipes == 0) line.by_lane = slope(more_lanes), lanes = true;
      if (!pipes && more_pipes > 0 && more_lanes == 0) line.by_pipe = slope(more_pipes), pipes = true;
    }
  return line;
}

FitModel::Values FitModel::Line::at(const FitPoint& point) const {
  Values there = value;
  for (size_t r = 0; r < there.size(); ++r)
    there[r] += by_lane[r] * (point.lanes - base.lanes) + by_pipe[r] * (point.pipes - base.pipes);
  return there;
}

FitAmounts FitModel::predict(const FitPoint& point, const FitAmounts& memories) const {
  if (points_.empty()) return memories;
  const Line& line = lines_[is_brick(point)];
  Values value = line.at(point);
  // What the lines miss at the nearest node that was measured they miss here.
  const Point* nearest = nullptr;
  double nearest_apart = 0;
  for (const Point& p : points_) {
    if (is_brick(p.at) != is_brick(point)) continue;
    const double by = apart(p.at, point);
    if (!nearest || by < nearest_apart) nearest = &p, nearest_apart = by;
  }
  if (nearest) {
    const Values there = line.at(nearest->at);
    for (size_t r = 0; r < value.size(); ++r) value[r] += nearest->rest[r] - there[r];
  }
  FitAmounts amounts;
  for (size_t r = 0; r < value.size(); ++r)
    amounts[r] =
        static_cast<uint64_t>(std::llround(std::max(0.0, value[r] + static_cast<double>(memories[r]))));
  return amounts;
}

}  // namespace cuboct::synth
