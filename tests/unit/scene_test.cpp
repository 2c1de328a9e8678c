// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "hw/arch/arch.h"
#include "model/analysis/measure.h"
#include "model/base/error.h"
#include "model/config/config.h"
#include "model/contract/law.h"
#include "model/scene/scene.h"
#include "model/scene/scene_parts.h"
#include "model/solid/dynamical_matrix.h"
#include "tests/support/folder.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

const std::string kRoot = CUBOCT_SOURCE_DIR;

// A valid scene: a bar of 2 x 2 x 4 cells, faces included.
const std::string kBase = R"(density = "1.41 g/cm^3"
[packing]
pitch = "0.5 mm"
[geometry]
shape = "box"
min = "[0, 0, 0] mm"
max = "[1.5, 1.5, 2.9] mm"
[law]
kind = "elastic"
stiffness = "1 MN/m"
[run]
dt = "auto"
steps = 10
)";

class SceneTest : public testing::Test {
 protected:
  Scene read(const std::string& text) const { return read_scene(folder_.write("a.toml", text)); }
  // The error's text, without the folder.
  std::string error(const std::string& text) const {
    const std::string what = refused_with([&] { read(text); }), folder = folder_.path("");
    return what.starts_with(folder) ? what.substr(folder.size()) : what;
  }
  // The base with one thing changed.
  static std::string with(const std::string& from, const std::string& to) {
    std::string text = kBase;
    const size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  }

 private:
  const test::Folder folder_;
};

TEST_F(SceneTest, BaseIsRead) {
  const Scene s = read(kBase);
  // n_x x n_y x n_z half cells of 0.35355 mm: 5 x 5 x 9 points of which those with an even sum are sites.
  EXPECT_EQ(s.body.size(), (5U * 5 * 9 + 1) / 2);
  EXPECT_DOUBLE_EQ(s.rule.mass, 1410 * 1.25e-10 / std::sqrt(2));
  EXPECT_EQ(s.density, 1410.0);
  EXPECT_EQ(s.pitch, 0.5e-3);
  ASSERT_EQ(s.rule.types.size(), 1U);
  EXPECT_EQ(s.rule.types[0].name, "matter");
  EXPECT_DOUBLE_EQ(s.rule.law->slope(s.pitch), -1e6);
  // Undamped: exactly 2/omega.
  EXPECT_DOUBLE_EQ(s.dt_limit, 2 / largest_frequency(*s.rule.law, s.rule.mass, s.pitch));
  EXPECT_NEAR(s.dt_limit, 2 / std::sqrt(8e6 / s.rule.mass),
              1e-6 * s.dt_limit);  // FCC, nearest neighbours: w^2 = 8k/m
  EXPECT_DOUBLE_EQ(s.rule.dt, 0.2 * s.dt_limit);
  EXPECT_TRUE(s.body.u.empty());
}

TEST_F(SceneTest, ReadsTheSameTwice) {
  const std::string text = kBase + "[[velocity]]\nthermal_speed = \"1 m/s\"\nseed = 3\n";
  const Scene a = read(text), b = read(text);
  EXPECT_EQ(a.body.x, b.body.x);
  EXPECT_EQ(a.body.v, b.body.v);
}

