// SPDX-License-Identifier: MIT
// What a plan leaves out: when a scene is flat, what a plan can carry all the same, and that no bit changes.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "hw/arch/arch.h"
#include "hw/plan/setup.h"
#include "hw/plan/spared.h"
#include "model/contract/golden.h"
#include "model/scene/scene.h"
#include "tests/support/block.h"
#include "tests/support/refused_with.h"

namespace cuboct::test {
namespace {

const std::string kRoot = CUBOCT_SOURCE_DIR;

Scene sheet() {
  return block_scene({.size = {3, 3, 1}, .jitter = 0.05, .speed = 0.1, .held = true, .flat = true});
}

int axes_after(const std::function<void(Scene&)>& change) {
  Scene scene = sheet();
  change(scene);
  return plan_of(scene, Arch{}).rule.axes;
}

TEST(FlatPlan, NeedsThatNothingHappensAlongZ) {
  EXPECT_EQ(axes_after([](Scene&) {}), 2);
  // Rounding errors of a packing are below the unit of a position with its owner; a whole unit is not.
  const FixedRule rule = plan_of(sheet(), Arch{}).rule;
  const double unit = std::ldexp(rule.cell_edge, -rule.widths.velocity_frac());
  EXPECT_EQ(axes_after([&](Scene& s) { s.body.x[4].z() += 0.4 * unit; }), 2);
  EXPECT_EQ(axes_after([&](Scene& s) { s.body.x[4].z() += unit; }), 3);
  EXPECT_EQ(axes_after([&](Scene& s) { s.body.x[4].z() -= unit; }), 3);
  const auto first_of = [](const Scene& s, bool held) {
    size_t id = 0;
    while (s.rule.types[s.body.type[id]].imposed[2] != held) ++id;
    return id;
  };
  EXPECT_EQ(axes_after([&](Scene& s) { s.body.v[first_of(s, false)].z() = 1e-4; }), 3);
  EXPECT_EQ(axes_after([&](Scene& s) { s.body.v[first_of(s, true)].z() = 1e-4; }), 2);  // it is held
  EXPECT_EQ(axes_after([](Scene& s) { s.rule.types.back().velocity.z() = 1e-3; }), 3);
  EXPECT_EQ(axes_after([](Scene& s) { s.rule.types.front().gravity.z() = -1e-3; }), 3);
  EXPECT_EQ(axes_after([](Scene& s) {
              s.periodic.origin.z() = -1;
              s.periodic.extent.z() = 6;
            }),
            3);
}

// One layer of nodes, whatever margin and further box say of z; records without it.
TEST(FlatPlan, HasOneLayerAndShortRecords) {
  Scene scene = sheet();
  scene.reach_margin = Vec3(1, 1, 50);
  scene.reach = {Vec3(-3, -3, -9), Vec3(7, 7, 9)};
  const Plan plan = plan_of(scene, Arch{});
  for (uint32_t n = 0; n < plan.lattice.size(); ++n) {
    EXPECT_EQ(plan.lattice.cell(n)[2], 0);
    EXPECT_LE(plan.lattice.neighbourhood(n).size(), 9u);
  }
  const int P = 20, G = 8, v = 29;
  EXPECT_EQ(plan.words.halo_bits, 2 * P + 2);
  EXPECT_EQ(plan.words.particle_bits, 2 * P + 2 + 2 * v + plan.rule.type_bits + plan.words.id_bits + 2 * G);
}

// Golden knows three axes: in a flat scene nothing leaves z = 0 of the layer.
TEST(FlatPlan, StaysFlatInGolden) {
  const cuboct::Setup setup = make_setup(sheet(), Arch{});
  Golden golden(setup.plan.rule, setup.plan.lattice, setup.plan.arch.capacity, setup.initial);
  const State before = golden.state();
  for (int k = 0; k < 30; ++k) golden.step();
  EXPECT_FALSE(golden.state().particles == before.particles);
  for (const Particle& p : golden.state().particles) {
    EXPECT_EQ(p.x[2], 0);
    EXPECT_EQ(p.v[2], 0);
  }
}

std::vector<uint64_t> hashes(const Scene& scene, const Arch& arch, uint64_t steps) {
  const cuboct::Setup setup = make_setup(scene, arch);
  Golden golden(setup.plan.rule, setup.plan.lattice, setup.plan.arch.capacity, setup.initial);
  std::vector<uint64_t> found{hash_of(setup.plan.lattice, golden.state())};
  for (uint64_t k = 0; k < steps; ++k) {
    golden.step();
    found.push_back(hash_of(setup.plan.lattice, golden.state()));
  }
  return found;
}

// Each part alone and all together: another plan, longer words or more nodes, the same bits.
TEST(Carry, ChangesNoBit) {
  for (const Scene& scene : {sheet(), block_scene({.size = {2, 2, 2}, .jitter = 0.05, .speed = 0.1})}) {
    const Plan plain = plan_of(scene, Arch{});
    const auto expected = hashes(scene, Arch{}, 12);
    int other = 0;
    for (size_t k = 0; k <= Carry::kCount; ++k) {
      Arch arch;
      if (k < Carry::kCount)
        arch.carry[k] = true;
      else
        arch.carry = Carry::everything();
      EXPECT_EQ(hashes(scene, arch, 12), expected) << k;
      const Plan plan = plan_of(scene, arch);
      EXPECT_GE(plan.words.halo_bits, plain.words.halo_bits);
      EXPECT_GE(plan.words.particle_bits, plain.words.particle_bits);
      other += plan.hash != plain.hash;
    }
    // What the scene has already changes nothing: types of the sheet, the third axis and the nodes of the
    // block.
    EXPECT_GE(other, 6);
  }
}

// What is said to be saved is what the plan that carries the part has more.
TEST(Spared, IsTheDifferenceToThePlanThatCarriesIt) {
  int parts = 0;
  for (const Scene& scene : {sheet(), block_scene({.size = {2, 2, 2}, .jitter = 0.05, .speed = 0.1})}) {
    const Plan plain = plan_of(scene, Arch{});
    const Spared left = spared(plain);
    for (const Spared::Part& part : left.parts) {
      Arch arch;
      arch.carry[part.index] = true;
      arch.carry.types = arch.carry.types || arch.carry.scales;
      const Plan plan = plan_of(scene, arch);
      EXPECT_NE(plan.hash, plain.hash);
      EXPECT_EQ(plan.words.halo_bits - plain.words.halo_bits, part.halo_bits) << part.index;
      EXPECT_EQ(plan.words.particle_bits - plain.words.particle_bits, part.particle_bits) << part.index;
      ++parts;
    }
    Arch everything;
    everything.carry = Carry::everything();
    const Plan all = plan_of(scene, everything);
    EXPECT_EQ(all.words.particle_bits, left.all.particle_bits);
    EXPECT_EQ(all.lattice.size(), left.box);
    EXPECT_EQ(all.lattice.size() - plain.lattice.size(), left.missing);
    EXPECT_TRUE(spared(all).parts.empty());
  }
  EXPECT_GE(parts, 7);
}

TEST(Spared, LooserFormatsAreThoseOfATenthOfTheAccuracy) {
  Scene scene = read_scene(kRoot + "/scenes/two_types.toml");
  const Plan plan = plan_of(scene, Arch{});
  const auto looser = looser_formats(scene, plan);
  ASSERT_TRUE(looser);
  scene.accuracy *= 10;
  const Plan other = plan_of(scene, Arch{});
  EXPECT_EQ(looser->accuracy, scene.accuracy);
  EXPECT_EQ(looser->words.halo_bits, other.words.halo_bits);
  EXPECT_EQ(looser->words.particle_bits, other.words.particle_bits);
  EXPECT_LT(looser->words.halo_bits, plan.words.halo_bits);
  Arch asked;
  asked.widths.guard = 12;
  EXPECT_FALSE(looser_formats(scene, plan_of(scene, asked)));
  const Scene narrow = read_scene(kRoot + "/scenes/coupon.toml");  // the least formats are exact enough
  EXPECT_FALSE(looser_formats(narrow, plan_of(narrow, Arch{})));
}

TEST(Carry, IsReadFromArchFiles) {
  const Arch arch = read_arch(kRoot + "/scenes/archs/everything.toml");
  EXPECT_TRUE(arch.carry.damping && arch.carry.scales && arch.carry.types && arch.carry.pd &&
              arch.carry.masses && arch.carry.third_axis && arch.carry.empty_nodes);
  EXPECT_EQ(refused_with([&] {
              parse_arch("name = \"a\"\n[plan]\ncarry = [\"damping\", \"third_axes\"]\n", "a.toml");
            }),
            "a.toml:3:21: unknown part of a plan 'third_axes'\n  hint: did you mean 'third_axis'?");
}

}  // namespace
}  // namespace cuboct::test
