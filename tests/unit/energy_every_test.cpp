// SPDX-License-Identifier: MIT
// How often a scene has its energies read.
#include <gtest/gtest.h>

#include <string>

#include "model/config/config.h"
#include "model/scene/readings.h"
#include "model/scene/scene.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

const std::string kProbe =
    "[[probe]]\nname = \"way\"\nkind = \"displacement\"\nregion = { shape = \"sphere\", radius = 9 }\n";

Scene block(const std::string& run, const std::string& more = kProbe, const std::string& stage = "") {
  return parse_scene(
      "units = \"reduced\"\nmass = 1\npacking = { pitch = 1 }\nbox = { cells = [2, 2, 2] }\n"
      "law = { kind = \"elastic\", stiffness = 1 }\n[run]\n" +
          run + "\n" + more,
      "s.toml", {.begins = !stage.empty(), .stage = stage});
}

struct Every {
  uint64_t probes, energies;
  bool operator==(const Every&) const = default;
};

void PrintTo(const Every& every, std::ostream* out) { *out << every.probes << ", " << every.energies; }

Every every(const Scene& scene) { return {scene.probe_every, scene.energy_every}; }

TEST(EnergyEvery, IsTwoHundredStepsAndFewerOfAShortRun) {
  EXPECT_EQ(every(block("steps = 5000")), (Every{10, 200}));
  EXPECT_EQ(every(block("steps = 3500")), (Every{7, 175}));
  EXPECT_EQ(every(block("steps = 1000")), (Every{2, 50}));
  EXPECT_EQ(every(block("steps = 10")), (Every{1, 1}));
  EXPECT_EQ(every(block("steps = 200000")), (Every{400, 400}));
  EXPECT_EQ(every(block("steps = 5000\nprobe_every = 30")), (Every{30, 210}));
  EXPECT_EQ(every(block("steps = 5000\nprobe_every = 0")), (Every{0, 0}));
}

TEST(EnergyEvery, IsThatOfTheProbesWhereThereAreNone) {
  EXPECT_EQ(every(block("steps = 5000", "")), (Every{0, 0}));
  EXPECT_EQ(every(block("steps = 5000\nprobe_every = 7", "")), (Every{7, 7}));
  EXPECT_EQ(every(block("steps = 5000\nenergy_every = 7", "")), (Every{7, 7}));
}

TEST(EnergyEvery, IsGivenAndMetByProbes) {
  EXPECT_EQ(every(block("steps = 5000\nenergy_every = 10")), (Every{10, 10}));
  EXPECT_EQ(every(block("steps = 5000\nenergy_every = 11")), (Every{10, 20}));
  EXPECT_EQ(every(block("steps = 5000\nenergy_every = 0")), (Every{10, 0}));
  EXPECT_EQ(every(block("steps = 5000\nprobe_every = 9\nenergy_every = 1")), (Every{9, 9}));
}

TEST(EnergyEvery, OfAStageReplacesThatOfTheRun) {
  const std::string run = "steps = 5000\nenergy_every = 300",
                    stages = kProbe +
                             "[[stage]]\nname = \"a\"\nenergy_every = 20\n[[stage]]\nname = \"b\"\n" +
                             "probe_every = 40\n";
  EXPECT_EQ(every(block(run, stages, "a")), (Every{10, 20}));
  EXPECT_EQ(every(block(run, stages, "b")), (Every{40, 320}));
}

// Of many more steps than the scene's. Fewer than a million readings stay as the scene has them: a run that
// is cut may then be resumed to end elsewhere.
TEST(EnergyEvery, FollowsManyMoreStepsUnlessGiven) {
  constexpr uint64_t kMany = 5'000'000'000;
  const auto probes = [](const std::string& run, uint64_t steps, const std::string& probe = kProbe) {
    return readings_of(block(run, probe), steps).probes;
  };
  EXPECT_EQ(probes("steps = 50", 50), 1u);
  EXPECT_EQ(probes("steps = 50", 1'000'000), 1u);
  EXPECT_EQ(probes("steps = 5000", 50), 10u);
  EXPECT_EQ(probes("steps = 50", kMany), 10'000'000u);
  EXPECT_EQ(readings_of(block("steps = 50"), kMany).energies, 10'000'000u);
  EXPECT_EQ(probes("steps = 50\nprobe_every = 3", kMany), 3u);
  EXPECT_EQ(readings_of(block("steps = 50\nenergy_every = 0"), kMany).energies, 0u);
  EXPECT_EQ(probes("steps = 50", kMany, ""), 0u);
  EXPECT_EQ(probes("steps = 50\nenergy_every = 7", kMany, ""), 7u);
}

TEST(EnergyEvery, NeedsReadings) {
  EXPECT_EQ(refused_with([&] { block("steps = 10\nprobe_every = 0\nenergy_every = 5"); }),
            "s.toml:6:1: 'energy_every' needs readings: 'probe_every' is 0");
}

}  // namespace
}  // namespace cuboct
