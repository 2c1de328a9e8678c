// SPDX-License-Identifier: MIT
#include "model/analysis/tension.h"

#include <algorithm>
#include <stdexcept>

namespace cuboct {
namespace {

constexpr double kElasticStrain = 0.005;
constexpr size_t kFewest = 5;    // readings that make a modulus
constexpr double kBroken = 0.1;  // of the strength

std::optional<double> slope(const std::vector<double>& x, const std::vector<double>& y, size_t end) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (size_t k = 0; k < end; ++k) {
    if (x[k] > kElasticStrain) continue;
    n += 1, sx += x[k], sy += y[k], sxx += x[k] * x[k], sxy += x[k] * y[k];
  }
  const double spread = n * sxx - sx * sx;
  if (n < kFewest || !(spread > 0)) return std::nullopt;
  return (n * sxy - sx * sy) / spread;
}

}  // namespace

const Curve* find_curve(const std::vector<Curve>& curves, const std::string& name) {
  for (const Curve& curve : curves)
    if (curve.name == name && curve.value.size() > 1) return &curve;
  return nullptr;
}

std::optional<Tension> tension_of(const std::vector<Curve>& curves, const std::string& probe) {
  const Tension tension{find_curve(curves, probe + ".strain"), find_curve(curves, probe + ".stress")};
  if (!tension.strain || !tension.stress || tension.strain->step != tension.stress->step) return std::nullopt;
  return tension;
}

std::vector<double> running_mean(const std::vector<double>& values, size_t width) {
  const auto count = static_cast<ptrdiff_t>(values.size()), half = static_cast<ptrdiff_t>(width / 2);
  std::vector<double> mean(values.size());
  for (ptrdiff_t k = 0; k < count; ++k) {
    // The same number on both sides: a straight rise stays where it is.
    const ptrdiff_t reach = std::min({half, k, count - 1 - k});
    double sum = 0;
    for (ptrdiff_t j = k - reach; j <= k + reach; ++j) sum += values[static_cast<size_t>(j)];
    mean[static_cast<size_t>(k)] = sum / static_cast<double>(2 * reach + 1);
  }
  return mean;
}

size_t tension_window(size_t count) { return std::max<size_t>(1, count / 100) | 1; }

TensionFigures tension_figures(const std::vector<double>& strain, const std::vector<double>& stress) {
  if (strain.size() != stress.size() || strain.size() < 2)
    throw std::invalid_argument("a tension test needs strains and stresses of the same two or more readings");
  const std::vector<double> mean = running_mean(stress, tension_window(stress.size()));
  const auto peak = static_cast<size_t>(std::max_element(mean.begin(), mean.end()) - mean.begin());
  TensionFigures figures;
  figures.strength = mean[peak];
  figures.yield_strain = strain[peak];
  figures.modulus = slope(strain, stress, peak + 1);
  if (figures.strength > 0 && mean.back() < kBroken * figures.strength) {
    size_t last = mean.size() - 1;
    while (mean[last] < kBroken * figures.strength) --last;
    figures.strain_at_break = strain[last];
  }
  return figures;
}

}  // namespace cuboct
