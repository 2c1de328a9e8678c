// SPDX-License-Identifier: MIT
// Runs of rules of text in floats and doubles, with loops for kernels: what they tell of a state, and what
// the reference's terms are made for.
#include "emu/gpu/text_run.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <numeric>

#include "hw/engine/scene_engine.h"
#include "tests/support/counted_terms.h"

namespace cuboct::test {
namespace {

class TextRuns : public testing::TestWithParam<gpu::Arithmetic> {
 protected:
  // Where the host's compiler keeps its code.
  void SetUp() override { setenv("XDG_CACHE_HOME", (testing::TempDir() + "text_runs").c_str(), 1); }
};

TEST_P(TextRuns, TakeForcesAndVelocitiesFromTheDevice) {
  Scene scene = read_scene(CUBOCT_SOURCE_DIR "/scenes/rules/copper.toml");
  const Scene plain = scene;
  const auto terms = count_terms(scene);
  const gpu::GpuChoice choice{GetParam(), {}, {}};
  const auto run = gpu::TextRun::make(scene, 1e-9, choice, nullptr);
  RoundsRun doubles(plain, plain.body, {}, 1e-9);
  run->advance(4, nullptr), doubles.advance(4, nullptr);
  std::vector<uint32_t> ids(scene.body.size());
  std::iota(ids.begin(), ids.end(), 0);
  Asked asked{.ids = ids, .forces = true, .velocities = true, .fields = true};
  const Reading here = run->read(asked), there = doubles.read(asked);
  EXPECT_EQ(terms->made(), 0);
  const double share = GetParam() == gpu::Arithmetic::float32 ? 1e-4 : 1e-9;
  double force = 0, gain = 0;
  const Body& body = *doubles.saved_body();
  for (size_t i = 0; i < ids.size(); ++i) {
    force = std::max(force, there.force[i].norm());
    gain = std::max(gain, (there.v[i] - body.v[i]).norm());
  }
  EXPECT_GT(gain, 1);
  for (size_t i = 0; i < ids.size(); ++i) {
    EXPECT_LT((here.force[i] - there.force[i]).norm(), share * force) << i;
    EXPECT_LT((here.v[i] - there.v[i]).norm(), share * gain + 1e-3 * share * there.v[i].norm()) << i;
  }
  ASSERT_EQ(here.fields.size(), there.fields.size());
  for (size_t f = 0; f < here.fields.size(); ++f)
    for (size_t k = 0; k < here.fields[f].size(); ++k)
      EXPECT_NEAR(here.fields[f][k], there.fields[f][k], share * std::abs(there.fields[f][k]))
          << f << " " << k;
  EXPECT_GT(here.fields.size(), 0u);

  asked.energies = true;
  const Reading energies = run->read(asked);
  EXPECT_EQ(terms->made(), 1);
  EXPECT_NEAR(energies.energies.potential, doubles.read(asked).energies.potential,
              share * std::abs(energies.energies.potential));
}

INSTANTIATE_TEST_SUITE_P(Reals, TextRuns, testing::Values(gpu::Arithmetic::float32, gpu::Arithmetic::float64),
                         [](const auto& of) {
                           return of.param == gpu::Arithmetic::float32 ? "Float" : "Double";
                         });

}  // namespace
}  // namespace cuboct::test
