// SPDX-License-Identifier: MIT
// The peridynamic solid of the GPU, compiled for the host, beside the reference engine, which tests/rules
// compares with LAMMPS and closed forms.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "emu/gpu/lps/lps_compare.h"
#include "emu/gpu/lps/lps_layout.h"
#include "model/base/error.h"
#include "model/real/rounds_engine.h"
#include "model/rules/lps.h"
#include "model/scene/scene.h"

namespace cuboct::gpu {
namespace {

// A plate with a cut, whose upper half moves up: bonds at the cut's end break, others only stretch.
Scene plate(const std::string& rule, const std::string& more = "") {
  return parse_scene(
      "density = \"2440 kg/m^3\"\npacking = { pitch = \"1 mm\" }\n"
      "geometry = { shape = \"box\", min = \"[0, 0, 0] mm\", max = \"[12, 12, 3] mm\" }\n"
      "[rule]\nkind = \"lps\"\nyoungs_modulus = \"72 GPa\"\npoissons_ratio = 0.3\n"
      "fracture_energy = \"3.8 J/m^2\"\nunbreakable = [\"top\"]\n" +
          rule +
          "[[rule.slit]]\ncorner = \"[-1, 6.1, -1] mm\"\nalong = \"[6, 0, 0] mm\"\nacross = \"[0, 0, 6] "
          "mm\"\n"
          "[regions]\ntop = { shape = \"half_space\", point = \"[0, 11, 0] mm\", normal = \"-y\" }\n"
          "[[constraint]]\nname = \"up\"\nkind = \"moved\"\nvelocity = \"[0, 2, 0] m/s\"\naxes = \"y\"\n"
          "region = \"top\"\n"
          "[[velocity]]\nregion = { shape = \"half_space\", point = \"[0, 6.1, 0] mm\", normal = \"-y\" }\n"
          "uniform = \"[0, 1.5, 0.3] m/s\"\n" +
          more + "[run]\ndt = \"auto\"\nsteps = 40\n",
      "plate");
}

struct Beside {
  Scene scene;
  std::unique_ptr<RealEngine> reference;
  std::unique_ptr<LpsDevice> device;

