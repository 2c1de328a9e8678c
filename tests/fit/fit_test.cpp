// SPDX-License-Identifier: MIT
#include "study/law_fit/fit.h"

#include "model/base/error.h"
#include "model/base/output.h"
#include "study/law_fit/curve_error.h"
#include "tests/fit/small_fit.h"
#include "tests/support/refused_with.h"

namespace cuboct::fit::test {
namespace {

TEST_F(SmallFit, RecoversTheLawThatMadeTheData) {
  const FitStudy study = read_fit(this->study(data(), "goal = 0.015\ngenerations = 40\n"));
  Evaluations evaluations(directory("out"), study);
  const Fit found = fit(study, evaluations);
  EXPECT_GT(found.cheap->error, 0.1);  // there was something to find
  EXPECT_LT(found.best->error, 0.02);
  // The error that is told is that of the law that is left.
  const Tested again =
      run_test(study.test, points_of(draw(parameters_of(study, found.best->sample), study.scale)));
  const std::vector<double> stress = first_passage(again.strain, again.stress, study.target.even_strain);
  EXPECT_EQ(curve_error(stress, study.target.even_stress), found.best->error);
  EXPECT_EQ(found.evaluations, 2 + 16 * found.best_errors.size() + kParameters);
  // A pull of 6 % sees the pull's beginning, and nothing of the push far below the pitch.
  ASSERT_EQ(found.free.size(), size_t{kParameters});
  EXPECT_LT(found.told.uncertainty[stiffness], 0.2);
  EXPECT_GE(found.told.uncertainty[push_top], kUnknown);
}

TEST_F(SmallFit, GoesOnAsIfItHadNotBeenCut) {
  const std::string target = data();
  const FitStudy whole = read_fit(study(target, "generations = 2\n"));
  Evaluations all(directory("whole"), whole);
  const Fit expected = fit(whole, all);
  ASSERT_EQ(expected.best_errors.size(), 2U);

  const FitStudy begun = read_fit(study(target, "generations = 1\n", "begun.toml"));
  {
    Evaluations first(directory("cut"), begun);
    fit(begun, first);
  }
  // As a process leaves it that ended within a generation: some of its samples are there.
  const std::string file = path("cut/evaluations.jsonl"), text = read_text(file);
  size_t end = text.size() - 1;
  for (int k = 0; k < 18; ++k) end = text.rfind('\n', end - 1);
  write_text(file, text.substr(0, end + 1));
  Evaluations rest(path("cut"), whole);
  ASSERT_EQ(rest.size(), 2 + 16 + kParameters - 18U);
  const Fit found = fit(whole, rest);
  EXPECT_EQ(found.errors, expected.errors);
  EXPECT_EQ(found.best->sample, expected.best->sample);
  EXPECT_EQ(found.told.uncertainty, expected.told.uncertainty);
  EXPECT_EQ(found.particle_steps, expected.particle_steps);
}

TEST_F(SmallFit, IsNotMixedWithAnother) {
  const std::string target = data();
  const FitStudy one = read_fit(study(target, "generations = 0\n"));
  Evaluations evaluations(directory("out"), one);
  const Fit start = fit(one, evaluations);  // of a search of no generation
  ASSERT_FALSE(start.notes.empty());
  EXPECT_NE(start.notes[0].find(" % off: perhaps no law"), std::string::npos);
  const FitStudy longer = read_fit(study(target, "generations = 9\ngoal = 0.5\n"));
  EXPECT_EQ(Evaluations(path("out"), longer).size(), evaluations.size());
  const FitStudy other = read_fit(study(target, "generations = 0\nseed = 2\n"));
  EXPECT_THROW(Evaluations(path("out"), other), InputError);
  // In our words, not in those of the library that reads it.
  const std::string file = path("out/evaluations.jsonl"), text = read_text(file);
  write_text(file,
             text.substr(0, text.find('\n') + 1) + "{\"free\": [1,\n" + text.substr(text.find('\n') + 1));
  EXPECT_EQ(refused_with([&] { Evaluations(path("out"), one); }),
            file +
                ": line 2 is none of its results\n  hint: it is damaged: take another --out DIR, "
                "or remove the file and begin again");
}

// The fixed rule and doubles, of the same start: they part by the rounding of the rule.
TEST_F(SmallFit, RunsInMotionOnEitherEngine) {
  const auto tested = [&](const std::string& engine) {
    const std::string file = path(engine + ".toml");
    std::ofstream(file) << "scene = \"" CUBOCT_SOURCE_DIR "/scenes/studies/fit_bar_scene.toml\"\nengine = \""
                        << engine
                        << "\"\nreach = 1.4142135\n[change.run]\nduration = \"0.2 ms\"\nstatic = false\n"
                        << "[target]\nstrain = [0, 0.005, 0.012]\nstress = \"[0, 15, 30] MPa\"\n";
    const FitStudy study = read_fit(file);
    const Tested tested = run_test(study.test, points_of(draw(study.start, study.scale)));
    EXPECT_EQ(tested.stop, "");
    EXPECT_GT(tested.particle_steps, 191U * 1000);
    return first_passage(tested.strain, tested.stress, study.target.even_strain);
  };
  const std::vector<double> fixed = tested("lattice"), doubles = tested("reference");
  EXPECT_GT(doubles.back(), 1e7);
  EXPECT_LT(curve_error(fixed, doubles), 0.01);
}

// Stresses in the wrong unit make a law so stiff that a run in motion has 1e9 steps; a static run has none.
TEST_F(SmallFit, WorkOfYearsIsRefusedBeforeItBegins) {
  const auto refusal = [&](const std::string& loading, const std::string& stress) -> std::string {
    const std::string file = path("stiff.toml");
    std::ofstream(file) << "scene = \"" CUBOCT_SOURCE_DIR "/scenes/studies/fit_bar_scene.toml\"\n"
                        << "reach = 1.4142135\n[change.run]\nstatic = " << loading
                        << "\n[target]\nstrain = [0, 0.01, 0.02, 0.05]\nstress = \"" << stress << "\"\n";
    return refused_with([&] { read_fit(file); });
  };
  const std::string far = refusal("false", "[0, 1e17, 2e17, 4e17] Pa");
  EXPECT_NE(
      far.find(
          "stiff.toml:5:1: a run of the scene with a law for this curve, whose modulus is 1e+19 Pa, takes "
          "1.71e+11 particle-steps: at most 1e+11 are made"),
      std::string::npos)
      << far;
  EXPECT_EQ(refusal("{ load_steps = 12, evaluations = 500 }", "[0, 1e17, 2e17, 4e17] Pa"), "accepted");
}

// A bar that breaks, one whose law is refused, and one that finds no rest have errors all the same.
TEST_F(SmallFit, LawsThatFailHaveAnError) {
  const FitStudy study = read_fit(this->study(data(), ""));
  Parameters p = study.start;
  p[pull_3] = p[pull_2] = 0.02, p[pull_2_force] = p[pull_3_force] = -0.5;
  const Tested weak = run_test(study.test, points_of(draw(p, study.scale)));
  EXPECT_FALSE(weak.refused);
  LawPoints none = points_of(draw(study.start, study.scale));
  for (double& f : none.f) f += 1;  // no force of 0 at the pitch
  const Tested refused = run_test(study.test, none);
  EXPECT_TRUE(refused.refused);
  EXPECT_NE(refused.stop.find("does not vanish"), std::string::npos) << refused.stop;
  FitStudy hasty = study;
  hasty.test.base.scene_text.replace(hasty.test.base.scene_text.find("evaluations = 500"), 17,
                                     "evaluations = 3");
  const Tested restless = run_test(hasty.test, points_of(draw(study.start, study.scale)));
  EXPECT_FALSE(restless.refused);
  EXPECT_NE(restless.stop.find("finds no rest"), std::string::npos) << restless.stop;
}

}  // namespace
}  // namespace cuboct::fit::test
