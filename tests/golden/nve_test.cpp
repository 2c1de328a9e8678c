// SPDX-License-Identifier: MIT
// The total energy of a liquid fluctuates in proportion to dt^2, and as much as in LAMMPS: the check by which
// GROMACS tests its integrators. docs/measured/validation.md, section 1, has the full table.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/golden/scene_with.h"

namespace cuboct {
namespace {

const std::string kTreeScenes = CUBOCT_SOURCE_DIR "/scenes/validation/";

// The liquid, 4 units of time after its start as a crystal.
Body melted() {
  const Scene scene =
      test::scene_with(kTreeScenes + "melt_864.toml", {{"run.duration", "4"}, {"run.probe_every", "0"}});
  const Plan plan = plan_of(scene, read_arch(kTreeScenes + "wide.toml"));
  emu::LatticeRun request;
  request.steps = request.hash_every = scene.steps;
  request.frames = {scene.steps};
  request.engine.threads = 1;
  const Trace trace = emu::run_lattice(scene, plan, request).trace;
  if (trace.stop || trace.frames.empty()) throw std::runtime_error("the melt did not end");
  return to_real(trace.frames.back(), plan.rule, plan.lattice, plan.origin);
}

// Root mean square fluctuation of the total energy per particle about its mean, over 5 units of time.
double fluctuation(const Body& liquid, double dt) {
  Scene scene = test::scene_with(kTreeScenes + "melt_864.toml",
                                 {{"run.dt", fmt::format("{}", dt)},
                                  {"run.duration", "5"},
                                  {"run.probe_every", fmt::format("{}", std::lround(0.048 / dt))}});
  scene.body = liquid;
  const auto curves = test::curves_of(scene, read_arch(kTreeScenes + "wide.toml"), true);
  const Curve& total = test::curve_named(curves, "energy.total");
  double sum = 0, squares = 0;
  const auto n = static_cast<double>(total.value.size());
  for (const double value : total.value) {
    const double e = (value - total.value[0]) / static_cast<double>(scene.body.size());
    sum += e, squares += e * e;
  }
  return std::sqrt(squares / n - sum * sum / (n * n));
}

// Both runs begin in one state and part only as their errors grow, so that the ratio of their fluctuations is
// known better than each: some 40 of 104 samples are independent, 12 % of statistical error.
TEST(EnergyFluctuation, GrowsAsTheSquareOfTheTimeStep) {
  const Body liquid = melted();
  const double fine = fluctuation(liquid, 0.004), coarse = fluctuation(liquid, 0.008);
  fmt::print("{:.3g} at dt 0.004, {:.3g} at 0.008: ratio {:.2f}\n", fine, coarse, coarse / fine);
  EXPECT_NEAR(coarse / fine, 4, 0.8);
  // LAMMPS with 4,000 atoms (pair_style lj/smooth/linear 2.5, kT about 0.70): 1.82e-5 and 7.24e-5 epsilon per
  // atom. Fluctuations per particle go with 1/sqrt(N). Three times the statistical error.
  const double larger = std::sqrt(4000 / 864.0);
  EXPECT_NEAR(fine / (1.82e-5 * larger), 1, 0.36);
  EXPECT_NEAR(coarse / (7.24e-5 * larger), 1, 0.36);
}

}  // namespace
}  // namespace cuboct
