// SPDX-License-Identifier: MIT
// A body cut at its planes of symmetry moves as the whole one does.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <map>

#include "model/analysis/measure.h"
#include "model/analysis/motion.h"
#include "model/base/error.h"
#include "model/real/reference.h"
#include "model/scene/scene.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

// A bar with a hole, stretched by both ends; of it what lies beyond `from`. `more` is added to the file.
Scene bar(const std::array<double, 3>& from, const std::string& more = {}, const std::string& kind = "moved",
          const std::string& load = "velocity = \"[20, 0, 0] m/s\"") {
  return parse_scene(fmt::format(R"(density = "1.4 g/cm^3"
[packing]
pitch = "1 mm"
[geometry]
shape = "difference"
from = {{ shape = "box", min = "[{}, {}, {}] mm", max = "[8.6, 4.3, 3] mm" }}
minus = [{{ shape = "cylinder", radius = "1.5 mm", length = "9 mm" }}]
[law]
kind = "ductile"
youngs_modulus = "3 GPa"
direction = "x"
fracture_energy = "10 kJ/m^2"  # a shorter cutoff: sides that narrow feel no image
[damping]
ratio = 0.1
[[material]]
name = "matrix"
[[material]]
name = "fibre"
density = "2 g/cm^3"
strength = 3
region = {{ shape = "box", size = "[30, 3, 30] mm" }}
[[constraint]]
name = "right"
kind = "{}"
{}
region = {{ shape = "half_space", point = "[7.5, 0, 0] mm", normal = "-x" }}
[run]
steps = 150
{})",
                                 from[0], from[1], from[2], kind, load, more),
                     "bar.toml");
}

const std::string kLeft = R"([[constraint]]
name = "left"
kind = "moved"
velocity = "[-20, 0, 0] m/s"
region = { shape = "half_space", point = "[-7.5, 0, 0] mm", normal = "x" }
)";

const std::string kEighth =
    "[[symmetry]]\nnormal = \"x\"\n[[symmetry]]\nnormal = \"y\"\n[[symmetry]]\nnormal = \"z\"\n";

Body after(const Scene& scene) {
  Reference run(scene.rule, scene.body, scene.periodic);
  run.step(scene.steps);
  return run.body();
}

// The largest distance of the part's particles from those of the whole that began where they did.
double apart(const Scene& part, const Scene& whole) {
  std::map<std::array<long, 3>, size_t> at;
  const auto key = [](const Vec3& x) {
    return std::array{std::lround(x[0] * 1e8), std::lround(x[1] * 1e8), std::lround(x[2] * 1e8)};
  };
  for (size_t i = 0; i < whole.body.size(); ++i) at[key(whole.body.x[i])] = i;
  const Body a = after(part), b = after(whole);
  double most = 0;
  for (size_t i = 0; i < part.body.size(); ++i)
    most = std::max(most, (a.x[i] - b.x[at.at(key(part.body.x[i]))]).norm());
  return most;
}

TEST(Symmetry, HalfMovesAsTheWhole) {
  const Scene whole = bar({-8.6, -4.3, -3}, kLeft);
  const Scene half = bar({0, -4.3, -3}, "[[symmetry]]\nnormal = \"x\"\n");
  EXPECT_LT(half.body.size(), 0.6 * static_cast<double>(whole.body.size()));
  EXPECT_EQ(half.rule.dt, whole.rule.dt);
  EXPECT_LT(apart(half, whole), 1e-12);  // m: of a way of 10 mm, and forces summed in another order
  // Without the plane the same part goes another way.
  EXPECT_GT(apart(bar({0, -4.3, -3}), whole), 1e-5);
}

TEST(Symmetry, EighthMovesAsTheWhole) {
  const Scene whole = bar({-8.6, -4.3, -3}, kLeft);
  const Scene eighth =
      bar({0, 0, 0},
          "[[symmetry]]\nnormal = \"x\"\n[[symmetry]]\nnormal = \"y\"\n[[symmetry]]\nnormal = \"-z\"\n");
  EXPECT_LT(apart(eighth, whole), 1e-12);
  // Mass and energy are those of the part.
  const auto mass = [](const Scene& scene) {
    double sum = 0;
    for (const uint8_t type : scene.body.type) sum += scene.rule.mass_of(type);
    return sum;
  };
  EXPECT_NEAR(8 * mass(eighth), mass(whole), 1e-12 * mass(whole));
  Reference a(eighth.rule, after(eighth), eighth.periodic), b(whole.rule, after(whole), whole.periodic);
  EXPECT_NEAR(8 * a.potential_energy(), b.potential_energy(), 1e-9 * std::abs(b.potential_energy()));
}

