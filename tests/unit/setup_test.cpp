// SPDX-License-Identifier: MIT
// From scenes to plans: with and without a State in memory, and the cells that a body can reach.
#include "hw/setup.h"

#include <gtest/gtest.h>

#include <functional>

#include "model/base/error.h"
#include "model/scene/scene.h"

namespace cuboct {
namespace {

const std::string kRoot = CUBOCT_SOURCE_DIR;

Scene example(const std::string& name) { return read_scene(kRoot + "/scenes/" + name + ".toml"); }

std::string error_of(const std::function<void()>& act) {
  try {
    act();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Setup, APlanNeedsNoState) {
  for (const char* name : {"coupon", "lj_block", "two_types"}) {
    SCOPED_TRACE(name);
    const Scene scene = example(name);
    const cuboct::Setup setup = make_setup(scene, {});
    const Plan plan = plan_of(scene, {});
    EXPECT_EQ(plan.hash, setup.plan.hash);
    EXPECT_EQ(describe(plan), describe(setup.plan));
    ASSERT_EQ(plan.particles, setup.initial.particles.size());
    InitialParticles initial(scene.body, plan);
    for (uint32_t id = 0; id < plan.particles; ++id) ASSERT_EQ(initial(id), setup.initial.particles[id]);
  }
}

// A body of many blocks of what InitialParticles gives back.
TEST(Setup, ABodyIsUsedUpWithoutHarm) {
  const Scene scene = example("bench/block_256k");
  const cuboct::Setup setup = make_setup(scene, {});
  InitialParticles initial(scene.body, setup.plan);
  for (uint32_t id = 0; id < setup.plan.particles; ++id) ASSERT_EQ(initial(id), setup.initial.particles[id]);
}

TEST(Setup, BothWaysRefuseAlike) {
  Scene scene = example("undamped_block");
  Arch arch;
  arch.capacity = 3;
  EXPECT_EQ(error_of([&] { plan_of(scene, arch); }),
            "a cell would hold 4 particles: its capacity is 3\n"
            "  hint: set node.capacity to at least 4 in the arch file");
  EXPECT_EQ(error_of([&] { make_setup(scene, arch); }), error_of([&] { plan_of(scene, arch); }));
  arch.capacity = 300;
  EXPECT_EQ(error_of([&] { plan_of(scene, arch); }), "capacity = 300 is out of range: 1 to 256");
  EXPECT_EQ(error_of([&] { make_setup(scene, arch); }), error_of([&] { plan_of(scene, arch); }));
  arch.capacity = 16;
  arch.narrow_memories = true;
  const std::string port = "memories = \"narrow\" have one port to read: set ";
  EXPECT_EQ(error_of([&] { plan_of(scene, arch); }), port + "filter_lanes = 1");
  arch.filter_lanes = 1;
  EXPECT_EQ(error_of([&] { plan_of(scene, arch); }), port + "overlap = false");
  arch.overlap = false;
  EXPECT_NO_THROW(plan_of(scene, arch));
  scene.body.v[7][1] = 1e6;
  const std::string fast = error_of([&] { plan_of(scene, {}); });
  EXPECT_TRUE(fast.starts_with("particle 7 moves at 1e+06 m/s: more than the ")) << fast;
  EXPECT_EQ(error_of([&] { make_setup(scene, {}); }), fast);
}

}  // namespace
}  // namespace cuboct
