// SPDX-License-Identifier: MIT
#include "study/law_fit/drawn_law.h"

#include <algorithm>
#include <cmath>
#include <unsupported/Eigen/Splines>

namespace cuboct::fit {
namespace {

// Of each spline. They gather about the pitch, where a pull may bend over within a hundredth of the reach:
// the scene's law, cubics through them, then has the slope of the tangent there.
constexpr int kPushPoints = 32, kPullPoints = 48;
constexpr int kDegree = 3;

// Uniform knots, clamped: the curve begins in the first control point and ends in the last, along the
// polygon.
template <size_t N>
Eigen::Spline<double, 2, kDegree> spline_of(const std::array<ControlPoint, N>& control) {
  constexpr double pieces = N - kDegree;
  Eigen::Array<double, 1, N + kDegree + 1> knots;
  for (Eigen::Index k = 0; k < knots.size(); ++k)
    knots[k] = std::clamp(static_cast<double>(k) - kDegree, 0.0, pieces) / pieces;
  Eigen::Array<double, 2, N> controls;
  for (size_t k = 0; k < N; ++k) controls.col(static_cast<Eigen::Index>(k)) << control[k].r, control[k].f;
  return {knots, controls};
}

}  // namespace

const std::array<std::string, kParameters>& parameter_names() {
  static const std::array<std::string, kParameters> names{
      "stiffness", "push_top", "push_1", "push_2",       "push_2_force", "push_3",      "pull_1",
      "pull_2",    "pull_3",   "pull_4", "pull_2_force", "pull_3_force", "pull_4_force"};
  return names;
}

DrawnLaw draw(const Parameters& p, const LawScale& scale) {
  const double k = p[stiffness] * scale.stiffness, reach = scale.reach * scale.pitch;
  const double inner = (1 - p[push_3]) * scale.pitch, top = p[push_top] * k * scale.pitch;
  const double r1 = p[push_1] * inner, r2 = r1 + p[push_2] * (inner - r1);
  // Half of the way to the reach is left to the points behind, whatever the height.
  const double outer = scale.pitch + std::min(p[pull_1] * scale.height / k, (reach - scale.pitch) / 2);
  const double q2 = outer + p[pull_2] * (reach - outer);
  const double q3 = q2 + p[pull_3] * (reach - q2), q4 = q3 + p[pull_4] * (reach - q3);
  DrawnLaw law;
  law.push = {{{0, top},
               {r1, top},
               {r2, p[push_2_force] * k * (scale.pitch - r2)},
               {inner, k * (scale.pitch - inner)},
               {scale.pitch, 0}}};
  law.pull = {{{scale.pitch, 0},
               {outer, -k * (outer - scale.pitch)},
               {q2, -p[pull_2_force] * scale.height},
               {q3, -p[pull_3_force] * scale.height},
               {q4, -p[pull_4_force] * scale.height},
               {reach, 0}}};
  return law;
}

LawPoints points_of(const DrawnLaw& law) {
  const auto push = spline_of(law.push), pull = spline_of(law.pull);
  LawPoints points;
  const auto add = [&](const ControlPoint& p) { points.r.push_back(p.r), points.f.push_back(p.f); };
  const auto add_at = [&](const auto& spline, double t) {
    const auto at = spline(t);
    add({at[0], at[1]});
  };
  add(law.push.front());
  for (double k = kPushPoints - 1; k > 0; --k) add_at(push, 1 - std::pow(k / kPushPoints, 3));
  add(law.pull.front());
  for (double k = 1; k < kPullPoints; ++k) add_at(pull, std::pow(k / kPullPoints, 3));
  add(law.pull.back());
  return points;
}

}  // namespace cuboct::fit