TEST(Symmetry, ForceIsThatOfThePart) {
  const std::string pull = "kind = \"pulled\"\nforce = \"[-8, 0, 0] kN\"\n";
  std::string left = kLeft;
  const size_t from = left.find("kind"), to = left.find("region");
  left.replace(from, to - from, pull);
  const Scene whole = bar({-8.6, -4.3, -3}, left, "pulled", "force = \"[8, 0, 0] kN\"");
  const Scene eighth = bar({0, 0, 0}, kEighth, "pulled", "force = \"[2, 0, 0] kN\"");
  EXPECT_LT(apart(eighth, whole), 1e-12);
  // The end does move.
  double most = 0;
  const Body after_run = after(eighth);
  for (size_t i = 0; i < after_run.size(); ++i)
    most = std::max(most, after_run.x[i].x() - eighth.body.x[i].x());
  EXPECT_GT(most, 1e-4);
}

// Half of a particle has the velocity of a whole one: its component of 100,000 draws, to 3 standard errors.
TEST(Symmetry, TemperatureIsThatOfTheWhole) {
  const std::string hot = "[[velocity]]\ntemperature = \"300 K\"\nseed = 1\n";
  const Scene half = bar({0, -4.3, -3}, "[[symmetry]]\nnormal = \"x\"\n" + hot);
  std::map<std::string, std::array<double, 2>> sums;
  for (size_t i = 0; i < half.body.size(); ++i) {
    const ParticleType& type = half.rule.types[half.body.type[i]];
    if (type.imposed == std::array{true, true, true}) continue;
    auto& [count, square] = sums[type.name];
    count += 2;
    square += half.body.v[i][1] * half.body.v[i][1] + half.body.v[i][2] * half.body.v[i][2];
  }
  ASSERT_TRUE(sums.contains("matrix") && sums.contains("matrix:x"));
  const auto mean = [&](const char* name) { return sums[name][1] / sums[name][0]; };
  EXPECT_NEAR(mean("matrix:x") / mean("matrix"), 1, 3 * std::sqrt(2 / sums["matrix:x"][0]));
}

TEST(Symmetry, WavesAreThoseOfTheWhole) {
  const Scene whole = bar({-8.6, -4.3, -3}, kLeft);
  const Scene eighth = bar({0, 0, 0}, kEighth);
  EXPECT_DOUBLE_EQ(motion_of(eighth).sound_speed, motion_of(whole).sound_speed);
}

TEST(Symmetry, IsRefusedWhereThereIsNone) {
  const auto has = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  const std::string x = "[[symmetry]]\nnormal = \"x\"\n";
  has(refused_with([&] { bar({-8.6, 0, 0}, x); }), "both sides of this plane");
  has(refused_with([&] {
        bar({0, 0, 0}, x + "point = \"[-0.2, 0, 0] mm\"\n");
      }),
      "no particle stands in this plane");
  has(refused_with([&] {
        bar({0, 0, 0}, x + "point = \"[8.485281374, 0, 0] mm\"\n");
      }),
      "moves particles out");
  has(refused_with([&] {
        parse_scene(R"(gravity = "[0, 0, -9.81] m/s^2"
mass = "1 g"
packing = { pitch = "1 mm" }
geometry = { shape = "box", min = "[0, 0, 0] mm", max = "[4, 4, 4] mm" }
law = { kind = "elastic", stiffness = "1 kN/m" }
run = { steps = 1 }
[[symmetry]]
normal = "z"
)",
                    "fallen.toml");
      }),
      "fallen.toml:7:1: gravity along z is not its own mirror image");
  has(refused_with([&] {
        bar({0, 0, 0}, "[[symmetry]]\nnormal = [1, 1, 0]\n");
      }),
      "must be an axis of the scene");
  has(refused_with([&] { bar({0, 0, 0}, x + x); }), "there twice");
  has(refused_with([&] {
        bar({0, 0, 0}, "[[symmetry]]\nnormal = \"y\"\n[box]\nperiodic = \"y\"\ncells = [6, 3, 2]\n");
      }),
      "the box repeats along y");
  has(refused_with([&] { bar({0, 0, 0}, "[[symmetry]]\nnormal = \"y\"\n", "moved_by_force"); }), "by force");
  has(refused_with([&] {
        bar({0, 0, 0}, "[[symmetry]]\nnormal = \"y\"\n", "pulled", "force = \"[1, 1, 0] N\"");
      }),
      "pulls particles out");
  const auto turned = [](const std::string& axes) {
    return refused_with([&] {
      parse_scene("mass = \"1 g\"\npacking = { pitch = \"1 mm\", axes = " + axes + R"( }
geometry = { shape = "box", min = "[0, -3, -3] mm", max = "[6, 3, 3] mm" }
law = { kind = "elastic", stiffness = "1 kN/m" }
run = { steps = 1 }
[[symmetry]]
normal = "x"
)",
                  "turned.toml");
    });
  };
  // {111} planes are no mirrors of the packing.
  has(turned("[[1, 1, 1], [1, -1, 0]]"), "not its own mirror image along x");
  // {110} planes are, but a bond crosses them.
  has(turned("[[1, 1, 0], [-1, 1, 0]]"), "would feel their images");
}

}  // namespace
}  // namespace cuboct
