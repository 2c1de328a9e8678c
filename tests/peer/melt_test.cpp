// SPDX-License-Identifier: MIT
// A Lennard-Jones liquid in golden's bits (the lattice engine holds them) and in LAMMPS: from the same start,
// at the same energy, temperature and pressure agree within their statistical errors.
// docs/measured/validation.md, section 3.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <random>

#include "emu/lattice/run.h"
#include "hw/plan/setup.h"
#include "tests/peer/blocks.h"
#include "tests/peer/lammps.h"

namespace cuboct {
namespace {

using test::Mean;

// An autoregressive series of known correlation: x' = a x + noise of variance 1 has a mean whose variance is
// 1/(n (1 - a)^2).
TEST(Blocks, FindTheErrorOfACorrelatedSeries) {
  std::mt19937_64 random(5);
  const auto noise = [&] {  // a sum of 12 uniform numbers: variance 1
    double sum = -6;
    for (int k = 0; k < 12; ++k) sum += static_cast<double>(random() >> 11) * 0x1p-53;
    return sum;
  };
  const double a = 0.9;
  std::vector<double> x{0};
  while (x.size() < 1 << 15) x.push_back(a * x.back() + noise());
  const Mean mean = test::blocked(x);
  const double expected = 1 / (1 - a) / std::sqrt(static_cast<double>(x.size()));
  EXPECT_NEAR(mean.error / expected, 1, 0.25);  // blocks of a few hundred samples: some 100 are left
  EXPECT_LT(std::abs(mean.value), 4 * expected);
  // Independent samples need no blocks.
  for (double& value : x) value = noise();
  EXPECT_NEAR(test::blocked(x).error * std::sqrt(static_cast<double>(x.size())), 1, 0.1);
}

struct Liquid {
  Mean temperature, pressure, energy;
};

// Of kinetic energies, pressures and total energies of all of `n` particles.
Liquid liquid_of(const std::vector<double>& kinetic, const std::vector<double>& pressure,
                 const std::vector<double>& total, double n) {
  Liquid liquid{test::blocked(kinetic), test::blocked(pressure), test::blocked(total)};
  for (double* value : {&liquid.temperature.value, &liquid.temperature.error}) *value /= 1.5 * n;
  for (double* value : {&liquid.energy.value, &liquid.energy.error}) *value /= n;
  return liquid;
}

double sigmas(const Mean& a, const Mean& b) { return (a.value - b.value) / std::hypot(a.error, b.error); }

TEST(Melt, TemperatureAndPressureAreThoseOfLammps) {
  if (!test::have_lammps()) GTEST_SKIP() << "LAMMPS (lmp) was not found when the build was configured";
  constexpr int kMelt = 2000, kSteps = 6000, kEvery = 25;  // 8 units of time to melt, 16 to measure
  const Scene scene = read_scene(CUBOCT_SOURCE_DIR "/scenes/validation/melt_864.toml");
  const auto n = static_cast<double>(scene.body.size());
  Arch arch = read_arch(CUBOCT_SOURCE_DIR "/scenes/validation/default.toml");
  const Plan plan = plan_of(scene, arch);
  emu::LatticeRun request;
  request.steps = kSteps;
  request.energies = true;
  request.hash_every = kSteps;
  request.engine.threads = 1;
  for (uint64_t step = 0; step <= kSteps; step += kEvery) request.probes.push_back(step);
  const Trace trace = emu::run_lattice(scene, plan, request).trace;
  ASSERT_FALSE(trace.stop);
  const auto curve = [&](const char* name) {
    for (const Curve& c : trace.curves)
      if (c.name == name) return std::vector<double>(c.value.begin() + kMelt / kEvery, c.value.end());
    throw std::runtime_error(name);
  };
  const Liquid ours = liquid_of(curve("energy.kinetic"), curve("pressure"), curve("energy.total"), n);

  test::LammpsRun peer{
      scene.periodic, "pair_style lj/smooth/linear 2.5\npair_coeff 1 1 1 1", 1, scene.rule.dt, kSteps, {},
      kEvery};
  std::vector<double> kinetic, pressure, total;
  for (const test::LammpsSample& sample : test::sample_lammps(peer, scene.body)) {
    if (sample.step < kMelt) continue;
    kinetic.push_back(sample.kinetic_energy);
    pressure.push_back(sample.pressure);
    total.push_back(sample.kinetic_energy + sample.potential_energy);
  }
  const Liquid theirs = liquid_of(kinetic, pressure, total, n);
  fmt::print(
      "kT {:.5f} +- {:.5f}, {:.5f} +- {:.5f}: {:+.1f} sigma\npressure {:.4f} +- {:.4f}, {:.4f} +- {:.4f}: "
      "{:+.1f} "
      "sigma\nenergy {:.6f}, {:.6f}\n",
      ours.temperature.value, ours.temperature.error, theirs.temperature.value, theirs.temperature.error,
      sigmas(ours.temperature, theirs.temperature), ours.pressure.value, ours.pressure.error,
      theirs.pressure.value, theirs.pressure.error, sigmas(ours.pressure, theirs.pressure), ours.energy.value,
      theirs.energy.value);
  // Four sigma: one run of 16,000 is further off by chance.
  EXPECT_LT(std::abs(sigmas(ours.temperature, theirs.temperature)), 4);
  EXPECT_LT(std::abs(sigmas(ours.pressure, theirs.pressure)), 4);
  // The error is small enough to tell a pressure without its kinetic part, or a virial counted twice (both
  // off by more than 0.5), or an energy that is off by 1 %: its derivative by kT is 2.4.
  EXPECT_LT(ours.pressure.error, 0.03);
  EXPECT_LT(ours.temperature.error, 0.003);
  // What the coarse table's energy differs by from the law's while the crystal melts.
  EXPECT_NEAR(ours.energy.value, theirs.energy.value, 2e-3);
}

}  // namespace
}  // namespace cuboct
