// SPDX-License-Identifier: MIT
#include "model/body/packing_scatter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "model/base/output.h"
#include "model/scene/packed_shape.h"

namespace cuboct {
namespace {

// Sites of some cells, their heights along the direction, and the least distance between two heights.
TEST(PackingScatter, LayersAreApartAsSitesAre) {
  const Fcc fcc{.pitch = 1};
  for (const Vec3& n : {Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(1, 1, 1), Vec3(1, 1, -2), Vec3(3, 1, -1),
                        Vec3(2, 1, 0), Vec3(-1, 1, 0)}) {
    std::set<int64_t> heights;  // in millionths
    for (const Vec3& x : pack(fcc, nullptr, {.origin = Vec3::Constant(-4), .extent = Vec3::Constant(8)}))
      if (const double height = n.normalized().dot(x); std::abs(height) < 2)
        heights.insert(std::llround(1e6 * height));
    double least = 1e9;
    for (auto h = std::next(heights.begin()); h != heights.end(); ++h)
      if (*h - *std::prev(h) > 2) least = std::min(least, static_cast<double>(*h - *std::prev(h)));
    EXPECT_NEAR(layer_spacing(fcc, n), 1e-6 * least, 3e-6) << n;
  }
}

// A strip that repeats along y, of a thickness in layers of a/2; its packing has a layer at z = 0.
PackedShape strip(double layers) {
  PackedShape packed;
  packed.fcc.pitch = std::numbers::sqrt2;  // a/2 = 1
  packed.along = {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
  packed.shape = box({-20, -100, -layers / 2}, {20, 100, layers / 2});
  packed.box.extent[1] = 8;
  packed.free = {false, false, true};
  return packed;
}

// 4.5 layers are 4 or 5, each half of the time. Bending by n (n^2 - 1): 60 or 120. The sixteen places of the
// packing halve the two but for one of them.
TEST(PackingScatter, AFaceBetweenLayersTakesOneOffOrAddsOne) {
  const auto section = packed_section(strip(4.5));
  ASSERT_TRUE(section);
  EXPECT_EQ(section->axis, 0);
  EXPECT_NEAR(section->mean, 4.5 * 8, 0.07 * 8);
  EXPECT_NEAR(section->area.least, 4 / 4.5, 0.02);
  EXPECT_NEAR(section->area.most, 5 / 4.5, 0.02);
  EXPECT_EQ(section->area.packed, section->area.most);  // at -2, -1, 0, 1 and 2
  EXPECT_NEAR(section->bending.least, 60.0 / 90, 0.05);
  EXPECT_NEAR(section->bending.most, 120.0 / 90, 0.05);
  EXPECT_DOUBLE_EQ(section->bending.packed, section->bending.most);
}

// With a whole number of layers no place has more of them: faces of half a layer beyond particles.
TEST(PackingScatter, AWholeNumberOfLayersStays) { EXPECT_FALSE(packed_section(strip(5 - 1e-4))); }

TEST(PackingScatter, NothingChangesWhatRepeatsOrIsTurned) {
  PackedShape packed = strip(4.5);
  packed.free = {false, false, false};
  EXPECT_FALSE(packed_section(packed));
  packed = strip(4.5);
  packed.along = {};
  EXPECT_FALSE(packed_section(packed));
}

// Particles in a plane of symmetry are halves, which the sites do not know.
TEST(PackingScatter, TellsNothingOfHalves) {
  PackedShape packed = strip(4.5);
  packed.halves = true;
  EXPECT_FALSE(packed_section(packed));
}

// The mean over places of the packing is the shape's own area, pi r^2.
TEST(PackingScatter, TheMeanIsTheShapes) {
  PackedShape packed = strip(0);
  packed.shape = cylinder(Vec3(0, 0.3, 0.1), Vec3(1, 0, 0), 6.3, 40);
  packed.box = {};
  packed.free = {true, true, true};
  const auto section = packed_section(packed);
  ASSERT_TRUE(section);
  const double area = std::numbers::pi * 6.3 * 6.3;
  EXPECT_NEAR(section->mean, area, 0.02 * area);
  EXPECT_LT(section->area.least, 1);
  EXPECT_GT(section->area.most, 1);
}

// Of two thicknesses the thin one: a plate of 3.5 layers beside a block of 12.
TEST(PackingScatter, TheThinnestPlaceCounts) {
  PackedShape packed = strip(0);
  packed.shape = unite({box({-20, -100, -1.75}, {20, 100, 1.75}), box({-20, -100, -6}, {-8, 100, 6})});
  const auto section = packed_section(packed);
  ASSERT_TRUE(section);
  EXPECT_GT(section->at, -8);
  EXPECT_NEAR(section->area.most / section->area.least, 4.0 / 3, 1e-9);
}

// A scene's packing again: its pitch, its box and the axes along which it may move.
TEST(PackingScatter, KnowsTheScenesPacking) {
  const auto of = [](const std::string& name) {
    const std::string path = CUBOCT_SOURCE_DIR "/scenes/" + name;
    const Scene scene = read_scene(path);
    const auto packed = packed_shape(scene);
    EXPECT_TRUE(packed) << name;
    if (!packed) return std::array{false, false, false};
    EXPECT_EQ(pack(packed->fcc, packed->shape.get(), packed->box).size(), scene.body.size()) << name;
    return packed->free;
  };
  EXPECT_EQ(of("templates/tension.toml"), (std::array{true, true, true}));
  EXPECT_EQ(of("templates/sheet.toml"), (std::array{true, true, false}));
  EXPECT_EQ(of("templates/metal.toml"), (std::array{false, false, false}));
  EXPECT_EQ(of("templates/rule.toml"), (std::array{true, false, false}));
}

}  // namespace
}  // namespace cuboct
