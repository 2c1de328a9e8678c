// SPDX-License-Identifier: MIT
#include "model/program/cubic_table.h"

#include <utility>

namespace cuboct {

CubicTable::CubicTable(std::string what, double step, const std::vector<double>& f, bool bounded)
    : what_(std::move(what)), step_(step), per_step_(1 / step), bounded_(bounded) {
  const size_t n = f.size();
  std::vector<double> slope(n);  // a step
  slope[0] = f[1] - f[0];
  slope[1] = (f[2] - f[0]) / 2;
  for (size_t m = 2; m + 2 < n; ++m) slope[m] = ((f[m - 2] - f[m + 2]) + 8 * (f[m + 1] - f[m - 1])) / 12;
  slope[n - 2] = (f[n - 1] - f[n - 3]) / 2;
  slope[n - 1] = f[n - 1] - f[n - 2];
  for (size_t m = 0; m + 1 < n; ++m) {
    const double rise = f[m + 1] - f[m];
    cubics_.insert(cubics_.end(), {f[m], slope[m], 3 * rise - 2 * slope[m] - slope[m + 1],
                                   slope[m] + slope[m + 1] - 2 * rise});
  }
}

std::pair<double, double> CubicTable::range(bool of_slope) const {
  constexpr size_t kPoints = 8;  // of a bin
  const auto value = [&](double x) { return of_slope ? slope(x) : at(x); };
  double low = value(0), high = low;
  for (size_t k = 1; k <= kPoints * bins(); ++k) {
    const double v = value(step_ * static_cast<double>(k) / kPoints);
    low = std::min(low, v), high = std::max(high, v);
  }
  return {low, high};
}

}  // namespace cuboct
