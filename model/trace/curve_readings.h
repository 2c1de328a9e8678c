// SPDX-License-Identifier: MIT
// Curves row by row, as they come while a run goes: at a step a value of each curve, or of the first ones.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "model/trace/trace.h"

namespace cuboct {

using Values = std::span<const double>;

// What a run hands over of a step. `of`: name and unit of each curve.
using TakeReading = std::function<void(const std::vector<Curve>& of, uint64_t step, Values values)>;

void add_reading(std::vector<Curve>& to, uint64_t step, Values values);
// Of curves that were made so: the first one has every step.
void for_each_reading(const std::vector<Curve>& curves, const std::function<void(uint64_t, Values)>& see);
// Curves of the same names and units, without readings.
std::vector<Curve> bare(std::vector<Curve> curves);
// name, unit, step, value
std::string curve_json(const Curve& curve);

// A part of many readings, spread evenly over them: 2 `most` at most, and the newest. Each time they fill up,
// every second one goes, and so does every second one of those that follow.
class ThinnedReadings {
 public:
  explicit ThinnedReadings(size_t most) : most_(most) {}
  void add(uint64_t step, Values values);
  void clear();
  size_t size() const { return rows_.size() + (newest_is_kept_ ? 0 : 1); }
  void append_to(std::vector<Curve>& curves) const;

 private:
  using Row = std::pair<uint64_t, std::vector<double>>;
  size_t most_;
  uint64_t come_ = 0, every_ = 1;
  std::vector<Row> rows_;
  Row newest_;
  bool newest_is_kept_ = true;  // in rows_, or there is none
};

}  // namespace cuboct
