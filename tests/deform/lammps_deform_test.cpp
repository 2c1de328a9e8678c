// SPDX-License-Identifier: MIT
// A box that deforms at a strain rate beside LAMMPS's `fix deform erate ... remap x`: stresses and energies
// step by step. Reduced units, epsilon = sigma = mass = 1.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <sstream>

#include "model/contract/law.h"
#include "model/real/reference.h"
#include "model/solid/dynamical_matrix.h"
#include "tests/fcc_block.h"
#include "tests/peer/lammps.h"

namespace cuboct {
namespace {

constexpr double kDt = 0.004;
constexpr int kSteps = 400;
const Vec3 kRate(0.05, -0.02, 0);  // 1/time

struct Sample {
  double potential = 0, kinetic = 0, xx = 0, yy = 0, xy = 0, length = 0;
};

// LAMMPS changes the box at a step's end, after its forces, so that its volume is a step ahead of its virial.
// A run that begins in our box of step 1 is ours: it drifts in the box of each step as we do. No force is
// lost at the start, as the crystal has none in any such box.
std::vector<Sample> of_lammps(Body body, const BoxDeformation& box) {
  const Periodic first = box.at(1);
  BoxStretch(box.at(0), first).carry(body.x);
  const Vec3 rate = kRate.cwiseProduct(box.packed.extent.cwiseQuotient(first.extent));
  const std::string lines = fmt::format(R"lmp(neighbor 0.3 bin
neigh_modify every 1 delay 0 check yes
timestep {:.17g}
fix nve all nve
fix pull all deform 1 x erate {:.17g} y erate {:.17g} units box remap x
thermo_style custom step pe ke pxx pyy pxy vol lx
thermo_modify norm no format float %.17g
fix out all print 1 "$(step) $(pe) $(ke) $(pxx) $(pyy) $(pxy) $(vol) $(lx)" file curves.txt screen no
thermo 1
run {}
)lmp",
                                        kDt, rate[0], rate[1], kSteps);
  const test::LammpsRun run{first, "pair_style lj/smooth/linear 2.5\npair_coeff 1 1 1 1", 1, kDt, kSteps, {}};
  std::istringstream text(test::ask_lammps(run, body, lines, {"curves.txt"})[0]);
  std::vector<Sample> samples;
  for (std::string line; std::getline(text, line);) {
    std::istringstream words(line);
    double step = 0, pxx = 0, pyy = 0, pxy = 0, volume = 0;
    Sample sample;
    if (line[0] == '#' || !(words >> step >> sample.potential >> sample.kinetic >> pxx >> pyy >> pxy >>
                            volume >> sample.length))
      continue;
    const double to_ours = -volume / box.at(static_cast<uint64_t>(step)).extent.prod();
    sample.xx = pxx * to_ours, sample.yy = pyy * to_ours, sample.xy = pxy * to_ours;
    samples.push_back(sample);
  }
  return samples;
}

std::vector<Sample> ours(const Body& body, const BoxDeformation& box) {
  RealOptions options{.integrator = Integrator::velocity_verlet};
  options.deform = box;
  Reference run(test::simple_rule(lennard_jones(1, 1, 2.5, 0.5, Smoothing::linear), 1, kDt), body, box.at(0),
                options);
  std::vector<Sample> samples;
  for (uint64_t step = 0; step <= kSteps; ++step) {
    if (step > 0) run.step();
    const double volume = box.at(step).extent.prod();
    Mat3 stress = Mat3::Zero();
    for (const Mat3& of : run.virial_stress(volume)) stress += of;
    for (const Vec3& v : run.body().v) stress -= v * v.transpose() / volume;
    samples.push_back({run.potential_energy(), run.kinetic_energy(), stress(0, 0), stress(1, 1), stress(0, 1),
                       box.at(step + 1).extent[0]});
  }
  return samples;
}

// Both add the same terms in another order, and 1.6 units of time let rounding grow by a few units of e, as
// in the comparison of boxes that keep their size.
TEST(LammpsDeform, StressesAndEnergiesAgreeToRounding) {
  if (!test::have_lammps()) GTEST_SKIP() << "LAMMPS (lmp) was not found when the build was configured";
  const double pitch = relaxed_pitch(*lennard_jones(1, 1, 2.5, 0.5, Smoothing::linear), 1.1);
  Body body = test::fcc_block(4, pitch);
  test::shake(body, 0, 0.6, 21);
  const BoxDeformation box{test::fcc_box(4, pitch), Vec3::Zero(), kRate * kDt};
  const std::vector<Sample> theirs = of_lammps(body, box), here = ours(body, box);
  ASSERT_EQ(theirs.size(), static_cast<size_t>(kSteps) + 1);
  Sample most, first = here.front(), last = here.back();
  // Step 0 of theirs is in the box of step 1.
  for (size_t k = 1; k < theirs.size(); ++k) {
    const Sample &a = here[k], &b = theirs[k];
    const auto meet = [](double& most_so_far, double x, double y) {
      most_so_far = std::max(most_so_far, std::abs(x - y));
    };
    meet(most.potential, a.potential, b.potential), meet(most.kinetic, a.kinetic, b.kinetic);
    meet(most.xx, a.xx, b.xx), meet(most.yy, a.yy, b.yy), meet(most.xy, a.xy, b.xy);
    meet(most.length, a.length, b.length);
  }
  // The run has strained the crystal by 8 %, to a stress of the order of its constants' 80 times that.
  EXPECT_GT(last.xx - first.xx, 2);
  EXPECT_LT(last.yy - first.yy, last.xx - first.xx - 1);
  EXPECT_GT(std::abs(last.kinetic - first.kinetic), 5);
  EXPECT_LT(most.length, 1e-12);
  EXPECT_LT(most.potential, 1e-8 * std::abs(first.potential));
  EXPECT_LT(most.kinetic, 1e-8 * first.kinetic);
  EXPECT_LT(most.xx, 1e-8);
  EXPECT_LT(most.yy, 1e-8);
  EXPECT_LT(most.xy, 1e-8);
  if (std::getenv("CUBOCT_VERBOSE"))
    fmt::print(
        "largest differences: pe {:.2e} ke {:.2e} xx {:.2e} yy {:.2e} xy {:.2e}; end xx {:.4g} yy {:.4g}\n",
        most.potential, most.kinetic, most.xx, most.yy, most.xy, last.xx, last.yy);
}

}  // namespace
}  // namespace cuboct
