// SPDX-License-Identifier: MIT
// `cuboct view --steer`: velocities that change on the way, and the scene that gives the same run again.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "model/trace/left_state.h"
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

std::string part(const std::string& out, int k) {
  return out + "/" + std::to_string(k) + "-part-" + std::to_string(k);
}

void expect_the_same_run(const std::string& a, const std::string& b, int parts) {
  for (int k = 1; k <= parts; ++k) {
    const Trace one = read_trace(part(a, k) + "/trace.h5"), other = read_trace(part(b, k) + "/trace.h5");
    EXPECT_EQ(one.plan_hash, other.plan_hash) << k;
    EXPECT_EQ(one.state_hash, other.state_hash) << k;
    EXPECT_FALSE(one.state_hash.empty());
    EXPECT_EQ(one.frames.back(), other.frames.back()) << k;
  }
}

// A steered coupon that obeys: what is asked for while it waits, by part. `done`: of the page's news.
struct Steered {
  const Bench& bench;
  std::string news{};
  size_t part = 0;
  bool paused = false;

  std::string post(const std::string& path) const { return ask(address(), path, "POST"); }
  Address address() const { return address_in(contents(bench.path("out"))); }
  // `change`: asked once in each part that begins, while the run waits; false: the run goes on alone.
  bool look(const std::function<bool(size_t part)>& change) {
    if (address().port == 0) return false;
    news = ask(address(), "news?frames=0&lines=0");
    if (has(news, "\"state\":\"ended\"")) return true;
    if (!paused && has(news, "\"part\":" + std::to_string(part + 1) + ",") &&
        has(post("command/pause"), " 204 ")) {
      paused = true;
      if (!change(++part)) part = 1000;
      EXPECT_TRUE(has(post("command/continue"), " 204 "));
      paused = false;
    }
    return false;
  }
};

// The first of a text of stages that follows the scene's.
std::string stages_in(const std::string& path) {
  const std::string text = contents(path);
  return text.substr(std::min(text.find("\n[[stage]]"), text.size()));
}

// The page changes a velocity in the midst of the run, then pulls particles; what they leave behind gives the
// same bits without a page.
TEST(Steer, AChangeIsAStageOfASceneThatGivesTheSameRun) {
  const Bench bench(false);
  const std::string out = bench.path("run"), again = bench.path("again");
  Steered run{bench};
  const Answer ran =
      bench.cuboct(with(kView, {"--steps", "6000", "--frame-every", "150", "--out", out}), [&](pid_t) {
        return run.look([&](size_t part) {
          if (part == 1) {
            EXPECT_TRUE(has(run.post("steer/velocity/0/1/x/0"), " 404 "));
            const std::string beyond = run.post("steer/velocity/7/1/0/0"),
                              held = run.post("steer/velocity/0/1e9/0/0");
            EXPECT_TRUE(has(beyond, " 400 ") && has(beyond, "there is no such constraint")) << beyond;
            EXPECT_TRUE(has(held, " 400 ") && has(held, "an imposed velocity is")) << held;
            EXPECT_TRUE(has(run.post("steer/velocity/0/-2.5/0/0"), " 204 "));
            EXPECT_TRUE(has(run.post("steer/gravity/0/0/-9.81"), " 204 "));
            EXPECT_TRUE(has(run.post("steer/damping/0.5/1"), " 404 "));
            EXPECT_TRUE(has(run.post("steer/damping/-1"), " 400 "));
          } else if (part == 2) {
            const std::string none = run.post("steer/pull/9999999/1e-3/0/0/0/5");
            EXPECT_TRUE(has(none, " 400 ") && has(none, "there is no such particle")) << none;
            EXPECT_TRUE(has(run.post("steer/pull/2000/1e-3/0/0/0/0"), " 400 "));
            EXPECT_TRUE(has(run.post("steer/pull/2000/1e-3/0/0/2e-4/2000"), " 204 "));
          } else {
            EXPECT_TRUE(has(run.post("steer/gravity/0/0/0"), " 204 "));
          }
          return part < 3;
        });
      });
  EXPECT_EQ(ran.code, 0) << ran.err;
  // The first three parts ended before their time, and the fourth when the hand let go.
  const std::string stages = stages_in(out + "/scene.toml");
  EXPECT_EQ(count(stages, "[[stage]]"), 5U) << stages;
  EXPECT_EQ(count(stages, "planned_steps = "), 3U) << stages;
  EXPECT_EQ(count(stages, "{ name = \"pulled\", velocity = \"[-2.5, 0, 0] m/s\" }"), 4U) << stages;
  EXPECT_EQ(count(stages, "{ name = \"hand\", kind = \"moved\", velocity = \"[0, 0, "), 2U) << stages;
  EXPECT_EQ(count(stages, "gravity = \"[0, 0, -9.8100000000000005] m/s^2\"\n"), 2U) << stages;
  size_t steps = 0, pulled = 0;
  for (int k = 1; k <= 5; ++k) {
    const Trace trace = read_trace(part(out, k) + "/trace.h5");
    steps += trace.steps();
    pulled += k == 3 || k == 4 ? trace.steps() : 0;
    EXPECT_EQ(std::string(trace.ended()), "finished") << k;
    EXPECT_TRUE(has(contents(part(out, k) + "/run.toml"), "state = 'finished'")) << k;
  }
  EXPECT_EQ(steps, 6000U);
  EXPECT_EQ(pulled, 2000U);
  EXPECT_TRUE(
      has(run.news, "\"first\":" + std::to_string(6000 - read_trace(part(out, 5) + "/trace.h5").steps())));

  // What the hand took hold of went its way, and what is far away did not.
  const auto height = [&](int k, size_t particle) {
    return read_left_state(part(out, k) + "/trace.h5").body.x[particle].z();
  };
  EXPECT_NEAR(height(4, 2000) - height(2, 2000), 2e-4, 1e-8);
  EXPECT_LT(std::abs(height(4, 0) - height(2, 0)), 2e-5);

  const Answer rerun =
      bench.cuboct({"run", out + "/scene.toml", "--frame-every", "150", "--quiet", "--out", again});
  EXPECT_EQ(rerun.code, 0) << rerun.err;
  expect_the_same_run(out, again, 5);
}

