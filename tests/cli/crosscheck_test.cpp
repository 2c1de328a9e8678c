// SPDX-License-Identifier: MIT
// The crosscheck against an engine that lies in one thing at a time.
#include <gtest/gtest.h>

#include <cstdlib>
#include <regex>

#include "tests/cli/shell.h"

namespace cuboct::test {
namespace {

// 256 particles on 27 nodes.
Answer crosscheck(const char* lie, const std::string& engines = "golden,systemc,rtl") {
  setenv("LIE", lie, 1);
  const Answer answer =
      Bench(true).cuboct({"crosscheck", "scenes/lj_block.toml", "--steps", "5", "--engines", engines});
  unsetenv("LIE");
  return answer;
}

TEST(Crosscheck, SaysHowMuchMatched) {
  const Answer answer = crosscheck("");
  EXPECT_EQ(answer.code, 0);
  EXPECT_EQ(answer.out, "matched 1280 updates over 5 steps in 3 engines\nmatched 1080 phase times\n");
  EXPECT_EQ(answer.err, "");
}

TEST(Crosscheck, ComparesNoCyclesWhereOneEngineCountsThem) {
  EXPECT_EQ(crosscheck("", "golden,rtl").out, "matched 1280 updates over 5 steps in 2 engines\n");
}

TEST(Crosscheck, NamesTheParticleBehindADifferentHash) {
  const Answer answer = crosscheck("state");
  EXPECT_EQ(answer.code, 1);
  std::smatch found;
  ASSERT_TRUE(std::regex_match(
      answer.out, found,
      std::regex(
          "mismatch: step 3, state hash: golden [0-9a-f]{16}, rtl [0-9a-f]{16}\n"
          "first difference: step 3, cell \\d+ \\(\\d \\d \\d\\), particle 17, v\\.y: golden (-?\\d+), "
          "rtl (-?\\d+)\n")))
      << answer.out;
  EXPECT_EQ(std::stoll(found[1]) ^ 1, std::stoll(found[2]));
}

TEST(Crosscheck, OfLatticeSharesItsBits) {
  EXPECT_EQ(crosscheck("", "golden,lattice").out, "matched 1280 updates over 5 steps in 2 engines\n");
  // The fake engine's cycles are made up; lattice counts the machine's, and they are compared.
  const Answer answer = crosscheck("", "lattice,systemc");
  EXPECT_EQ(answer.code, 1);
  EXPECT_TRUE(std::regex_match(
      answer.out, std::regex("mismatch: step 0, node 0 \\(cell 0 0 0\\), exchange_x \\w+: lattice \\d+, "
                             "systemc \\d+\n")))
      << answer.out;
  EXPECT_EQ(crosscheck("state", "lattice,rtl").code, 1);
}

TEST(Crosscheck, SaysWhereOnlyAHashIsWrong) {
  const Answer answer = crosscheck("hash");
  EXPECT_EQ(answer.code, 1);
  EXPECT_NE(answer.out.find(
                "first difference: the states of step 2 are equal when run again: one of the engines is "
                "not deterministic, or computes its hashes wrong\n"),
            std::string::npos)
      << answer.out;
}

TEST(Crosscheck, NamesThePhaseThatIsLate) {
  const Answer answer = crosscheck("cycles");
  EXPECT_EQ(answer.code, 1);
  EXPECT_EQ(answer.out, "mismatch: step 2, node 5 (cell 2 1 0), force end: systemc 239, rtl 240\n");
}

TEST(Crosscheck, NamesAnEngineThatStops) {
  const Answer answer = crosscheck("stop");
  EXPECT_EQ(answer.code, 1);
  EXPECT_EQ(answer.out,
            "mismatch: stop, fault: golden none, rtl sum of kicks out of width\n"
            "golden: not stopped\nrtl: stopped by the fake engine\n");
}

TEST(Crosscheck, NamesAnotherPlan) {
  const Answer answer = crosscheck("plan");
  EXPECT_EQ(answer.code, 1);
  EXPECT_TRUE(std::regex_match(answer.out,
                               std::regex("mismatch: plan hash: cuboct [0-9a-f]{16}, rtl [0-9a-f]{16}\n")))
      << answer.out;
}

TEST(Crosscheck, TellsAnEnginesFailureOnce) {
  Answer answer = crosscheck("refuse");
  EXPECT_EQ(answer.code, 2);
  EXPECT_EQ(answer.err, "refused by the fake engine\n");
  answer = crosscheck("crash");
  EXPECT_EQ(answer.code, 1);
  EXPECT_EQ(answer.err, "cuboct-rtl was ended by signal 6 (Aborted)\n");
  answer = crosscheck("nothing");
  EXPECT_EQ(answer.code, 1);
  EXPECT_EQ(answer.err, "cuboct-rtl ended with exit code 1\n");
}

}  // namespace
}  // namespace cuboct::test
