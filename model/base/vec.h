// SPDX-License-Identifier: MIT
// Vectors of three real numbers, and triples of integers. Most files read this header and need nothing else
// of linear algebra, so it is plain: expression templates take a third of their time to compile. Methods have
// Eigen's names and meanings; mat3.h has matrices, which are Eigen's, and what joins both.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <iterator>

namespace cuboct {

class Vec3 {
 public:
  constexpr Vec3() = default;
  constexpr Vec3(double x, double y, double z) : x_{x, y, z} {}
  explicit constexpr Vec3(const double* x) : x_{x[0], x[1], x[2]} {}
  // Of a column or a row of Eigen's with three numbers.
  template <class Expression>
  requires(Expression::SizeAtCompileTime == 3) Vec3(const Expression& from) {
    const auto value = from.eval();
    for (int k = 0; k < 3; ++k) x_[k] = value[k];
  }

  static constexpr Vec3 Zero() { return {}; }
  static constexpr Vec3 Constant(double value) { return {value, value, value}; }
  static constexpr Vec3 Ones() { return Constant(1); }
  template <std::integral Axis>
  static constexpr Vec3 Unit(Axis axis) {
    Vec3 unit;
    unit[axis] = 1;
    return unit;
  }
  static constexpr Vec3 UnitX() { return {1, 0, 0}; }
  static constexpr Vec3 UnitY() { return {0, 1, 0}; }
  static constexpr Vec3 UnitZ() { return {0, 0, 1}; }

  template <std::integral Axis>
  constexpr double& operator[](Axis axis) {
    return x_[axis];
  }
  template <std::integral Axis>
  constexpr double operator[](Axis axis) const {
    return x_[axis];
  }
  constexpr double& x() { return x_[0]; }
  constexpr double& y() { return x_[1]; }
  constexpr double& z() { return x_[2]; }
  constexpr double x() const { return x_[0]; }
  constexpr double y() const { return x_[1]; }
  constexpr double z() const { return x_[2]; }
  constexpr double* data() { return x_; }
  constexpr const double* data() const { return x_; }
  static constexpr size_t size() { return 3; }
  constexpr double* begin() { return x_; }
  constexpr double* end() { return x_ + 3; }
  constexpr const double* begin() const { return x_; }
  constexpr const double* end() const { return x_ + 3; }

  // [f(x), f(y), f(z)], and with b's numbers as second arguments.
  template <class Function>
  constexpr Vec3 map(const Function& f) const {
    return {f(x_[0]), f(x_[1]), f(x_[2])};
  }
  template <class Function>
  constexpr Vec3 map(const Vec3& b, const Function& f) const {
    return {f(x_[0], b.x_[0]), f(x_[1], b.x_[1]), f(x_[2], b.x_[2])};
  }

  constexpr Vec3& operator+=(const Vec3& b) {
    x_[0] += b.x_[0], x_[1] += b.x_[1], x_[2] += b.x_[2];
    return *this;
  }
  constexpr Vec3& operator-=(const Vec3& b) {
    x_[0] -= b.x_[0], x_[1] -= b.x_[1], x_[2] -= b.x_[2];
    return *this;
  }
  constexpr Vec3& operator*=(double b) {
    x_[0] *= b, x_[1] *= b, x_[2] *= b;
    return *this;
  }
  constexpr Vec3& operator/=(double b) {
    x_[0] /= b, x_[1] /= b, x_[2] /= b;
    return *this;
  }
  friend constexpr Vec3 operator+(const Vec3& a, const Vec3& b) {
    return {a.x_[0] + b.x_[0], a.x_[1] + b.x_[1], a.x_[2] + b.x_[2]};
  }
  friend constexpr Vec3 operator-(const Vec3& a, const Vec3& b) {
    return {a.x_[0] - b.x_[0], a.x_[1] - b.x_[1], a.x_[2] - b.x_[2]};
  }
  friend constexpr Vec3 operator-(const Vec3& a) { return {-a.x_[0], -a.x_[1], -a.x_[2]}; }
  friend constexpr Vec3 operator*(const Vec3& a, double b) { return {a.x_[0] * b, a.x_[1] * b, a.x_[2] * b}; }
  friend constexpr Vec3 operator*(double a, const Vec3& b) { return {a * b.x_[0], a * b.x_[1], a * b.x_[2]}; }
  friend constexpr Vec3 operator/(const Vec3& a, double b) { return {a.x_[0] / b, a.x_[1] / b, a.x_[2] / b}; }
  friend constexpr bool operator==(const Vec3& a, const Vec3& b) {
    return a.x_[0] == b.x_[0] && a.x_[1] == b.x_[1] && a.x_[2] == b.x_[2];
  }
  friend std::ostream& operator<<(std::ostream& out, const Vec3& a);  // "x y z"

