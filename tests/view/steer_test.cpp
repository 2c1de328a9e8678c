// SPDX-License-Identifier: MIT
// `cuboct view --steer`: velocities that change on the way, and the scene that gives the same run again.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "model/trace/trace.h"
#include "tests/cli/shell.h"
#include "tests/view/page_client.h"

namespace cuboct::test {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kView{"view", "scenes/coupon.toml", "--no-open", "--steer"};

std::vector<std::string> with(std::vector<std::string> words, const std::vector<std::string>& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

size_t count(const std::string& text, const std::string& part) {
  size_t found = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

std::string part(const std::string& out, int k) {
  return out + "/" + std::to_string(k) + "-part-" + std::to_string(k);
}

void expect_the_same_run(const std::string& a, const std::string& b, int parts) {
  for (int k = 1; k <= parts; ++k) {
    const Trace one = read_trace(part(a, k) + "/trace.h5"), other = read_trace(part(b, k) + "/trace.h5");
    EXPECT_EQ(one.plan_hash, other.plan_hash) << k;
    EXPECT_EQ(one.state_hash, other.state_hash) << k;
    EXPECT_GT(one.state_hash.size(), 1U);
    EXPECT_EQ(one.frames.back(), other.frames.back()) << k;
  }
}

// The page changes the velocity while the first part waits; the run goes on to its end. The scene of stages
// that it leaves gives the same bits without a page.
TEST(Steer, AChangeIsAStageOfASceneThatGivesTheSameRun) {
  const Bench bench(false);
  const std::string out = bench.path("run"), again = bench.path("again");
  enum class Doing { begin, paused, on } doing = Doing::begin;
  std::string news, taken, wrong, beyond, held;
  const Answer ran =
      bench.cuboct(with(kView, {"4", "--steps", "1600", "--frame-every", "40", "--out", out}), [&](pid_t) {
        const Address at = address_in(contents(bench.path("out")));
        if (at.port == 0) return false;
        if (doing == Doing::begin && has(ask(at, "command/pause", "POST"), " 204 ")) doing = Doing::paused;
        if (doing == Doing::paused) {
          wrong = ask(at, "velocity/0/1/x/0", "POST");
          beyond = ask(at, "velocity/7/1/0/0", "POST");
          held = ask(at, "velocity/0/1e9/0/0", "POST");
          taken = ask(at, "velocity/0/-2.5/0/0", "POST");
          if (has(ask(at, "command/continue", "POST"), " 204 ")) doing = Doing::on;
        }
        news = ask(at, "news?frames=0&lines=0");
        return doing == Doing::on && has(news, "\"state\":\"ended\"");
      });
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_TRUE(has(wrong, " 404 ") && has(taken, " 204 ")) << wrong << taken;
  EXPECT_TRUE(has(beyond, " 400 ") && has(beyond, "there is no such constraint")) << beyond;
  EXPECT_TRUE(has(held, " 400 ") && has(held, "an imposed velocity is")) << held;
  const std::string scene = contents(out + "/scene.toml");
  EXPECT_EQ(count(scene, "[[stage]]"), 4U) << scene;
  const size_t changes =
      count(scene, "constraint = [{ name = \"pulled\", velocity = \"[-2.5, 0, 0] m/s\" }]");
  EXPECT_GE(changes, 1U);
  EXPECT_LT(changes, 4U);
  EXPECT_TRUE(has(news, "\"first\":1200")) << news.substr(0, 2000);

  const Answer rerun =
      bench.cuboct({"run", out + "/scene.toml", "--frame-every", "40", "--quiet", "--out", again});
  EXPECT_EQ(rerun.code, 0) << rerun.err;
  expect_the_same_run(out, again, 4);
  // The grip has turned back: its last place is not that of the run that nobody steered.
  const Answer plain =
      bench.cuboct({"run", "scenes/coupon.toml", "--steps", "1600", "--quiet", "--out", bench.path("plain")});
  ASSERT_EQ(plain.code, 0);
  EXPECT_NE(read_trace(bench.path("plain/trace.h5")).state_hash.back(),
            read_trace(part(out, 4) + "/trace.h5").state_hash.back());
}

// Without a change the parts are the run.
TEST(Steer, WithoutAChangeNothingChanges) {
  const Bench bench(false);
  const std::string out = bench.path("run");
  const Answer ran = bench.cuboct(with(kView, {"3", "--steps", "100", "--out", out}), [&](pid_t) {
    return has(ask(address_in(contents(bench.path("out"))), "news"), "\"state\":\"ended\"");
  });
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(count(contents(out + "/scene.toml"), "[[stage]]"), 3U);
  EXPECT_FALSE(has(contents(out + "/scene.toml"), "constraint = ["));
  EXPECT_EQ(read_trace(part(out, 3) + "/trace.h5").steps(), 32U);  // 34 + 34 + 32
  // Where something lies already nothing is written over it.
  const Answer second = bench.cuboct(with(kView, {"3", "--steps", "100", "--out", out}));
  EXPECT_EQ(second.code, 2);
  EXPECT_TRUE(second.err.starts_with(out + " holds a scene.toml\n  hint: another --out keeps it"))
      << second.err;
}

// A page that ends the run ends it for good.
TEST(Steer, TheEndIsOfAllParts) {
  const Bench bench(false);
  const std::string out = bench.path("run");
  bool asked = false;
  const Answer ran = bench.cuboct(
      with(kView, {"10", "--steps", "1000000", "--frame-every", "100", "--out", out}), [&](pid_t) {
        const Address at = address_in(contents(bench.path("out")));
        if (!asked) return asked = has(ask(at, "command/end", "POST"), " 204 "), false;
        return has(ask(at, "news"), "\"state\":\"ended\"");
      });
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_TRUE(has(contents(part(out, 1) + "/run.toml"), "state = 'interrupted'"));
  EXPECT_FALSE(fs::exists(part(out, 2)));
}

TEST(Steer, RefusesWhatItCannotSteer) {
  const Bench bench(false);
  const auto refusal = [&](const std::vector<std::string>& words) {
    const Answer answer = bench.cuboct(words);
    EXPECT_EQ(answer.code, 2);
    EXPECT_FALSE(fs::exists(bench.path("run")));
    return answer.err;
  };
  const auto of = [&](const std::string& scene) {
    return refusal({"view", scene, "--no-open", "--steer", "3", "--out", bench.path("run")});
  };
  EXPECT_EQ(
      of("scenes/lj_block.toml"),
      "--steer: scenes/lj_block.toml moves nothing\n  hint: a constraint of kind 'moved' has a velocity\n");
  const std::string text = contents(CUBOCT_SOURCE_DIR "/scenes/coupon.toml"),
                    until = bench.path("until.toml");
  const size_t run = text.find("[run]\n") + 6;
  std::ofstream(until) << text.substr(0, run) << "until = { probe = \"tension.strain\", above = 0.1 }\n"
                       << text.substr(run);
  EXPECT_EQ(of(until),
            "--steer: " + until + " ends by 'until'\n  hint: without it the run goes to its last step\n");
  EXPECT_EQ(of("scenes/rules/glass.toml"),
            "--steer: scenes/rules/glass.toml names files, which its copy in the run's directory would not "
            "find\n  hint: whole paths are found\n");
  EXPECT_EQ(refusal({"view", "scenes/coupon.toml", "--no-open", "--steer", "3"}),
            "--steer needs --out DIR, where the scene of stages lies that the page makes\n");
}

}  // namespace
}  // namespace cuboct::test
