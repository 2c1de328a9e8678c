// SPDX-License-Identifier: MIT
// A function of one number by its values at places of the author's: cubics between them, and beyond the first
// and the last place what it is there.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "model/contract/hermite.h"
#include "model/program/table_curve.h"

namespace cuboct {

class PointTable final : public TableCurve {
 public:
  PointTable(std::string what, Hermite cubics) : what_(std::move(what)), cubics_(std::move(cubics)) {}

  double at(double x) const override {
    if (!(x > begin())) return cubics_.first();
    return x < end() ? cubics_.at(x) : cubics_.last();
  }
  double slope(double x) const override { return x >= begin() && x < end() ? cubics_.slope(x) : 0; }
  double begin() const override { return cubics_.begin(); }
  double end() const override { return cubics_.end(); }
  const std::string& what() const override { return what_; }
  std::pair<double, double> range(bool of_slope) const override {
    constexpr int kPoints = 4096;
    const auto value = [&](double x) { return of_slope ? slope(x) : at(x); };
    double low = value(begin()), high = low;
    for (int k = 1; k < kPoints; ++k) {
      const double v = value(begin() + (end() - begin()) * k / kPoints);
      low = std::min(low, v), high = std::max(high, v);
    }
    const double last = of_slope ? slope(end()) : at(end());
    return {std::min(low, last), std::max(high, last)};
  }
  const Hermite& cubics() const { return cubics_; }

 private:
  std::string what_;
  Hermite cubics_;
};

}  // namespace cuboct
