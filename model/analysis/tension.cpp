// SPDX-License-Identifier: MIT
#include "model/analysis/tension.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>

#include "model/analysis/motion.h"

namespace cuboct {
namespace {

constexpr double kBroken = 0.1;    // of the strength
constexpr double kLevel = 1e-3;    // of a stress: less is no rise
constexpr double kYielded = 0.05;  // of a stress

// A line is straight where the slopes of its halves differ by so much of them at most, but for their errors,
// and readings stand beside it by so much of its rise.
constexpr double kStraight = 0.02;
constexpr size_t kFewest = 4;      // readings that make a line
constexpr double kRoundTrips = 3;  // that a line goes over at least
constexpr double kLonger = 1.03;   // a stretch that is tried, over the one before
constexpr double kSigmas = 2;

// A curve between its points, and its integral.
class Between {
 public:
  Between(const std::vector<double>& time, const std::vector<double>& value)
      : time_(time), value_(value), sum_(time.size()) {
    for (size_t k = 1; k < time.size(); ++k)
      sum_[k] = sum_[k - 1] + (time[k] - time[k - 1]) * (value[k - 1] + value[k]) / 2;
  }
  // Over `width` around `at`; the value there where that is 0.
  double mean(double at, double width) const {
    return width > 0 ? (integral(at + width / 2) - integral(at - width / 2)) / width : look(at).value;
  }

 private:
  struct Look {
    size_t piece;
    double value;
  };
  Look look(double at) const {
    const auto above = std::upper_bound(time_.begin() + 1, time_.end() - 1, at);
    const auto k = static_cast<size_t>(above - time_.begin()) - 1;
    const double part = std::clamp((at - time_[k]) / (time_[k + 1] - time_[k]), 0.0, 1.0);
    return {k, value_[k] + part * (value_[k + 1] - value_[k])};
  }
  double integral(double at) const {
    const auto [k, value] = look(at);
    const double along = std::clamp(at, time_[k], time_[k + 1]) - time_[k];
    return sum_[k] + along * (value_[k] + value) / 2;
  }

