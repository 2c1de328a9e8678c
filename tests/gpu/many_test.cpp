// SPDX-License-Identifier: MIT
// Many runs at once in one cuboct-gpu, here the one that computes on the host: each leaves what it leaves
// alone.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include "model/base/text.h"
#include "model/trace/trace_file.h"
#include "tests/cli/shell.h"

namespace cuboct {
namespace {

using test::Answer;
using test::contents;
using RunWords = std::vector<std::string>;

class GpuMany : public testing::Test {
 protected:
  GpuMany() { std::filesystem::copy(CUBOCT_GPU_HOST, bench_.path("cuboct-gpu")); }

  // In the root of the sources.
  Answer sh(const std::string& arguments, const std::string& input) const {
    std::ofstream(bench_.path("in")) << input;
    const std::string out = bench_.path("out"), err = bench_.path("err");
    const int status =
        std::system(fmt::format("cd {} && {} {} <{} >{} 2>{}", CUBOCT_SOURCE_DIR, bench_.path("cuboct-gpu"),
                                arguments, bench_.path("in"), out, err)
                        .c_str());
    return {WEXITSTATUS(status), contents(out), contents(err)};
  }
  // Exit codes by number of line.
  std::map<int, int> many(const std::vector<RunWords>& runs, int at_once, int code = 0) const {
    std::string input;
    for (const RunWords& words : runs) {
      input += '[';
      for (const std::string& word : words) input += toml_string(word) + ",";
      input += "]\n";
    }
    answer_ = sh(fmt::format("many --at-once {}", at_once), input);
    EXPECT_EQ(answer_.code, code) << answer_.err;
    std::map<int, int> codes;
    std::istringstream in(answer_.out);
    for (int number = 0, ended = 0; in >> number >> ended;) codes[number] = ended;
    return codes;
  }
  void alone(const RunWords& words, int code) const {
    std::string line;
    for (const std::string& word : words) line += shell_word(word) + " ";
    const Answer answer = sh(line, "");
    EXPECT_EQ(answer.code, code) << answer.err;
  }
  RunWords scene(const std::string& name, const RunWords& more, const std::string& out) const {
    RunWords words{name, "--out", bench_.path(out), "--frames", "0,7,40", "--energies"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

  test::Bench bench_{false};
  mutable Answer answer_;
};

void expect_same(const Trace& a, const Trace& b) {
  EXPECT_EQ(a.plan_hash, b.plan_hash);
  EXPECT_EQ(a.state_hash, b.state_hash);
  EXPECT_EQ(a.steps(), b.steps());
  EXPECT_EQ(a.frames, b.frames);
  ASSERT_EQ(a.bodies.size(), b.bodies.size());
  for (size_t k = 0; k < a.bodies.size(); ++k) {
    EXPECT_EQ(a.bodies[k].step, b.bodies[k].step);
    EXPECT_TRUE(a.bodies[k].x == b.bodies[k].x && a.bodies[k].v == b.bodies[k].v) << "state " << k;
  }
  ASSERT_EQ(a.curves.size(), b.curves.size());
  for (size_t k = 0; k < a.curves.size(); ++k) {
    EXPECT_EQ(a.curves[k].name, b.curves[k].name);
    EXPECT_EQ(a.curves[k].value, b.curves[k].value) << a.curves[k].name;
  }
  EXPECT_EQ(a.stop.has_value(), b.stop.has_value());
  if (a.stop && b.stop) {
    EXPECT_EQ(a.stop->text, b.stop->text);
  }
}

// One of them fails, and one is refused.
TEST_F(GpuMany, LeaveTheBitsOfEachAloneInAnyOrder) {
  const std::string block = "scenes/lj_block.toml", coupon = "scenes/coupon.toml";
  const std::vector<std::pair<std::string, RunWords>> kinds{
      {block, {"--steps", "40"}},
      {block, {"--steps", "40", "--precision", "float"}},
      {block, {"--steps", "40", "--precision", "double"}},
      {coupon, {"--steps", "20", "--precision", "float"}},
      {"scenes/failures/velocity.toml", {}},
      {"scenes/two_types.toml", {"--steps", "40"}},
      {block, {"--steps", "40", "--precision", "float", "--hash-every", "1"}},
  };
  const int codes[] = {0, 0, 0, 0, 1, 0, 2};
  std::vector<Trace> traces;
  for (size_t k = 0; k < kinds.size(); ++k) {
    alone(scene(kinds[k].first, kinds[k].second, fmt::format("alone{}.h5", k)), codes[k]);
    if (codes[k] < 2) traces.push_back(read_trace(bench_.path(fmt::format("alone{}.h5", k))));
  }
  EXPECT_EQ(traces[0].state_hash.size(), 41u);
  EXPECT_EQ(traces[1].bodies.size(), 3u);
  std::vector<size_t> order;
  for (size_t k = 0; k < 3 * kinds.size(); ++k) order.push_back(k % kinds.size());
  std::mt19937 random(1);
  constexpr int kAtOnce = 5;
  std::ranges::shuffle(order, random);
  std::vector<RunWords> runs;
  for (size_t k = 0; k < order.size(); ++k) {
    const auto& [name, more] = kinds[order[k]];
    runs.push_back(scene(name, more, fmt::format("many{}.h5", k)));
  }
  const std::map<int, int> ended = many(runs, kAtOnce);
  ASSERT_EQ(ended.size(), runs.size());
  for (size_t k = 0; k < order.size(); ++k) {
    EXPECT_EQ(ended.at(static_cast<int>(k) + 1), codes[order[k]]) << "run " << k;
    const std::string trace = bench_.path(fmt::format("many{}.h5", k));
    ASSERT_EQ(std::filesystem::exists(trace), codes[order[k]] < 2);
    if (codes[order[k]] == 2) continue;
    SCOPED_TRACE(fmt::format("run {} of {} at once: {}", k, kAtOnce, runs[k][0]));
    expect_same(read_trace(trace), traces[order[k]]);
    std::filesystem::remove(trace);
  }
}

TEST_F(GpuMany, TellErrorsWhereTheyAreAskedTo) {
  const std::string error = bench_.path("error");
  const std::map<int, int> ended = many({{"scenes/none.toml", "--out", bench_.path("t.h5"), "--error", error},
                                         {"--list"},
                                         {"scenes/lj_block.toml", "--bench", "--error", error + "2"},
                                         {"scenes/lj_block.toml", "--devices", "0,1", "--out", "t.h5"}},
                                        2);
  EXPECT_EQ(ended, (std::map<int, int>{{1, 2}, {2, 2}, {3, 2}, {4, 2}}));
  EXPECT_NE(contents(error).find("scenes/none.toml"), std::string::npos);
  EXPECT_NE(contents(error + "2").find("--bench is of a run by itself, not of one among many"),
            std::string::npos);
  for (const char* what : {"--list", "more than one device"})
    EXPECT_NE(answer_.err.find(std::string(what) + " is of a run by itself, not of one among many\n"),
              std::string::npos)
        << answer_.err;
}

TEST_F(GpuMany, ALineThatIsNoRunEndsThemAll) {
  const std::string hint = "\n  hint: a run is its words: [\"scene.toml\", \"--out\", \"trace.h5\"]\n";
  Answer answer = sh("many", "scenes/lj_block.toml --out t.h5\n");
  EXPECT_EQ(answer.code, 2);
  EXPECT_TRUE(answer.err.starts_with("line 1 of standard input: ") && answer.err.ends_with(hint))
      << answer.err;
  answer = sh("many", "[\"--list\", 3]\n");
  EXPECT_EQ(answer.code, 2);
  EXPECT_EQ(answer.err, "line 1 of standard input: a word is a string" + hint);
  EXPECT_EQ(sh("many", "").code, 0);
}

}  // namespace
}  // namespace cuboct
