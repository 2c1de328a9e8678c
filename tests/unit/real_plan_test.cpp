// SPDX-License-Identifier: MIT
// The hash of a run in doubles binds all that moves its particles: a checkpoint of another scene is refused.
#include "hw/plan/real_plan.h"

#include <gtest/gtest.h>

#include <set>

#include "model/rules/rounds_rule.h"

namespace cuboct {
namespace {

TEST(RealPlan, HashBindsAllThatMovesAScene) {
  const std::string glass =
      "density = \"2440 kg/m^3\"\npacking = { pitch = \"1 mm\" }\n"
      "geometry = { shape = \"box\", size = \"[6, 5, 5] mm\" }\n"
      "[rule]\nkind = \"lps\"\nyoungs_modulus = \"72 GPa\"\npoissons_ratio = 0.22\n"
      "[[constraint]]\nname = \"right\"\nkind = \"moved\"\nvelocity = \"[1, 0, 0] m/s\"\n"
      "region = { shape = \"half_space\", point = \"[2, 0, 0] mm\", normal = \"-x\" }\n"
      "[run]\ndt = \"10 ns\"\nsteps = 10\n";
  const Scene scene = parse_scene(glass, "glass.toml");
  ASSERT_NE(scene.rule.rounds.get(), nullptr);
  ASSERT_EQ(scene.rule.types.size(), 2u);
  std::set<uint64_t> hashes{real_plan_of(scene, Arch{}).hash};
  EXPECT_EQ(*hashes.begin(), real_plan_of(parse_scene(glass, "other.toml"), Arch{}).hash);
  const auto differs = [&](const char* what, const std::function<void(Scene&)>& change) {
    Scene other = scene;
    change(other);
    EXPECT_TRUE(hashes.insert(real_plan_of(other, Arch{}).hash).second) << what;
  };
  for (size_t type = 0; type < 2; ++type) {
    const auto differs_in = [&](const char* what, const std::function<void(ParticleType&)>& change) {
      differs(what, [&](Scene& s) { change(s.rule.types[type]); });
    };
    differs_in("velocity", [](ParticleType& t) { t.velocity[1] += 1; });
    differs_in("gravity, or a force", [](ParticleType& t) { t.gravity[2] -= 1; });
    differs_in("imposed", [](ParticleType& t) { t.imposed[2] = !t.imposed[2]; });
    differs_in("pd", [](ParticleType& t) { t.pd = true; });
    differs_in("kp", [](ParticleType& t) { t.kp += 1; });
    differs_in("kd", [](ParticleType& t) { t.kd += 1; });
  }
  differs("mass", [](Scene& s) { s.rule.mass *= 2; });
  differs("damping", [](Scene& s) { s.rule.damping.coefficient += 1; });
  differs("dt", [](Scene& s) { s.rule.dt *= 2; });
  differs("box", [](Scene& s) { s.periodic.extent[0] = 1; });
  differs("position", [](Scene& s) { s.body.x[3][0] += 1e-6; });
  differs("velocity of a particle", [](Scene& s) { s.body.v[3][0] += 1; });
  differs("type", [](Scene& s) { s.body.type[0] ^= 1; });
  differs("displacement", [](Scene& s) { s.body.u.assign(s.body.size(), Vec3::Ones()); });
  differs("static loading", [](Scene& s) { s.loading = StaticLoading{}; });
  differs("tolerance", [](Scene& s) { s.loading = StaticLoading{.tolerance = 1e-5}; });
}

}  // namespace
}  // namespace cuboct
