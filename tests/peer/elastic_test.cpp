// SPDX-License-Identifier: MIT
// Elastic constants beside LAMMPS: its stress of boxes that are stretched a little, of a crystal along its
// cubic axes and of one that is turned, whose constants hold C44. Reduced units, epsilon = sigma = 1.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numeric>

#include "model/analysis/strained_cell.h"
#include "model/base/mat3.h"
#include "model/body/packing.h"
#include "model/contract/law.h"
#include "model/solid/moduli.h"
#include "tests/fcc_block.h"
#include "tests/peer/lammps.h"

namespace cuboct {
namespace {

constexpr double kStrain = 1e-5;
constexpr const char* kPair = "pair_style lj/smooth/linear 2.5\npair_coeff 1 1 1 1";

// Tension, of the state that the lines of `run.pair` leave.
Mat3 lammps_stress(test::LammpsRun run, const Body& body) {
  run.dt = 0.001;
  run.steps = 1;  // LAMMPS dumps at no fewer; the frame before it counts
  const std::vector<Mat3> virial = test::run_lammps(run, body)[0].virial;
  return std::accumulate(virial.begin(), virial.end(), Mat3(Mat3::Zero())) / run.periodic.extent.prod();
}

Mat3 lammps_stress(const Fcc& fcc, const Vec3& size, const Vec3& stretch) {
  test::LammpsRun run;
  run.pair = kPair;
  run.periodic.extent = size;
  Body body;
  body.x = pack(fcc, nullptr, run.periodic);
  for (Vec3& x : body.x) x = x.cwiseProduct(stretch);
  run.periodic.extent = size.cwiseProduct(stretch);
  body.v.assign(body.size(), Vec3::Zero());
  body.type.assign(body.size(), 0);
  return lammps_stress(run, body);
}

TEST(Elastic, LennardJonesConstantsAreThoseOfLammps) {
  if (!test::have_lammps()) GTEST_SKIP() << "LAMMPS (lmp) was not found when the build was configured";
  const Rule rule = test::simple_rule(lennard_jones(1, 1, 2.5, 0.5, Smoothing::linear), 1, 1);
  const double pitch = relaxed_pitch(*rule.law, 1.1), edge = std::numbers::sqrt2 * pitch;
  CrystalCell cell;
  cell.vectors << 0, 1, 1, 1, 0, 1, 1, 1, 0;
  cell.vectors *= edge / 2;
  cell.x = {Vec3::Zero()};
  cell.type = {0};
  uint64_t evaluations = 0;
  const Matrix6 sums = elastic_tensor(rule, cell).c,
                strained = constants_by_strain(rule, cell, 1e-6, 1, evaluations);
  const Mat3 turn = Eigen::AngleAxisd(std::numbers::pi / 4, eigen(Vec3::UnitZ())).toRotationMatrix();
  int compared = 0;
  for (const auto& [axes, size] : {std::pair{Mat3(Mat3::Identity()), Vec3(4 * edge, 4 * edge, 4 * edge)},
                                   {turn, Vec3(6 * pitch, 6 * pitch, 4 * edge)}}) {
    // Sites stand a quarter of a pitch inside the box, none on its border.
    const Fcc fcc{pitch, axes, Vec3::Constant(0.25 * pitch)};
    const Matrix6 expected = in_axes(sums, axes.transpose()), simulated = in_axes(strained, axes.transpose());
    // Along x: what stretches along the other axes tell is the same, or C11 and C12 again.
    const Mat3 slope =
        (lammps_stress(fcc, size, {1 + kStrain, 1, 1}) - lammps_stress(fcc, size, {1 - kStrain, 1, 1})) /
        (2 * kStrain);
    for (int row = 0; row < 3; ++row, ++compared) {
      // The central difference errs by the strain's square, times third over first derivatives: some hundred.
      EXPECT_NEAR(slope(row, row), expected(row, 0), 1e-6 * sums(0, 0)) << row;
      EXPECT_NEAR(slope(row, row), simulated(row, 0), 1e-6 * sums(0, 0)) << row;
    }
  }
  EXPECT_EQ(compared, 6);
}

// Two planes of one material and two of a stiffer one in turn, along a cubic axis: planes move against each
// other when the crystal is strained, so LAMMPS relaxes each state too.
TEST(Elastic, ConstantsOfALayeredMixtureAreThoseOfLammps) {
  if (!test::have_lammps()) GTEST_SKIP() << "LAMMPS (lmp) was not found when the build was configured";
  constexpr double kStiffer = 3, kBetween = 0.5;
  Rule rule = test::simple_rule(lennard_jones(1, 1, 2.5, 0.5, Smoothing::linear), 1, 1);
  rule.types = {{.name = "soft"}, {.name = "stiff", .material = 1}};
  rule.strength = {{1, kBetween}, {kBetween, kStiffer}};
  const double edge = std::numbers::sqrt2 * relaxed_pitch(*rule.law, 1.1);
  CrystalCell start;
  start.vectors = edge * diagonal({2, 1, 1});
  for (int plane = 0; plane < 4; ++plane)
    for (int k = 0; k < 2; ++k) {
      start.x.emplace_back(edge / 2 * Vec3(plane, k, (plane + k) % 2));
      start.type.push_back(static_cast<uint8_t>(plane / 2));
    }
  const CrystalCell cell = without_stress(rule, start, 1);
  uint64_t evaluations = 0;
  const Matrix6 sums = elastic_tensor(rule, cell).c,
                strained = constants_by_strain(rule, cell, 1e-6, 1, evaluations);
  const auto stress = [&](int axis, double strain) {
    constexpr int kCopies[] = {2, 4, 4};
    Vec3 stretch = Vec3::Ones();
    stretch[axis] += strain;
    test::LammpsRun run;
    run.types = 2;
    run.pair =
        "pair_style lj/smooth/linear 2.5\npair_coeff 1 1 1 1\npair_coeff 2 2 3 1\npair_coeff 1 2 0.5 1\n"
        "min_style cg\nminimize 0 1e-11 20000 20000\nreset_timestep 0";
    Body body;
    for (int h = 0; h < kCopies[0]; ++h)
      for (int k = 0; k < kCopies[1]; ++k)
        for (int l = 0; l < kCopies[2]; ++l)
          for (size_t i = 0; i < cell.x.size(); ++i) {
            // No site stands on the border.
            const Vec3 x = cell.x[i] + cell.vectors * Vec3(h, k, l) + Vec3::Constant(0.2 * edge);
            body.x.emplace_back(x.cwiseProduct(stretch));
            body.type.push_back(cell.type[i]);
          }
    body.v.assign(body.size(), Vec3::Zero());
    run.periodic.extent = Vec3(cell.vectors.diagonal())
                              .cwiseProduct(Vec3(kCopies[0], kCopies[1], kCopies[2]))
                              .cwiseProduct(stretch);
    return lammps_stress(run, body);
  };
  for (int axis = 0; axis < 2; ++axis) {
    const Mat3 slope = (stress(axis, kStrain) - stress(axis, -kStrain)) / (2 * kStrain);
    for (int row = 0; row < 3; ++row) {
      // LAMMPS ends its search at forces of 1e-11, a part of 1e-7 of what these strains make.
      EXPECT_NEAR(slope(row, row), sums(row, axis), 1e-5 * sums(0, 0)) << row << axis;
      EXPECT_NEAR(slope(row, row), strained(row, axis), 1e-5 * sums(0, 0)) << row << axis;
    }
  }
  EXPECT_GT(sums(1, 1), 1.2 * sums(0, 0));  // stiffer along its planes than across
}

}  // namespace
}  // namespace cuboct