TEST_F(SceneTest, ErrorsWordForWord) {
  EXPECT_EQ(error(kBase), "accepted");
  EXPECT_EQ(error(with("steps = 10", "steps = 10\nfram_every = 2")),
            "a.toml:14:1: unknown key 'fram_every'\n  hint: did you mean 'frame_every'?");
  EXPECT_EQ(error(kBase + "[dampng]\nratio = 0.1\n"),
            "a.toml:14:2: unknown key 'dampng'\n  hint: did you mean 'damping'?");
  EXPECT_EQ(error(with("density = ", "densty = ")),
            "a.toml:1:1: unknown key 'densty'\n  hint: did you mean 'density'?");
  EXPECT_EQ(error(with("\"0.5 mm\"", "0.5")),
            "a.toml:3:9: 'pitch' needs a unit: a length such as \"0.5 mm\"");
  EXPECT_EQ(error(with("\"0.5 mm\"", "\"0.2\"")),
            "a.toml:3:9: 'pitch' needs a unit: a length such as \"0.2 mm\"");
  // 0.0002 mm is not what is meant.
  EXPECT_EQ(error(with("\"0.5 mm\"", "2e-4")),
            "a.toml:3:9: 'pitch' needs a unit: a length such as \"0.5 mm\"");
  EXPECT_EQ(
      error(with("\"0.5 mm\"", "\"auto\"")),
      "a.toml:3:9: a run has one pitch, which 'auto' does not tell\n  hint: 'cuboct pitch SCENE --error "
      "5%' finds the coarsest one that keeps a figure within an error");
  EXPECT_EQ(error("gravity = [0, 0, -9.81]\n" + kBase),
            "a.toml:1:11: 'gravity' needs a unit: an acceleration such as \"[0, 0, -9.81] m/s^2\"");
  EXPECT_EQ(error("gravity = [0, \"0 m/s^2\", -9.81]\n" + kBase),
            "a.toml:1:12: 'gravity' needs a unit: an acceleration such as \"0 m/s^2\"");
  EXPECT_EQ(error(kBase + "[[velocity]]\nseed = 1\ntemperature = 300\n"),
            "a.toml:16:15: 'temperature' needs a unit: a temperature such as \"300 K\"");
  EXPECT_EQ(error(kBase + "[[velocity]]\nseed = 1\ntemperature = \"1 K\"\nthermal_energy = \"1 eV\"\n"),
            "a.toml:16:15: give 'thermal_energy' or 'temperature', not both");
  EXPECT_EQ(error(with("1 MN/m", "1 MN")),
            "a.toml:10:13: 'stiffness' must be a stiffness such as \"1 MN/m\", but \"1 MN\" is a force");
  EXPECT_EQ(error(with("\"elastic\"", "\"elastc\"")),
            "a.toml:9:8: unknown law 'elastc'\n  hint: did you mean 'elastic'?");
  EXPECT_EQ(error(with("\"elastic\"", "\"plasma\"")),
            "a.toml:9:8: unknown law 'plasma'\n  hint: known: elastic, brittle, ductile, viscous, spline, lj "
            "or rule");
  EXPECT_EQ(error(with("[1.5, 1.5, 2.9]", "[1.5, 0.4, 2.9]")),
            "a.toml:4:1: the geometry is 0.0004 m along y, less than the pitch 0.0005 m");
  EXPECT_EQ(error(with("shape = \"box\"\nmin = \"[0, 0, 0] mm\"\nmax = \"[1.5, 1.5, 2.9] mm\"",
                       "shape = \"half_space\"\nnormal = [0, 0, 1]")),
            "a.toml:4:1: the geometry has no end along x");
  EXPECT_EQ(error(with("shape = \"box\"\nmin = \"[0, 0, 0] mm\"\nmax = \"[1.5, 1.5, 2.9] mm\"",
                       "shape = \"sphere\"\ncentre = \"[0.35, 0, 0] mm\"\nradius = \"0.251 mm\"")),
            "a.toml:4:1: no particle: no site of the packing lies inside");
  EXPECT_EQ(
      error("mass = \"1 g\"\n[law]\nkind = \"lj\"\nepsilon = \"1 J\"\nsigma = \"1 mm\"\ncutoff = \"2 mm\"\n"),
      "a.toml:1:1: no particle\n  hint: add [packing] with [geometry], [particles] or [[particle]]");
  EXPECT_EQ(error(with("dt = \"auto\"", "dt = \"1 ms\"")).substr(0, 53),
            "a.toml:12:6: 'dt' is beyond the stability limit 2.496");
  EXPECT_EQ(error(with("steps = 10", "dt_safety = 1.5\nsteps = 10")),
            "a.toml:13:13: 'dt_safety' must be above 0 and at most 1, not 1.5");
  EXPECT_EQ(
      error(
          kBase +
          "[[constraint]]\nname = \"a\"\nkind = \"held\"\nregion = { shape = \"sphere\", radius = \"1 um\", "
          "centre = \"[9, 9, 9] mm\" }\n"),
      "a.toml:17:10: no particle lies in this region");
  EXPECT_EQ(
      error(
          kBase +
          "[regions]\ntop = { shape = \"half_space\", normal = \"z\" }\n[[constraint]]\nname = \"a\"\nkind = "
          "\"held\"\nregion = \"tip\"\n"),
      "a.toml:19:10: unknown region 'tip'\n  hint: did you mean 'top'?");
  EXPECT_EQ(error(kBase + "[[constraint]]\nname = \"a\"\nkind = \"moved\"\naxes = \"z\"\nvelocity = \"[1, 0, "
                          "1] m/s\"\nregion "
                          "= { shape = \"half_space\", normal = \"z\" }\n"),
            "a.toml:18:12: 'velocity' has a part along x, which 'axes' leaves free");
  EXPECT_EQ(error(kBase +
                  "[[constraint]]\nname = \"a\"\nkind = \"held_by_force\"\naxes = \"z\"\nregion = { shape = "
                  "\"half_space\", normal = \"z\" }\n"),
            "a.toml:17:8: 'axes' serves 'held' and 'moved' only, not 'held_by_force'");
  EXPECT_EQ(error(kBase + "[box]\nperiodic = \"x\"\nsize = \"[1.5, 2, 3] mm\"\n"),
            "a.toml:16:8: the packing does not repeat after 0.0015 m along x\n  hint: give 'cells' instead");
  EXPECT_EQ(error(kBase + "[[particle]]\nposition = \"[0, 0, 0] mm\"\n"),
            "a.toml:1:1: particles 0 and 113 stand at the same point");
  EXPECT_EQ(error(kBase + "[[velocity]]\nthermal_speed = \"1 m/s\"\n"),
            "a.toml:14:1: missing key 'seed' in 'velocity'");
  for (const char* key : {"ratio = 1e308", "coefficient = \"1e308 kg/s\""})
    EXPECT_NE(error(kBase + "[damping]\n" + key + "\n")
                  .find("the damping is larger than anything that can be computed with"),
              std::string::npos);
  EXPECT_EQ(error(with("steps = 10", "steps = 10\nduration = \"1 s\"")),
            "a.toml:14:12: give 'steps' or 'duration', not both");
}

std::string spline(const std::string& force) {
  return "[law]\nkind = \"spline\"\nr = \"[0, 0.25, 0.5, 0.6, 0.7] mm\"\nforce = \"" + force + " N\"\n";
}

