// SPDX-License-Identifier: MIT
#include "model/atoms/multiscale/stretch.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "model/solid/moduli.h"

namespace cuboct {
namespace {

// The slope at 0 of value = slope e + q e^2.
double initial_slope(const std::vector<StretchPoint>& points, double StretchPoint::*value) {
  Eigen::MatrixX2d powers(static_cast<Eigen::Index>(points.size()), 2);
  Eigen::VectorXd values(powers.rows());
  for (Eigen::Index k = 0; k < powers.rows(); ++k) {
    const StretchPoint& point = points[static_cast<size_t>(k)];
    powers.row(k) << point.strain, point.strain * point.strain;
    values[k] = point.*value;
  }
  return powers.colPivHouseholderQr().solve(values)[0];
}

double rest_volume(const ElementBody& body) {
  double sum = 0;
  for (size_t e = 0; e < body.mesh().elements.size(); ++e) sum += body.rest_volume(e);
  return sum;
}

}  // namespace

Moduli moduli_of(const std::vector<StretchPoint>& points) {
  return {initial_slope(points, &StretchPoint::stress),
          (1 - initial_slope(points, &StretchPoint::expansion)) / 2};
}

Stretch::Stretch(ElementBody& body, int axis, double precision)
    : body_(body),
      axis_(axis),
      precision_(precision),
      face_(std::cbrt(std::pow(6 * rest_volume(body) / static_cast<double>(body.mesh().elements.size()), 2))),
      rest_(body) {}

StretchPoint Stretch::to(double strain) {
  const double period = body_.mesh().period[axis_] * (1 + strain), scale = period / body_.period()[axis_];
  body_.period()[axis_] = period;
  for (Vec3& x : body_.x()) x[axis_] *= scale;
  const double modulus = hill_mean(body_.material().constants).youngs();
  const double force = precision_ * modulus * std::abs(strain) * face_;
  const RestResult rest = rest_(body_, force);
  if (!rest.at_rest)
    throw std::runtime_error(
        fmt::format("at a strain of {:g} the vertices found no rest: a force of {:.3g} N is left "
                    "after {} updates, {:.3g} was asked for",
                    strain, rest.force, rest.iterations, force));
  const Mat3 stress = body_.mean_stress();
  StretchPoint out{strain, stress(axis_, axis_), body_.volume() / rest_volume(body_) - 1, 0, rest.iterations};
  for (int a = 0; a < 3; ++a)
    if (a != axis_) out.across = std::max(out.across, std::abs(stress(a, a)));
  return out;
}

}  // namespace cuboct
