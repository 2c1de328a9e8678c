// SPDX-License-Identifier: MIT
#include "study/sweep/sampling.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <stdexcept>

namespace cuboct::study {
namespace {

Curve every_second(const Curve& curve) {
  Curve half{curve.name, curve.unit, {}, {}};
  for (size_t k = 1 - curve.value.size() % 2; k < curve.value.size(); k += 2) {
    half.step.push_back(curve.step[k]);
    half.value.push_back(curve.value[k]);
  }
  return half;
}

std::optional<double> found(const Figure& figure, const std::vector<Curve>& curves, double dt) {
  try {
    const double value = value_of(figure, curves, dt);
    if (std::isfinite(value)) return value;
  } catch (const std::runtime_error&) {
  }
  return std::nullopt;
}

}  // namespace

std::vector<std::string> sampling_notes(const std::vector<Figure>& figures, const std::vector<Curve>& curves,
                                        double dt, double most) {
  std::vector<Curve> halves;
  for (const Curve& curve : curves) halves.push_back(every_second(curve));
  std::vector<std::string> notes;
  for (const Figure& figure : figures) {
    const auto whole = found(figure, curves, dt), half = found(figure, halves, dt);
    if (!whole || *whole == 0) continue;
    const double change = half ? std::abs((*half - *whole) / *whole) : 0;
    if (half && change <= most) continue;
    notes.push_back(
        fmt::format("{} {} if every second sample is left out: more 'samples', or a wider window, make it a "
                    "property of the scene",
                    figure.name, half ? fmt::format("changes by {:.2g} %", 100 * change) : "is lost"));
  }
  return notes;
}

}  // namespace cuboct::study
