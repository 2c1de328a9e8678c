// SPDX-License-Identifier: MIT
// Curves as comma-separated values.
#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>

#include "model/base/output.h"
#include "model/trace/curves_csv.h"
#include "model/trace/trace.h"
#include "tests/cli/refusal.h"

namespace cuboct::test {
namespace {

TEST(CurvesCsv, HasARowForEachStepAndRoundTripsValues) {
  const std::vector<Curve> curves{{"a,b", "m", {0, 2, 4}, {0.1, 1.0 / 3, -1e-300}},
                                  {"say \"x\"", "1", {0, 3}, {5, 6}},
                                  {"none", "N", {}, {}}};
  EXPECT_EQ(curves_csv(curves, 0.5),
            "step,time (s),\"a,b (m)\",\"say \"\"x\"\"\",none (N)\n"
            "0,0,0.1,5,\n2,1,0.3333333333333333,,\n3,1.5,,6,\n4,2,-1e-300,,\n");
  EXPECT_EQ(curves_csv({curves[1]}, 0.5, false), "step,time,\"say \"\"x\"\"\"\n0,0,5\n3,1.5,6\n");
  EXPECT_EQ(curves_csv({curves[0]}, {}, false).substr(0, 12), "step,\"a,b\"\n0");
  EXPECT_EQ(curves_csv({curves[1]}, {}), "step,\"say \"\"x\"\"\"\n0,5\n3,6\n");
}

class CurvesCommand : public testing::Test {
 protected:
  void run(const std::vector<std::string>& more) {
    std::vector<std::string> words{"run",   "scenes/rules/heat.toml", "--steps", "6",
                                   "--out", bench_.path("run")};
    words.insert(words.end(), more.begin(), more.end());
    const Answer answer = bench_.cuboct(words);
    ASSERT_EQ(answer.code, 0) << answer.err;
  }
  const Bench bench_{false};
};

// Each number is the trace's own.
TEST_F(CurvesCommand, WritesWhatTheTraceHolds) {
  run({"--csv"});
  const Trace trace = read_trace(bench_.path("run/trace.h5"));
  const Answer all = bench_.cuboct({"curves", bench_.path("run")});
  EXPECT_EQ(all.code, 0) << all.err;
  EXPECT_EQ(all.out, read_text(bench_.path("run/curves.csv")));
  EXPECT_TRUE(all.out.starts_with("step,time (s),left.T (K),right.T (K),energy.kinetic (J),")) << all.out;
  const Answer one = bench_.cuboct({"curves", bench_.path("run"), "--probe", "right,left.T"});
  std::istringstream lines(one.out);
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "step,time (s),right.T (K),left.T (K)");
  size_t k = 0;
  for (; std::getline(lines, line); ++k) {
    std::istringstream cells(line);
    double step = 0, time = 0, right = 0, left = 0;
    char comma = 0;
    cells >> step >> comma >> time >> comma >> right >> comma >> left;
    EXPECT_EQ(step, trace.curves[0].step.at(k));
    EXPECT_DOUBLE_EQ(time, 5e-3 * step);
    EXPECT_EQ(left, trace.curves[0].value.at(k));
    EXPECT_EQ(right, trace.curves[1].value.at(k));
  }
  EXPECT_EQ(k, trace.curves[0].step.size());
  EXPECT_EQ(bench_.cuboct({"curves", bench_.path("run"), "--probe", "right,left.T,left"}).out, one.out);
  const Answer file = bench_.cuboct({"curves", bench_.path("run"), "--out", bench_.path("c.csv")});
  EXPECT_EQ(file.out + read_text(bench_.path("c.csv")), all.out);
}

TEST_F(CurvesCommand, OfARunWithoutTheOptionGo) {
  run({"--csv"});
  run({});
  EXPECT_EQ(bench_.cuboct({"curves", bench_.path("run"), "--probe", "lift"}).err,
            "--probe: no curve 'lift'\n  hint: did you mean 'left'?\n");
  EXPECT_THROW(read_text(bench_.path("run/curves.csv")), std::runtime_error);
  EXPECT_EQ(bench_.cuboct({"run", "scenes/rules/heat.toml", "--csv"}).err.substr(0, 17), "--csv needs --out");
  EXPECT_EQ(bench_.cuboct({"curves", bench_.path("nothing")}).code, 2);
}

// A scene that has changed has another step; a run that was killed has no curves; load steps have no time.
TEST_F(CurvesCommand, KnowsItsRun) {
  const std::string scene = bench_.path("bar.toml"), out = bench_.path("bar");
  std::string text = read_text(CUBOCT_SOURCE_DIR "/scenes/rules/heat.toml");
  text.replace(text.find("texts/"), 6, CUBOCT_SOURCE_DIR "/scenes/rules/texts/");
  write_text(scene, text);
  ASSERT_EQ(bench_.cuboct({"run", scene, "--steps", "2", "--out", out}).code, 0);
  ASSERT_EQ(bench_.cuboct({"curves", out}).code, 0);
  std::string other = text;
  other.replace(other.find("\"5 ms\""), 6, "\"1 ms\"");
  write_text(scene, other);
  const Answer changed = bench_.cuboct({"curves", out});
  EXPECT_EQ(changed.code, 2);
  EXPECT_EQ(changed.out, "");
  EXPECT_NE(changed.err.find("was made by plan"), std::string::npos) << changed.err;
  std::filesystem::remove(out + "/trace.h5");
  EXPECT_EQ(bench_.cuboct({"curves", out}).err, out +
                                                    " holds no trace.h5: its run is 'finished'\n  hint: a "
                                                    "trace is there when the run has ended; --resume "
                                                    "goes on with one that kept a checkpoint\n");
}

}  // namespace
}  // namespace cuboct::test