TEST_F(SceneTest, LawsMustFitThePacking) {
  const std::string preset = "[law]\nkind = \"elastic\"\nstiffness = \"1 MN/m\"\n";
  EXPECT_EQ(error(with(preset, spline("[150, 125, 0, -30, 0]"))), "accepted");
  EXPECT_EQ(error(with(preset, spline("[150, 125, 5, -30, 0]"))),
            "a.toml:8:1: the law does not vanish at the pitch: 5 N at 0.0005 m\n"
            "  hint: the undeformed packing would not be at rest");
  EXPECT_EQ(error(with(preset, spline("[150, 125, 0, -30, 2]"))),
            "a.toml:11:9: the law does not vanish at the cutoff: the last force is 2 N\n  hint: let the last "
            "force be 0");
  EXPECT_EQ(error(with(preset, spline("[150, 125, 0, 0]"))), "a.toml:11:9: 'r' has 5 points, 'force' has 4");
  // A Lennard-Jones packing may be under pressure.
  const std::string lj = "[law]\nkind = \"lj\"\nepsilon = \"1 J\"\nsigma = \"0.47 mm\"\n";
  EXPECT_EQ(error(with(preset, lj + "cutoff = \"0.9 mm\"\n")), "accepted");
  EXPECT_EQ(error(with(preset, lj + "cutoff = \"0.45 mm\"\n")),
            "a.toml:8:1: the cutoff 0.00045 m of the law is not beyond the pitch 0.0005 m");
  EXPECT_EQ(error(with(preset, lj + "cutoff = \"0.9 mm\"\nsmooth = \"liner\"\n")),
            "a.toml:13:10: unknown smoothing 'liner'\n  hint: did you mean 'linear'?");
  const auto jump = [&](const std::string& smooth) {
    return read(with(preset, lj + "cutoff = \"0.9 mm\"\n" + smooth)).rule.law->force(0.9e-3 * (1 - 1e-12));
  };
  EXPECT_LT(jump(""), -50);
  EXPECT_EQ(jump("smooth = \"none\"\n"), jump(""));
  EXPECT_NEAR(jump("smooth = \"linear\"\n"), 0, 1e-6);
}

// The bond's stiffness from Young's modulus, against the lattice sums over the very law.
TEST_F(SceneTest, ModulusIsMet) {
  for (const Vec3& direction : {Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(1, 1, 1), Vec3(1, 2, 3)}) {
    const double k = stiffness_from_modulus(3e9, direction, 0.5e-3);
    const auto law = preset_law("elastic", 0.5e-3, k);
    EXPECT_NEAR(youngs_modulus(elastic_constants(*law, 0.5e-3), direction), 3e9, 3e9 * 1e-9);
  }
  const Scene s = read(with("stiffness = \"1 MN/m\"", "youngs_modulus = \"3 GPa\"\ndirection = [1, 1, 0]"));
  // E110 = sqrt(2) k/pitch.
  EXPECT_NEAR(-s.rule.law->slope(s.pitch), 3e9 * 0.5e-3 / std::sqrt(2), 1e-3);
  // A name is an axis of the scene: in a turned packing, the crystal direction along it.
  const std::string stiffness = "stiffness = \"1 MN/m\"";
  std::string text = with("[geometry]", "axes = [[1, 1, 0], [-1, 1, 0]]\n[geometry]");
  text.replace(text.find(stiffness), stiffness.size(), "youngs_modulus = \"3 GPa\"\ndirection = \"-x\"");
  const Scene turned = read(text);
  EXPECT_NEAR(turned.rule.law->slope(turned.pitch), s.rule.law->slope(s.pitch), 1e-3);
}

TEST_F(SceneTest, MaterialsAndConstraintsMakeTypes) {
  const std::string text = "gravity = \"[0, 0, -9.81] m/s^2\"\n" + kBase + R"(
[damping]
ratio = 0.25
[regions]
bottom = { shape = "half_space", normal = "z" }
top = { shape = "half_space", point = "[0, 0, 2.7] mm", normal = [0, 0, -1] }
[[material]]
name = "hard"
[[material]]
name = "soft"
strength = 0.25
region = "top"
[[material]]
name = "odd"
strength = 0.5
region = { shape = "sphere", radius = "0.1 mm" }
[[bond]]
between = ["soft", "odd"]
strength = 0.125
[[constraint]]
name = "base"
kind = "held_by_force"
region = "bottom"
[[constraint]]
name = "pull"
kind = "moved"
axes = "z"
velocity = "[0, 0, 2] m/s"
region = "top"
[[velocity]]
uniform = "[1, 0, 0] m/s"
)";
  const Scene s = read(text);
  std::map<std::string, int> count;
  for (uint8_t type : s.body.type) ++count[s.rule.types[type].name];
  // 13 sites in the bottom layer, of which one is odd; the top layer (z = 8 half cells) has 13.
  EXPECT_EQ(count, (std::map<std::string, int>{
                       {"hard", 87}, {"hard/base", 12}, {"odd/base", 1}, {"soft/pull", 13}}));
  ASSERT_EQ(s.rule.types.size(), 4U);
  EXPECT_EQ(s.rule.types[0].name, "hard");  // by material, then constraint
  EXPECT_EQ(s.rule.types[2].name, "soft/pull");
  const auto named = [&](const std::string& name) {
    return *std::ranges::find(s.rule.types, name, &ParticleType::name);
  };
  for (const ParticleType& type : s.rule.types) EXPECT_EQ(type.gravity, Vec3(0, 0, -9.81));
  const double critical = 2 * std::sqrt(1e6 * s.rule.mass);
  EXPECT_DOUBLE_EQ(s.rule.damping.coefficient, 0.25 * critical);
  EXPECT_TRUE(named("hard/base").pd);
  EXPECT_DOUBLE_EQ(named("hard/base").kp, 10 * largest_stiffness(s.rule, s.pitch));
  EXPECT_GE(named("hard/base").kp, 10e6 * (1 - 1e-12));
  EXPECT_DOUBLE_EQ(named("hard/base").kd, 0.25 * critical);
  EXPECT_EQ(named("soft/pull").imposed, (std::array{false, false, true}));
  // Symmetric; the geometric mean unless [[bond]] says otherwise.
  const auto& f = s.rule.strength;
  EXPECT_EQ(f[0][0], 1.0);
  EXPECT_EQ(f[1][1], 0.25);
  EXPECT_DOUBLE_EQ(f[0][1], 0.5);
  EXPECT_EQ(f[1][0], f[0][1]);
  EXPECT_EQ(f[1][2], 0.125);
  EXPECT_EQ(f[2][1], 0.125);
  EXPECT_TRUE(s.rule.contact.empty());
  for (size_t i = 0; i < s.body.size(); ++i) {
    const bool pulled = s.rule.types[s.body.type[i]].name == "soft/pull";
    EXPECT_EQ(s.body.v[i], pulled ? Vec3(1, 0, 2) : Vec3(1, 0, 0));
  }
  EXPECT_EQ(s.body.u.size(), s.body.size());
}

