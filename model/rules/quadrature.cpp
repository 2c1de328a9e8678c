// SPDX-License-Identifier: MIT
#include "model/rules/quadrature.h"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <string>

#include "model/base/error.h"
#include "model/base/parallel.h"

namespace cuboct {
namespace {

constexpr double kExact = 1e-10;

// The points, and the images of those that have none opposite.
std::vector<Vec3> completed(const std::vector<Vec3>& points, double spacing) {
  std::vector<Vec3> all = points;
  for (const Vec3& point : points)
    if (std::ranges::none_of(points, [&](const Vec3& other) { return (other + point).norm() < spacing / 2; }))
      all.push_back(-point);
  return all;
}

// Of points on a lattice many have the same neighbours: told by their places to 1e-9 of the horizon.
std::string signature(const std::vector<Vec3>& points, double horizon) {
  std::vector<int64_t> places;
  for (const Vec3& point : points)
    for (const double x : point) places.push_back(std::llround(x / horizon * 1e9));
  return {reinterpret_cast<const char*>(places.data()), places.size() * sizeof(int64_t)};
}

class Fitter {
 public:
  explicit Fitter(const LpsMaterial& material) : m_(material) {}

  std::vector<double> operator()(const std::vector<Vec3>& points) {
    const std::string key = signature(points, m_.horizon);
    {
      const std::lock_guard lock(guard_);
      if (const auto found = known_.find(key); found != known_.end()) return found->second;
    }
    auto weights = ball_weights(completed(points, m_.spacing), m_.horizon, m_.dimensions, m_.order);
    if (!weights) return {};
    weights->resize(points.size());
    const std::lock_guard lock(guard_);
    return known_.emplace(key, std::move(*weights)).first->second;
  }

 private:
  const LpsMaterial& m_;
  std::mutex guard_;
  std::map<std::string, std::vector<double>> known_;
};

}  // namespace

double Monomial::at(const Vec3& r) const {
  return std::pow(r[0], power[0]) * std::pow(r[1], power[1]) * std::pow(r[2], power[2]) /
         std::pow(r.norm(), 3);
}

// Over the sphere: 2 prod G((a+1)/2)/G((sum a + d)/2) where all powers are even. G. B. Folland, Am. Math.
// Mon. 108 (2001) 446.
double Monomial::integral(int dimensions, double horizon) const {
  double product = 2;
  int sum = 0;
  for (int axis = 0; axis < dimensions; ++axis) {
    if (power[static_cast<size_t>(axis)] % 2 != 0) return 0;
    product *= std::tgamma((power[static_cast<size_t>(axis)] + 1) / 2.0);
    sum += power[static_cast<size_t>(axis)];
  }
  const double radial = sum - 3 + dimensions;
  return product / std::tgamma((sum + dimensions) / 2.0) * std::pow(horizon, radial) / radial;
}

std::vector<Monomial> integrated_functions(int dimensions, int order) {
  const int least = 4 - dimensions;  // below, the integral of r^(least - 4) over the ball diverges
  std::vector<Monomial> functions;
  for (int degree = least; degree <= order; ++degree)
    for (int a = 0; a <= degree; ++a)
      for (int b = 0; a + b <= degree; ++b) {
        const int c = degree - a - b;
        if (dimensions == 3 || c == 0) functions.push_back({{a, b, c}});
      }
  return functions;
}

std::optional<std::vector<double>> ball_weights(const std::vector<Vec3>& points, double horizon,
                                                int dimensions, int order) {
  // In units of the horizon; the least squares solution of an underdetermined system is the shortest one.
  const std::vector<Monomial> functions = integrated_functions(dimensions, order);
  const auto rows = static_cast<Eigen::Index>(functions.size());
  Eigen::MatrixXd q(rows, static_cast<Eigen::Index>(points.size()));
  Eigen::VectorXd exact(rows);
  for (Eigen::Index f = 0; f < rows; ++f) {
    const Monomial& function = functions[static_cast<size_t>(f)];
    exact[f] = function.integral(dimensions, 1);
    for (Eigen::Index p = 0; p < q.cols(); ++p)
      q(f, p) = function.at(points[static_cast<size_t>(p)] / horizon);
  }
  if (points.empty()) return std::nullopt;
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver(q);
  solver.setThreshold(1e-12);
  Eigen::VectorXd weights = solver.solve(exact);
  weights += solver.solve(exact - q * weights);
  const double off = (q * weights - exact).cwiseAbs().maxCoeff();
  if (!(off <= kExact * exact.cwiseAbs().maxCoeff())) return std::nullopt;
  weights *= std::pow(horizon, dimensions);
  return std::vector<double>(weights.data(), weights.data() + weights.size());
}

std::vector<double> fitted_weights(const LpsMaterial& material, const ReferenceBonds& bonds, int threads) {
  constexpr size_t kEach = 16;
  std::vector<double> weights(bonds.other.size());
  Fitter fitter(material);
  for_each_range(
      bonds.particles(), kEach,
      [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
          const std::vector<Vec3> points(bonds.vector.begin() + static_cast<int64_t>(bonds.begin(i)),
                                         bonds.vector.begin() + static_cast<int64_t>(bonds.end(i)));
          const std::vector<double> own = fitter(points);
          if (own.empty())
            throw InputError(
                fmt::format("particle {} has {} points within the horizon of {:.6g} m, too few to integrate "
                            "polynomials of degree {} exactly ({} functions)",
                            i, points.size(), material.horizon, material.order,
                            integrated_functions(material.dimensions, material.order).size()),
                "a larger horizon, or a lower 'order'");
          std::copy(own.begin(), own.end(), weights.begin() + static_cast<int64_t>(bonds.begin(i)));
        }
      },
      threads);
  return weights;
}

}  // namespace cuboct
