// SPDX-License-Identifier: MIT
// Devices that do their work in any order that events allow: no order may show in the bits.
#include <gtest/gtest.h>

#include "gpu_ref/device.h"
#include "tests/gpu/beside_golden.h"

namespace cuboct::test {
namespace {

TEST(GpuOrder, SeveralDevicesHoldGoldensBitsInWhateverOrderTheyWork) {
  Met met;
  auto& shuffle = gpu::Shuffle::all();
  for (uint64_t seed = 1; seed <= 200; ++seed) {
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

}  // namespace
}  // namespace cuboct::test
