// SPDX-License-Identifier: MIT
// Readings of a run one after another: what a list keeps between them changes no bit.
#include "model/analysis/state_reader.h"

#include <gtest/gtest.h>

#include <cmath>

#include "model/contract/golden.h"
#include "tests/support/block.h"

namespace cuboct::test {
namespace {

// J, over all pairs, each with its nearest image.
double energy_of_all_pairs(const Scene& scene, const cuboct::Setup& setup, const State& state) {
  const Plan& plan = setup.plan;
  const Body body = to_real(state, plan.rule, plan.lattice, plan.origin);
  double sum = 0;
  for (uint32_t i = 0; i < body.size(); ++i)
    for (uint32_t j = i + 1; j < body.size(); ++j) {
      Vec3 d = body.x[j] - body.x[i];
      for (int a = 0; a < 3; ++a)
        if (const double box = scene.periodic.extent[a]; box > 0) d[a] -= box * std::round(d[a] / box);
      sum += scene.rule.pair_energy(body.type[i], body.type[j], d.norm());
    }
  return sum;
}

struct Moving {
  const char* name;
  Features features;
  bool periodic = false;
};

class StateReaders : public testing::TestWithParam<Moving> {};

// A solid whose list serves many readings, a gas whose list serves few, and one that comes to rest.
TEST_P(StateReaders, AKeptListReadsAsAFreshOne) {
  Scene scene = block_scene(GetParam().features);
  if (GetParam().periodic)
    for (int a = 0; a < 3; ++a) {
      scene.periodic.origin[a] = -0.3;
      scene.periodic.extent[a] = 4 * std::sqrt(2.0);
    }
  Arch arch;
  arch.capacity = 60;
  const cuboct::Setup setup = make_setup(scene, arch);
  const Plan& plan = setup.plan;
  Golden golden(plan.rule, plan.lattice, plan.arch.capacity, setup.initial);
  const auto reader = [&](int threads) {
    return StateReader(scene.rule, plan.rule, plan.lattice, plan.origin, threads);
  };
  StateReader kept = reader(3);
  Asked asked;
  asked.energies = true;
  asked.volume = GetParam().periodic ? scene.periodic.extent.prod() : 0;
  double least = INFINITY, most = -INFINITY;
  for (int n = 0; n < 40; ++n) {
    const State state = golden.state();
    const Reading a = kept.read(state, asked), b = reader(1).read(state, asked);
    ASSERT_EQ(a.energies.kinetic, b.energies.kinetic) << n;
    ASSERT_EQ(a.energies.potential, b.energies.potential) << n;
    ASSERT_EQ(a.stress, b.stress) << n;
    least = std::min(least, a.energies.potential), most = std::max(most, a.energies.potential);
    if (n % 8 == 7) {
      const double all = energy_of_all_pairs(scene, setup, state);
      ASSERT_NEAR(a.energies.potential, all, 1e-9 * std::abs(all) + 1e-12) << n;
    }
    for (int k = 0; k < 3; ++k) golden.step();
  }
  EXPECT_GT(most - least, 1e-3 * std::abs(most));  // something moves
}

INSTANTIATE_TEST_SUITE_P(
    Cases, StateReaders,
    testing::Values(Moving{"solid", {.size = {5, 4, 4}, .cutoff = 1.4, .dt = 0.1, .jitter = 0.05, .seed = 1}},
                    Moving{
                        "gas",
                        {.size = {4, 4, 4}, .cutoff = 1.4, .dt = 0.1, .jitter = 0.1, .speed = 0.3, .seed = 2},
                        true},
                    Moving{"materials",
                           {.size = {4, 4, 4},
                            .cutoff = 1.4,
                            .dt = 0.1,
                            .jitter = 0.1,
                            .speed = 0.1,
                            .damping = 0.02,
                            .two_materials = true,
                            .contact = true,
                            .seed = 3}}),
    [](const auto& p) { return std::string(p.param.name); });

}  // namespace
}  // namespace cuboct::test
