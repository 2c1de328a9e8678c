// SPDX-License-Identifier: MIT
// `cuboct explore STUDY --error E` as users meet it.
#include <gtest/gtest.h>

#include <sstream>
#include <vector>

#include "model/base/output.h"
#include "model/scene/scene.h"
#include "model/trace/figure.h"
#include "model/trace/trace.h"
#include "tests/cli/shell.h"
#include "tests/study/breathing_block.h"

namespace cuboct::test {
namespace {

constexpr const char* kStudy = R"(scene = "scene.toml"
samples = 60

[[figure]]
kind = "frequency"
name = "breath"
curve = "right.x"

[search]
dt_safety = [0.9, 0.3]
difference_frac = [8, 16]
index_bits = [6, 9]
)";

struct Studied {
  explicit Studied(const std::string& study = kStudy) : bench(false) {
    write_text(bench.path("scene.toml"), std::string(kBreathing));
    write_text(bench.path("study.toml"), study);
  }
  Answer explore(const std::vector<std::string>& more) const {
    std::vector<std::string> words{
        "explore", bench.path("study.toml"), "--out", bench.path("results"), "--jobs", "2"};
    words.insert(words.end(), more.begin(), more.end());
    return bench.cuboct(words);
  }
  Bench bench;
};

TEST(ErrorBudget, WrongQuestionsAreToldBeforeAnythingRuns) {
  const Studied s;
  const auto expect = [&](const std::vector<std::string>& words, const std::string& text) {
    const Answer answer = s.explore(words);
    EXPECT_EQ(answer.code, 2);
    EXPECT_EQ(answer.out, "");
    EXPECT_EQ(answer.err, text);
  };
  expect({"--error", "little"},
         "'little' is no error\n  hint: a percentage or a share: --error 1% or --error 0.01\n");
  expect({"--error", "1"},
         "an error of '1' is out of range: above 0 and below 100%\n  hint: did you mean '1%'?\n");
  expect({"--error", "1%", "--figure", "breadth"},
         s.bench.path("study.toml") + ": no figure 'breadth'\n  hint: did you mean 'breath'?\n");
  expect({"--figure", "breath"}, "--figure names the figure of --error E\n");
  std::string without = kStudy;
  without = without.substr(0, without.find("[search]")) + "[[sweep]]\ndt_safety = 0.3\n";
  const Answer answer = Studied(without).explore({"--error", "1%"});
  EXPECT_EQ(answer.code, 2);
  EXPECT_NE(answer.err.find(": no [search] to choose from\n  hint: list settings from cheap to dear, e.g. "),
            std::string::npos)
      << answer.err;
}

TEST(ErrorBudget, CannotBeKept) {
  const Answer answer = Studied().explore({"--error", "0.02%"});
  EXPECT_EQ(answer.code, 1) << answer.err;
  EXPECT_NE(answer.out.find("no settings of [search] keep 'breath' within 0.02%\nthe best: "),
            std::string::npos)
      << answer.out;
  EXPECT_NE(answer.out.find("\nwhat limits is "), std::string::npos) << answer.out;
}

// What is written, run by `cuboct run`, has the figure that was told.
TEST(ErrorBudget, TheChosenFilesRun) {
  const Studied s;
  const Answer answer = s.explore({"--error", "5%"});
  ASSERT_EQ(answer.code, 0) << answer.err << answer.out;
  EXPECT_EQ(answer.err, "");
  double told = 0, truth = 0;
  const auto number_after = [&](const std::string& words, double& number) {
    const size_t at = answer.out.find(words);
    ASSERT_NE(at, std::string::npos) << answer.out;
    std::istringstream(answer.out.substr(at + words.size())) >> number;
  };
  number_after("as measured: ", told);
  number_after("figure 'breath': ", truth);
  EXPECT_NEAR(told, truth, 0.05 * truth);
  const std::string out = s.bench.path("results");
  EXPECT_NE(answer.out.find("cuboct run " + out + "/cheapest.toml --arch " + out + "/cheapest_arch.toml\n"),
            std::string::npos);
  const Answer run =
      s.bench.cuboct({"run", out + "/cheapest.toml", "--arch", out + "/cheapest_arch.toml", "--out",
                      s.bench.path("run"), "--no-watch"});  // which warns of formats with few units
  ASSERT_EQ(run.code, 0) << run.err;
  const Trace trace = read_trace(s.bench.path("run") + "/trace.h5");
  Figure figure;
  figure.kind = Figure::Kind::frequency;
  figure.curve = "right.x";
  // The engine of `run` starts with v(0) where the study starts with v(-dt/2): another amplitude, the same
  // law, which is not quite linear.
  EXPECT_NEAR(value_of(figure, trace.curves, read_scene(out + "/cheapest.toml").rule.dt), told, 2e-3 * told);
  EXPECT_NE(contents(out + "/cheapest.toml").find("# acetal"), std::string::npos);
  // Again: all is known, and the answer the same.
  EXPECT_EQ(s.explore({"--error", "5%"}).out, answer.out);
}

// Real numbers: the command names precision and integrator where they were chosen, and nothing else.
TEST(ErrorBudget, TheCommandNamesFloatsAndTheIntegrator) {
  std::string text = kStudy;
  text = text.substr(0, text.find("[search]")) + "[search]\ndt_safety = [0.9, 0.3]\n";
  const auto command = [&](const Studied& s) {
    const Answer answer = s.explore({"--error", "5%"});
    EXPECT_EQ(answer.code, 0) << answer.err << answer.out;
    const size_t at = answer.out.find("cuboct run ");
    return at == std::string::npos ? answer.out : answer.out.substr(at);
  };
  const Studied floats(text + "arithmetic = [\"float32\"]\nintegrator = [\"verlet\"]\n");
  const std::string scene = floats.bench.path("results") + "/cheapest.toml";
  EXPECT_EQ(command(floats),
            "cuboct run " + scene + " --engine reference --precision float --integrator verlet\n");
  EXPECT_EQ(
      floats.bench
          .cuboct({"run", scene, "--engine", "reference", "--precision", "float", "--integrator", "verlet"})
          .code,
      0);
  const Studied doubles(text + "arithmetic = [\"float64\"]\n");
  EXPECT_EQ(command(doubles),
            "cuboct run " + doubles.bench.path("results") + "/cheapest.toml --engine reference\n");
}

}  // namespace
}  // namespace cuboct::test
