// SPDX-License-Identifier: MIT
// Where methods fail: each scene of scenes/failures is told by its name, step and number, its healthy twin
// and the examples are not, in whatever engine runs them.
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>

#include "tests/cli/shell.h"

namespace cuboct::test {
namespace {

struct Pair {
  std::string failure;  // as the warning calls it; empty: a fault
  std::string sick, healthy;
  std::string sick_arch, healthy_arch;  // empty: the default
  uint64_t first, last;                 // steps between which the warning must come
};

std::string scene(const std::string& name) { return "scenes/failures/" + name + ".toml"; }

Answer run(const Bench& bench, const std::string& path, const std::string& arch,
           const std::vector<std::string>& more = {}) {
  std::vector<std::string> arguments{"run", path};
  if (!arch.empty()) arguments.insert(arguments.end(), {"--arch", "scenes/failures/archs/" + arch + ".toml"});
  arguments.insert(arguments.end(), more.begin(), more.end());
  return bench.cuboct(arguments);
}

// The warnings' texts, in turn.
std::vector<std::string> warnings(const std::string& summary) {
  std::vector<std::string> found;
  const std::regex line("(?:^|\n)warning: ([^\n]*)");
  for (std::sregex_iterator at(summary.begin(), summary.end(), line), end; at != end; ++at)
    found.push_back((*at)[1]);
  return found;
}

// Those of the watch: "step 120: time step: ...". Others are about the plan.
std::vector<std::string> findings(const std::string& summary) {
  std::vector<std::string> found = warnings(summary);
  std::erase_if(found, [](const std::string& warning) { return !warning.starts_with("step "); });
  return found;
}

uint64_t step_of(const std::string& warning) { return std::stoull(warning.substr(5)); }
std::string failure_of(const std::string& warning) {
  const size_t begin = warning.find(": ") + 2;
  return warning.substr(begin, warning.find(':', begin) - begin);
}

class Failures : public testing::TestWithParam<Pair> {};

TEST_P(Failures, AreToldAndTheHealthyTwinIsSilent) {
  const Pair& pair = GetParam();
  const Bench bench(false);
  const Answer sick = run(bench, scene(pair.sick), pair.sick_arch);
  EXPECT_EQ(sick.code, 1) << sick.out << sick.err;
  const std::vector<std::string> told = findings(sick.out);
  ASSERT_FALSE(told.empty()) << sick.out;
  EXPECT_EQ(failure_of(told[0]), pair.failure) << told[0];
  EXPECT_GE(step_of(told[0]), pair.first);
  EXPECT_LE(step_of(told[0]), pair.last);
  const Answer healthy = run(bench, scene(pair.healthy), pair.healthy_arch);
  EXPECT_EQ(healthy.code, 0) << healthy.out << healthy.err;
  EXPECT_TRUE(findings(healthy.out).empty()) << healthy.out;
}

// The steps: what docs/reference/failures.md says, with room for other orders of rounding, and before the run
// ends or stops.
INSTANTIATE_TEST_SUITE_P(
    Each, Failures,
    testing::Values(Pair{"time step", "time_step", "time_step_healthy", "", "", 1, 10},
                    Pair{"damping", "damping", "damping_healthy", "", "", 5, 25},
                    Pair{"stiff hold", "stiff_hold", "stiff_hold_healthy", "", "", 1, 40},
                    Pair{"force jump", "force_jump", "force_jump_healthy", "", "", 2000, 8000},
                    Pair{"tunnelling", "tunnelling", "tunnelling_healthy", "", "", 5, 15},
                    Pair{"constraint work", "constraint_work", "constraint_work_healthy", "", "", 150, 300},
                    Pair{"heating", "heating", "heating", "heating", "heating_healthy", 20, 500},
                    Pair{"creep", "creep", "creep", "creep", "creep_healthy", 10, 20},
                    Pair{"resolution", "resolution", "resolution", "resolution", "", 1, 1000}),
    [](const auto& info) { return info.param.sick; });

TEST(Watch, ExamplesAreSilent) {
  const Bench bench(false);
  for (const char* name : {"coupon", "hot_cluster", "lj_block", "sheet", "two_types", "undamped_block"})
    for (std::vector<std::string> more :
         {std::vector<std::string>{"--threads", "1"}, {"--engine", "reference", "--steps", "150"}}) {
      const Answer answer = run(bench, std::string("scenes/") + name + ".toml", "", more);
      EXPECT_EQ(answer.code, 0) << answer.out << answer.err;
      EXPECT_TRUE(warnings(answer.out).empty()) << name << answer.out;
    }
}

TEST(Watch, AreTheSameInEveryFixedEngine) {
  const Bench bench(true);
  std::vector<std::vector<std::string>> told;
  for (const char* engine : {"lattice", "golden", "systemc"}) {
    const Answer answer = run(bench, scene("stiff_hold"), "", {"--engine", engine});
    EXPECT_EQ(answer.code, 1) << engine << answer.err;
    told.push_back(warnings(answer.out));
  }
  ASSERT_FALSE(told[0].empty());
  EXPECT_EQ(told[0], told[1]);
  // An engine that stops keeps no state of its last complete step here; what it saw before is the same.
  ASSERT_FALSE(told[2].empty());
  EXPECT_EQ(told[0][0], told[2][0]);
  const Answer doubles = run(bench, scene("stiff_hold"), "", {"--engine", "reference"});
  EXPECT_EQ(doubles.code, 1);
  ASSERT_FALSE(warnings(doubles.out).empty());
  EXPECT_EQ(failure_of(warnings(doubles.out)[0]), "stiff hold");
}

TEST(Watch, SeesWhatRanksRun) {
  const Bench bench(false);
  std::filesystem::copy(CUBOCT_LATTICE, bench.path("bin/cuboct-lattice"));
  const auto of_ranks = [&](const std::string& name, const char* count) {
    return run(bench, scene(name), "", {"--ranks", count});
  };
  const Answer healthy = of_ranks("stiff_hold_healthy", "2");
  if (healthy.code == 2) GTEST_SKIP() << healthy.err;  // no MPI
  EXPECT_EQ(healthy.code, 0) << healthy.err;
  EXPECT_TRUE(warnings(healthy.out).empty()) << healthy.out;
  const Answer one = of_ranks("stiff_hold", "1"), two = of_ranks("stiff_hold", "2");
  EXPECT_EQ(two.code, 1) << two.err;
  ASSERT_FALSE(warnings(one.out).empty()) << one.out;
  EXPECT_EQ(warnings(two.out), warnings(one.out));
}

TEST(Watch, TextNamesStepPlaceAndNumber) {
  const Answer answer = run(Bench(false), scene("creep"), "creep");
  ASSERT_EQ(warnings(answer.out).size(), 1u) << answer.out;
  EXPECT_TRUE(std::regex_match(
      warnings(answer.out)[0],
      std::regex("step 10: creep: particle [0-9]+ at \\([-0-9.]+, [-0-9.]+, [-0-9.]+\\) m: it has moved "
                 "0\\.00[0-9]+ m out of a body at rest, 0\\.00[0-9]+ of the pitch")))
      << warnings(answer.out)[0];
}

TEST(Watch, AreAnArrayInJson) {
  const Bench bench(false);
  const Answer sick = run(bench, scene("creep"), "creep", {"--json"});
  EXPECT_EQ(sick.code, 1);
  EXPECT_TRUE(std::regex_search(
      sick.out,
      std::regex("\n  \"warnings\": \\{\"value\": \\[\n    \\{\"failure\": \"creep\", \"step\": 10, "
                 "\"particle\": [0-9]+, \"x\": [^,]+, \"y\": [^,]+, \"z\": [^,]+, \"number\": "
                 "0\\.00[0-9]+, \"limit\": 0\\.001, \"text\": \"step 10: creep: [^\"]*\"\\}\n  \\]\\}")))
      << sick.out;
  const Answer healthy = run(bench, scene("creep"), "creep_healthy", {"--json"});
  EXPECT_NE(healthy.out.find("\n  \"warnings\": {\"value\": []}"), std::string::npos) << healthy.out;
}

TEST(Watch, AreNotLookedForWithNoWatch) {
  const Bench bench(false);
  for (const char* engine : {"lattice", "golden"}) {
    const Answer answer = run(bench, scene("creep"), "creep", {"--no-watch", "--engine", engine});
    EXPECT_EQ(answer.code, 0);
    EXPECT_TRUE(warnings(answer.out).empty());
  }
}

// Floats: a warning before the first step, by the spacing of floats alone.
TEST(Watch, FarOriginIsToldWithFloatsAlone) {
  const Bench bench(false);
  const std::vector<std::string> floats{"--engine", "reference", "--precision", "float", "--steps", "5"};
  const Answer sick = run(bench, scene("far_origin"), "", floats);
  ASSERT_FALSE(warnings(sick.out).empty()) << sick.out << sick.err;
  EXPECT_EQ(warnings(sick.out)[0].find("far origin: float32 positions are 0.00781 m apart"), 0u)
      << warnings(sick.out)[0];
  EXPECT_EQ(run(bench, scene("far_origin_healthy"), "", floats).code, 0);
  EXPECT_EQ(run(bench, scene("far_origin"), "", {"--engine", "reference", "--steps", "5"}).code, 0);
}

// The faults that stop a run: what the last look saw, what helps, and the fault itself.
TEST(Stop, SaysWhatHelpsAgainstAFullCell) {
  const Bench bench(false);
  const Answer answer = run(bench, scene("full_node"), "full_node");
  EXPECT_EQ(answer.code, 1);
  EXPECT_NE(
      answer.out.find("\nlast look         step 33: nothing amiss\n"
                      "advice            cell (1 1 3) at (1.868, 1.868, 4.696) m: particle 154 came, and "
                      "the cell holds 5 particles; raise node.capacity, or take a shorter node.cell_edge "
                      "where it is longer than the cutoff\n"
                      "stopped           step 33, cell "),
      std::string::npos)
      << answer.out;
  EXPECT_EQ(run(bench, scene("full_node"), "full_node_healthy").code, 0);
}

TEST(Stop, SaysWhatHelpsAgainstAVelocityThatSaturates) {
  const Bench bench(false);
  const Answer answer = run(bench, scene("velocity"), "");
  EXPECT_EQ(answer.code, 1);
  EXPECT_NE(
      answer.out.find("\nadvice            cell (0 0 -15) at (0.45, 0.45, 3.45) m: particle 0 would move "
                      "1.03 cells in a step, 1 fit; use a smaller run.dt or a larger node.cell_edge; a run "
                      "that was stable until then met an impact, or its dt is too long\n"),
      std::string::npos)
      << answer.out;
  EXPECT_EQ(run(bench, scene("velocity_healthy"), "").code, 0);
}

// A run that blows up is told what was seen before the fault.
TEST(Stop, TellsWhatTheWatchSawBefore) {
  const Answer answer = run(Bench(false), scene("time_step"), "");
  EXPECT_EQ(answer.code, 1);
  EXPECT_NE(answer.out.find("\nlast look         step "), std::string::npos) << answer.out;
  EXPECT_NE(answer.out.find(": see the warnings\n"), std::string::npos) << answer.out;
}

}  // namespace
}  // namespace cuboct::test