TEST_F(SceneTest, MaterialsMayOnlyTouch) {
  const std::string materials = kBase + R"(
[[material]]
name = "ball"
[[material]]
name = "plate"
strength = 0.25
region = { shape = "half_space", point = "[0, 0, 1.5] mm", normal = "z" }
[[bond]]
between = ["ball", "plate"]
)";
  const Scene s = read(materials + "contact = true\n");
  EXPECT_DOUBLE_EQ(s.rule.contact_distance, s.pitch);
  EXPECT_TRUE(s.rule.only_touch(0, 1) && s.rule.only_touch(1, 0));
  EXPECT_FALSE(s.rule.only_touch(0, 0) || s.rule.only_touch(1, 1));
  EXPECT_DOUBLE_EQ(s.rule.strength[0][1], 0.5);
  EXPECT_DOUBLE_EQ(read(materials + "contact = true\nstrength = 0.7\n").rule.strength[1][0], 0.7);
  EXPECT_TRUE(read(materials + "contact = false\nstrength = 0.7\n").rule.contact.empty());
  EXPECT_NE(error(materials).find("a.toml:21:1: missing key 'strength' in 'bond'"), std::string::npos);
}

TEST_F(SceneTest, MaterialsMayHaveTheirOwnMass) {
  const std::string steel = R"([[material]]
name = "polymer"
[[material]]
name = "steel"
density = "7.05 g/cm^3"
region = { shape = "half_space", point = "[0, 0, 1.5] mm", normal = "z" }
)";
  const Scene s = read(kBase + steel);
  ASSERT_EQ(s.rule.types.size(), 2u);
  EXPECT_EQ(s.rule.mass, read(kBase).rule.mass);
  EXPECT_EQ(s.rule.mass_of(0), s.rule.mass);
  EXPECT_DOUBLE_EQ(s.rule.mass_of(1), 5 * s.rule.mass);
  EXPECT_DOUBLE_EQ(s.rule.heaviest(), 5 * s.rule.mass);
  // The lighter material sets the step.
  EXPECT_EQ(s.dt_limit, read(kBase).dt_limit);
  // The lightest need not be the file's; the file's need not be there.
  std::string light = steel;
  light.replace(light.find("7.05"), 4, "0.47");
  const Scene foam = read(kBase + light);
  EXPECT_DOUBLE_EQ(3 * foam.rule.mass, s.rule.mass);
  EXPECT_DOUBLE_EQ(foam.rule.relative_mass(0), 3);
  EXPECT_DOUBLE_EQ(foam.dt_limit, s.dt_limit / std::sqrt(3));
  std::string own = with("density = \"1.41 g/cm^3\"\n", "") + steel;
  EXPECT_EQ(error(own), "a.toml:1:1: missing key 'density'");
  own.replace(own.find("\"polymer\""), 9, "\"polymer\"\nmass = \"2 mg\"");
  EXPECT_DOUBLE_EQ(read(own).rule.mass_of(0), 2e-6);
  EXPECT_TRUE(read(kBase + "[[material]]\nname = \"a\"\ndensity = \"1.41 g/cm^3\"\n").rule.masses.empty());
  EXPECT_EQ(error(kBase + steel + "mass = \"1 g\"\n"), "a.toml:20:8: give 'density' or 'mass', not both");
  EXPECT_NE(error(kBase + "[[material]]\nname = \"a\"\nmass = \"0 g\"\n").find("a.toml:16:8"),
            std::string::npos);
}

