// SPDX-License-Identifier: MIT
// Liquids of scenes/rules in a bath: the temperature that was asked for, and LAMMPS's energy and pressure
// from the same start. docs/measured/validation.md, section 6, has longer runs.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "emu/lattice/run.h"
#include "hw/plan/setup.h"
#include "tests/peer/blocks.h"
#include "tests/peer/lammps.h"

namespace cuboct {
namespace {

using test::Mean;

struct Bath {
  Mean temperature, potential, pressure;
};

Bath bath_of(const Scene& scene, uint64_t rest, uint64_t steps, uint64_t every) {
  const Plan plan = program_plan_of(scene, Arch());
  emu::LatticeRun request;
  request.steps = rest + steps;
  request.energies = true;
  request.hash_every = request.steps;
  request.engine.threads = 1;
  for (uint64_t step = 0; step <= request.steps; step += every) request.probes.push_back(step);
  const Trace trace = emu::run_lattice(scene, plan, request).trace;
  EXPECT_FALSE(trace.stop);
  const auto curve = [&](const char* name) {
    for (const Curve& c : trace.curves)
      if (c.name == name)
        return test::blocked({c.value.begin() + static_cast<ptrdiff_t>(rest / every), c.value.end()});
    throw std::runtime_error(name);
  };
  return {curve("temperature"), curve("energy.potential"), curve("pressure")};
}

// The bits are the same anywhere, and so is what these means are off by.
void expect_temperature(const Bath& bath) {
  fmt::print("kT {:.5f} +- {:.5f}, potential {:.2f} +- {:.2f}, pressure {:.4f} +- {:.4f}\n",
             bath.temperature.value, bath.temperature.error, bath.potential.value, bath.potential.error,
             bath.pressure.value, bath.pressure.error);
  EXPECT_LT(bath.temperature.error, 0.005);
  EXPECT_NEAR(bath.temperature.value, 1, 0.01);
}

TEST(Thermostats, DissipativeParticlesHaveTheirTemperature) {
  expect_temperature(bath_of(read_scene(CUBOCT_SOURCE_DIR "/scenes/rules/dpd.toml"), 800, 12000, 10));
}

TEST(Thermostats, LangevinsLiquidIsThatOfLammps) {
  const Scene scene = read_scene(CUBOCT_SOURCE_DIR "/scenes/rules/langevin.toml");
  constexpr int kRest = 2000, kSteps = 20000, kEvery = 20;
  const Bath ours = bath_of(scene, kRest, kSteps, kEvery);
  expect_temperature(ours);
  if (!test::have_lammps()) GTEST_SKIP() << "LAMMPS (lmp) was not found when the build was configured";
  const test::LammpsRun peer{scene.periodic,
                             "pair_style lj/cut 2.5\npair_coeff 1 1 1 1\npair_modify shift yes\n"
                             "fix bath all langevin 1 1 1 48279",
                             1,
                             scene.rule.dt,
                             kRest + kSteps,
                             {},
                             kEvery};
  std::vector<double> potential, pressure;
  for (const test::LammpsSample& sample : test::sample_lammps(peer, scene.body)) {
    if (sample.step < kRest) continue;
    potential.push_back(sample.potential_energy), pressure.push_back(sample.pressure);
  }
  const auto expect_same = [](const char* what, const Mean& a, const Mean& b) {
    const double sigmas = (a.value - b.value) / std::hypot(a.error, b.error);
    fmt::print("{}: LAMMPS's {:.4f} +- {:.4f}, {:+.1f} sigma\n", what, b.value, b.error, sigmas);
    EXPECT_LT(std::abs(sigmas), 4) << what;
  };
  expect_same("potential", ours.potential, test::blocked(potential));
  expect_same("pressure", ours.pressure, test::blocked(pressure));
}

}  // namespace
}  // namespace cuboct
