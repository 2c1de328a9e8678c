// SPDX-License-Identifier: MIT
#include "model/solid/moduli.h"

#include "model/base/mat3.h"

#include <Eigen/Dense>
#include <cmath>
#include <functional>
#include <numbers>

namespace cuboct {
namespace {

int voigt(int a, int b) { return a == b ? a : 6 - a - b; }

// Voigt's vector of n n^T: for strains (twice the shears) or stresses.
Eigen::Matrix<double, 6, 1> square_of(const Vec3& n, double shear) {
  Eigen::Matrix<double, 6, 1> out;
  for (int v = 0; v < 6; ++v) out[v] = (v < 3 ? 1 : shear) * n[kVoigt[v][0]] * n[kVoigt[v][1]];
  return out;
}

// Two directions across n and each other.
Eigen::Matrix<double, 3, 2> across(const Vec3& n) {
  int least = 0;
  n.cwiseAbs().minCoeff(&least);
  Eigen::Matrix<double, 3, 2> out;
  const Vec3 first = n.cross(Vec3::Unit(least)).normalized();
  out << eigen(first), eigen(n.cross(first).normalized());
  return out;
}

Vec3 on_sphere(double polar, double azimuth) {
  return {std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar)};
}

// From the best of a grid over the sphere, steps across that halve.
Vec3 most_of(const std::function<double(const Vec3&)>& value) {
  constexpr int kGrid = 24;
  Vec3 best = Vec3::UnitZ();
  double most = value(best);
  const auto meet = [&](const Vec3& n) {
    const double here = value(n);
    const bool better = here > most * (1 + 1e-12);  // directions that are alike: the first
    if (better) best = n, most = here;
    return better;
  };
  for (int p = 0; p <= kGrid; ++p)
    for (int a = 0; a < 2 * kGrid; ++a)
      meet(on_sphere(std::numbers::pi * p / (2 * kGrid), std::numbers::pi * a / kGrid));
  for (double step = 0.1; step > 1e-7; step /= 2)
    for (bool moved = true; moved;) {
      moved = false;
      const Eigen::Matrix<double, 3, 2> sides = across(best);
      for (const double sign : {-1.0, 1.0})
        for (int side = 0; side < 2; ++side)
          moved = meet((best + sign * step * sides.col(side)).normalized()) || moved;
    }
  for (int axis = 0; axis < 3; ++axis)
    if (std::abs(best[axis]) < 1e-6) best[axis] = 0;
  for (int axis = 2; axis >= 0; --axis)
    if (best[axis] < 0) {
      best = -best;
      break;
    } else if (best[axis] > 0) {
      break;
    }
  return best.normalized();
}

}  // namespace

double softest_strain(const Matrix6& c) {
  Eigen::Matrix<double, 6, 1> scale;
  scale << 1, 1, 1, std::numbers::sqrt2, std::numbers::sqrt2, std::numbers::sqrt2;
  const Matrix6 kelvin = scale.asDiagonal() * ((c + c.transpose()) / 2) * scale.asDiagonal();
  return eigenvalues(kelvin)[0];
}

Matrix6 in_axes(const Matrix6& c, const Mat3& axes) {
  Matrix6 out = Matrix6::Zero();
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j)
      for (int a = 0; a < 9; ++a)
        for (int b = 0; b < 9; ++b)
          out(i, j) += axes(a / 3, kVoigt[i][0]) * axes(a % 3, kVoigt[i][1]) * axes(b / 3, kVoigt[j][0]) *
                       axes(b % 3, kVoigt[j][1]) * c(voigt(a / 3, a % 3), voigt(b / 3, b % 3));
  return out;
}

double plane_modulus(const Matrix6& c) {
  Mat3 plane;
  constexpr std::array<int, 3> kPlane{0, 1, 5};
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) plane(a, b) = c(kPlane[a], kPlane[b]);
  return 1 / plane.inverse()(0, 0);
}

std::pair<double, double> poissons_ratio(const Matrix6& c, const Vec3& direction) {
  const Vec3 n = direction.normalized();
  const Eigen::Matrix<double, 6, 1> strain = c.ldlt().solve(square_of(n, 1));
  Mat3 e;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) e(a, b) = strain[voigt(a, b)] / (a == b ? 1 : 2);
  const Eigen::Matrix<double, 3, 2> sides = across(n);
  const Eigen::Matrix2d lateral = -sides.transpose() * e * sides / n.dot(e * n);
  const Eigen::Vector2d ends = eigenvalues(lateral);
  return {ends[0], ends[1]};
}

Vec3 wave_speeds(const Matrix6& c, double density, const Vec3& direction) {
  const Vec3 n = direction.normalized();
  Mat3 christoffel = Mat3::Zero();
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      for (int j = 0; j < 3; ++j)
        for (int l = 0; l < 3; ++l) christoffel(i, k) += c(voigt(i, j), voigt(k, l)) * n[j] * n[l] / density;
  const Mat3 symmetric = (christoffel + christoffel.transpose()) / 2;
  return eigenvalues(symmetric).cwiseMax(0).cwiseSqrt();
}

std::pair<Vec3, Vec3> extreme_directions(const Matrix6& c) {
  const Matrix6 compliance = inverse(c);
  const auto inverse_modulus = [&](const Vec3& n) {
    const auto along = square_of(n, 1);
    return along.dot(compliance * along);
  };
  return {most_of(inverse_modulus), most_of([&](const Vec3& n) { return 1 / inverse_modulus(n); })};
}

double zener_ratio(const Matrix6& c) {
  const double c11 = (c(0, 0) + c(1, 1) + c(2, 2)) / 3, c44 = (c(3, 3) + c(4, 4) + c(5, 5)) / 3;
  const double c12 = (c(0, 1) + c(1, 2) + c(0, 2) + c(1, 0) + c(2, 1) + c(2, 0)) / 6;
  return 2 * c44 / (c11 - c12);
}

Isotropic voigt_mean(const Matrix6& c) {
  const double axial = c(0, 0) + c(1, 1) + c(2, 2), cross = c(0, 1) + c(1, 2) + c(0, 2);
  return {(axial + 2 * cross) / 9, (axial - cross + 3 * (c(3, 3) + c(4, 4) + c(5, 5))) / 15};
}

Isotropic reuss_mean(const Matrix6& c) {
  const Matrix6 s = inverse(c);
  const double axial = s(0, 0) + s(1, 1) + s(2, 2), cross = s(0, 1) + s(1, 2) + s(0, 2);
  return {1 / (axial + 2 * cross), 15 / (4 * (axial - cross) + 3 * (s(3, 3) + s(4, 4) + s(5, 5)))};
}

Isotropic hill_mean(const Matrix6& c) {
  const Isotropic high = voigt_mean(c), low = reuss_mean(c);
  return {(high.bulk + low.bulk) / 2, (high.shear + low.shear) / 2};
}

double universal_anisotropy(const Matrix6& c) {
  const Isotropic high = voigt_mean(c), low = reuss_mean(c);
  return 5 * high.shear / low.shear + high.bulk / low.bulk - 6;
}

}  // namespace cuboct