// A scene may have a constraint of the hand's own name, also one that holds.
TEST(Steer, TheHandTakesANameOfItsOwn) {
  const Bench bench(false);
  const std::string out = bench.path("run"), scene = bench.path("scene.toml");
  std::string text = contents(CUBOCT_SOURCE_DIR "/scenes/coupon.toml");
  const std::string fixed = "name = \"fixed\"";
  text.replace(text.find(fixed), fixed.size(), "name = \"hand\"");
  std::ofstream(scene) << text;
  std::string pulled;
  const Answer ran = bench.cuboct(
      {"view", scene, "--no-open", "--steer", "--steps", "1000000", "--frame-every", "100", "--out", out},
      [&](pid_t) {
        const Address at = address_in(contents(bench.path("out")));
        if (at.port == 0) return false;
        if (pulled.empty()) pulled = ask(at, "steer/pull/2000/1e-3/0/0/1e-5/100", "POST");
        const std::string news = ask(at, "news");
        if (!has(news, "\"part\":1,")) ask(at, "command/end", "POST");
        return has(news, "\"state\":\"ended\"");
      });
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_TRUE(has(pulled, " 204 ")) << pulled;
  EXPECT_TRUE(has(stages_in(out + "/scene.toml"), "{ name = \"hand-\", kind = \"moved\""));
}

// Without a change the run is that of the scene.
TEST(Steer, WithoutAChangeNothingChanges) {
  const Bench bench(false);
  const std::string out = bench.path("run");
  const Answer ran = bench.cuboct(with(kView, {"--steps", "100", "--out", out}), [&](pid_t) {
    return has(ask(address_in(contents(bench.path("out"))), "news"), "\"state\":\"ended\"");
  });
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(stages_in(out + "/scene.toml"), "\n[[stage]]\nname = \"part-1\"\nsteps = 100\n");
  EXPECT_EQ(read_trace(part(out, 1) + "/trace.h5").steps(), 100U);
  // Where something lies already nothing is written over it.
  const Answer second = bench.cuboct(with(kView, {"--steps", "100", "--out", out}));
  EXPECT_EQ(second.code, 2);
  EXPECT_TRUE(second.err.starts_with(out + " holds a scene.toml\n  hint: another --out keeps it"))
      << second.err;
}

// A page that ends the run ends it for good. What it did has its stage.
TEST(Steer, TheEndIsOfAllParts) {
  const Bench bench(false);
  const std::string out = bench.path("run");
  bool asked = false;
  const Answer ran =
      bench.cuboct(with(kView, {"--steps", "1000000", "--frame-every", "100", "--out", out}), [&](pid_t) {
        const Address at = address_in(contents(bench.path("out")));
        if (!asked) return asked = has(ask(at, "command/end", "POST"), " 204 "), false;
        return has(ask(at, "news"), "\"state\":\"ended\"");
      });
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_TRUE(has(contents(part(out, 1) + "/run.toml"), "state = 'interrupted'"));
  EXPECT_FALSE(fs::exists(part(out, 2)));
  const std::string steps = std::to_string(read_trace(part(out, 1) + "/trace.h5").steps());
  EXPECT_EQ(stages_in(out + "/scene.toml"),
            "\n[[stage]]\nname = \"part-1\"\nsteps = " + steps + "\nplanned_steps = 1000000\n");
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
    return refusal({"view", scene, "--no-open", "--steer", "--out", bench.path("run")});
  };
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
  EXPECT_EQ(refusal({"view", "scenes/coupon.toml", "--no-open", "--steer"}),
            "--steer needs --out DIR, where the scene of stages lies that the page makes\n");
}

}  // namespace
}  // namespace cuboct::test
