// SPDX-License-Identifier: MIT
// What lives and what does not: published silicon, and each way to fail.
#include "study/potential_fit/endurance.h"

#include <gtest/gtest.h>

#include "study/sweep/interrupted.h"

namespace cuboct::bond_fit {
namespace {

constexpr double kMass = 2.9108573e-3;  // eV ps^2/angstrom^2: 28.0855 u
const Trial kShort{.cells = 3, .mass = kMass, .time = 0.2};
bool never() { return false; }

TEST(Endurance, PublishedSiliconIsStableWithEverySurface) {
  const Tersoff tersoff = tersoff_set("si_erhart_albe");
  Endurance all;
  for (size_t b = 0; b < kBoundaries; ++b) all.runs[b] = endure(tersoff, 5.428877, kShort, b, never);
  EXPECT_TRUE(all.stable());
  // Of a crystal half of the heat goes into its bonds: fluctuations of 216 atoms are some 300 K sqrt(2/648).
  EXPECT_NEAR(all.runs[0].temperature, 150, 30);
  EXPECT_GE(all.hottest(), all.runs[0].temperature);
  EXPECT_LT(std::abs(all.runs[0].drift), 1e-4);
  // Surfaces relax, which heats.
  EXPECT_GT(all.runs[3].temperature, all.runs[0].temperature);
}

// Its only difference is where bonds want to stand: the lattice is at rest, but no minimum.
TEST(Endurance, ALatticeThatFallsDownhillIsNot) {
  Tersoff tersoff = tersoff_set("si_erhart_albe");
  tersoff.terms[0].cos_theta0 = 0.5;
  const Endured run = endure(tersoff, 5.43, kShort, 0, never);
  EXPECT_NE(run.fault.find("its bonds have less energy than the crystal's"), std::string::npos) << run.fault;
}

TEST(Endurance, ACrystalThatMeltsChangesItsNeighbours) {
  Trial hot = kShort;
  hot.temperature = 9000;
  const Endured run = endure(tersoff_set("si_erhart_albe"), 5.428877, hot, 0, never);
  EXPECT_NE(run.fault.find("of 216 inner atoms changed their neighbours"), std::string::npos) << run.fault;
}

TEST(Endurance, AClusterThatBoilsComesApart) {
  Trial boiling = kShort;
  boiling.temperature = 60000, boiling.time = 0.4;
  const Endured run = endure(tersoff_set("si_erhart_albe"), 5.428877, boiling, 3, never);
  EXPECT_EQ(run.fault.substr(0, 21), "the body comes apart:") << run.fault;
}

TEST(Endurance, AStepThatIsTooLongLosesTheEnergy) {
  Trial coarse = kShort;
  coarse.step = 0.03, coarse.time = 6;
  const Endured run = endure(tersoff_set("si_erhart_albe"), 5.428877, coarse, 0, never);
  EXPECT_FALSE(run.fault.empty());
}

TEST(Endurance, IsInterrupted) {
  EXPECT_THROW(endure(tersoff_set("si_erhart_albe"), 5.43, kShort, 0, [] { return true; }),
               study::Interrupted);
}

}  // namespace
}  // namespace cuboct::bond_fit
