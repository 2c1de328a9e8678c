// SPDX-License-Identifier: MIT
// The skin's choice on made-up matter: how many entries a list has and how long it serves are functions of
// the skin.
#include "emu/gpu/skin.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <vector>

namespace cuboct::gpu {
namespace {

struct Matter {
  std::function<double(double)> entries;  // per particle, of a list of that skin
  std::function<double(double)> life;     // steps; infinite where particles only vibrate
};

// What a step costs by the class's own measure: skin.h.
constexpr double kMaking = 400, kEntry = 0.06, kOthers = 20;
constexpr double kMany = 1e9;

struct Lived {
  std::vector<double> skins;  // one per list
  double cost = 0;            // per step, of the last half of the steps
  double usual = 0;           // the skin that served the most of them
};

Lived live(const Matter& matter, uint64_t steps) {
  Skin skin(1, 0.16, kMany);
  Lived lived;
  uint64_t step = 0;
  double cost = 0, counted = 0;
  std::map<double, double> served;
  while (step < steps) {
    const double entries = matter.entries(skin.now());
    skin.listed(entries);
    lived.skins.push_back(skin.now());
    const double serves = std::min(matter.life(skin.now()), static_cast<double>(steps - step));
    const auto age = static_cast<uint64_t>(std::max(1.0, serves));
    if (2 * step > steps) {
      cost += kMaking + static_cast<double>(age) * (kOthers + kEntry * entries);
      counted += static_cast<double>(age);
      served[skin.now()] += static_cast<double>(age);
    }
    step += age;
    skin.aged(age);
  }
  lived.cost = cost / counted;
  for (const auto& [one, age] : served)
    if (age > served[lived.usual]) lived.usual = one;
  return lived;
}

// The least cost per step of any of the skins that there are.
double best(const Matter& matter) {
  double least = 1e300;
  for (int k = 0; k < 14; ++k) {
    const double skin = std::min(0.02 * std::pow(1.25, k), 0.16);
    least =
        std::min(least, kMaking / std::max(1.0, matter.life(skin)) + kOthers + kEntry * matter.entries(skin));
  }
  return least;
}

// Density times the volume of the shell; life by a steady motion of `speed` per step.
Matter fluid(double density, double speed) {
  return {[=](double skin) { return density * std::pow(1 + skin, 3); },
          [=](double skin) { return std::floor(skin / 2 / speed); }};
}

TEST(GpuSkin, AFluidIsServedAtNearlyTheLeastCost) {
  for (const double density : {5.0, 12.0, 55.0, 80.0})
    for (const double speed : {2e-5, 1e-4, 5e-4, 2e-3, 1e-2}) {
      SCOPED_TRACE("density " + std::to_string(density) + ", speed " + std::to_string(speed));
      const Matter matter = fluid(density, speed);
      const Lived lived = live(matter, 400'000);
      EXPECT_LE(lived.cost, 1.08 * best(matter));
    }
}

// Below the amplitude of the vibrations lists serve for few steps, beyond it for very many.
TEST(GpuSkin, ASolidComesToASkinBeyondItsVibrations) {
  for (const double amplitude : {0.03, 0.05, 0.08, 0.12}) {
    SCOPED_TRACE("amplitude " + std::to_string(amplitude));
    const Matter matter{[](double skin) { return skin < 0.15 ? 12.0 : 18.0; },
                        [=](double skin) { return skin > amplitude ? 5000.0 : 20.0; }};
    const Lived lived = live(matter, 2'000'000);
    EXPECT_GT(lived.usual, amplitude);
    EXPECT_LE(lived.cost, 1.08 * best(matter));
  }
}

TEST(GpuSkin, IsTheSameForTheSameRun) {
  const Matter matter = fluid(30, 7e-4);
  EXPECT_EQ(live(matter, 50'000).skins, live(matter, 50'000).skins);
  // A longer run begins as the shorter one.
  const Lived shorter = live(matter, 20'000), longer = live(matter, 50'000);
  ASSERT_GT(shorter.skins.size(), 20u);
  EXPECT_EQ(shorter.skins,
            std::vector<double>(longer.skins.begin(), longer.skins.begin() + shorter.skins.size()));
}

TEST(GpuSkin, StaysWithinWhatTheCellsHold) {
  for (const double largest : {0.001, 0.02, 0.05, 0.16, 0.4, 2.0}) {
    const Matter matter = fluid(1, 1e-2);  // gains from the thickest
    Skin skin(1, largest, kMany);
    for (int k = 0; k < 500; ++k) {
      EXPECT_LE(skin.now(), largest);
      EXPECT_GT(skin.now(), 0);
      skin.listed(1);
      skin.aged(static_cast<uint64_t>(std::max(1.0, matter.life(skin.now()))));
    }
  }
}

}  // namespace
}  // namespace cuboct::gpu
