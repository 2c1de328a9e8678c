// SPDX-License-Identifier: MIT
#include "model/trace/figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>
#include <unsupported/Eigen/FFT>

#include "model/base/error.h"
#include "model/base/spelling.h"

namespace cuboct {
namespace {

constexpr const char* kKinds[] = {"modulus", "strength", "frequency", "break_time", "mean", "final"};

const Curve& curve_named(const std::string& name, const std::vector<Curve>& curves) {
  std::vector<std::string> names;
  for (const Curve& curve : curves) {
    if (curve.name == name) return curve;
    names.push_back(curve.name);
  }
  const std::string near = did_you_mean(name, names);
  throw InputError(fmt::format("no curve '{}'", name), !near.empty()   ? near
                                                       : names.empty() ? "the scene has no probes"
                                                                       : "there are " + list_of(names));
}

[[noreturn]] void cannot(const Figure& figure, const std::string& why) {
  throw std::runtime_error(fmt::format("{}: {}", figure.name, why));
}

// Where the window lies beside all that there is, for who chose it.
std::string window_text(const std::string& of, const Figure& figure, const std::vector<double>& all,
                        size_t inside) {
  std::string text = fmt::format("{} samples of {} {}", inside, of,
                                 figure.to > 0 ? fmt::format("between {:g} and {:g}", figure.from, figure.to)
                                               : fmt::format("from {:g} on", figure.from));
  if (!all.empty())
    text += fmt::format(", of {} from {:.4g} to {:.4g}", all.size(), std::ranges::min(all),
                        std::ranges::max(all));
  return text;
}

// Samples of a curve inside the window.
struct Samples {
  std::vector<double> at;  // s, or values of `against`
  std::vector<double> value;
};

std::vector<double> times_of(const Curve& curve, double dt) {
  std::vector<double> times;
  for (const uint64_t step : curve.step) times.push_back(static_cast<double>(step) * dt);
  return times;
}

Samples in_time(const Figure& figure, const Curve& curve, double dt) {
  Samples in;
  for (size_t k = 0; k < curve.value.size(); ++k) {
    const double t = static_cast<double>(curve.step[k]) * dt;
    if (t < figure.from * (1 - 1e-12) || (figure.to > 0 && t > figure.to * (1 + 1e-12))) continue;
    in.at.push_back(t);
    in.value.push_back(curve.value[k]);
  }
  return in;
}

double slope(const Samples& s) {
  double x = 0, y = 0, xx = 0, xy = 0;
  for (size_t k = 0; k < s.at.size(); ++k) x += s.at[k], y += s.value[k];
  x /= static_cast<double>(s.at.size()), y /= static_cast<double>(s.at.size());
  for (size_t k = 0; k < s.at.size(); ++k) {
    xx += (s.at[k] - x) * (s.at[k] - x);
    xy += (s.at[k] - x) * (s.value[k] - y);
  }
  return xy / xx;
}

double modulus(const Figure& figure, const std::vector<Curve>& curves) {
  const Curve &stress = curve_named(figure.curve, curves), &strain = curve_named(figure.against, curves);
  Samples in;
  for (size_t k = 0; k < std::min(stress.value.size(), strain.value.size()); ++k) {
    if (strain.value[k] < figure.from || (figure.to > 0 && strain.value[k] > figure.to)) continue;
    in.at.push_back(strain.value[k]);
    in.value.push_back(stress.value[k]);
  }
  if (in.at.size() < 2 || std::ranges::max(in.at) <= std::ranges::min(in.at))
    cannot(figure, window_text(figure.against, figure, strain.value, in.at.size()) +
                       ": at least 2 that differ are needed");
  return slope(in);
}

double strength(const Figure& figure, const Curve& curve) {
  if (curve.value.empty()) cannot(figure, "no samples");
  const auto top = static_cast<size_t>(std::ranges::max_element(curve.value) - curve.value.begin());
  if (top == 0 || top + 1 == curve.value.size()) return curve.value[top];
  // The parabola through three points at distances a, b from the middle one.
  const double y0 = curve.value[top];
  const auto a = static_cast<double>(curve.step[top] - curve.step[top - 1]);
  const auto b = static_cast<double>(curve.step[top + 1] - curve.step[top]);
  const double left = (y0 - curve.value[top - 1]) / a, right = (curve.value[top + 1] - y0) / b;
  const double bend = (right - left) / (a + b), tilt = (left * b + right * a) / (a + b);
  return bend < 0 ? y0 - tilt * tilt / (4 * bend) : y0;
}

// |sum of w(t) y(t) exp(-2 pi i f t)|, the turn by recurrence.
double amplitude(const std::vector<double>& windowed, double spacing, double f) {
  std::complex<double> sum = 0, turn = 1;
  const std::complex<double> by = std::polar(1.0, -2 * std::numbers::pi * f * spacing);
  for (const double y : windowed) sum += y * turn, turn *= by;
  return std::abs(sum);
}

double frequency(const Figure& figure, const Curve& curve, double dt) {
  Samples s = in_time(figure, curve, dt);
  // The last sample may stand off the grid of the others.
  if (s.at.size() > 2 &&
      std::abs((s.at.back() - s.at[s.at.size() - 2]) - (s.at[1] - s.at[0])) > 0.01 * (s.at[1] - s.at[0]))
    s.at.pop_back(), s.value.pop_back();
  const size_t n = s.value.size();
  if (n < 16)
    cannot(figure, window_text("the times of " + figure.curve, figure, times_of(curve, dt), n) +
                       ": at least 16 are needed");
  const double spacing = (s.at.back() - s.at.front()) / static_cast<double>(n - 1);
  double mean = 0;
  for (const double y : s.value) mean += y / static_cast<double>(n);
  size_t padded = 1;
  while (padded < 4 * n) padded *= 2;
  std::vector<double> windowed(n);  // Hann's window
  for (size_t k = 0; k < n; ++k) {
    const double phase = std::numbers::pi * (static_cast<double>(k) + 0.5) / static_cast<double>(n);
    windowed[k] = (s.value[k] - mean) * std::sin(phase) * std::sin(phase);
  }
  std::vector<double> zeros = windowed;
  zeros.resize(padded, 0);
  std::vector<std::complex<double>> spectrum;
  Eigen::FFT<double>().fwd(spectrum, zeros);
  // From two periods in the window on: below, the window's own lobe stands.
  const size_t first = 2 * padded / n;
  size_t top = first;
  for (size_t k = first; k < padded / 2; ++k)
    if (std::abs(spectrum[k]) > std::abs(spectrum[top])) top = k;
  if (top == first || !(std::abs(spectrum[top]) > 0))
    cannot(figure, fmt::format("{} does not oscillate at least twice in its {} samples", figure.curve, n));
  // The peak lies within a bin of the padded transform: golden section.
  const double bin = 1 / (static_cast<double>(padded) * spacing);
  double low = (static_cast<double>(top) - 1) * bin, high = (static_cast<double>(top) + 1) * bin;
  constexpr double kRatio = 0.6180339887498949;
  for (int step = 0; step < 40; ++step) {
    const double a = high - kRatio * (high - low), b = low + kRatio * (high - low);
    if (amplitude(windowed, spacing, a) > amplitude(windowed, spacing, b))
      high = b;
    else
      low = a;
  }
  return (low + high) / 2;
}

double break_time(const Figure& figure, const Curve& curve, double dt) {
  if (curve.value.empty()) cannot(figure, "no samples");
  const double most = std::ranges::max(curve.value);
  if (!(most > 0))
    cannot(figure, fmt::format("{} has no value above 0: the largest is {:.6g}", figure.curve, most));
  const double level = figure.fraction * most;
  const auto top = std::ranges::max_element(curve.value) - curve.value.begin();
  size_t k = curve.value.size() - 1;
  if (!(curve.value[k] < level))
    cannot(figure, fmt::format("{} never stays below {:.6g}, {} of its largest value", figure.curve, level,
                               figure.fraction));
  while (level > curve.value[k - 1] && top + 1 < static_cast<ptrdiff_t>(k)) --k;
  const double above = curve.value[k - 1], below = curve.value[k];
  const double part = (above - level) / (above - below);
  return dt * (static_cast<double>(curve.step[k - 1]) +
               part * static_cast<double>(curve.step[k] - curve.step[k - 1]));
}

double mean(const Figure& figure, const Curve& curve, double dt) {
  const Samples s = in_time(figure, curve, dt);
  if (s.value.empty())
    cannot(figure, window_text("the times of " + figure.curve, figure, times_of(curve, dt), 0));
  double sum = 0;
  for (const double y : s.value) sum += y;
  return sum / static_cast<double>(s.value.size());
}

}  // namespace

std::string Figure::unit(const std::vector<Curve>& curves) const {
  if (kind == Kind::frequency) return "Hz";
  if (kind == Kind::break_time) return "s";
  return curve_named(curve, curves).unit;
}

Figure read_figure(const ConfigTable& table) {
  Figure figure;
  const std::vector<std::string> kinds(std::begin(kKinds), std::end(kKinds));
  const size_t kind = table.at("kind").choice("figure", kinds);
  figure.kind = static_cast<Figure::Kind>(kind);
  figure.name = table.string_or("name", kKinds[kind]);
  figure.curve = table.at("curve").string();
  const bool windowed = figure.kind == Figure::Kind::modulus || figure.kind == Figure::Kind::frequency ||
                        figure.kind == Figure::Kind::mean;
  if (figure.kind == Figure::Kind::modulus) {
    const size_t dot = figure.curve.rfind('.');
    figure.against = table.string_or("against", figure.curve.substr(0, dot) + ".strain");
  }
  if (windowed) {
    const Quantity& quantity = figure.kind == Figure::Kind::modulus ? quantity::number : quantity::time;
    figure.from = table.number_or("from", quantity, 0, Range::not_negative());
    figure.to = table.number_or("to", quantity, 0, Range::positive());
    if (figure.to > 0 && figure.to <= figure.from) table.at("to").fail("'to' must be above 'from'");
  }
  if (figure.kind == Figure::Kind::break_time)
    figure.fraction = table.number_or("fraction", quantity::number, 0.5,
                                      {.low = 0, .high = 1, .low_open = true, .high_open = true});
  table.done();
  return figure;
}

double value_of(const Figure& figure, const std::vector<Curve>& curves, double dt) {
  const Curve& curve = curve_named(figure.curve, curves);
  switch (figure.kind) {
    case Figure::Kind::modulus:
      return modulus(figure, curves);
    case Figure::Kind::strength:
      return strength(figure, curve);
    case Figure::Kind::frequency:
      return frequency(figure, curve, dt);
    case Figure::Kind::break_time:
      return break_time(figure, curve, dt);
    case Figure::Kind::mean:
      return mean(figure, curve, dt);
    case Figure::Kind::final:
      if (curve.value.empty()) cannot(figure, "no samples");
      return curve.value.back();
  }
  return 0;
}

}  // namespace cuboct