TEST_F(SceneTest, MassesCountInTemperaturesAndProbes) {
  const std::string two = R"([[material]]
name = "light"
[[material]]
name = "heavy"
density = "11.28 g/cm^3"
region = { shape = "half_space", point = "[0, 0, 1.5] mm", normal = "z" }
[[probe]]
name = "hot"
kind = "temperature"
region = { shape = "half_space", point = "[0, 0, -1] mm", normal = "-z" }
)";
  const auto heated = [&](const std::string& how) {
    return read(kBase + "[[velocity]]\nseed = 3\n" + how + "\n" + two);
  };
  const Scene s = heated("temperature = \"300 K\"");
  std::array<double, 2> count{}, energy{};
  Vec3 momentum = Vec3::Zero();
  for (size_t i = 0; i < s.body.size(); ++i) {
    const int type = s.body.type[i];
    count[type] += 1, energy[type] += s.rule.mass_of(type) * s.body.v[i].squaredNorm() / 2;
    momentum += s.rule.relative_mass(type) * s.body.v[i];
  }
  // Each has 3 kT/2, whatever its mass; of N draws the energy is off by sqrt(2/(3 N)).
  for (const int type : {0, 1})
    EXPECT_NEAR(energy[type] / count[type], 1.5 * s.boltzmann * 300,
                4 * 1.5 * s.boltzmann * 300 * std::sqrt(2 / (3 * count[type])));
  const double speed = std::sqrt(s.boltzmann * 300 / s.rule.mass);
  EXPECT_LT(momentum.norm(), 1e-12 * speed);
  // A speed is a speed.
  double slow = 0, heavy = 0;
  const Scene alike = heated("thermal_speed = \"1 m/s\"");
  for (size_t i = 0; i < alike.body.size(); ++i)
    if (alike.body.type[i] == 1) slow += alike.body.v[i].squaredNorm(), ++heavy;
  EXPECT_NEAR(slow / heavy, 3, 12 * std::sqrt(2 / (3 * heavy)));
  // The probe's temperature is 2 K/(g k_B) about the centre of mass, which rests.
  const Probe& probe = s.probes[0];
  ASSERT_EQ(probe.relative.size(), s.body.size());
  ProbeMeter meter(s.probes, s.periodic, s.body.x);
  Sample sample{0, s.body.x, std::vector<Vec3>(s.body.size(), Vec3::Zero()), s.body.v};
  for (Vec3& v : sample.v) v += Vec3(1, 2, 3);
  meter.add(sample);
  const double degrees = 3 * (count[0] + count[1] - 1);
  EXPECT_NEAR(meter.curves()[0].value[0], 2 * (energy[0] + energy[1]) / (degrees * s.boltzmann), 1e-4);
}

// A fibre in a matrix; line 20 begins the bonds.
const std::string kComposite = kBase + R"([[material]]
name = "fibre"
[[material]]
name = "matrix"
strength = 0.25
region = { shape = "half_space", point = "[0, 0, 1.5] mm", normal = "z" }
)";
const std::string kBetween = "[[bond]]\nbetween = [\"fibre\", \"matrix\"]\n";

TEST_F(SceneTest, BondsMayHaveLawsOfTheirOwn) {
  const std::string soft =
      "[[bond]]\nbetween = [\"matrix\", \"matrix\"]\nlaw = { kind = \"ductile\", stiffness = \"2 kN/m\" }\n";
  const Scene s =
      read(kComposite + soft + kBetween +
           "strength = 0.5\n[bond.law]\nkind = \"spline\"\nr = \"[0.2, 0.5, 0.6] mm\"\nforce = \"[60, "
           "0, 0] N\"\ncore = \"0.25 mm\"\n");
  ASSERT_EQ(s.rule.laws(), 3u);
  EXPECT_EQ(s.rule.law_index, (std::vector<std::vector<uint8_t>>{{0, 2}, {2, 1}}));
  EXPECT_TRUE(same_law(*s.rule.other_laws[0], *preset_law("ductile", 0.5e-3, 2e3)));
  EXPECT_DOUBLE_EQ(s.rule.law_of(1, 0).cutoff(), 0.6e-3);
  EXPECT_DOUBLE_EQ(s.rule.cutoff(), std::sqrt(2) * 0.5e-3);
  EXPECT_DOUBLE_EQ(s.rule.core(), 0.25e-3);
  // A law stands for itself; a strength beside it scales it.
  EXPECT_EQ(s.rule.strength, (std::vector<std::vector<double>>{{1, 0.5}, {0.5, 1}}));
  // The stiffest pair decides the time step, as if all were of it.
  EXPECT_DOUBLE_EQ(s.dt_limit, read(kComposite).dt_limit);
  EXPECT_EQ(s.rule.pair_energy(0, 1, 0.61e-3), 0);
  EXPECT_DOUBLE_EQ(s.rule.pair_energy(1, 1, 0.55e-3), s.rule.other_laws[0]->energy(0.55e-3));
}

// 2 sqrt(3)/pitch^2 bonds per area of {111}; stiffness 1 MN/m, pitch 0.5 mm.
TEST_F(SceneTest, FractureEnergyIsThatOfTheWeakestPlane) {
  const Scene s =
      read(with("stiffness = \"1 MN/m\"", "stiffness = \"1 MN/m\"\nfracture_energy = \"2 kJ/m^2\""));
  EXPECT_NEAR(-2 * std::sqrt(3) * s.rule.law->energy(0.5e-3) / 0.25e-6, 2e3, 1e-6);
  EXPECT_NEAR(s.rule.law->slope(0.5e-3), -1e6, 1e-3);
  EXPECT_EQ(error(with("stiffness = \"1 MN/m\"", "stiffness = \"1 MN/m\"\nfracture_energy = \"1 MJ/m^2\"")),
            "a.toml:11:19: at this pitch and stiffness the law holds no more than 90891.9 J/m^2\n"
            "  hint: the energy grows with pitch times stiffness");
}