  constexpr double dot(const Vec3& b) const { return x_[0] * b.x_[0] + x_[1] * b.x_[1] + x_[2] * b.x_[2]; }
  constexpr Vec3 cross(const Vec3& b) const {
    return {x_[1] * b.x_[2] - x_[2] * b.x_[1], x_[2] * b.x_[0] - x_[0] * b.x_[2],
            x_[0] * b.x_[1] - x_[1] * b.x_[0]};
  }
  constexpr double squaredNorm() const { return dot(*this); }
  double norm() const { return std::sqrt(squaredNorm()); }
  // Zero stays zero.
  Vec3 normalized() const {
    const double square = squaredNorm();
    return square > 0 ? *this / std::sqrt(square) : *this;
  }
  void normalize() { *this = normalized(); }
  constexpr void setZero() { *this = Zero(); }
  constexpr double sum() const { return x_[0] + x_[1] + x_[2]; }
  constexpr double prod() const { return x_[0] * x_[1] * x_[2]; }
  constexpr double minCoeff() const { return std::min({x_[0], x_[1], x_[2]}); }
  constexpr double maxCoeff() const { return std::max({x_[0], x_[1], x_[2]}); }
  // The first of the least, of the largest, is number `axis`.
  template <std::integral Axis>
  constexpr double minCoeff(Axis* axis) const {
    return *axis = static_cast<Axis>(std::min_element(begin(), end()) - begin()), x_[*axis];
  }
  template <std::integral Axis>
  constexpr double maxCoeff(Axis* axis) const {
    return *axis = static_cast<Axis>(std::max_element(begin(), end()) - begin()), x_[*axis];
  }
  constexpr Vec3 cwiseProduct(const Vec3& b) const {
    return {x_[0] * b.x_[0], x_[1] * b.x_[1], x_[2] * b.x_[2]};
  }
  constexpr Vec3 cwiseQuotient(const Vec3& b) const {
    return {x_[0] / b.x_[0], x_[1] / b.x_[1], x_[2] / b.x_[2]};
  }
  constexpr Vec3 cwiseMin(const Vec3& b) const {
    return map(b, [](double p, double q) { return std::min(p, q); });
  }
  constexpr Vec3 cwiseMax(const Vec3& b) const {
    return map(b, [](double p, double q) { return std::max(p, q); });
  }
  constexpr Vec3 cwiseMax(double b) const { return cwiseMax(Constant(b)); }
  constexpr Vec3 cwiseMin(double b) const { return cwiseMin(Constant(b)); }
  Vec3 cwiseAbs() const { return {std::abs(x_[0]), std::abs(x_[1]), std::abs(x_[2])}; }
  constexpr Vec3 cwiseAbs2() const { return cwiseProduct(*this); }
  Vec3 cwiseSqrt() const { return {std::sqrt(x_[0]), std::sqrt(x_[1]), std::sqrt(x_[2])}; }
  bool allFinite() const { return std::isfinite(x_[0]) && std::isfinite(x_[1]) && std::isfinite(x_[2]); }
  // No component is larger than `precision`.
  bool isZero(double precision = 1e-12) const {
    return std::ranges::all_of(x_, [&](double c) { return std::abs(c) <= precision; });
  }
  // Their difference is at most `precision` of the shorter's length.
  bool isApprox(const Vec3& b, double precision = 1e-12) const {
    return (*this - b).squaredNorm() <= precision * precision * std::min(squaredNorm(), b.squaredNorm());
  }
  // low <= x <= high along each axis.
  constexpr bool within(const Vec3& low, const Vec3& high) const {
    for (int k = 0; k < 3; ++k)
      if (!(x_[k] >= low[k] && x_[k] <= high[k])) return false;
    return true;
  }

  struct Row;
  constexpr Row transpose() const;

 private:
  double x_[3] = {};
};

// A vector as a row: the right factor of a dyadic product (mat3.h).
struct Vec3::Row {
  Vec3 column;
};
constexpr Vec3::Row Vec3::transpose() const { return {*this}; }

using Int3 = std::array<int64_t, 3>;  // fixed-point triples; the unit stands where it is used
using Cell = std::array<int32_t, 3>;  // a cell's integer coordinates in the lattice

}  // namespace cuboct
