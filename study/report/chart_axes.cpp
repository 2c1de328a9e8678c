// SPDX-License-Identifier: MIT
#include "study/report/chart_axes.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "study/sweep/numbers.h"

namespace cuboct::study {
namespace {

constexpr int kMostLabels = 12;

// Few digits leave no room for the last bits of a power or a product.
constexpr double kNear = 1e-9;

std::set<double> drawn_values(const std::vector<double>& values, const Rows& drawn) {
  std::set<double> all;
  for (const size_t row : drawn) all.insert(values[row]);
  return all;
}

// A sixth of the range or less, of 1, 2 or 5 times a power of ten.
double round_step(double range) {
  const double power = std::pow(10, std::floor(std::log10(range / 6)));
  for (const double digit : {1, 2, 5})
    if (range / (digit * power) <= 6) return digit * power;
  return 10 * power;
}

}  // namespace

ChartAxis decades_axis(const std::string& label, std::vector<double> values, const Rows& drawn) {
  std::set<double> all = drawn_values(values, drawn);
  const bool zero = all.erase(0) > 0;
  int low = -1, high = 0;
  if (!all.empty()) {
    low = static_cast<int>(std::floor(std::log10(*all.begin()) + kNear));
    high = std::max(static_cast<int>(std::ceil(std::log10(*all.rbegin()) - kNear)), low + 1);
  }
  ChartAxis axis{label, std::move(values), true, true, std::pow(10, zero ? low - 1 : low), std::pow(10, high),
                 {}};
  if (zero) axis.ticks.push_back({axis.low, "0"});
  for (int e = low; e <= high; e += 1 + (high - low) / kMostLabels)
    axis.ticks.push_back({std::pow(10, e), power_of_ten(e)});
  return axis;
}

ChartAxis close_axis(const std::string& label, std::vector<double> values, const Rows& drawn,
                     bool logarithmic) {
  const std::set<double> all = drawn_values(values, drawn);
  const double least = *all.begin(), most = *all.rbegin();
  ChartAxis axis{label, std::move(values), logarithmic, false, 0, 0, {}};
  if (logarithmic) {
    axis.low = least / 1.3, axis.high = most * 1.3;
    const int first = static_cast<int>(std::floor(std::log10(axis.low)));
    for (int e = first; e <= std::log10(axis.high); ++e)
      for (const int digit : {1, 2, 5})
        if (const double tick = digit * std::pow(10, e); tick >= axis.low && tick <= axis.high)
          axis.ticks.push_back({tick, digit == 1 ? power_of_ten(e) : number_text(tick)});
    return axis;
  }
  const double margin = most > least ? 0.06 * (most - least) : 1;
  axis.low = least - margin, axis.high = most + margin;
  if (all.size() <= kMostLabels) {
    for (const double value : all) axis.ticks.push_back({value, number_text(value)});
    return axis;
  }
  const double step = round_step(axis.high - axis.low);
  for (double k = std::ceil(axis.low / step); k * step <= axis.high; ++k)
    axis.ticks.push_back({k * step, number_text(k * step)});
  return axis;
}

ChartAxis named_axis(const std::string& label, std::vector<double> values,
                     const std::vector<std::string>& names) {
  ChartAxis axis{label, std::move(values), false, false, -0.5, static_cast<double>(names.size()) - 0.5, {}};
  for (size_t k = 0; k < names.size(); ++k) axis.ticks.push_back({static_cast<double>(k), names[k]});
  return axis;
}

}  // namespace cuboct::study