TEST_F(SceneTest, EqualLawsAreOne) {
  const std::string same = "law = { kind = \"elastic\", stiffness = \"1 MN/m\" }\n";
  const Scene one = read(kComposite + kBetween + same);
  EXPECT_EQ(one.rule.laws(), 1u);
  EXPECT_TRUE(one.rule.law_index.empty());
  EXPECT_EQ(one.rule.strength[0][1], 1);
  const std::string soft = "law = { kind = \"elastic\", stiffness = \"1 kN/m\" }\n";
  const std::string all = "[[bond]]\nbetween = [\"fibre\", \"fibre\"]\n" + soft +
                          "[[bond]]\nbetween = [\"matrix\", \"matrix\"]\n" + soft;
  EXPECT_EQ(read(kComposite + all).rule.laws(), 2u);
  // What serves no pair is left out.
  const Scene dropped = read(kComposite + all + kBetween + soft);
  EXPECT_EQ(dropped.rule.laws(), 1u);
  EXPECT_DOUBLE_EQ(-dropped.rule.law->slope(0.5e-3), 1e3);
}

TEST_F(SceneTest, LawsOfBondsAreRefusedInTheirPlace) {
  EXPECT_EQ(error(kComposite + kBetween + "law = { kind = \"elastik\", stiffness = \"1 N/m\" }\n"),
            "a.toml:22:16: unknown law 'elastik'\n  hint: did you mean 'elastic'?");
  EXPECT_NE(error(kComposite + kBetween + "law = { kind = \"elastic\", stiffness = \"1 N/m\", cutof = 1 }\n")
                .find("a.toml:22:48: unknown key 'cutof'"),
            std::string::npos);
  EXPECT_NE(error(kComposite + kBetween + "law = \"elastic\"\n").find("a.toml:22:7: "), std::string::npos);
  EXPECT_NE(
      error(
          kComposite + kBetween +
          "contact = true\nlaw = { kind = \"lj\", sigma = \"0.5 mm\", epsilon = \"1 J\", cutoff = \"0.7 mm\" "
          "}\n[[bond]]\nbetween = [\"fibre\", \"fibre\"]\ncontact = true\n")
          .find("a.toml:26:11: the push of this pair's law ends at 0.0005 m, that of another contact at "
                "0.000561231 m"),
      std::string::npos);
  std::string many = kComposite;
  for (const char* name : {"a", "b", "c", "d"})
    many += std::string("[[material]]\nname = \"") + name +
            "\"\nregion = { shape = \"sphere\", radius = \"0.1 mm\" }\n";
  int k = 0;
  for (const char* name : {"a", "b", "c", "d"})
    many += fmt::format(
        "[[bond]]\nbetween = [\"fibre\", \"{}\"]\nlaw = {{ kind = \"elastic\", stiffness = \"{} N/m\" }}\n",
        name, ++k);
  const std::string text = error(many);
  EXPECT_NE(text.find("a.toml:43:7: more than 4 laws"), std::string::npos) << text;
  EXPECT_NE(text.find("hint: each takes a table in every force pipe; bonds of equal laws share one"),
            std::string::npos);
}

TEST_F(SceneTest, ProbesTakeAnyAxis) {
  const std::string regions =
      "[regions]\nbar = { shape = \"box\", min = \"[0, 0, 0] mm\", max = \"[1.5, 1.5, 2.9] mm\" }\n"
      "low = { shape = \"half_space\", normal = \"z\" }\n"
      "high = { shape = \"half_space\", point = \"[0, 0, 2.7] mm\", normal = \"-z\" }\n";
  const auto probe = [&](const std::string& axis, const std::string& lower, const std::string& upper) {
    return with("[geometry]\nshape = \"box\"\nmin = \"[0, 0, 0] mm\"\nmax = \"[1.5, 1.5, 2.9] mm\"\n",
                regions + "[geometry]\nregion = \"bar\"\n") +
           "[[probe]]\nname = \"p\"\nkind = \"stress_strain\"\narea = \"1 mm^2\"\naxis = " + axis +
           "\nlower = \"" + lower + "\"\nupper = \"" + upper + "\"\ngrip = \"high\"\n" +
           "[[probe]]\nname = \"f\"\nkind = \"force\"\nregion = \"high\"\naxis = [0, 3, 4]\n";
  };
  const Scene s = read(probe("[0, 0, 5]", "low", "high"));
  EXPECT_EQ(s.body.size(), read(kBase).body.size());
  EXPECT_EQ(s.probes[0].axis, Vec3::UnitZ());
  EXPECT_LT((s.probes[1].axis - Vec3(0, 0.6, 0.8)).norm(), 1e-15);
  EXPECT_EQ(read(probe("\"-z\"", "high", "low")).probes[0].axis, -Vec3::UnitZ());
  EXPECT_EQ(error(probe("\"-z\"", "low", "high")),
            "a.toml:22:9: 'upper' must lie further along 'axis' than 'lower'");
}

