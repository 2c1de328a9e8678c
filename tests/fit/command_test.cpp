// SPDX-License-Identifier: MIT
// `cuboct fit` as users meet it.
#include <nlohmann/json.hpp>

#include "tests/cli/shell.h"
#include "tests/fit/small_fit.h"

namespace cuboct::fit::test {
namespace {

using cuboct::test::Answer;
using cuboct::test::Bench;
using cuboct::test::contents;

class FitCommand : public SmallFit {
 protected:
  Answer run(const std::string& study, const std::string& out,
             const cuboct::test::Condition& interrupts = {}) const {
    return bench_.cuboct({"fit", study, "--out", path(out), "--json"}, interrupts);
  }
  const Bench bench_{false};
};

TEST_F(FitCommand, GoesOnAfterCtrlCAndLeavesALawThatEnginesTake) {
  const std::string study = this->study(data(), "generations = 2\n");
  const Answer whole = run(study, "whole");
  ASSERT_EQ(whole.code, 0) << whole.err;
  // Before the first evaluation, and behind some.
  for (const bool first : {true, false}) {
    const std::string kept = path("cut/evaluations.jsonl");
    const Answer cut = run(study, "cut", [&](pid_t program) {
      return cuboct::test::catches_interrupts(program) && (first || std::filesystem::exists(kept));
    });
    EXPECT_EQ(cut.code, 1) << cut.err;
    EXPECT_EQ(nlohmann::json::parse(cut.err)["error"]["message"],
              "interrupted; the same command goes on where it was");
  }
  const Answer cut = run(study, "cut");
  ASSERT_EQ(cut.code, 0) << cut.err;
  EXPECT_EQ(contents(path("cut/fitted.toml")), contents(path("whole/fitted.toml")));
  EXPECT_EQ(contents(path("cut/page.html")), contents(path("whole/page.html")));

  const nlohmann::json told = nlohmann::json::parse(whole.out);
  EXPECT_EQ(told["generations"], 2);
  EXPECT_EQ(told["evaluations"], 2 + 2 * 16 + kParameters);
  EXPECT_EQ(told["parameters"].size(), size_t{kParameters});
  EXPECT_GT(told["particle_steps"].get<double>(), 1e6);
  EXPECT_LT(told["error"].get<double>(), told["cheap_error"].get<double>());
  EXPECT_EQ(told["end"], "ended after its last generation");
  const Answer checked = bench_.cuboct({"check", path("whole/fitted.toml")});
  EXPECT_EQ(checked.code, 0) << checked.err;
  // Nothing is simulated again.
  const std::string before = contents(path("whole/evaluations.jsonl"));
  EXPECT_EQ(nlohmann::json::parse(run(study, "whole").out)["error"], told["error"]);
  EXPECT_EQ(contents(path("whole/evaluations.jsonl")), before);
}

TEST_F(FitCommand, RefusesBeforeItBegins) {
  const auto refused = [&](const std::string& study) {
    const Answer answer = bench_.cuboct({"fit", study, "--out", path("none")});
    EXPECT_EQ(answer.code, 2);
    EXPECT_FALSE(std::filesystem::exists(path("none")));
    std::string text = cuboct::test::without_excerpt(answer.err);
    for (size_t at; (at = text.find(path(""))) != std::string::npos;) text.erase(at, path("").size());
    return text;
  };
  const std::string curve = "strain = [0, 0.01, 0.06]\nstress = \"[0, 30, 60] MPa\"\n";
  EXPECT_EQ(refused(study(curve, "sample = 3\n")),
            "study.toml:10:1: unknown key 'sample'\n  hint: did you mean 'samples'?\n");
  EXPECT_EQ(refused(study(curve, "[bounds]\npull_2 = [0.5, 0.1]\n")),
            "study.toml:11:10: 'pull_2' takes [lowest, highest]\n");
  const auto with_top = [&](const std::string& top) {
    std::ofstream(path("top.toml")) << top << "[target]\n" << curve;
    return path("top.toml");
  };
  const std::string scenes = "scene = \"" CUBOCT_SOURCE_DIR "/scenes/";
  EXPECT_EQ(refused(with_top(scenes + "coupon.toml\"\ncurve = \"tension.strain\"\n")),
            "top.toml:2:9: the scene has no curve 'tension.strain' of stress\n  hint: did you mean "
            "'tension.stress'?\n");
  EXPECT_EQ(refused(with_top(scenes + "lj_block.toml\"\n")),
            "top.toml:1:9: the scene has no probe of the kind 'stress_strain'\n");
  EXPECT_EQ(refused(with_top(scenes + "studies/fit_bar_scene.toml\"\nengine = \"lattice\"\n")),
            "top.toml:2:10: the lattice engine knows motion alone, but the scene's loading is static\n  "
            "hint: leave "
            "'engine' out, or say \"reference\"\n");
  EXPECT_EQ(refused(with_top(scenes + "none.toml\"\n")).substr(0, 37),
            "top.toml:1:9: 'scene' names no file: ");
}

}  // namespace
}  // namespace cuboct::fit::test