  const std::vector<double>&time_, &value_;
  std::vector<double> sum_;
};

struct Line {
  double slope = 0, intercept = 0;
  double rest = 0;   // root mean square of what stands beside it
  double error = 0;  // of the slope
  double rise = 0;
};

// `independent`: of so many readings the curve tells, as neighbours share most of what they are means of.
Line line_through(std::span<const double> x, std::span<const double> y, double independent) {
  const auto n = static_cast<double>(x.size());
  double mx = 0, my = 0, xx = 0, xy = 0, yy = 0;
  for (size_t k = 0; k < x.size(); ++k) mx += x[k] / n, my += y[k] / n;
  for (size_t k = 0; k < x.size(); ++k) {
    xx += (x[k] - mx) * (x[k] - mx), xy += (x[k] - mx) * (y[k] - my), yy += (y[k] - my) * (y[k] - my);
  }
  if (!(xx > 0)) return {};
  Line line;
  line.slope = xy / xx;
  line.intercept = my - line.slope * mx;
  line.rest = std::sqrt(std::max(0.0, yy - xy * xy / xx) / n);
  line.error = line.rest / std::sqrt(xx / n * std::max(1.0, independent - 2));
  line.rise = line.slope * (x.back() - x.front());
  return line;
}

// The readings at which a mean over a round trip is behind the first one, and within the curve.
struct Settled {
  std::vector<double> strain, stress;
  double spacing = 0;  // of their times
  double independent(size_t count, double round_trip) const {
    return 1 + static_cast<double>(count - 1) * std::min(1.0, round_trip > 0 ? spacing / round_trip : 1.0);
  }
};

Settled settled(const TensionTest& test, size_t end) {
  const Between strain(test.time, test.strain), stress(test.time, test.stress);
  Settled all;
  double first = 0, last = 0;
  for (size_t k = 0; k < end; ++k) {
    const double t = test.time[k], half = test.round_trip / 2;
    if (t - test.time.front() < test.round_trip || t + half > test.time.back()) continue;
    if (all.strain.empty()) first = t;
    last = t;
    all.strain.push_back(strain.mean(t, test.round_trip));
    all.stress.push_back(stress.mean(t, test.round_trip));
  }
  if (all.strain.size() > 1) all.spacing = (last - first) / static_cast<double>(all.strain.size() - 1);
  return all;
}

bool is_straight(const Settled& all, size_t count, double independent, const Line& whole) {
  const std::span x(all.strain.data(), count), y(all.stress.data(), count);
  const Line below = line_through(x.first((count + 1) / 2), y.first((count + 1) / 2), independent / 2);
  const Line above = line_through(x.last((count + 1) / 2), y.last((count + 1) / 2), independent / 2);
  return std::abs(above.slope - below.slope) <=
             kStraight * std::abs(whole.slope) + kSigmas * std::hypot(below.error, above.error) &&
         whole.rest <= kStraight * std::abs(whole.rise) && whole.slope > 0;
}

struct Straight {
  CurveFigure slope;
  double intercept = 0;
  double stress_at(double strain) const { return intercept + slope.value.value_or(0) * strain; }
};

// The longest straight stretch from the first settled reading on. `end`: readings up to the largest stress.
Straight straight_part(const TensionTest& test, size_t end) {
  Straight found;
  const Settled all = settled(test, end);
  const size_t most = all.strain.size();
  const auto independent = [&](size_t count) { return all.independent(count, test.round_trip); };
  size_t least = kFewest;
  while (least <= most && independent(least) < kRoundTrips) ++least;
  if (least > most) {
    found.slope.why =
        most < kFewest
            ? fmt::format("{} readings{} before the largest stress: {} are needed", most,
                          test.round_trip > 0 ? " behind the first round trip of waves and" : "", kFewest)
            : fmt::format(
                  "{:.2g} round trips of waves behind the first one and before the largest stress: "
                  "{:g} are needed",
                  independent(most), kRoundTrips);
    return found;
  }
  for (size_t count = least, before = 0; count != before; before = count,
              count = std::min(
                  most, std::max(count + 1, static_cast<size_t>(kLonger * static_cast<double>(count))))) {
    const Line line =
        line_through({all.strain.data(), count}, {all.stress.data(), count}, independent(count));
    if (!is_straight(all, count, independent(count), line)) continue;
    found.slope.value = line.slope;
    found.slope.error = line.error;
    found.slope.from = all.strain.front(), found.slope.to = all.strain[count - 1];
    found.intercept = line.intercept;
  }
  if (!found.slope.value)
    found.slope.why = fmt::format("the stress is no straight line of the strain from {:.3g} to {:.3g}",
                                  all.strain.front(), all.strain[least - 1]);
  return found;
}

// Whether the stress, without what waves add, is largest at the end.
bool rises_to_the_end(const TensionTest& test) {
  const Settled all = settled(test, test.time.size());
  if (all.stress.empty()) return true;
  const size_t window = tension_window(all.stress.size());
  const std::vector<double> mean = running_mean(all.stress, window);
  const double level = (1 - kLevel) * std::ranges::max(mean);
  const auto reached = std::ranges::find_if(mean, [&](double stress) { return stress >= level; });
  return static_cast<size_t>(mean.end() - reached) < window / 2 + 2;
}

double deviation(const std::vector<double>& values, size_t from, size_t end, double mean) {
  double sum = 0;
  for (size_t k = from; k < end; ++k) sum += (values[k] - mean) * (values[k] - mean);
  return std::sqrt(sum / static_cast<double>(end - from));
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

double pulled_length(const Scene& scene, const Probe& probe) {
  const auto along = [&](uint32_t id) { return scene.body.x[id].dot(probe.axis); };
  double gauge = 0, count = 0;
  for (const ParticleSet* set : {&probe.lower, &probe.upper})
    for (const uint32_t id : set->ids) gauge += along(id), ++count;
  gauge /= std::max(1.0, count);
  double low = gauge, high = gauge, low_grip = -INFINITY, high_grip = INFINITY;
  for (uint32_t id = 0; id < scene.body.size(); ++id) {
    const double x = along(id);
    low = std::min(low, x), high = std::max(high, x);
    if (!driven(scene.rule.types[scene.body.type[id]])) continue;
    if (x <= gauge) low_grip = std::max(low_grip, x);
    if (x >= gauge) high_grip = std::min(high_grip, x);
  }
  return (std::isfinite(high_grip) ? high_grip : high) - (std::isfinite(low_grip) ? low_grip : low);
}

TensionTest tension_test(const Tension& curves, const Scene& scene, const Probe& probe) {
  TensionTest test{curves.strain->value, curves.stress->value, {}};
  for (const uint64_t step : curves.strain->step) test.time.push_back(static_cast<double>(step));
  if (scene.loading) return test;
  if (const double speed = motion_of(scene).sound_speed; speed > 0)
    test.round_trip = 2 * pulled_length(scene, probe) / speed / scene.rule.dt;
  return test;
}

TensionFigures tension_figures(const TensionTest& given) {
  const size_t count = given.strain.size();
  if (count < 2 || given.stress.size() != count || given.time.size() != count ||
      !std::ranges::is_sorted(given.time, std::less_equal<>()))
    throw std::invalid_argument("a tension test needs strains and stresses of the same two or more readings");
  TensionTest test = given;
  const double sign = std::ranges::max(test.strain) < -std::ranges::min(test.strain) ? -1 : 1;
  for (double& strain : test.strain) strain *= sign;
  for (double& stress : test.stress) stress *= sign;
  const size_t window = tension_window(count), half = window / 2;
  const std::vector<double> mean = running_mean(test.stress, window);
  const auto peak = static_cast<size_t>(std::ranges::max_element(mean) - mean.begin());
  TensionFigures figures;
  const Straight straight = straight_part(test, peak + 1);
  figures.modulus = straight.slope;
  figures.modulus.from *= sign, figures.modulus.to *= sign;
  const bool early = test.time[peak] - test.time.front() < test.round_trip;
  if (early || !(mean[peak] > 0)) {
    const std::string why = early ? "the largest stress comes while waves go to and fro for the first time"
                                  : "nothing resists the strain";
    for (CurveFigure* figure : {&figures.strength, &figures.yield_strain, &figures.strain_at_break})
      figure->why = why;
    return figures;
  }
  const size_t reach = std::min({half, peak, count - 1 - peak}), from = peak - reach, end = peak + reach + 1;
  figures.strength.value = sign * mean[peak];
  figures.strength.from = given.strain[from], figures.strength.to = given.strain[end - 1];
  figures.strength.error =
      deviation(test.stress, from, end, mean[peak]) / std::sqrt(static_cast<double>(end - from));
  figures.rises_at_end = rises_to_the_end(test);

  // A body that yields falls behind its straight part before it loses its strength.
  size_t carried = count - 1;
  while (mean[carried] < (1 - kYielded) * mean[peak]) --carried;
  CurveFigure& yields = figures.yield_strain;
  if (figures.rises_at_end)
    yields.why = "the stress still rises at the end";
  else if (straight.slope.value && mean[carried] > (1 - kYielded) * straight.stress_at(test.strain[carried]))
    yields.why = "it breaks on its straight part";
  else
    yields.value = given.strain[peak];
  yields.from = figures.strength.from, yields.to = figures.strength.to;
  yields.error = std::abs(yields.to - yields.from) / 2;

  CurveFigure& breaks = figures.strain_at_break;
  if (mean.back() >= kBroken * mean[peak]) {
    breaks.why =
        fmt::format("at the end it carries {:.3g} % of its strength", 100 * mean.back() / mean[peak]);
  } else {
    size_t last = count - 1;
    while (mean[last] < kBroken * mean[peak]) --last;
    breaks.value = breaks.from = given.strain[last];
    breaks.to = given.strain[last + 1];
    breaks.error = std::abs(breaks.to - breaks.from) / 2;
  }
  return figures;
}

}  // namespace cuboct
