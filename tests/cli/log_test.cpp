// SPDX-License-Identifier: MIT
// What a run shows of itself on stderr while it goes.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>

#include "model/trace/trace.h"
#include "tests/cli/shell.h"

namespace cuboct::test {
namespace {

using Strings = std::vector<std::string>;

Strings words_of(const std::string& line) {
  std::istringstream in(line);
  Strings words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

struct Table {
  Strings names, lines;
  std::vector<std::map<std::string, std::string>> rows;  // by name
};

Table table_of(const std::string& err) {
  Table table;
  std::istringstream in(err);
  for (std::string line; std::getline(in, line);) table.lines.push_back(line);
  if (table.lines.size() < 2) return table;
  table.names = words_of(table.lines[0]);
  for (size_t k = 2; k < table.lines.size(); ++k) {
    const Strings words = words_of(table.lines[k]);
    EXPECT_EQ(words.size(), table.names.size()) << table.lines[k];
    auto& row = table.rows.emplace_back();
    for (size_t c = 0; c < std::min(words.size(), table.names.size()); ++c) row[table.names[c]] = words[c];
  }
  return table;
}

class Log : public testing::Test {
 protected:
  Answer run(const Strings& more) const {
    Strings all{"run", "scenes/coupon.toml", "--hash-every", "1"};
    all.insert(all.end(), more.begin(), more.end());
    return bench_.cuboct(all);
  }
  Bench bench_{true};
};

// Twenty parts of a run that is not on a terminal, each with the curves' values at its step.
TEST_F(Log, ARowHoldsWhatTheCurvesHold) {
#ifdef CUBOCT_SYSTEMC
  std::filesystem::remove(bench_.path("bin/cuboct-systemc"));
  std::filesystem::copy(CUBOCT_SYSTEMC, bench_.path("bin/cuboct-systemc"));
#endif
  // The scene reads its probes every 50 steps and its energies every 200: rows are at those.
  // Some rows stand where probes alone were read.
  struct Case {
    std::string engine, steps;
    int rows, sampled, probed_alone;
  };
  for (const auto& [engine, steps, rows, sampled, probed_alone] :
       {Case{"lattice", "2000", 21, 11, 10}, Case{"golden", "200", 21, 2, 3},
        Case{"systemc", "30", 21, 2, 0}}) {
    const Answer answer = run({"--engine", engine, "--steps", steps, "--out", bench_.path(engine), "--json"});
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_EQ(answer.out.front(), '{');
    const Table table = table_of(answer.err);
    const Trace trace = read_trace(bench_.path(engine) + "/trace.h5");
    EXPECT_EQ(table.names, (Strings{"step", "time", "steps/s", "left", "kinetic", "potential",
                                    "tension.strain", "tension.stress", "total"}));
    ASSERT_EQ(table.rows.size(), static_cast<size_t>(rows)) << answer.err;
    int compared = 0;
    for (const auto& row : table.rows)
      for (const Curve& curve : trace.curves) {
        const std::string name = curve.name.starts_with("energy.") ? curve.name.substr(7) : curve.name;
        const auto shown = row.find(name);
        const auto at = std::ranges::find(curve.step, std::stoull(row.at("step")));
        if (shown == row.end() || at == curve.step.end()) continue;
        EXPECT_EQ(shown->second,
                  fmt::format("{:.4g}", curve.value[static_cast<size_t>(at - curve.step.begin())]))
            << engine << " " << name << " at step " << *at;
        ++compared;
      }
    EXPECT_EQ(compared, 5 * sampled + 2 * probed_alone) << engine << answer.err;
    EXPECT_EQ(table.rows.back().at("step"), steps);
    EXPECT_EQ(table.rows.back().at("left"), "0:00:00");
    for (const std::string& line : table.lines) EXPECT_EQ(line.size(), table.lines[0].size()) << line;
  }
}

TEST_F(Log, ChangesNothingOfTheTrace) {
  const Answer quiet = run({"--quiet", "--steps", "200", "--cycles", "--out", bench_.path("quiet")});
  EXPECT_EQ(quiet.code, 0);
  EXPECT_EQ(quiet.err, "");
  const Answer loud = run({"--steps", "200", "--cycles", "--out", bench_.path("loud")});
  EXPECT_NE(loud.err, "");
  const Trace a = read_trace(bench_.path("quiet") + "/trace.h5"),
              b = read_trace(bench_.path("loud") + "/trace.h5");
  EXPECT_EQ(a.state_hash, b.state_hash);
  EXPECT_EQ(a.frames, b.frames);
  EXPECT_EQ(a.counters, b.counters);
  ASSERT_EQ(a.cycles.size(), b.cycles.size());
  ASSERT_EQ(a.curves.size(), b.curves.size());
  for (size_t k = 0; k < a.curves.size(); ++k) {
    EXPECT_EQ(a.curves[k].step, b.curves[k].step);
    EXPECT_EQ(a.curves[k].value, b.curves[k].value);
  }
}

TEST_F(Log, TellsEngineAndPlanWhereAsked) {
  const Answer answer = run({"--steps", "50", "--verbose", "--engine", "golden"});
  EXPECT_EQ(answer.code, 0);
  for (const char* text : {"engine                 golden, in this process\n", "  plan hash  ",
                           "  position_frac  ", "worst force error"})
    EXPECT_NE(answer.err.find(text), std::string::npos) << text << answer.err;
  EXPECT_EQ(run({"-v", "-q"}).code, 2);
}

// Rows of a run that is stopped: the last one is that of the last step.
TEST_F(Log, EndsWithTheLastStep) {
  const Answer answer = bench_.cuboct(
      {"run", "scenes/lj_block.toml", "--engine", "golden", "--steps", "100000000"}, bench_.table_begins());
  EXPECT_EQ(answer.code, 1);
  ASSERT_TRUE(answer.err.ends_with("\ninterrupted\n")) << answer.err;
  const Table table = table_of(answer.err.substr(0, answer.err.size() - 12));
  ASSERT_GE(table.rows.size(), 2u) << answer.err;
  EXPECT_NE(answer.out.find("after " + table.rows.back().at("step") + " of"), std::string::npos)
      << answer.out;
}

// On a terminal, of load steps: each is many evaluations of forces, so that a speed in steps says nothing.
TEST(TerminalLog, ALineOnATerminalCountsLoadStepsWithoutASpeed) {
  if (std::system("script --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "no script(1) for a terminal";
  const Bench bench(false);
  const std::string scene = bench.path("bar.toml"), seen = bench.path("seen");
  std::ofstream(scene) << R"(density = "1 g/cm^3"
[packing]
pitch = "1 mm"
[law]
kind = "elastic"
youngs_modulus = "1 MPa"
direction = "x"
[geometry]
shape = "box"
min = "[-1, -2, -2] mm"
max = "[20, 2, 2] mm"
[[constraint]]
name = "clamp"
kind = "held"
region = { shape = "half_space", normal = "x" }
[[constraint]]
name = "grip"
kind = "moved"
velocity = "[0.1, 0, 0] m/s"
region = { shape = "half_space", point = "[19, 0, 0] mm", normal = "-x" }
[run]
dt = "auto"
steps = 2000
static = { load_steps = 1000, tolerance = 0.001, evaluations = 1000 }
)";
  const std::string run =
      fmt::format("script -qec '{} run {}' /dev/null >{}", bench.path("bin/cuboct"), scene, seen);
  ASSERT_EQ(std::system(run.c_str()), 0);
  const std::string text = contents(seen);
  EXPECT_NE(text.find("reference, loading: step "), std::string::npos) << text;
  EXPECT_EQ(text.find("particle-steps"), std::string::npos) << text;
}

}  // namespace
}  // namespace cuboct::test
