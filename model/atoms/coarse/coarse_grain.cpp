// SPDX-License-Identifier: MIT
#include "model/atoms/coarse/coarse_grain.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>

#include "model/base/error.h"
#include "model/base/mat3.h"

namespace cuboct {
namespace {

constexpr double kFlat = 1e-4;  // of R^2: atoms whose spread along some direction is less have no gradient

// Sums over pairs (d, u) from which the squared error of their straight line follows.
struct Line {
  double n = 0, d = 0, u = 0, dd = 0, du = 0, uu = 0;
  void add(double at, double value, double sign = 1) {
    n += sign, d += sign * at, u += sign * value;
    dd += sign * at * at, du += sign * at * value, uu += sign * value * value;
  }
  double error() const {
    if (n < 1.5) return 0;
    const double spread = dd - d * d / n, both = du - d * u / n, all = uu - u * u / n;
    return std::max(0.0, spread > 1e-12 * dd ? all - both * both / spread : all);
  }
};

// Counts both from their means, so that sums of squares lose no digits. The displacements' mean.
double centre(std::span<std::pair<double, double>> pairs) {
  double d = 0, u = 0;
  for (const auto& [at, value] : pairs) d += at, u += value;
  const auto n = static_cast<double>(pairs.size());
  for (auto& [at, value] : pairs) at -= d / n, value -= u / n;
  return u / n;
}

// The least error of two lines over all places between two neighbours of `pairs`, or `two` where that is
// less. Where `by` says so only places that part displacements from..to.
double least_of_two(std::span<const std::pair<double, double>> pairs, const Line& all, double two,
                    const std::optional<std::pair<double, double>>& by) {
  Line before, behind = all;
  for (size_t k = 0; k + 1 < pairs.size(); ++k) {
    const auto& [at, value] = pairs[k];
    before.add(at, value);
    behind.add(at, value, -1);
    if (!by || (value >= by->first && pairs[k + 1].second <= by->second))
      two = std::min(two, before.error() + behind.error());
  }
  return two;
}

}  // namespace

double smoothness_of(std::span<std::pair<double, double>> pairs, double noise, double here, double there) {
  if (pairs.size() < 2) return 1;
  const double middle = centre(pairs);
  Line all;
  for (const auto& [at, value] : pairs) all.add(at, value);
  std::ranges::sort(pairs);
  double two = least_of_two(pairs, all, all.error(), std::nullopt);
  if (there > here) {
    std::ranges::sort(pairs, {}, [](const auto& pair) { return pair.second; });
    two = least_of_two(pairs, all, two, std::pair(here - middle, there - middle));
  }
  const double floor = static_cast<double>(pairs.size()) * noise * noise;
  return all.error() + floor > 0 ? (two + floor) / (all.error() + floor) : 1;
}

CoarseGrain::CoarseGrain(CoarsePoints points, std::span<const Vec3> x, std::vector<double> mass)
    : points_(std::move(points)), mass_(std::move(mass)), x_(x.begin(), x.end()) {
  find();
  share(cone_);
  weight_ = cone_;
}

void CoarseGrain::find() {
  first_.assign(1, 0);
  for (size_t p = 0; p < points_.x.size(); ++p) {
    for (size_t i = 0; i < x_.size(); ++i) {
      Vec3 d = x_[i] - points_.x[p];
      if (points_.dimensions == 2) d[2] = 0;
      for (int a = 0; a < 3; ++a)
        if (points_.period[a] > 0) d[a] -= points_.period[a] * std::round(d[a] / points_.period[a]);
      const double inside = points_.radius - d.norm();
      if (!(inside > 0)) continue;
      atom_.push_back(static_cast<uint32_t>(i));
      away_.push_back(d);
      cone_.push_back(inside);
    }
    if (atom_.size() == first_.back())
      throw InputError(fmt::format("point {} at ({:.6g}, {:.6g}, {:.6g}) has no atom within {:.6g}", p,
                                   points_.x[p][0], points_.x[p][1], points_.x[p][2], points_.radius),
                       "a larger radius, or points where atoms are");
    first_.push_back(atom_.size());
  }
}

// Makes sum over points of weight times volume 1 for each atom: equations 4 and 5.
void CoarseGrain::share(std::vector<double>& weight) const {
  std::vector<double> sum(x_.size());
  for (size_t e = 0; e < weight.size(); ++e) sum[atom_[e]] += weight[e];
  for (size_t i = 0; i < sum.size(); ++i)
    if (!(sum[i] > 0))
      throw InputError(fmt::format("atom {} at ({:.6g}, {:.6g}, {:.6g}) is within {:.6g} of no point", i,
                                   x_[i][0], x_[i][1], x_[i][2], points_.radius),
                       "a larger radius, or more points");
  for (size_t e = 0; e < weight.size(); ++e) weight[e] /= sum[atom_[e]] * points_.volume;
}

std::vector<std::pair<uint32_t, double>> CoarseGrain::smoothness(size_t point, std::span<const Vec3> u,
                                                                 const CrackSight& sight) const {
  std::vector<std::pair<uint32_t, double>> out;
  std::vector<std::pair<double, double>> pairs;
  const uint64_t first = begin(point), last = end(point);
  uint64_t home = first;
  for (uint64_t e = first; e < last; ++e)
    if (away_[e].squaredNorm() < away_[home].squaredNorm()) home = e;
  const Vec3& here = u[atom_[home]];
  const double wide = sight.tube * sight.tube;
  for (uint64_t e = first; e < last; ++e) {
    const Vec3 moved = u[atom_[e]] - here;
    const double length = away_[e].norm(), size = moved.norm();
    out.emplace_back(atom_[e], 1);
    if (!(length > 0 && size > 0)) continue;
    const Vec3 along = away_[e] / length, direction = moved / size;
    pairs.clear();
    for (uint64_t other = first; other < last; ++other) {
      const double d = away_[other].dot(along);
      if (d < 0 || d > length || away_[other].squaredNorm() - d * d > wide) continue;
      pairs.emplace_back(d, (u[atom_[other]] - here).dot(direction));
    }
    out.back().second = smoothness_of(pairs, sight.noise, 0, size);
  }
  return out;
}

void CoarseGrain::look(std::span<const Vec3> u, const CrackSight& sight) {
  for (size_t i = 0; i < u.size(); ++i)
    if (!u[i].allFinite()) throw InputError(fmt::format("the displacement of atom {} is not finite", i));
  weight_ = cone_;
  for (size_t p = 0; p < points_.x.size(); ++p) {
    const auto alpha = smoothness(p, u, sight);
    for (uint64_t e = begin(p); e < end(p); ++e) weight_[e] *= alpha[e - begin(p)].second;
  }
  share(weight_);
}

std::vector<double> CoarseGrain::density() const {
  std::vector<double> out(points_.x.size());
  for (size_t p = 0; p < out.size(); ++p)
    for (uint64_t e = begin(p); e < end(p); ++e) out[p] += weight_[e] * mass_[atom_[e]];
  return out;
}

std::vector<Vec3> CoarseGrain::density_of(std::span<const Vec3> force) const {
  std::vector<Vec3> out(points_.x.size(), Vec3::Zero());
  for (size_t p = 0; p < out.size(); ++p)
    for (uint64_t e = begin(p); e < end(p); ++e) out[p] += weight_[e] * force[atom_[e]];
  return out;
}

std::vector<Vec3> CoarseGrain::mean(std::span<const Vec3> u) const {
  std::vector<Vec3> out(points_.x.size(), Vec3::Zero());
  for (size_t p = 0; p < out.size(); ++p) {
    double density = 0;
    for (uint64_t e = begin(p); e < end(p); ++e) {
      const double m = weight_[e] * mass_[atom_[e]];
      density += m, out[p] += m * u[atom_[e]];
    }
    out[p] /= density;
  }
  return out;
}

// With moments over (1, r): [m0 m1; m1 m2] (a, b) = (1, 0). Where too few atoms lie around a point for a
// gradient, the plain mean: a = 1/m0, b = 0.
std::vector<Vec3> CoarseGrain::linear_mean(std::span<const Vec3> u) const {
  std::vector<Vec3> out(points_.x.size(), Vec3::Zero());
  const int size = 1 + points_.dimensions;
  for (size_t p = 0; p < out.size(); ++p) {
    Eigen::Matrix4d moments = Eigen::Matrix4d::Identity();
    moments.topLeftCorner(size, size).setZero();
    const auto row = [&](uint64_t e) {
      Eigen::Vector4d r(1, 0, 0, 0);
      r.segment(1, points_.dimensions) = eigen(away_[e]).head(points_.dimensions) / points_.radius;
      return r;
    };
    for (uint64_t e = begin(p); e < end(p); ++e)
      moments += weight_[e] * mass_[atom_[e]] * (row(e) * row(e).transpose());
    for (int k = size; k < 4; ++k) moments(k, k) = moments(0, 0);
    const Eigen::LDLT<Eigen::Matrix4d> solver(moments);
    Eigen::Vector4d factor = solver.solve(Eigen::Vector4d(1, 0, 0, 0));
    if (solver.vectorD().minCoeff() < kFlat * moments(0, 0))
      factor = Eigen::Vector4d(1 / moments(0, 0), 0, 0, 0);
    for (uint64_t e = begin(p); e < end(p); ++e)
      out[p] += weight_[e] * mass_[atom_[e]] * row(e).dot(factor) * u[atom_[e]];
  }
  return out;
}

}  // namespace cuboct
