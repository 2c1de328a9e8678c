// SPDX-License-Identifier: MIT
#include "model/analysis/displacement.h"

#include <fmt/format.h>

#include "model/base/error.h"
#include "model/contract/nearest_image.h"

namespace cuboct {
namespace {

constexpr double kKnownWay = 0.25;  // of a period

[[noreturn]] void refuse_way(uint64_t from, uint64_t to, const std::string& who, double way, int axis,
                             double period) {
  throw InputError(fmt::format("between steps {} and {} {} {:.3g} m along {}, more than a quarter of the box "
                               "({:.3g} m): its way is not known",
                               from, to, who, way, "xyz"[axis], period),
                   "keep frames more often: 'cuboct run --frame-every N'");
}

}  // namespace

void DisplacementMeter::check(uint64_t step, const std::vector<Vec3>& ways, const Vec3& drift,
                              double dt) const {
  const double time = static_cast<double>(step - step_) * dt;
  for (int axis = 0; axis < 3; ++axis) {
    const double period = periodic_.extent[axis];
    if (period == 0) continue;
    const double whole = time * std::max(std::abs(drift[axis]), std::abs(drift_[axis]));
    if (whole > kKnownWay * period) refuse_way(step_, step, "the whole moves", whole, axis, period);
    for (size_t i = 0; i < ways.size(); ++i)
      if (const double way = std::abs(ways[i][axis]); way > kKnownWay * period)
        refuse_way(step_, step, fmt::format("particle {} moves", i), way, axis, period);
  }
}

void DisplacementMeter::add(uint64_t step, const std::vector<Vec3>& x, const std::vector<Vec3>& v,
                            double dt) {
  Vec3 drift = Vec3::Zero();
  for (const Vec3& one : v) drift += one / static_cast<double>(v.size());
  if (latest_.empty()) {
    moved_.assign(x.size(), Vec3::Zero());
    latest_ = x;
  } else if (wrapped_) {
    std::vector<Vec3> ways(x.size());
    for (size_t i = 0; i < x.size(); ++i) ways[i] = nearest_image(x[i] - latest_[i], periodic_);
    check(step, ways, drift, dt);
    for (size_t i = 0; i < x.size(); ++i) moved_[i] += ways[i];
    latest_ = x;
  } else {
    for (size_t i = 0; i < x.size(); ++i) moved_[i] = x[i] - latest_[i];
  }
  step_ = step, drift_ = drift;
}

Vec3 mean_squared(const std::vector<Vec3>& moved, const std::vector<char>& counted,
                  const std::vector<double>& masses) {
  Vec3 centre = Vec3::Zero(), sum = Vec3::Zero();
  const auto counts = [&](size_t i) { return counted.empty() || counted[i] != 0; };
  double mass = 0, number = 0;
  for (size_t i = 0; i < masses.size(); ++i)
    if (counts(i)) centre += masses[i] * moved[i], mass += masses[i];
  if (mass > 0) centre /= mass;
  for (size_t i = 0; i < moved.size(); ++i)
    if (counts(i)) sum += (moved[i] - centre).cwiseAbs2(), ++number;
  return number > 0 ? Vec3(sum / number) : sum;
}

}  // namespace cuboct
