// SPDX-License-Identifier: MIT
// Devices that do their work in any order that events allow: no order may show in the bits.
#include <gtest/gtest.h>

#include "emu/gpu/device/device.h"
#include "model/contract/law.h"
#include "tests/fcc_block.h"
#include "tests/gpu/beside_golden.h"

namespace cuboct::test {
namespace {

class GpuOrder : public testing::Test {
 protected:
  GpuOrder() { gpu::Shuffle::all().on = true; }
  ~GpuOrder() override { gpu::Shuffle::all().on = false; }
};

TEST_F(GpuOrder, SeveralDevicesHoldGoldensBitsInWhateverOrderTheyWork) {
  Met met;
  auto& shuffle = gpu::Shuffle::all();
  for (uint64_t seed = 1; seed <= 500; ++seed) {
    Case c;
    try {
      c = random_bar(seed);
    } catch (const InputError&) {
      continue;
    }
    const GoldenPath golden = golden_path(c);
    for (int slabs = 2; slabs <= most_slabs(c.setup.plan); ++slabs) {
      gpu::Options options;
      options.devices.clear();
      for (int s = 0; s < slabs; ++s) options.devices.push_back(s);
      shuffle.random.seed(seed);
      compare(c, golden, options, seed % 2 == 0 ? Cut::whole : Cut::random, seed, met);
      if (HasFatalFailure()) return;
    }
  }
  EXPECT_GT(met.runs, 150u);
  EXPECT_GT(met.golden_steps, 3u);
  EXPECT_GT(met.faults, 80u);
  EXPECT_GT(shuffle.overtaken, 10000u);
}

TEST_F(GpuOrder, RealEnginesHaveOneRunInWhateverOrderTheyWork) {
  Scene scene;
  scene.rule = simple_rule(preset_law("ductile", 1e-3, 1e3), 1e-6, 3e-6);
  scene.rule.damping.coefficient = 1e-3;
  scene.body = fcc_block(8, 1e-3);
  scene.periodic = fcc_box(8, 1e-3);
  scene.periodic.extent.z() = 0;
  shake(scene.body, 3e-5, 20, 5);
  std::vector<Vec3> expected;
  for (uint64_t seed = 0; seed <= 6; ++seed) {
    gpu::Options options;
    for (int s = 1; s < std::min(static_cast<int>(seed), 3); ++s) options.devices.push_back(s);
    gpu::Shuffle::all().random.seed(seed);
    const auto engine = gpu::make_real_engine(scene, scene.body, gpu::Arithmetic::float32, options);
    engine->advance(80);
    EXPECT_GT(engine->counters().list_builds, 8u);
    if (seed == 0) expected = engine->body().x;
    ASSERT_EQ(engine->body().x, expected) << options.devices.size() << " devices, seed " << seed;
  }
}

}  // namespace
}  // namespace cuboct::test
