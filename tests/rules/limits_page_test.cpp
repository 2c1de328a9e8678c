// SPDX-License-Identifier: MIT
// The rules that docs/user/limits.md gives for what cuboct does not have: each beside its closed form.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <numbers>
#include <string>
#include <variant>
#include <vector>

#include "model/run/rounds_run.h"
#include "model/scene/scene.h"
#include "tests/support/folder.h"

namespace cuboct {
namespace {

// The rule file of that name as it stands on the page.
std::string rule_on_the_page(const std::string& name) {
  std::ifstream page(CUBOCT_SOURCE_DIR "/docs/user/limits.md");
  std::string line, rule;
  while (std::getline(page, line) && line != fmt::format("name = \"{}\"", name)) {
  }
  for (; page && line != "```"; std::getline(page, line)) rule += line + "\n";
  return rule;
}

// A scene of these lines under that rule; `start`: of its field.
Scene scene_of(const std::string& rule, const std::string& lines, const std::string& start = "") {
  const test::Folder folder;
  folder.write("rule.toml", rule_on_the_page(rule));
  return parse_scene(fmt::format("{}[rule]\nfile = \"rule.toml\"\n{}", lines, start),
                     folder.path("scene.toml"));
}

std::vector<Vec3> forces_of(const Scene& scene) {
  RoundsRun run(scene, scene.body, {}, 1e-3);
  return std::get<RealFrame>(run.frame(true)).force;
}

double potential_of(const Scene& scene) {
  RoundsRun run(scene, scene.body, {}, 1e-3);
  Asked asked;
  asked.energies = true;
  return run.read(asked).energies.potential;
}

constexpr double kE = 1.602176634e-19, kAngstrom = 1e-10;  // C, m

// Two ions at rest, r apart along x: one of charge 1, one of `sign`.
Scene two_ions(double r, int sign) {
  return scene_of("charges",
                  fmt::format("mass = \"29 u\"\n"
                              "particle = [{{ position = \"[0, 0, 0] m\" }}, "
                              "{{ position = \"[{}, 0, 0] angstrom\" }}]\n"
                              "run = {{ dt = \"1 fs\", steps = 1 }}\n",
                              r),
                  fmt::format("start.q = \"select(x.x > 0, {}, 1)\"\n", sign));
}

// The damped shifted force of Fennell and Gezelter (2006), and the push of Born and Mayer.
TEST(LimitsPage, ChargesPullAsTheDampedShiftedForce) {
  constexpr double a = 0.25, end = 9;  // 1/angstrom, angstrom
  const auto damped = [&](double r) {
    return std::erfc(a * r) / (r * r) + 2 * a / std::sqrt(std::numbers::pi) * std::exp(-a * a * r * r) / r;
  };
  for (const double r : {2.5, 4.0, 8.9})
    for (const int sign : {1, -1}) {
      const double force = (sign * 14.3996 * (damped(r) - damped(end)) + 1500 / 0.32 * std::exp(-r / 0.32)) *
                           kE / kAngstrom;  // N
      const auto f = forces_of(two_ions(r, sign));
      ASSERT_EQ(f.size(), 2U);
      EXPECT_NEAR(f[1].x(), force, 1e-9 * std::abs(force)) << r << " " << sign;
      EXPECT_EQ(f[0], -f[1]);
      // Central differences: their error is (1e-4/r)^2 of the force, that of the energies' digits less.
      constexpr double h = 1e-4;
      const double slope =
          (potential_of(two_ions(r + h, sign)) - potential_of(two_ions(r - h, sign))) / (2 * h * kAngstrom);
      EXPECT_NEAR(-slope, force, 1e-6 * std::abs(force) + 1e-9 * kE / kAngstrom) << r << " " << sign;
    }
}

// Two spheres of 1 mm that overlap by 0.1 mm, of which the second passes at `slip`, m/s.
std::vector<Vec3> passing(double slip) {
  return forces_of(
      scene_of("grains",
               fmt::format("density = \"2.5 g/cm^3\"\npacking = {{ pitch = \"1 mm\" }}\n"
                           "geometry = {{ shape = \"sphere\", radius = \"0.5 mm\" }}\n"
                           "particle = [{{ position = \"[0.9, 0, 0] mm\", velocity = \"[0, {}, 0] m/s\" }}]\n"
                           "run = {{ dt = \"1 us\", steps = 1 }}\n",
                           slip)));
}

// 0.1 N push them apart. Across the line it is 0.02 kg/s times the slip, and 0.4 of the push at most.
TEST(LimitsPage, GrainsHaveCoulombsFriction) {
  for (const auto& [slip, across] : {std::pair{10.0, 0.04}, {-3.0, -0.04}, {1.0, 0.02}, {-0.5, -0.01}}) {
    const auto f = passing(slip);
    ASSERT_EQ(f.size(), 2U);
    EXPECT_NEAR(f[0].x(), -0.1, 1e-12);
    EXPECT_NEAR(f[0].y(), across, 1e-12) << slip;
    EXPECT_EQ(f[0], -f[1]);
  }
}

// Two particles that are warmer by 100 K push with spring r0 expansion 100 K = 1 N. Heat goes from one to the
// other: conductance dt/(heat capacity mass) of the difference in a step, and none is lost.
TEST(LimitsPage, WarmMatterExpandsAndConducts) {
  const std::string pair =
      "density = \"7.85 g/cm^3\"\npacking = { pitch = \"1 mm\" }\n"
      "geometry = { shape = \"sphere\", radius = \"0.5 mm\" }\n"
      "particle = [{ position = \"[1, 0, 0] mm\" }]\nrun = { dt = \"10 ns\", steps = 1 }\n";
  const auto f = forces_of(scene_of("warm", pair, "start.T = \"400 K\"\n"));
  ASSERT_EQ(f.size(), 2U);
  EXPECT_NEAR(f[0].x(), -1, 1e-9);
  EXPECT_EQ(f[0], -f[1]);

  const Scene scene = scene_of("warm", pair, "start.T = \"select(x.x > 0, 500 K, 300 K)\"\n");
  RoundsRun run(scene, scene.body, {}, 1e-3);
  run.advance(1000, nullptr);
  const std::vector<double> T = std::get<RealFrame>(run.frame(false)).shown[0];
  const double share = 50 / (2 * 1e-6 * 500 * 7850.0) * 10e-9;
  EXPECT_NEAR(T[0], 400 - 100 * std::pow(1 - 2 * share, 1000), 1e-9);
  EXPECT_NEAR(T[0] + T[1], 800, 1e-9);
}

}  // namespace
}  // namespace cuboct
