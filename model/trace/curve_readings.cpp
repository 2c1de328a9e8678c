// SPDX-License-Identifier: MIT
#include "model/trace/curve_readings.h"

#include "model/base/json.h"

namespace cuboct {

void add_reading(std::vector<Curve>& to, uint64_t step, Values values) {
  for (size_t k = 0; k < values.size(); ++k) to[k].step.push_back(step), to[k].value.push_back(values[k]);
}

void for_each_reading(const std::vector<Curve>& curves, const std::function<void(uint64_t, Values)>& see) {
  if (curves.empty()) return;
  std::vector<size_t> next(curves.size());
  std::vector<double> values;
  for (const uint64_t step : curves[0].step) {
    values.clear();
    for (size_t k = 0; k < curves.size(); ++k) {
      if (next[k] == curves[k].step.size() || curves[k].step[next[k]] != step) break;
      values.push_back(curves[k].value[next[k]++]);
    }
    see(step, values);
  }
}

std::vector<Curve> bare(std::vector<Curve> curves) {
  for (Curve& curve : curves) curve.step.clear(), curve.value.clear();
  return curves;
}

std::string curve_json(const Curve& curve) {
  std::vector<size_t> steps(curve.step.begin(), curve.step.end());
  return json_object({{"name", json(curve.name)},
                      {"unit", json(curve.unit)},
                      {"step", json(steps)},
                      {"value", json(curve.value)}});
}

void ThinnedReadings::add(uint64_t step, Values values) {
  newest_ = {step, {values.begin(), values.end()}};
  newest_is_kept_ = come_++ % every_ == 0;
  if (!newest_is_kept_) return;
  rows_.push_back(newest_);
  if (rows_.size() < 2 * most_) return;
  // Of an even number: the newest goes from the rows, and stays the newest.
  for (size_t k = 1; k < most_; ++k) rows_[k] = std::move(rows_[2 * k]);
  rows_.resize(most_);
  every_ *= 2;
  newest_is_kept_ = false;
}

void ThinnedReadings::clear() { *this = ThinnedReadings(most_); }

void ThinnedReadings::append_to(std::vector<Curve>& curves) const {
  for (const auto& [step, values] : rows_) add_reading(curves, step, values);
  if (!newest_is_kept_) add_reading(curves, newest_.first, newest_.second);
}

}  // namespace cuboct
