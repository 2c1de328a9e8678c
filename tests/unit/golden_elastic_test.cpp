// SPDX-License-Identifier: MIT
// Elastic constants of the Lennard-Jones FCC crystal from golden's integer pair kicks.
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "hw/plan/setup.h"
#include "model/contract/law.h"

namespace cuboct {
namespace {

constexpr double kEdge = 1.549603;  // cubic cell edge at zero pressure, cutoff 2.5 sigma

Scene crystal(const Mat3& deformation) {
  Scene scene;
  scene.path = "lj";
  scene.rule.law = lennard_jones(1, 1, 2.5, 0.8);
  scene.rule.mass = 1;
  scene.rule.dt = 0.004;
  scene.rule.types.resize(1);
  scene.rule.strength = {{1.0}};
  const int n = 7;
  for (int z = 0; z < n; ++z)
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x)
        for (const Vec3& site : {Vec3(0, 0, 0), Vec3(0, 0.5, 0.5), Vec3(0.5, 0, 0.5), Vec3(0.5, 0.5, 0)})
          scene.body.x.push_back(deformation * (Vec3(x, y, z) + site) * kEdge);
  scene.body.v.assign(scene.body.size(), Vec3::Zero());
  scene.body.type.assign(scene.body.size(), 0);
  return scene;
}

// Mean virial stress of the particles that have all their neighbours: the sum over pairs of d (x) f / (2 V).
Mat3 stress(const Mat3& strain) {
  const Mat3 deformation = Mat3::Identity() + strain;
  const Scene scene = crystal(deformation);
  Arch arch;
  arch.capacity = 32;
  const auto setup = make_setup(scene, arch);
  const FixedRule& rule = setup.plan.rule;
  const int P = rule.widths.position_frac;
  const double length = rule.cell_edge, position = std::ldexp(length, -P);  // of a visible unit
  const double newton = std::ldexp(length, -rule.widths.velocity_frac()) * rule.mass / (rule.dt * rule.dt);
  std::vector<std::vector<const Particle*>> cells(setup.plan.lattice.size());
  for (const Particle& p : setup.initial.particles) cells[p.cell].push_back(&p);

  const Vec3 low = Vec3::Constant(2.6), high = Vec3::Constant(6.5 * kEdge - 2.6);
  Mat3 sum = Mat3::Zero();
  int bulk = 0;
  for (uint32_t n = 0; n < cells.size(); ++n)
    for (const Particle* i : cells[n]) {
      const Vec3& at = scene.body.x[i->id];
      if (!at.within(low, high)) continue;
      ++bulk;
      for (const auto& [other, offset] : setup.plan.lattice.neighbourhood(n))
        for (const Particle* j : cells[other]) {
          const Int3 x_i = visible(rule, i->x);
          Int3 x_j = visible(rule, j->x);
          for (int a = 0; a < 3; ++a) x_j[a] += int64_t{offset[a]} << P;
          const Int3 kick = pair_kick(rule, x_i, i->v, 0, x_j, j->v, 0).kick;
          for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b)
              sum(a, b) += 0.5 * static_cast<double>(x_j[a] - x_i[a]) * position *
                           static_cast<double>(kick[b]) * newton;
        }
    }
  EXPECT_GT(bulk, 60);
  return sum / (bulk * kEdge * kEdge * kEdge / 4 * deformation.determinant());
}

// Slope at zero strain of stress(i, j) along `direction`, by least squares of c1 e + c3 e^3 over strains up
// to 0.9 %. One pair of strains would do for real numbers; d's unit, 2^-16 of a cell (4e-5 sigma), is up to 2
// % of what the smallest of these strains does to a bond, the same for all bonds of a perfect crystal, so
// that many strains must average it.
Mat3 stiffness(const Mat3& direction) {
  double s2 = 0, s4 = 0, s6 = 0;
  Mat3 b1 = Mat3::Zero(), b3 = Mat3::Zero();
  for (int k = 1; k <= 18; ++k) {
    const double e = 5e-4 * k;
    const Mat3 odd = 0.5 * (stress(e * direction) - stress(-e * direction));
    s2 += e * e, s4 += std::pow(e, 4), s6 += std::pow(e, 6);
    b1 += e * odd, b3 += e * e * e * odd;
  }
  return (s6 * b1 - s4 * b3) / (s2 * s6 - s4 * s4);
}

// Reference values: LAMMPS, plain truncation at 2.5 sigma, zero temperature and pressure. Tolerance 1 %: the
// unit of d, above.
TEST(GoldenElasticity, LennardJonesCrystalAtDefaultWidths) {
  Mat3 stretch = Mat3::Zero(), shear = Mat3::Zero();
  stretch(0, 0) = 1;
  shear(1, 2) = shear(2, 1) = 0.5;
  const Mat3 s = stiffness(stretch), t = stiffness(shear);
  EXPECT_NEAR(s(0, 0) / 97.71, 1, 0.01);
  EXPECT_NEAR(s(1, 1) / 55.63, 1, 0.01);
  EXPECT_NEAR(t(1, 2) / 55.63, 1, 0.01);
  EXPECT_LT(std::abs(stress(Mat3::Zero()).trace() / 3),
            0.005 * 69.66);  // zero pressure, against the bulk modulus
  std::printf("C11 %.3f (97.71)  C12 %.3f (55.63)  C44 %.3f (55.63)\n", s(0, 0), s(1, 1), t(1, 2));
}

}  // namespace
}  // namespace cuboct
