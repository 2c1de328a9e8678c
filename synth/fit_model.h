// SPDX-License-Identifier: MIT
// What a node takes on a device, as a function of brick, lanes and pipes: its memories as they are counted
// (hw/cost/node_memories.h) in the blocks that the device has, all else as synthesis measured it for a few
// nodes, straight lines between.
#pragma once

#include <array>
#include <vector>

#include "hw/cost/node_memories.h"
#include "hw/cost/room_search.h"
#include "synth/target.h"

namespace cuboct::synth {

// The resources of an FPGA in the order of FitAmounts.
inline constexpr std::array<Resource, 5> kFitted = {Resource::lut, Resource::ff, Resource::dsp,
                                                    Resource::bram, Resource::cell};
FitAmounts amounts_of(const Counts& counts);
// What may be used of a device: planned_share of what it holds; its logic cells where a LUT and a flip-flop
// share one.
FitAmounts room_of(const Target& target);

// A memory in the blocks, LUTs or flip-flops of a family, as yosys chooses: the least number of blocks, of
// any of their shapes; what has up to 16 words, or answers at once, in LUTs where LUTs can hold it.
Counts memory_counts(Family family, const NodeMemory& memory);

class FitModel {
 public:
  // The first point that is added is the lines' base.
  void add(const FitPoint& point, const FitAmounts& memories, const FitAmounts& measured);
  bool empty() const { return points_.empty(); }
  // `memories`: those of the point.
  FitAmounts predict(const FitPoint& point, const FitAmounts& memories) const;

 private:
  using Values = std::array<double, 5>;
  struct Point {
    FitPoint at;
    Values rest;  // measured less memories
  };
  // Of nodes of one cell, or of bricks, which have other modules: a point, and what a lane and a pipe more
  // take.
  struct Line {
    FitPoint base;
    Values value{}, by_lane{}, by_pipe{};
    Values at(const FitPoint& point) const;
  };
  Line line_through(bool bricks) const;

  std::vector<Point> points_;
  std::array<Line, 2> lines_;  // of one cell, of bricks
};

}  // namespace cuboct::synth
