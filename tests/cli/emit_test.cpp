// SPDX-License-Identifier: MIT
// What an emitted project says of its speed, beside the run that it is of.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "model/base/output.h"
#include "model/trace/cycles.h"
#include "model/trace/trace.h"
#include "tests/cli/shell.h"

namespace cuboct::test {
namespace {

// Particles of a liquid, whose steps take unequal numbers of cycles; the trace of `cuboct run --cycles` has
// them node by node.
TEST(Emit, CountsTheCyclesOfTheFirstStepsOfARun) {
  const Bench bench(false);
  const std::string scene = CUBOCT_SOURCE_DIR "/scenes/lj_block.toml";
  const Answer ran = bench.cuboct(
      {"run", scene, "--engine", "lattice", "--steps", "200", "--cycles", "--out", bench.path("run")});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const auto exact = cycles_per_step(read_trace(bench.path("run/trace.h5")));
  ASSERT_TRUE(exact);
  const Answer emitted = bench.cuboct({"emit", scene, "--out", bench.path("block"), "--json"});
  ASSERT_EQ(emitted.code, 0) << emitted.err;
  const auto cycles =
      nlohmann::json::parse(read_text(bench.path("block/project.json"))).at("cycles_per_step");
  EXPECT_EQ(cycles.at("counted").at("steps"), 200);
  EXPECT_DOUBLE_EQ(cycles.at("counted").at("mean"), exact->mean);
  EXPECT_EQ(cycles.at("counted").at("most"), exact->max);
  EXPECT_GT(exact->max, exact->mean);  // so that the two are told apart
  EXPECT_NE(cycles.at("expected"), exact->max);
  EXPECT_DOUBLE_EQ(nlohmann::json::parse(emitted.out).at("mean_cycles_per_step").at("value"), exact->mean);
}

// A machine's file in the place of a scene's, as the two lie side by side.
TEST(Emit, TellsAnArchFromAScene) {
  const Bench bench(false);
  const Answer refused = bench.cuboct({"emit", "scenes/archs/board.toml", "--out", bench.path("none")});
  EXPECT_EQ(refused.code, 2);
  EXPECT_EQ(refused.out, "");
  EXPECT_EQ(refused.err,
            "scenes/archs/board.toml:5:1: this is an arch file, not a scene\n"
            "   5 | [node]\n"
            "     | ^\n"
            "  hint: --arch scenes/archs/board.toml gives it to a scene\n");
  EXPECT_FALSE(std::filesystem::exists(bench.path("none")));
}

// Before anything is built, and nothing is written.
TEST(Emit, RefusesAPrefixThatIsNoName) {
  const Bench bench(false);
  const Answer refused =
      bench.cuboct({"emit", "scenes/lj_block.toml", "--prefix", "2nd", "--out", bench.path("none")});
  EXPECT_EQ(refused.code, 2);
  EXPECT_EQ(refused.err,
            "--prefix '2nd': names of SystemVerilog cannot begin so\n"
            "  hint: at most 64 letters, digits and '_', a letter first\n");
  EXPECT_FALSE(std::filesystem::exists(bench.path("none")));
}

#ifdef CUBOCT_HAS_SYNTH
// Far too many nodes: told at once, without a tool.
TEST(Emit, RefusesABoardThatHasNoRoom) {
  const Bench bench(false);
  std::vector<std::string> words{"emit",  "scenes/coupon.toml", "--board", "icebreaker",
                                 "--out", bench.path("large")};
  const Answer refused = bench.cuboct(words);
  EXPECT_EQ(refused.code, 2);
  EXPECT_EQ(refused.out, "");
  EXPECT_EQ(
      refused.err.find("scenes/coupon.toml: its 2640 nodes and a host link do not fit the icebreaker (up5k): "
                       "they take BRAM "),
      0u)
      << refused.err;
  EXPECT_NE(
      refused.err.find(" for their memories alone\n  hint: not one such node fits; --fit up5k looks for a "
                       "machine that fits, --unchecked writes this one for the simulator\n"),
      std::string::npos)
      << refused.err;
  EXPECT_FALSE(std::filesystem::exists(bench.path("large")));
}

// Without the tools that could tell, it is said that they did not.
TEST(Emit, SaysWhatOfTheFitItCouldNotCheck) {
  const Bench bench(false);
  const std::string path = std::getenv("PATH");
  setenv("PATH", bench.path("").c_str(), 1);
  const Answer emitted =
      bench.cuboct({"emit", "scenes/boards/grips.toml", "--arch", "scenes/archs/icebreaker.toml", "--board",
                    "icebreaker", "--out", bench.path("bar")});
  setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(emitted.code, 0);
  EXPECT_EQ(emitted.err,
            "note: of the fit only memories were checked: yosys or nextpnr-ice40 is not in PATH\n");
  EXPECT_NE(read_text(bench.path("bar/README.md"))
                .find("cuboct run SCENE --arch arch.toml --engine fpga --port /dev/ttyUSB0 --baud 1000000\n"),
            std::string::npos);
}
#endif

// The project has the arch that it was made with, so that its README can name it: the same plan.
TEST(Emit, LeavesTheArchThatMakesTheSamePlan) {
  const Bench bench(false);
  const std::string scene = "scenes/lj_block.toml";
  for (const std::string arch : {"", "scenes/archs/fast.toml"}) {
    const auto emit = [&](const std::string& given, const std::string& out) {
      std::vector<std::string> words{"emit", scene, "--out", bench.path(out), "--vector-steps", "1"};
      if (!given.empty()) words.insert(words.end(), {"--arch", given});
      const Answer answer = bench.cuboct(words);
      EXPECT_EQ(answer.code, 0) << answer.err;
      return nlohmann::json::parse(read_text(bench.path(out + "/project.json"))).at("plan");
    };
    const auto plan = emit(arch, "first");
    EXPECT_EQ(emit(bench.path("first/arch.toml"), "second"), plan) << arch;
    if (arch.empty()) continue;
    EXPECT_EQ(read_text(bench.path("first/arch.toml")), read_text(CUBOCT_SOURCE_DIR "/" + arch));
  }
}

}  // namespace
}  // namespace cuboct::test
