// SPDX-License-Identifier: MIT
// The free-surface correction, and elasticity under refinement.
#include <gtest/gtest.h>

#include <cmath>

#include "model/rules/lps_lattice.h"
#include "tests/rules/lps_body.h"

namespace cuboct {
namespace {

using test::cubic_block;
using test::cubic_material;
using test::LpsBody;

// Of a plate whose faces across x are free, under even strain without traction on them.
Mat3 free_strain(const LpsMaterial& m) {
  const double t = 1e-3, across = -m.lambda * t / (2 * m.mu);
  Mat3 strain = Mat3::Zero();
  strain(0, 0) = across;
  strain(1, 1) = m.dimensions == 3 ? 0.7 * (t - across) : t - across;
  if (m.dimensions == 3) strain(2, 2) = 0.3 * (t - across);
  return strain;
}

// The largest force on a particle whose bonds end within the block along y (and z), over mu times the strain.
double unbalance(const LpsMaterial& m, const std::vector<Vec3>& full, const Body& body, int n) {
  LpsBody lps(m, full, body);
  const Mat3 strain = free_strain(m);
  std::vector<Vec3> x = body.x;
  for (Vec3& at : x) at += strain * at;
  const std::vector<Vec3>& f = lps.forces(x);
  double most = 0;
  size_t seen = 0;
  for (size_t i = 0; i < x.size(); ++i) {
    const Vec3& at = body.x[i];
    const double end = n - 1 - 6;  // neither it nor those whose dilatation it takes lack a bond along y, z
    const bool inside = at[1] >= 6 && at[1] <= end && (m.dimensions == 2 || (at[2] >= 6 && at[2] <= end));
    if (inside) most = std::max(most, f[i].norm()), ++seen;
  }
  EXPECT_GE(seen, 8u);
  return most / (m.mu * 1e-3);
}

// Patch test: no force on any particle, those of the surface included. With the lattice's own sums 1/r makes
// no exact moments of fourth order, so that the interior balances by symmetry and the surface by the
// correction alone; fitted weights make both exact.
TEST(LpsSurface, EvenStrainWithoutTractionIsAtRest) {
  for (const int dimensions : {2, 3}) {
    LpsMaterial m = cubic_material();
    m.dimensions = dimensions, m.finite = false, m.corrected = true;
    m.quadrature = LpsQuadrature::fitted;
    m.order = 5;
    const int n = dimensions == 3 ? 14 : 20;
    const Body body = cubic_block(8, n, dimensions == 3 ? n : 1);
    EXPECT_LT(unbalance(m, {}, body, n), 1e-9) << dimensions;
    m.corrected = false;
    EXPECT_GT(unbalance(m, {}, body, n), 1e-2) << dimensions;
  }
}

// A slit through the block is a free surface as its faces are.
TEST(LpsSurface, ASlitIsAFreeSurface) {
  LpsMaterial m = cubic_material();
  m.dimensions = 2, m.finite = false, m.corrected = true, m.quadrature = LpsQuadrature::fitted;
  const Body body = cubic_block(12, 20, 1);
  const Slit slit{Vec3(5.5, -1, -1), Vec3(0, 22, 0), Vec3(0, 0, 2)};
  LpsBody lps(m, {}, body, {}, {slit});
  const Mat3 strain = free_strain(m);
  std::vector<Vec3> x = body.x;
  for (Vec3& at : x) at += strain * at;
  const std::vector<Vec3> f = lps.forces(x);
  for (size_t i = 0; i < x.size(); ++i) {
    if (body.x[i][1] < 6 || body.x[i][1] > 13) continue;
    EXPECT_LT(f[i].norm(), 1e-12) << i;
  }
}

// u = x^2 along x has the force density 2 (lambda + 2 mu) everywhere: Taylor's next even term is of fourth
// order, so the error is rounding alone for this field; u = sin has the order of h^2 at a fixed ratio of
// horizon and spacing, and is the field to refine.
TEST(LpsSurface, LinearElasticityIsReachedInSecondOrder) {
  LpsMaterial m = cubic_material();
  m.dimensions = 2, m.finite = false, m.corrected = true, m.quadrature = LpsQuadrature::fitted;
  const double pi = std::acos(-1.0);
  std::vector<double> errors;
  for (const int n : {20, 40, 80}) {
    LpsMaterial fine = m;
    const double h = 1.0 / n;
    fine.horizon = 3 * h, fine.spacing = h, fine.volume = h * h;
    Body body = cubic_block(2 * n, 13, 1);
    for (Vec3& at : body.x) at *= h;
    LpsBody lps(fine, {}, body);
    std::vector<Vec3> x = body.x;
    for (Vec3& at : x) at[0] += 1e-6 * std::sin(pi * at[0]);
    const std::vector<Vec3>& f = lps.forces(x);
    double worst = 0;
    for (size_t i = 0; i < x.size(); ++i) {
      const Vec3& at = body.x[i];
      if (at[0] < 0.4 || at[0] > 1.6 || std::abs(at[1] - 6 * h) > 0.1 * h) continue;
      const double exact = -(m.lambda + 2 * m.mu) * 1e-6 * pi * pi * std::sin(pi * at[0]);
      worst = std::max(worst, std::abs(f[i][0] / fine.volume - exact));
    }
    errors.push_back(worst / ((m.lambda + 2 * m.mu) * 1e-6 * pi * pi));
  }
  EXPECT_NEAR(std::log2(errors[0] / errors[1]), 2, 0.1) << errors[0] << " " << errors[1];
  EXPECT_NEAR(std::log2(errors[1] / errors[2]), 2, 0.1) << errors[1] << " " << errors[2];
  EXPECT_LT(errors[2], 1e-2);
}

}  // namespace
}  // namespace cuboct
