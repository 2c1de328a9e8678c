// SPDX-License-Identifier: MIT
// Cracks cut by hand: bonds per area, energy, length and speed in closed form.
#include "model/analysis/crack.h"

#include <gtest/gtest.h>

#include <cmath>

#include "model/analysis/measure.h"
#include "model/base/error.h"
#include "tests/fcc_block.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

Probe crack_of(const Scene& scene) { return scene.probes.at(0); }

// A bar of the packing that repeats across x, whose crystal has n along x and m along y.
Scene notched_bar(const std::string& axes, const std::string& law, const std::string& probe = "") {
  return parse_scene("units = \"reduced\"\nmass = 1\npacking = { pitch = 0.5, axes = " + axes + " }\n" +
                         "box = { cells = [4, 4, 4], periodic = \"yz\" }\nlaw = { " + law +
                         " }\n[[probe]]\nname = \"crack\"\nkind = \"crack\"\naxis = \"y\"\n"
                         "region = { shape = \"sphere\", radius = 99 }\n" +
                         probe + "[run]\ndt = 0.01\nsteps = 1\n",
                     "bar");
}

double middle_of(const std::vector<Vec3>& x) {
  double low = 1e9, high = -1e9;
  for (const Vec3& at : x) low = std::min(low, at.x()), high = std::max(high, at.x());
  return (low + high) / 2 + 1e-3;  // between two planes of sites, whichever they are
}

// Bonds cut per area are the sum of n.d over the bonds d with n.d > 0, over the volume pitch^3/sqrt(2) of a
// site: of {100} four of pitch/sqrt(2), of {110} one of pitch and four of half of it, of {111} three of
// sqrt(2/3) pitch.
TEST(Crack, OfABarCutInTwoHasTheBondsOfItsPlane) {
  struct Of {
    std::string axes;
    double per_area;
  };
  const double pitch = 0.5;
  for (const auto& [axes, per_area] :
       {Of{"[[1, 0, 0], [0, 1, 0]]", 4 / std::sqrt(2.0)}, Of{"[[1, 1, 0], [0, 0, 1]]", 3.0},
        Of{"[[1, 1, 1], [1, -1, 0]]", 3 * std::sqrt(2.0 / 3)}}) {
    for (const std::string law :
         {"kind = \"brittle\", stiffness = 2.0", "kind = \"elastic\", stiffness = 1.0"}) {
      const Scene scene = notched_bar(axes, law);
      const CrackMeter meter(crack_of(scene), scene.periodic, scene.body.x);
      std::vector<Vec3> moved(scene.body.size(), Vec3::Zero());
      EXPECT_EQ(meter.look(moved).broken, 0u);
      for (size_t i = 0; i < moved.size(); ++i)
        if (scene.body.x[i].x() > middle_of(scene.body.x)) moved[i].x() = 2;
      const CrackMeter::Found found = meter.look(moved);
      const double area = scene.periodic.extent.y() * scene.periodic.extent.z();
      const double bonds = per_area * std::sqrt(2.0) / (pitch * pitch) * area;
      EXPECT_NEAR(static_cast<double>(found.broken), bonds, 1e-9 * bonds) << axes;
      EXPECT_NEAR(found.energy, -bonds * scene.rule.law->energy(pitch), 1e-9 * found.energy);
      EXPECT_GT(found.energy, 0);
      // The cut goes round the box: from the first bond's middle to the last one's.
      EXPECT_NEAR(found.length, scene.periodic.extent.y(), 0.75 * pitch) << axes;
    }
  }
}

// Ten columns and four rows of a square sheet, pitch 1, bonds of reach 1.6.
struct Sheet {
  Scene scene;
  std::vector<Vec3> moved;

  explicit Sheet(const std::string& probe = "", const std::string& more = "") {
    std::string text =
        "units = \"reduced\"\nmass = 1\nlaw = { kind = \"lj\", epsilon = 1, sigma = 1, cutoff = 1.6 }\n" +
        more +
        "[[probe]]\nname = \"crack\"\nkind = \"crack\"\naxis = \"x\"\nbond_length = 1.2\n"
        "region = { shape = \"sphere\", radius = 99 }\n" +
        probe + "[run]\ndt = 0.01\nsteps = 1\n";
    for (int y = 0; y < 4; ++y)
      for (int x = 0; x < 10; ++x)
        text += "[[particle]]\nposition = [" + std::to_string(x) + ", " + std::to_string(y) + ", 0]\n";
    scene = parse_scene(text, "sheet");
    moved.assign(40, Vec3::Zero());
  }
  // The upper two rows part from the lower ones by 1 in columns below `column`: bonds along y grow to 2, that
  // between the last such column and the next one to sqrt(2).
  void open(int column) {
    for (int y = 2; y < 4; ++y)
      for (int x = 0; x < column; ++x) moved[static_cast<size_t>(10 * y + x)].y() = 1;
  }
  CrackMeter::Found look() const {
    return CrackMeter(crack_of(scene), scene.periodic, scene.body.x).look(moved);
  }
};

TEST(Crack, IsAsLongAsItsBrokenBonds) {
  Sheet sheet, from_start("start = -0.5\n");
  EXPECT_EQ(CrackMeter(crack_of(sheet.scene), {}, sheet.scene.body.x).bonds(), 9u * 4 + 10 * 3);
  sheet.open(5), from_start.open(5);
  EXPECT_EQ(sheet.look().broken, 5u);
  EXPECT_DOUBLE_EQ(sheet.look().length, 4);
  EXPECT_DOUBLE_EQ(from_start.look().length, 4.5);
  EXPECT_NEAR(sheet.look().energy, -5 * sheet.scene.rule.law->energy(1), 1e-12);
}

