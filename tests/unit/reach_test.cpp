// SPDX-License-Identifier: MIT
// The reachable cells against their definition, particle by particle and cell by cell.
#include "hw/plan/reach.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>
#include <tuple>

#include "model/base/error.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

struct Order {
  bool operator()(const Cell& a, const Cell& b) const {
    return std::tie(a[2], a[1], a[0]) < std::tie(b[2], b[1], b[0]);
  }
};
using Cells = std::set<Cell, Order>;

void touch(Cells& cells, const Vec3& low, const Vec3& high, const Vec3& origin, double edge,
           const Cell& period) {
  const auto cell = [&](const Vec3& x, int a) {
    return static_cast<int>(std::floor((x[a] - origin[a]) / edge));
  };
  for (int x = cell(low, 0); x <= cell(high, 0); ++x)
    for (int y = cell(low, 1); y <= cell(high, 1); ++y)
      for (int z = cell(low, 2); z <= cell(high, 2); ++z) {
        Cell c{x, y, z};
        for (int a = 0; a < 3; ++a)
          if (period[a] > 0) c[a] = (c[a] % period[a] + period[a]) % period[a];
        cells.insert(c);
      }
}

Cells by_definition(const Scene& scene, double edge, const Vec3& origin, const Cell& period) {
  Cells cells;
  const Vec3 margin = scene.reach_margin.minCoeff() < 0 ? Vec3(Vec3::Constant(edge)) : scene.reach_margin;
  for (size_t id = 0; id < scene.body.size(); ++id) {
    const Vec3 displacement =
        scene.rule.types[scene.body.type[id]].velocity * (static_cast<double>(scene.steps) * scene.rule.dt);
    const int stops =
        displacement.norm() > 0 ? 1 + static_cast<int>(std::ceil(displacement.norm() / (0.5 * edge))) : 0;
    for (int k = 0; k <= stops; ++k) {
      const Vec3 at = stops > 0 ? Vec3(scene.body.x[id] + displacement * k / stops) : scene.body.x[id];
      touch(cells, at - margin, at + margin, origin, edge, period);
    }
  }
  if (scene.reach[0] != scene.reach[1]) touch(cells, scene.reach[0], scene.reach[1], origin, edge, period);
  return cells;
}

Scene random_scene(std::mt19937_64& random) {
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * std::uniform_real_distribution<>()(random);
  };
  Scene scene;
  scene.steps = 10;
  scene.rule.dt = 0.1;
  scene.rule.types.resize(2);
  const auto any = [&](double within) {
    const double z = uniform(-within, within), y = uniform(-within, within), x = uniform(-within, within);
    return Vec3(x, y, z);
  };
  if (random() % 3 == 0) scene.rule.types[1].velocity = any(4);
  if (random() % 3 == 0)
    scene.rule.types[1].velocity = Vec3::Unit(static_cast<int>(random() % 3)) * uniform(-9, 9);
  if (random() % 2 == 0) {
    const double z = random() % 2 == 0 ? 0 : uniform(0, 2), y = uniform(0, 2), x = uniform(0, 2);
    scene.reach_margin = Vec3(x, y, z);
  }
  if (random() % 3 == 0) scene.reach = {Vec3(-2, -1.5, -1), Vec3(uniform(0, 3), 1, 2)};
  const bool crystal = random() % 2 == 0;  // in rows, as packings come
  for (int k = 0; k < 120; ++k) {
    scene.body.x.push_back(crystal ? Vec3(0.7 * (k % 8), 0.7 * (k / 8 % 5), 0.7 * (k / 40)) : any(5));
    scene.body.type.push_back(static_cast<uint8_t>(random() % 8 == 0));
  }
  return scene;
}

TEST(Reach, IsWhatTheBoxesOfAllParticlesTouch) {
  std::mt19937_64 random(3);
  size_t rings = 0, moved = 0;
  for (int round = 0; round < 300; ++round) {
    const Scene scene = random_scene(random);
    Cell period{};
    for (int a = 0; a < 3; ++a)
      if (random() % 4 == 0) period[a] = 3 + static_cast<int>(random() % 10);
    rings += period[0] > 0;
    moved += scene.rule.types[1].velocity.norm() > 0;
    const double edge = round % 2 == 0 ? 1.0 : 0.83;
    const Vec3 origin(-0.25, 0.1, -0.2);
    const std::vector<Cell> cells = reachable_cells(scene, edge, origin, period);
    const Cells expected = by_definition(scene, edge, origin, period);
    ASSERT_EQ(cells, std::vector<Cell>(expected.begin(), expected.end())) << "round " << round;
  }
  EXPECT_GT(rings, 20u);
  EXPECT_GT(moved, 20u);
}

TEST(Reach, RefusesWhatCannotBeBuilt) {
  Scene scene;
  scene.rule.types.resize(1);
  scene.body.type = {0};
  scene.body.x = {Vec3::Zero()};
  const auto error = [&] { return refused_with([&] { reachable_cells(scene, 1, Vec3::Zero(), {}); }); };
  scene.reach_margin = Vec3::Constant(500);
  EXPECT_EQ(error(),
            "the reach of a particle spans 1e+09 cells of 1 m: at most 3e+07 can be built\n"
            "  hint: a smaller reach.margin");
  scene.reach_margin = Vec3::Constant(140);
  EXPECT_EQ(error(), "accepted");
  scene.body.type.push_back(0);
  scene.body.x.push_back(Vec3::Constant(281));  // beside the other: 2 x 281^3
  EXPECT_EQ(error(),
            "the body can reach 4.44e+07 cells of 1 m: at most 3e+07 can be built\n"
            "  hint: a smaller body, or a smaller reach.margin");
}

}  // namespace
}  // namespace cuboct