  Beside(Scene of, bool doubles) : scene(std::move(of)) {
    reference = make_rounds_engine(scene.rule, scene.packing(), scene.periodic, {});
    device = make_lps_device(scene.rule, scene.body, scene.packing().x, lps_terms_of(*reference),
                             {.doubles = doubles});
  }
  LpsErrors after(uint64_t from, uint64_t steps) {
    device->start();
    device->advance(from);
    return lps_errors(*device, *reference, scene.packing(), steps);
  }
  // How many points have bonds that gave way, and lost some of them wholly or in part.
  size_t damaged() const {
    size_t count = 0;
    for (const double d : device->damage()) count += d > 0 ? 1 : 0;
    return count;
  }
};

const std::string kRules[] = {"", "damage_width = 2e-5\n", "damage_width = 2e-5\nstrain = \"small\"\n"};

// The same operations in the same order, but for units, which are powers of two, accelerations, which are
// multiplied by 1/m where the reference divides, and bonds of one kind, which share one vector. A strain is a
// difference of lengths: roundings of 1e-16 are up to 1e-12 of it. Steps and breaking bonds make more of
// that.
TEST(Lps, DoublesAreTheReferences) {
  for (const std::string& rule : kRules) {
    Beside beside(plate(rule), true);
    const LpsErrors soon = beside.after(0, 10);
    EXPECT_LT(soon.displacement, 1e-11) << rule;
    EXPECT_LT(soon.velocity, 1e-10) << rule;
    EXPECT_LT(soon.damage, 1e-9) << rule;
    const LpsErrors off = beside.after(0, 60);
    EXPECT_GT(beside.damaged(), 20u) << rule;
    EXPECT_LT(off.displacement, 1e-9) << rule;
    EXPECT_LT(off.velocity, 1e-8) << rule;
    EXPECT_LT(off.dilatation, 1e-8) << rule;
    EXPECT_LT(off.damage, 1e-7) << rule;
  }
}

// From a state with broken bonds on, which the reference takes over: 1e-7 a rounding, of displacements some
// hundred times those that strain a bond.
TEST(Lps, FloatsAreNear) {
  for (const std::string& rule : kRules) {
    Beside beside(plate(rule), false);
    const LpsErrors off = beside.after(50, 10);
    EXPECT_GT(beside.damaged(), 20u) << rule;
    EXPECT_LT(off.displacement, 2e-6) << rule;
    EXPECT_LT(off.velocity, 1e-4) << rule;
    EXPECT_LT(off.dilatation, 1e-3) << rule;
  }
}

// What broke stays broken when the body is put back: damage never falls, and some bonds have closed again.
TEST(Lps, DamageNeverFalls) {
  Beside beside(plate("damage_width = 2e-5\n"), true);
  beside.device->advance(60);
  std::vector<double> before = beside.device->damage();
  for (int k = 0; k < 5; ++k) {
    beside.device->advance(20);
    const std::vector<double> now = beside.device->damage();
    for (size_t i = 0; i < now.size(); ++i) EXPECT_GE(now[i], before[i]) << i;
    before = now;
  }
  beside.device->start();
  EXPECT_EQ(beside.damaged(), 0u);
}

TEST(Lps, WithoutBreakingNothingBreaks) {
  Scene scene = plate("");
  const auto* rule = dynamic_cast<const LpsRule*>(scene.rule.rounds.get());
  ASSERT_NE(rule, nullptr);
  LpsMaterial material = rule->material();
  material.critical_stretch = std::numeric_limits<double>::infinity();
  scene.rule.rounds = std::make_shared<LpsRule>(material, rule->full());
  scene.rule.rounds_reach = material.horizon;
  Beside beside(std::move(scene), true);
  const LpsErrors off = beside.after(0, 60);
  EXPECT_EQ(beside.damaged(), 0u);
  EXPECT_TRUE(beside.device->memory().empty());
  EXPECT_LT(off.velocity, 1e-9);
}

// A packing has few kinds of bonds; a shaken one as many as bonds, which 16 bits do not number.
TEST(Lps, KindsAreThoseOfThePacking) {
  const Beside packed(plate(""), true);
  EXPECT_LT(packed.device->kinds(), 4000u);
  Scene scene = plate("");
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal(0, 1e-5);
  std::vector<Vec3> more;
  for (int copy = 0; copy < 12; ++copy)
    for (const Vec3& x : scene.body.x)
      more.push_back(x + Vec3(0.02 * copy + normal(random), normal(random), normal(random)));
  const size_t before = scene.body.size();
  scene.body.v.resize(more.size());
  scene.body.type.resize(more.size(), 0);
  for (size_t i = before; i < more.size(); ++i) scene.body.v[i] = scene.body.v[i % before];
  scene.body.x = more;
  const auto* rule = dynamic_cast<const LpsRule*>(scene.rule.rounds.get());
  scene.rule.rounds = std::make_shared<LpsRule>(rule->material(), rule->full());
  Beside shaken(std::move(scene), true);
  EXPECT_GT(shaken.device->kinds(), 65536u);
  EXPECT_LT(shaken.after(0, 10).velocity, 1e-9);
}

std::string refusal(const Scene& scene) {
  try {
    Beside beside(scene, false);
    return "none";
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(Lps, RefusesWhatItHasNot) {
  EXPECT_EQ(refusal(plate("strain = \"small\"\n")), "none");
  const std::string said = refusal(plate("strain = \"small\"\nsurface_correction = true\n"));
  EXPECT_NE(said.find("the GPU's peridynamic solid has no free-surface correction"), std::string::npos)
      << said;
  const std::string force = refusal(plate("",
                                          "[[constraint]]\nname = \"hold\"\nkind = \"held_by_force\"\nkp = "
                                          "\"1e5 N/m\"\nkd = \"0 kg/s\"\nregion = \"top\"\n"));
  EXPECT_NE(force.find("'matter/hold', held or moved by force"), std::string::npos) << force;
}

TEST(Lps, TellsALostPoint) {
  Scene scene = plate("");
  scene.rule.dt *= 1e3;
  Beside beside(std::move(scene), false);
  try {
    beside.device->advance(2000);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("has a position that is not finite"), std::string::npos);
  }
}

}  // namespace
}  // namespace cuboct::gpu