// The corner at column 9 flies off with its two bonds, and a bond breaks at the other corner.
TEST(Crack, StrayBondsMakeNoCrack) {
  Sheet sheet;
  sheet.moved[9].x() = 5;
  EXPECT_EQ(sheet.look().broken, 2u);
  EXPECT_DOUBLE_EQ(sheet.look().length, 0.5);  // from 8.5 to 9
  sheet.open(5);
  EXPECT_EQ(sheet.look().broken, 7u);
  EXPECT_DOUBLE_EQ(sheet.look().length, 4);
  Sheet alone("start = 0\n");
  alone.open(1);
  EXPECT_EQ(alone.look().broken, 1u);
  EXPECT_DOUBLE_EQ(alone.look().length, 0);
}

// The run begins with five columns open and the sheet drawn out by a tenth: what is open is no bond then, and
// what opens further on is. In a box that repeats, particles have gone round it before the run begins.
TEST(Crack, BondsMayBeThoseOfWhereTheRunBegins) {
  for (const bool round : {false, true}) {
    Sheet sheet("bonds = \"start\"\n");
    EXPECT_TRUE(sheet.scene.probes[0].from_start);
    if (round) sheet.scene.periodic.extent = Vec3(50, 50, 50);
    sheet.open(5);
    Probe& probe = sheet.scene.probes[0];
    for (size_t i = 0; i < sheet.moved.size(); ++i) {
      sheet.moved[i].x() += 0.1 * sheet.scene.body.x[i].x();
      probe.begin.push_back(sheet.scene.body.x[i] + sheet.moved[i] +
                            Vec3(round && i % 2 == 0 ? 50 : 0, 0, 0));
    }
    const CrackMeter meter(probe, sheet.scene.periodic, sheet.scene.body.x);
    EXPECT_EQ(meter.bonds(), 9u * 4 + 10 * 3 - 5 - 2 +
                                 1);  // across the step by column 5 one row is now level with the other
    EXPECT_EQ(meter.look(sheet.moved).broken, 0u);
    sheet.open(8);
    const CrackMeter::Found found = meter.look(sheet.moved);
    EXPECT_EQ(found.broken, 3u);
    EXPECT_NEAR(found.energy, -3 * sheet.scene.rule.law->energy(1), 1e-9);
    EXPECT_NEAR(found.length, 1.1 * 2, 1e-9);  // from column 5 to 7
  }
}

TEST(Crack, BondsOfMaterialsCountWithTheirStrengthAndContactsAreNone) {
  const std::string upper =
      "[[material]]\nname = \"lower\"\n[[material]]\nname = \"upper\"\nstrength = 4\n"
      "region = { shape = \"half_space\", point = [0, 1.5, 0], normal = \"-y\" }\n";
  Sheet bonded("", upper),
      touching("", upper + "[[bond]]\nbetween = [\"lower\", \"upper\"]\ncontact = true\n");
  bonded.open(5), touching.open(5);
  EXPECT_EQ(bonded.look().broken, 5u);
  EXPECT_NEAR(bonded.look().energy, -2 * 5 * bonded.scene.rule.law->energy(1), 1e-12);
  EXPECT_EQ(touching.look().broken, 0u);
}

// The crack grows by a column between readings 4 steps apart; dt = 0.01.
TEST(Crack, SpeedIsTheGrowthOverTheWindow) {
  Sheet sheet("start = 0\nwindow = 3\n");
  ProbeMeter meter(sheet.scene.probes, sheet.scene.periodic, sheet.scene.body.x);
  ASSERT_EQ(meter.curves().size(), 4u);
  const char* const names[] = {"crack.broken", "crack.length", "crack.speed", "crack.energy"};
  const char* const units[] = {"1", "m", "m/s", "J"};
  for (size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(meter.curves()[k].name, names[k]);
    EXPECT_EQ(meter.curves()[k].unit, units[k]);
  }
  for (int columns = 1; columns <= 8; ++columns) {
    sheet.open(columns);
    std::vector<Vec3> x = sheet.scene.body.x;
    for (size_t i = 0; i < x.size(); ++i) x[i] += sheet.moved[i];
    meter.add({static_cast<uint64_t>(4 * columns), x, {}, {}});
  }
  const Curve &length = meter.curves()[1], &speed = meter.curves()[2];
  EXPECT_EQ(length.value, (std::vector<double>{0, 1, 2, 3, 4, 5, 6, 7}));
  EXPECT_EQ(speed.value[0], 0);
  for (size_t k = 1; k < 8; ++k) EXPECT_NEAR(speed.value[k], 1 / 0.04, 1e-9) << k;
  // It stops: after two more readings a third of the growth is left within the window.
  std::vector<Vec3> x = sheet.scene.body.x;
  for (size_t i = 0; i < x.size(); ++i) x[i] += sheet.moved[i];
  for (const uint64_t step : {36, 40}) meter.add({step, x, {}, {}});
  EXPECT_NEAR(meter.curves()[2].value.back(), 1 / 0.12, 1e-9);
}

TEST(Crack, ErrorsSayWhatItNeeds) {
  const auto error = [](const std::string& probe) {
    return refused_with(
        [&] { notched_bar("[[1, 0, 0], [0, 1, 0]]", "kind = \"brittle\", stiffness = 1.0", probe); });
  };
  EXPECT_EQ(error(""), "accepted");
  EXPECT_EQ(error("window = 0\n"), "bar:11:10: 'window' must be between 1 and 1000000, not 0");
  EXPECT_EQ(error("bond_length = 0\n"), "bar:11:15: 'bond_length' must be greater than 0, not 0");
  EXPECT_EQ(error("area = 1\n").substr(0, 28), "bar:11:1: unknown key 'area'");
}

}  // namespace
}  // namespace cuboct
