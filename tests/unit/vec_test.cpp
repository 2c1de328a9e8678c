// SPDX-License-Identifier: MIT
// Vectors of our own give the bits that Eigen gives: results kept from before stay comparable, and formulas
// with matrices round alike.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <random>
#include <sstream>
#include <vector>

#include "model/base/mat3.h"

namespace cuboct {
namespace {

using Column = Eigen::Vector3d;

struct Random {
  std::mt19937_64 engine{1};
  std::uniform_real_distribution<double> number{-1, 1};

  Column column() { return {number(engine), number(engine), number(engine)}; }
  Mat3 matrix() {
    Mat3 out;
    for (double& one : out.reshaped()) one = number(engine);
    return out;
  }
};

std::array<double, 3> bits(const Column& v) { return {v[0], v[1], v[2]}; }
std::array<double, 3> bits(const Vec3& v) { return {v[0], v[1], v[2]}; }

// What formulas of the project are made of, in one type of vectors.
template <class Vector>
std::vector<std::array<double, 3>> vectors_of(const Mat3& m, const Vector& a, const Vector& b) {
  Vector sum = a;
  sum += m * b;
  sum -= 0.3 * m.transpose() * a;
  sum *= 1.7, sum /= 0.3;
  return {bits(Vector(a + b - 2 * a * 3)),
          bits(Vector(-a / 1.3)),
          bits(Vector(a.cross(b))),
          bits(Vector(a.normalized())),
          bits(Vector(a.cwiseProduct(b).cwiseQuotient(a + b))),
          bits(Vector(a.cwiseMin(b).cwiseMax(0.1) + a.cwiseAbs().cwiseSqrt())),
          bits(Vector(m * (a - b))),
          bits(Vector(m.transpose() * (a - b) / 1.3)),
          bits(Vector(a + m * b)),
          bits(Vector((m + a * b.transpose()) * b)),
          bits(Vector(m * m * a + m * (m * b))),
          bits(sum)};
}

template <class Vector>
std::vector<double> numbers_of(const Mat3& m, const Vector& a, const Vector& b) {
  return {a.dot(b),           (a - b).squaredNorm(),
          a.norm(),           (m * a - b).norm(),
          a.dot(m * b),       a.sum(),
          a.prod(),           a.minCoeff(),
          b.maxCoeff(),       a.normalized().dot(b.cross(m.col(1))) / a.dot(b),
          a.cwiseAbs2().sum()};
}

TEST(Vec3, HasTheBitsOfEigens) {
  Random random;
  for (int trial = 0; trial < 2000; ++trial) {
    const Column a = random.column(), b = random.column();
    const Mat3 m = random.matrix();
    ASSERT_EQ(vectors_of(m, Vec3(a), Vec3(b)), vectors_of(m, a, b)) << trial;
    ASSERT_EQ(numbers_of(m, Vec3(a), Vec3(b)), numbers_of(m, a, b)) << trial;
    ASSERT_EQ(Mat3(Vec3(a) * Vec3(b).transpose()), Mat3(a * b.transpose())) << trial;
    // Eigen scales the left factor first, whatever the brackets say.
    ASSERT_EQ(bits(0.3 * m * Vec3(a)), bits(Column(0.3 * (m * a)))) << trial;
    ASSERT_EQ(Mat3(0.3 * Vec3(a) * Vec3(b).transpose()), Mat3(0.3 * (a * b.transpose()))) << trial;
  }
}

TEST(Vec3, FindsAxesAndBoxes) {
  int axis = -1;
  EXPECT_EQ(Vec3(1, 3, 3).maxCoeff(&axis), 3);
  EXPECT_EQ(axis, 1);
  EXPECT_EQ(Vec3(2, 1, 1).minCoeff(&axis), 1);
  EXPECT_EQ(axis, 1);
  EXPECT_TRUE(Vec3(0, 1, 2).within(Vec3::Zero(), Vec3(0, 1, 2)));
  EXPECT_FALSE(Vec3(0, 1, 2.1).within(Vec3::Zero(), Vec3(0, 1, 2)));
  EXPECT_FALSE(Vec3(0, NAN, 2).within(Vec3::Zero(), Vec3(0, 1, 2)));
  EXPECT_FALSE(Vec3(0, INFINITY, 2).allFinite());
  EXPECT_EQ(Vec3::Zero().normalized(), Vec3::Zero());
  EXPECT_TRUE(Vec3(1, 2, 3).isApprox(Vec3(1, 2, 3 + 1e-12)));
  EXPECT_FALSE(Vec3(1, 2, 3).isApprox(Vec3(1, 2, 3 + 1e-11)));
  EXPECT_FALSE(Vec3(0, 0, 2e-12).isZero());
  std::ostringstream text;
  text << Vec3(1, -2, 0.5);
  EXPECT_EQ(text.str(), "1 -2 0.5");
}

}  // namespace
}  // namespace cuboct
