// SPDX-License-Identifier: MIT
// A look at a state changes no bit of what follows: whatever is read, of each kind of rule, by both
// integrators. Velocity Verlet has forces by the velocities of the half step when it is looked at.
#include <gtest/gtest.h>

#include <map>
#include <numeric>

#include "hw/engine/scene_engine.h"
#include "hw/plan/setup.h"
#include "model/base/steps.h"
#include "tests/run/kinds.h"

namespace cuboct::test {
namespace {

constexpr uint64_t kSteps = 20;

std::string reduced(const std::string& pitch, const std::string& rule, const std::string& more = "") {
  return "units = \"reduced\"\nmass = 1\npacking = { pitch = " + pitch +
         " }\n"
         "geometry = { shape = \"box\", min = [0, 0, 0], max = [5, 4, 4] }\n"
         "velocity = [ { thermal_energy = 1, seed = 1 } ]\n"
         "probe = [ { name = \"all\", kind = \"temperature\", region = { shape = \"sphere\", radius = 100 } "
         "} ]\n" +
         more + "run = { dt = 0.005, steps = 20 }\n" + rule;
}

// The kinds of rules, with friction where they can have it.
const std::map<std::string, std::string> kScenes{
    {"langevin", reduced("1.1", "rule = \"texts/langevin.toml\"\n")},
    {"dpd", reduced("0.85", "rule = \"texts/dpd.toml\"\n")},
    // Slow to slip: the friction of a bond by the velocities of its ends, and what it keeps.
    {"bonds that keep",
     reduced("1",
             "[rule]\nbonds = \"reference\"\nreach = 1.2\n[rule.bond.set]\n"
             "[[rule.round]]\nbond.set = \"max(min(set, r - r0 + 0.02), r - r0 - 0.02)\"\n"
             "sum.force = \"(50 * (r - r0 - set) + 3 * dot(v_j - v_i, d) / r) * d / r\"\n")},
    {"law",
     reduced("1", "[law]\nkind = \"lj\"\nepsilon = 1\nsigma = 0.9\ncutoff = 1.8\n[damping]\nratio = 0.1\n")},
    {"tersoff",
     "mass = \"12.011 u\"\ncrystal = { lattice = \"graphene\" }\n"
     "box = { cells = [4, 3, 1], periodic = \"xy\" }\n"
     "velocity = [ { temperature = \"3000 K\", seed = 3 } ]\nrun = { steps = 20 }\n"
     "rule = { kind = \"tersoff\", potential = \"c_1989\" }\n"},
    {"lps",
     "density = \"2440 kg/m^3\"\npacking = { pitch = \"1 mm\" }\n"
     "geometry = { shape = \"box\", min = \"[0, 0, 0] mm\", max = \"[6, 8, 4] mm\" }\n"
     "velocity = [ { region = { shape = \"half_space\", point = \"[0, 4.1, 0] mm\", normal = \"y\" }, "
     "uniform = \"[0, 40, 3] m/s\" } ]\nrun = { dt = \"auto\", steps = 20 }\n"
     "rule = { kind = \"lps\", youngs_modulus = \"72 GPa\", poissons_ratio = 0.22, "
     "fracture_energy = \"3.8 J/m^2\" }\n"},
};

class Looks : public testing::TestWithParam<std::string> {
 protected:
  const Scene scene = parse_scene(kScenes.at(GetParam()), CUBOCT_SOURCE_DIR "/scenes/rules/test.toml");
  const Plan plan = scene_plan_of(scene, {}, "reference");
  EngineKind kind(Integrator integrator) const {
    return scene_reference_kind(scene, plan, {.integrator = integrator});
  }
};

constexpr Integrator kBoth[] = {Integrator::semi_implicit_euler, Integrator::velocity_verlet};

void expect_equal(const RealFrame& a, const RealFrame& b) {
  ASSERT_EQ(a.x.size(), b.x.size());
  for (size_t i = 0; i < a.x.size(); ++i) {
    ASSERT_EQ(a.x[i], b.x[i]) << "particle " << i;
    ASSERT_EQ(a.v[i], b.v[i]) << "particle " << i;
  }
  EXPECT_EQ(a.shown, b.shown);
}

TEST_P(Looks, NoneChangesTheRun) {
  for (const Integrator integrator : kBoth) {
    SCOPED_TRACE(integrator == Integrator::velocity_verlet ? "verlet" : "euler");
    const EngineKind made = kind(integrator);
    const auto unseen = made.make(nullptr, false), seen = made.make(nullptr, false);
    unseen->advance(kSteps);
    std::vector<uint32_t> ids(scene.body.size());
    std::iota(ids.begin(), ids.end(), 0u);
    for (uint64_t step = 0; step < kSteps; ++step) {
      Asked asked;
      asked.energies = asked.forces = asked.velocities = true;
      asked.volume = 1;
      if (step % 2 == 0) seen->read(asked);
      seen->frame(step % 3 != 0);
      seen->momentum(), seen->counters_of_state(), seen->saved_body();
      seen->advance(1);
    }
    expect_equal(std::get<RealFrame>(unseen->frame(false)), std::get<RealFrame>(seen->frame(false)));
  }
}

TEST_P(Looks, ProbesAndFramesLeaveTheLastFrame) {
  for (const Integrator integrator : kBoth) {
    SCOPED_TRACE(integrator == Integrator::velocity_verlet ? "verlet" : "euler");
    RunRequest rarely;
    rarely.steps = kSteps, rarely.frames = {0, kSteps};
    RunRequest often = rarely;
    often.frames = often.probes = every_so_often(1, kSteps);
    often.energies = often.forces = true;
    const Recorded one = record(scene, kind(integrator), rarely),
                   other = record(scene, kind(integrator), often);
    ASSERT_FALSE(one.trace.stop || other.trace.stop);
    ASSERT_EQ(one.trace.bodies.back().step, kSteps);
    expect_equal(one.trace.bodies.back(), other.trace.bodies.back());
  }
}

std::string named(const testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  std::erase(name, ' ');
  return name;
}
INSTANTIATE_TEST_SUITE_P(Rules, Looks,
                         testing::Values("langevin", "dpd", "bonds that keep", "law", "tersoff", "lps"),
                         named);

}  // namespace
}  // namespace cuboct::test
