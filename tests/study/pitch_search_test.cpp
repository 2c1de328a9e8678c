// SPDX-License-Identifier: MIT
#include "study/search/pitch_search.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/base/error.h"
#include "model/base/output.h"
#include "tests/study/small_study.h"
#include "tests/support/refused_with.h"

namespace cuboct::study {
namespace {

using cuboct::test::SmallStudy;

std::string bar() { return read_text(CUBOCT_SOURCE_DIR "/scenes/studies/pitch_bar.toml"); }

PitchQuestion question(double error) {
  PitchQuestion q;
  q.base = {"bar.toml", bar(), "", ""};
  q.figure = {.kind = Figure::Kind::modulus,
              .name = "modulus",
              .curve = "tension.stress",
              .against = "tension.strain"};
  q.error = error;
  return q;
}

// Not one run has more than are allowed: each pitch is counted before it is run.
TEST(PitchSearch, KeepsToTheParticlesThatAreAllowed) {
  const SmallStudy files;
  make_directory(files.path("out"));
  PitchQuestion few = question(0.01);
  const uint64_t most = resolve(few.base, {}).scene.body.size();
  few.most_particles = most / 2;
  try {
    find_pitch(few, files.path("out"), [](const PitchAnswer&) { FAIL() << "it ran"; });
    ADD_FAILURE() << "no refusal";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(fmt::format("more than the {} that are allowed", most / 2)),
              std::string::npos)
        << error.what();
  }
  // The next pitch may count more than 2 sqrt(2) times as many.
  few.most_particles = 3 * most;
  for (const PitchRun& run : find_pitch(few, files.path("out"), [](const PitchAnswer&) {}).runs)
    EXPECT_LE(run.particles, few.most_particles);
}

// Limit 5, slope 2, and what is known of them by hand: four points of y = 5 x + 2 + e over x = 1/pitch = 1,
// 2, 3, 4 with e = d, -d, -d, d, which changes neither.
TEST(PitchLine, HasLimitSlopeAndTheirUncertainty) {
  constexpr double kScatter = 0.1;
  std::vector<PitchRun> runs;
  for (int k = 1; k <= 4; ++k) {
    PitchRun run;
    run.pitch = 1.0 / k;
    run.value = 5 + run.pitch * (2 + (k == 1 || k == 4 ? kScatter : -kScatter));
    runs.push_back(run);
  }
  const PitchLine line = line_through(runs);
  EXPECT_NEAR(line.limit, 5, 1e-12);
  EXPECT_NEAR(line.slope, 2, 1e-12);
  // Student's t of two degrees of freedom, 2.920, times sqrt(4 d^2/2); the sum of (x - mean)^2 is 5.
  EXPECT_NEAR(line.scatter, 2.920 * kScatter * std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(line.limit_within, line.scatter / std::sqrt(5.0), 1e-12);
  EXPECT_NEAR(line.error_at(0.25), ((2 + line.scatter) * 0.25 + line.limit_within) / 5, 1e-12);
  EXPECT_NEAR(line.error_at(*line.pitch_for(0.3)), 0.3, 1e-12);
  EXPECT_FALSE(line.pitch_for(0.9 * line.limit_within / 5));
}

TEST(PitchSearch, FindsTheLimitThatIsGivenAndGoesOn) {
  const SmallStudy files;
  make_directory(files.path("out"));
  int seen = 0;
  const PitchAnswer found =
      find_pitch(question(0.35), files.path("out"), [&](const PitchAnswer&) { ++seen; });
  ASSERT_TRUE(found.pitch);
  EXPECT_EQ(found.runs.size(), static_cast<size_t>(kShifts * seen));
  EXPECT_GT(found.runs.front().pitch, found.runs.back().pitch);
  // The bar's modulus is 3 GPa by its input, and nothing else here knows it.
  EXPECT_NEAR(found.line->limit, 3e9, std::min(found.line->limit_within, 0.05 * 3e9));
  for (const PitchRun& run : found.runs)
    if (run.pitch <= *found.pitch) {
      EXPECT_NEAR(run.value, 3e9, 0.35 * 3e9);
    }
  // The same question needs no run; a smaller error goes on with what there is.
  const std::string kept = read_text(files.path("out/runs.jsonl"));
  const PitchAnswer again = find_pitch(question(0.35), files.path("out"), [](const PitchAnswer&) {});
  EXPECT_EQ(again.pitch, found.pitch);
  EXPECT_EQ(read_text(files.path("out/runs.jsonl")), kept);
  PitchQuestion few = question(0.01);
  few.most_particles = found.runs.back().particles;
  EXPECT_FALSE(find_pitch(few, files.path("out"), [](const PitchAnswer&) {}).pitch);
  // Results of another figure are not taken for these.
  PitchQuestion other = question(0.35);
  other.figure.kind = Figure::Kind::final;
  EXPECT_THROW(find_pitch(other, files.path("out"), [](const PitchAnswer&) {}), InputError);
}

TEST(PitchSearch, RefusesWhatIsOfOnePitch) {
  const auto told = [](const std::string& old, const std::string& fresh) -> std::string {
    std::string text = bar();
    text.replace(text.find(old), old.size(), fresh);
    return refused_with([&] { check_refinable({"bar.toml", text, "", ""}); });
  };
  EXPECT_EQ(told("kind = \"elastic\"", "kind = \"elastic\""), "accepted");
  const auto has = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  has(told("youngs_modulus = \"3 GPa\"\ndirection = \"x\"", "stiffness = \"1 kN/m\""),
      "bar.toml:23:13: 'stiffness'");
  has(told("kind = \"elastic\"", "kind = \"lj\""), "lengths of its own");
  has(told("density = \"1.41 g/cm^3\"", "mass = \"1 g\""), "'mass' is that of a particle");
  has(told("duration = \"84 us\"", "steps = 100"), "another time at another pitch");
  has(told("static = { load_steps = 8 }", "dt = \"10 ns\""), "'dt' is stable at one pitch");
  has(told("[run]", "[box]\nperiodic = \"z\"\nsize = \"[1, 1, 1] m\"\n[run]"), "at some pitches only");
  has(told("[run]", "[damping]\ncoefficient = \"1 g/s\"\n[run]"), "that of a bond of one pitch");
  has(told("[run]", "[[particle]]\nposition = \"[1, 1, 1] m\"\n[run]"), "the mass of one pitch");
  has(told("name = \"pulled\"", "name = \"pulled\"\nkp = \"1 N/m\""), "'kp' is that of a particle");
  has(told("[run]", "[[stage]]\nname = \"a\"\n[run]"), "stages");
}

}  // namespace
}  // namespace cuboct::study
