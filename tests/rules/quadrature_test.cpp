// SPDX-License-Identifier: MIT
#include "model/rules/quadrature.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "model/base/error.h"
#include "tests/rules/lps_body.h"

namespace cuboct {
namespace {

// A grid of points around a middle, each shaken by a tenth of the spacing.
std::vector<Vec3> shaken_points(int dimensions, double horizon, unsigned seed) {
  std::mt19937 dice(seed);
  std::uniform_real_distribution<double> noise(-0.1, 0.1);
  std::vector<Vec3> points;
  const int most = static_cast<int>(horizon);
  for (int i = -most; i <= most; ++i)
    for (int j = -most; j <= most; ++j)
      for (int k = dimensions == 3 ? -most : 0; k <= (dimensions == 3 ? most : 0); ++k) {
        Vec3 at(i + noise(dice), j + noise(dice), dimensions == 3 ? k + noise(dice) : 0);
        if ((i != 0 || j != 0 || k != 0) && at.norm() < horizon) points.push_back(at);
      }
  return points;
}

// 2D: r^2 over the disc is pi h^4/2, so x^2/r^3 has the integral pi h; 3D: x^2/r^3 has 4 pi/3 h^2/2.
TEST(Quadrature, IntegralsAreThoseOfTheBall) {
  const double pi = std::acos(-1.0);
  EXPECT_NEAR((Monomial{{2, 0, 0}}.integral(2, 3)), pi * 3, 1e-13);
  EXPECT_NEAR((Monomial{{2, 0, 0}}.integral(3, 3)), 4 * pi / 3 * 9 / 2, 1e-12);
  EXPECT_NEAR((Monomial{{2, 2, 0}}.integral(3, 1)), 4 * pi / 15 / 4, 1e-14);
  EXPECT_EQ((Monomial{{1, 2, 0}}.integral(3, 1)), 0);
  EXPECT_EQ(integrated_functions(3, 5).size(), 55u);
  EXPECT_EQ(integrated_functions(2, 5).size(), 18u);
}

TEST(Quadrature, IsExactForItsSpace) {
  size_t compared = 0;
  for (const int dimensions : {2, 3})
    for (unsigned seed = 1; seed <= 3; ++seed) {
      const double horizon = 3.5;
      const std::vector<Vec3> points = shaken_points(dimensions, horizon, seed);
      const auto weights = ball_weights(points, horizon, dimensions, 5);
      ASSERT_TRUE(weights);
      for (const Monomial& f : integrated_functions(dimensions, 5)) {
        double sum = 0, scale = 0;
        for (size_t p = 0; p < points.size(); ++p) {
          sum += (*weights)[p] * f.at(points[p]);
          scale += std::abs((*weights)[p] * f.at(points[p]));
        }
        EXPECT_NEAR(sum, f.integral(dimensions, horizon), 1e-10 * scale);
        ++compared;
      }
    }
  EXPECT_EQ(compared, 3u * (55 + 18));
}

// Of all weights that are exact the shortest: any change within the null space is longer. Here against the
// normal equations, W = Q^T (Q Q^T)^-1 g, solved apart.
TEST(Quadrature, WeightsAreTheShortestOnes) {
  const double horizon = 3.5;
  const std::vector<Vec3> points = shaken_points(2, horizon, 9);
  const auto functions = integrated_functions(2, 3);
  Eigen::MatrixXd q(functions.size(), points.size());
  Eigen::VectorXd g(functions.size());
  for (Eigen::Index f = 0; f < q.rows(); ++f) {
    g[f] = functions[static_cast<size_t>(f)].integral(2, horizon);
    for (Eigen::Index p = 0; p < q.cols(); ++p)
      q(f, p) = functions[static_cast<size_t>(f)].at(points[static_cast<size_t>(p)]);
  }
  const Eigen::VectorXd expected = q.transpose() * (q * q.transpose()).ldlt().solve(g);
  const auto weights = ball_weights(points, horizon, 2, 3);
  ASSERT_TRUE(weights);
  for (Eigen::Index p = 0; p < q.cols(); ++p)
    EXPECT_NEAR((*weights)[static_cast<size_t>(p)], expected[p], 1e-8 * expected.cwiseAbs().maxCoeff());
}

TEST(Quadrature, TooFewPointsAreRefused) {
  EXPECT_FALSE(ball_weights({Vec3(1, 0, 0), Vec3(0, 1, 0)}, 2, 3, 5));
  EXPECT_FALSE(ball_weights({}, 2, 2, 2));
  LpsMaterial m = test::cubic_material();
  m.quadrature = LpsQuadrature::fitted;
  m.horizon = 1.5;
  try {
    test::LpsBody lps(m, {}, test::cubic_block(5, 5, 5));
    FAIL() << "18 points for 55 functions";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("too few to integrate polynomials of degree 5"),
              std::string::npos);
  }
}

}  // namespace
}  // namespace cuboct