// dt_limit with damping and PD: the mode equation z^2 - (2 - g dt - w^2 dt^2) z + 1 - g dt = 0 has a root on
// the unit circle at the limit and one outside beyond it.
TEST_F(SceneTest, DampingLowersTheLimit) {
  const Scene free = read(kBase), damped = read(kBase + "[damping]\nratio = 1.0\n");
  EXPECT_LT(damped.dt_limit, 0.6 * free.dt_limit);
  // Nearest neighbours only: the damping matrix is c(pitch)/k times the stiffness matrix.
  const double w = 2 / free.dt_limit;
  const double g = w * w * damped.rule.damping_over_r2(damped.pitch) * damped.pitch * damped.pitch / 1e6;
  const auto radius = [&](double dt) {
    const double b = 2 - g * dt - w * w * dt * dt, c = 1 - g * dt, disc = b * b - 4 * c;
    return disc < 0 ? std::sqrt(c)
                    : std::max(std::abs(b + std::sqrt(disc)), std::abs(b - std::sqrt(disc))) / 2;
  };
  EXPECT_NEAR(radius(damped.dt_limit), 1, 1e-6);
  EXPECT_GT(radius(1.01 * damped.dt_limit), 1.001);
  EXPECT_LT(radius(0.99 * damped.dt_limit), 0.999);
  // A strength scales stiffness and damping alike.
  const Scene strong = read(with("1 MN/m", "4 MN/m") + fmt::format("[damping]\ncoefficient = \"{} kg/s\"\n",
                                                                   4 * damped.rule.damping.coefficient));
  const Scene scaled =
      read(kBase + fmt::format("[damping]\ncoefficient = \"{} kg/s\"\n", damped.rule.damping.coefficient) +
           "[[material]]\nname = \"strong\"\nstrength = 4\n");
  EXPECT_NEAR(scaled.dt_limit, strong.dt_limit, 1e-9 * strong.dt_limit);
}

TEST_F(SceneTest, ListedParticles) {
  const Scene s = read(R"(units = "reduced"
mass = 2.0
[box]
size = [4, 5, 6]
origin = [-1, 0, 0]
periodic = "xy"
[law]
kind = "lj"
epsilon = 1
sigma = 1
cutoff = 1.3
[[particle]]
position = [0, 1, 2]
velocity = [1, 0, 0]
[[particle]]
position = [1, 1, 7]
[run]
dt = 0.01
duration = 1.0
)");
  ASSERT_EQ(s.body.size(), 2U);
  EXPECT_EQ(s.body.x[1], Vec3(1, 1, 7));
  EXPECT_EQ(s.body.v[0], Vec3(1, 0, 0));
  EXPECT_EQ(s.periodic.extent, Vec3(4, 5, 0));
  EXPECT_EQ(s.periodic.origin, Vec3(-1, 0, 0));
  EXPECT_EQ(s.steps, 100U);
  EXPECT_EQ(s.dt_limit, 0.0);
  EXPECT_EQ(s.rule.mass, 2.0);
}

// A dimer of Lennard-Jones particles: w^2 = 2k/m. A given dt must be below its limit; "auto" lasts for a
// crystal that listed particles may become.
TEST_F(SceneTest, ListedParticlesHaveTheLimitOfTheirVibrations) {
  const auto dimer = [&](double distance, const std::string& dt) {
    return fmt::format(
        "units = \"reduced\"\nmass = 2.0\n[law]\nkind = \"lj\"\nepsilon = 1\nsigma = 1\ncutoff = 1.8\n"
        "[[particle]]\nposition = [0, 0, 0]\n[[particle]]\nposition = [{:.17g}, 0, 0]\n"
        "[run]\ndt = {}\nsteps = 1\n",
        distance, dt);
  };
  const double rest = std::pow(2, 1.0 / 6);
  const Scene given = read(dimer(rest, "0.1"));
  const double k = -given.rule.law->slope(rest);
  EXPECT_NEAR(given.dt_limit, 2 / std::sqrt(2 * k / 2.0), 1e-9);
  EXPECT_NEAR(given.dt_safety, 0.1 / given.dt_limit, 1e-12);
  EXPECT_EQ(given.dt_limit_of, "the particles that are listed");
  EXPECT_EQ(error(dimer(rest, "0.3")),
            "a.toml:13:6: 'dt' is beyond the stability limit 0.2646 s\n"
            "  hint: \"auto\" would take 0.02647 s");
  const Scene automatic = read(dimer(rest, "\"auto\""));
  EXPECT_NEAR(automatic.dt_limit, stable_time_step(automatic.rule, rest), 1e-3 * automatic.dt_limit);
  EXPECT_NEAR(automatic.dt_limit, 0.5 * given.dt_limit, 0.01 * given.dt_limit);  // w^2 = 8k/m
  EXPECT_EQ(automatic.dt_limit_of, "a packing at the law's rest distance");
  EXPECT_DOUBLE_EQ(automatic.rule.dt, 0.2 * automatic.dt_limit);
  // Out of reach of each other nothing vibrates, but may yet; pressed together they are stiffer than a
  // crystal.
  EXPECT_EQ(read(dimer(3, "0.3")).dt_limit, 0.0);
  EXPECT_EQ(read(dimer(3, "\"auto\"")).dt_limit, automatic.dt_limit);
  const Scene pressed = read(dimer(0.85, "\"auto\""));
  EXPECT_LT(pressed.dt_limit, 0.6 * automatic.dt_limit);
  EXPECT_EQ(pressed.dt_limit_of, "the particles that are listed");
}

// A listed particle pressed into the packing is stiffer than the packing.
TEST_F(SceneTest, AListedParticleNearAPackingCounts) {
  const std::string law = "kind = \"spline\"\nr = [0, 1, 1.4]\nforce = [30, 0, 0]\ncore = 0.05\n";
  const auto scene = [&](double height) {
    return read(
        fmt::format("units = \"reduced\"\nmass = 1\n[packing]\npitch = 1\n[box]\ncells = [3, 3, 3]\n[law]\n{}"
                    "[[particle]]\nposition = [0, 0, {}]\n[run]\nsteps = 1\n",
                    law, height));
  };
  const Scene far = scene(-3), near = scene(-0.2);
  EXPECT_DOUBLE_EQ(far.dt_limit, stable_time_step(far.rule, 1));
  EXPECT_EQ(far.dt_limit_of, "the perfect packing");
  EXPECT_LT(near.dt_limit, 0.8 * far.dt_limit);
  EXPECT_EQ(near.dt_limit_of, "the particles that are listed");
}

