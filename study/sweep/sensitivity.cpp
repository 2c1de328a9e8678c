// SPDX-License-Identifier: MIT
#include "study/sweep/sensitivity.h"

#include <cmath>
#include <limits>
#include <random>
#include <span>

#include "model/base/interrupt.h"
#include "model/rules/rounds_rule.h"
#include "study/sweep/measure_run.h"

namespace cuboct::study {
namespace {

constexpr double kApart = 1e-9, kSaturated = 1e-3;  // of the length unit

Body neighbour_of(const Scene& scene) {
  Body body = scene.body;
  std::mt19937_64 random(1);
  const double size = kApart * length_unit(scene);
  for (size_t i = 0; i < body.size(); ++i)
    for (int axis = 0; axis < 3; ++axis) {
      // In [-1, 1): the library's distributions differ from machine to machine.
      const double draw = std::ldexp(static_cast<double>(random() >> 11), -52) - 1;
      if (!scene.rule.types[body.type[i]].imposed[axis]) body.x[i][axis] += size * draw;
    }
  return body;
}

double slope(std::span<const double> y) {
  double n = 0, x1 = 0, y1 = 0, xx = 0, xy = 0;
  for (size_t k = 0; k < y.size(); ++k) {
    const auto x = static_cast<double>(k);
    n += 1, x1 += x, y1 += y[k], xx += x * x, xy += x * y[k];
  }
  return (n * xy - x1 * y1) / (n * xx - x1 * x1);
}

}  // namespace

std::vector<double> separation(const Case& c, const TimeGrid& grid, int threads) {
  Scene scene = c.scene;
  const uint64_t per_sample = grid.steps_per_sample(scene.rule.dt);
  scene.rule.dt = grid.fitted(scene.rule.dt);
  const RealOptions options{.integrator = Integrator::velocity_verlet, .threads = threads};
  const auto run = [&](const Body& body) {
    return Reference(scene.rule, with_bonds(scene.rule, body, scene.body), scene.periodic, options);
  };
  Reference one = run(scene.body), other = run(neighbour_of(scene));
  std::vector<double> distance;
  for (uint64_t sample = 0; sample <= grid.samples; ++sample) {
    for (uint64_t k = 0; sample > 0 && k < per_sample; ++k) {
      if (interrupted()) throw Interrupted();
      one.step();
      other.step();
    }
    distance.push_back(rms_distance(one.body().x, other.body().x, scene.periodic));
    if (distance.back() > kSaturated * length_unit(scene)) break;
  }
  return distance;
}

Sensitivity sensitivity_of(const std::vector<double>& distance, double sample) {
  Sensitivity result{std::numeric_limits<double>::infinity(), distance.size() - 1};
  std::vector<double> grown;  // logarithms
  size_t ten = distance.size();
  for (size_t k = 0; k < distance.size(); ++k) {
    grown.push_back(std::log(distance[k] / distance[0]));
    if (grown[k] > std::log(10.0)) ten = std::min(ten, k);
    if (grown[k] > 3) result.horizon = std::min<uint64_t>(result.horizon, k - 1);
  }
  result.horizon = std::max<uint64_t>(result.horizon, 1);
  const size_t count = grown.size() - std::min(ten, grown.size());
  if (count < 5 || grown.back() - grown[ten] < 2) return result;
  const auto window = std::span(grown).subspan(ten);
  if (slope(window.subspan(count / 2)) < 0.5 * slope(window.first(count / 2 + 1))) return result;
  result.lyapunov_time = sample / slope(window);
  return result;
}

}  // namespace cuboct::study
