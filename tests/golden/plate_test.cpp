// SPDX-License-Identifier: MIT
// The plate with a cut breaks in two.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>

#include "model/analysis/measure.h"
#include "model/contract/neighbours.h"
#include "tests/golden/scene_with.h"

namespace cuboct::test {
namespace {

// Sizes of the pieces, the largest first: particles nearer than `reach`, or joined by others that are.
std::vector<size_t> pieces(const std::vector<Vec3>& x, double reach) {
  std::vector<uint32_t> root(x.size());
  std::iota(root.begin(), root.end(), 0U);
  const auto find = [&](uint32_t i) {
    while (root[i] != i) i = root[i] = root[root[i]];
    return i;
  };
  CellList cells(reach, {});
  cells.build(x);
  cells.for_each_pair(x, [&](uint32_t i, uint32_t j, const Vec3&, double) { root[find(i)] = find(j); });
  std::map<uint32_t, size_t> count;
  for (uint32_t i = 0; i < x.size(); ++i) ++count[find(i)];
  std::vector<size_t> sizes;
  for (const auto& [at, size] : count) sizes.push_back(size);
  std::sort(sizes.rbegin(), sizes.rend());
  return sizes;
}

// A twentieth of plate_5m's length and width: 6 mm x 3 mm. The curve rises to a peak; at the end no pair
// across the crack attracts (the law does up to 1.137 pitches), and what the grip feels is the ringing of its
// half. The stress is gone at 45 us. When the last pair parts is chance: between 49 and 66 us in doubles by
// either integrator and in five fixed formats. By 70 us the grip went 1.5 pitches on.
TEST(Plate, BreaksInTwo) {
  const Scene scene = scene_with(
      CUBOCT_SOURCE_DIR "/scenes/bench/plate_50k.toml",
      {{"geometry.from.max", "\"[6, 3, 0.47] mm\""},
       {"geometry.minus", "[{ shape = \"box\", min = \"[2.96, -1, -1] mm\", max = \"[3.04, 1.05, 1] mm\" }]"},
       {"regions.left.point", "\"[0.3, 0, 0] mm\""},
       {"regions.right.point", "\"[5.7, 0, 0] mm\""},
       {"regions.lower_mark", "{ shape = \"box\", min = \"[1.3, -1, -1] mm\", max = \"[1.7, 4, 1] mm\" }"},
       {"regions.upper_mark", "{ shape = \"box\", min = \"[4.3, -1, -1] mm\", max = \"[4.7, 4, 1] mm\" }"},
       {"probe.0.area", "\"1.47 mm^2\""},
       {"constraint.1.velocity", "\"[6, 0, 0] m/s\""},
       {"run.duration", "\"70 us\""}});
  ASSERT_GT(scene.body.size(), 12'000U);
  EXPECT_EQ(pieces(scene.body.x, 1.137 * scene.pitch).size(), 1U);
  const Plan plan = plan_of(scene, {});
  emu::LatticeRun request;
  request.steps = scene.steps;
  request.hash_every = scene.steps;
  request.engine.threads = 1;
  request.watch = true;
  request.frames = {scene.steps};
  for (uint64_t step = 0; step <= scene.steps; step += 20) request.probes.push_back(step);
  const Recorded result = emu::run_lattice(scene, plan, request);
  ASSERT_FALSE(result.trace.stop) << result.trace.stop->text;
  EXPECT_TRUE(result.trace.findings.empty());

  const std::vector<double>& stress = curve_named(result.trace.curves, "tension.stress").value;
  const auto peak = std::max_element(stress.begin(), stress.end());
  EXPECT_GT(*peak, 25e6);
  EXPECT_LT(*peak, 60e6);
  // Over the last third, which is three periods of the half: 4 x 2.7 mm at 1588 m/s, 7 us.
  const auto last = stress.end() - static_cast<ptrdiff_t>(stress.size() / 3);
  const double mean = std::accumulate(last, stress.end(), 0.0) / static_cast<double>(stress.end() - last);
  EXPECT_LT(std::abs(mean), 0.05 * *peak);

  const State& end = result.trace.frames.back();
  const std::vector<size_t> halves =
      pieces(to_real(end, plan.rule, plan.lattice, plan.origin).x, 1.137 * scene.pitch);
  ASSERT_GE(halves.size(), 2U);
  EXPECT_GT(halves[1], scene.body.size() * 45 / 100);
  EXPECT_GT(halves[0] + halves[1], scene.body.size() * 99 / 100);
}

}  // namespace
}  // namespace cuboct::test