// Angular momentum about the centre of mass and momentum of a spinning, drifting body.
TEST_F(SceneTest, SpinAndDrift) {
  const Scene s =
      read(kBase + "[[velocity]]\nspin = \"[0, 0, 10] rad/s\"\n[[velocity]]\nuniform = \"[1, 2, 3] m/s\"\n");
  Vec3 mean = Vec3::Zero(), centre = Vec3::Zero();
  const double n = static_cast<double>(s.body.size());
  for (size_t i = 0; i < s.body.size(); ++i) mean += s.body.v[i] / n, centre += s.body.x[i] / n;
  EXPECT_LT((mean - Vec3(1, 2, 3)).norm(), 1e-12);
  for (size_t i = 0; i < s.body.size(); ++i) {
    const Vec3 d = s.body.x[i] - centre;
    EXPECT_LT((s.body.v[i] - mean - Vec3(-10 * d[1], 10 * d[0], 0)).norm(), 1e-12);
  }
}

// Every committed scene and arch is read.
TEST(Examples, AreRead) {
  std::map<std::string, size_t> sizes;
  for (const auto& entry : std::filesystem::directory_iterator(kRoot + "/scenes"))
    if (entry.path().extension() == ".toml")
      sizes[entry.path().stem()] = read_scene(entry.path().string()).body.size();
  EXPECT_EQ(sizes.at("undamped_block"), 256U);
  EXPECT_EQ(sizes.at("lj_block"), 256U);
  EXPECT_GE(sizes.at("coupon"), 2000U);
  EXPECT_LE(sizes.at("coupon"), 4000U);
  EXPECT_GE(sizes.at("hot_cluster"), 50U);
  EXPECT_GE(sizes.at("two_types"), 50U);
}

TEST(Examples, DefaultArchIsTheDefault) {
  const Arch file = read_arch(kRoot + "/scenes/archs/default.toml"), none = read_arch("");
  EXPECT_EQ(file.name, none.name);
  EXPECT_EQ(file.cell_edge, none.cell_edge);
  EXPECT_EQ(file.capacity, none.capacity);
  EXPECT_EQ(file.filter_lanes, none.filter_lanes);
  EXPECT_EQ(file.force_pipes, none.force_pipes);
  EXPECT_EQ(file.queue_depth, none.queue_depth);
  EXPECT_EQ(file.overlap, none.overlap);
  EXPECT_EQ(file.multipliers, none.multipliers);
  EXPECT_EQ(file.narrow_memories, none.narrow_memories);
  EXPECT_EQ(file.widths.filter_frac, none.widths.filter_frac);
  EXPECT_EQ(file.link_bits, none.link_bits);
  EXPECT_EQ(file.widths.position_frac, none.widths.position_frac);
  EXPECT_EQ(file.widths.guard, none.widths.guard);
  EXPECT_EQ(file.widths.difference_frac, none.widths.difference_frac);
  EXPECT_EQ(file.widths.velocity_bits, none.widths.velocity_bits);
  EXPECT_EQ(file.widths.relative_velocity_frac, none.widths.relative_velocity_frac);
  EXPECT_EQ(file.widths.relative_velocity_bits, none.widths.relative_velocity_bits);
  EXPECT_EQ(file.widths.strength_bits, none.widths.strength_bits);
  EXPECT_EQ(file.widths.sum_bits, none.widths.sum_bits);
  EXPECT_EQ(file.widths.displacement_bits, none.widths.displacement_bits);
  EXPECT_EQ(file.widths.scale_frac, none.widths.scale_frac);
  EXPECT_EQ(file.widths.gain_frac, none.widths.gain_frac);
  EXPECT_EQ(file.table.shape, none.table.shape);
  EXPECT_EQ(file.table.degree, none.table.degree);
  EXPECT_EQ(file.table.index_bits, none.table.index_bits);
  EXPECT_EQ(file.table.fraction_bits, none.table.fraction_bits);
}

TEST(Examples, ArchValuesArrive) {
  const Arch small = read_arch(kRoot + "/scenes/archs/small.toml");
  EXPECT_EQ(small.name, "small");
  EXPECT_EQ(small.filter_lanes, 1);
  EXPECT_EQ(small.link_bits, 16);
  EXPECT_FALSE(small.overlap);
  EXPECT_EQ(small.table.index_bits, 8);
  const Arch fast = read_arch(kRoot + "/scenes/archs/fast.toml");
  EXPECT_EQ(fast.force_pipes, 2);
  EXPECT_EQ(fast.table.degree, 2);
  const Arch ice40 = read_arch(kRoot + "/scenes/archs/ice40.toml");
  EXPECT_EQ(ice40.multipliers, Multipliers::shared);
  EXPECT_EQ(fast.multipliers, Multipliers::parallel);
  EXPECT_TRUE(ice40.narrow_memories);
  EXPECT_FALSE(fast.narrow_memories);
  const Arch serial = read_arch(kRoot + "/scenes/archs/ice40_serial.toml");
  EXPECT_EQ(serial.multipliers, Multipliers::serial);
  EXPECT_TRUE(serial.narrow_memories);
  EXPECT_EQ(ice40.widths.filter_frac, 8);
  EXPECT_EQ(ice40.widths.difference_frac, 15);
}

}  // namespace
}  // namespace cuboct
