// SPDX-License-Identifier: MIT
#include "study/search/budget.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>

#include "cli/study/budget.h"
#include "hw/plan/setup.h"
#include "model/base/error.h"
#include "model/base/output.h"
#include "study/sweep/cost.h"
#include "tests/study/breathing_block.h"
#include "tests/support/folder.h"
#include "tests/support/refused_with.h"

namespace cuboct::study {
namespace {

namespace fs = std::filesystem;

constexpr const char* kArch = R"(name = "mine"  # my machine

[widths]
guard = 8  # as it was
)";
constexpr const char* kStudy = R"(scene = "scene.toml"
arch = "arch.toml"
samples = 60

[truth]
tolerance = 1e-4

[[figure]]
kind = "final"
name = "last"
curve = "right.x"

[[figure]]
kind = "frequency"
name = "breath"
curve = "right.x"

[search]
dt_safety = [0.9, 0.3, 0.1]
arithmetic = ["fixed", "float64"]
difference_frac = [8, 11, 16]
index_bits = [3, 6, 9]
)";

class Budget : public testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(dir_ / "scene.toml") << test::kBreathing;
    std::ofstream(dir_ / "arch.toml") << kArch;
  }

  Study study(const std::string& text = kStudy) const {
    std::ofstream(dir_ / "study.toml") << text;
    return read_study((dir_ / "study.toml").string());
  }
  Store store(const Study& study, const char* name = "search.db") const {
    return {(dir_ / name).string(), study};
  }
  BudgetQuestion question(double budget) const { return {1, budget, 2, false}; }

  const test::Folder folder_;
  const fs::path dir_ = folder_.path();
};

// The truth of kStudy, made once: it does not depend on where the files lie, nor on [search].
const Truth& truth_of(const Study& study) {
  static const Truth truth = make_truth(study, 2);
  return truth;
}

// The sum of parts of each point, out of runs of its own.
class AllPoints {
 public:
  AllPoints(const Study& study, const Truth& truth, const std::vector<Axis>& axes)
      : study_(study), truth_(truth), axes_(axes) {}

  double error(const Notches& at) {
    const auto [found, fresh] = errors_.try_emplace(at);
    if (fresh) {
      const double value = measure_figures(study_, truth_, settings_at(axes_, at)).errors.values[1];
      found->second = (value - truth_.figures[1]) / std::abs(truth_.figures[1]);
    }
    return found->second;
  }
  double sum(const Notches& p) {
    Notches at;
    for (const Axis& axis : axes_) at.push_back(static_cast<int>(axis.sets.size()) - 1);
    double sum = std::abs(error(at));
    for (size_t a = 0; a < p.size(); ++a) {
      double part = 0;
      for (int n = at[a]; n >= p[a]; --n) {
        Notches q = at;
        q[a] = n;
        const double change = std::abs(error(q) - error(at));
        part = std::isnan(change) ? std::numeric_limits<double>::infinity() : std::max(part, change);
      }
      sum += part;
      at[a] = p[a];
    }
    return sum;
  }

 private:
  const Study& study_;
  const Truth& truth_;
  const std::vector<Axis>& axes_;
  std::map<Notches, double> errors_;
};

TEST_F(Budget, IsTheCheapestOfAllPoints) {
  const Study s = study();
  const Truth& truth = truth_of(s);
  int answers = 0, cheaper = 0;
  double last_cost = std::numeric_limits<double>::infinity();
  for (const double budget : {0.002, 0.01, 0.05}) {
    Store memory = store(s, ("search" + std::to_string(budget)).c_str());
    const BudgetAnswer answer = keep_budget(s, truth, memory, question(budget));
    ASSERT_TRUE(answer.result.met) << budget;
    AllPoints all(s, truth, answer.axes);
    double least = std::numeric_limits<double>::infinity();
    for (int dt = 0; dt < 3; ++dt)
      for (int arithmetic = 0; arithmetic < 2; ++arithmetic)
        for (int d = 0; d < 3; ++d)
          for (int index = 0; index < 3; ++index) {
            const Notches p{dt, arithmetic, d, index};
            if (!(all.sum(p) <= budget)) continue;
            Case c = resolve(s.base, settings_at(answer.axes, p));
            c.scene.rule.dt = truth.grid.fitted(c.scene.rule.dt);
            least = std::min(least, cost_of(c));
          }
    EXPECT_DOUBLE_EQ(answer.chosen.cost, least);
    EXPECT_DOUBLE_EQ(answer.chosen.error, all.error(answer.result.best.at));
    EXPECT_LE(std::abs(answer.chosen.error), budget);
    for (const auto& c : answer.result.cheaper) {
      EXPECT_GT(all.sum(c.spending.at), budget);
      ++cheaper;
    }
    EXPECT_LE(answer.chosen.cost, last_cost);  // a larger budget never costs more
    last_cost = answer.chosen.cost;
    ++answers;
  }
  EXPECT_EQ(answers, 3);
  EXPECT_GT(cheaper, 3);
}

TEST_F(Budget, WrittenFilesAreTheRunThatWasMeasured) {
  const Study s = study();
  const Truth& truth = truth_of(s);
  Settings settings;
  settings.scene = {{"run.dt_safety", "0.7"}};
  settings.arch = {{"widths.difference_frac", "14"}, {"table.index_bits", "8"}};
  const Outcome outcome = measure_figures(s, truth, settings);
  const Written texts = written(s, truth, settings);
  std::ofstream(dir_ / "cheapest.toml") << texts.scene;
  std::ofstream(dir_ / "cheapest_arch.toml") << texts.arch;
  const Case c =
      resolve(read_base((dir_ / "cheapest.toml").string(), (dir_ / "cheapest_arch.toml").string()), {});
  EXPECT_EQ(c.scene.rule.dt, outcome.dt);
  EXPECT_EQ(c.scene.steps, outcome.steps);
  EXPECT_EQ(c.scene.probe_every * 60, c.scene.steps);
  EXPECT_NEAR(c.scene.rule.dt * static_cast<double>(c.scene.steps), truth.grid.duration(), 1e-15);
  EXPECT_NEAR(truth.grid.duration(), 24e-6, 0.04e-6);  // whole steps of the scene as it was
  EXPECT_EQ(c.arch.widths.difference_frac, 14);
  EXPECT_EQ(c.arch.table.index_bits, 8);
  for (const char* comment : {"# A small block.", "# acetal"})
    EXPECT_NE(texts.scene.find(comment), std::string::npos) << texts.scene;
  for (const char* comment : {"# my machine", "# as it was"})
    EXPECT_NE(texts.arch.find(comment), std::string::npos) << texts.arch;
  EXPECT_EQ(texts.scene.find("dt_safety"), std::string::npos);
  EXPECT_EQ(texts.scene.find("duration"), std::string::npos);
}

TEST_F(Budget, GoesOnFromItsStore) {
  const Study s = study();
  const Truth& truth = truth_of(s);
  Store memory = store(s);
  const BudgetAnswer first = keep_budget(s, truth, memory, question(0.01));
  ASSERT_TRUE(first.result.met);
  // A lie in the store about the chosen point shows that it is not run again.
  Outcome lie = *memory.errors(first.chosen.settings);
  lie.errors.values[1] *= 2;
  memory.put_errors(lie);
  const BudgetAnswer second = keep_budget(s, truth, memory, question(0.01));
  EXPECT_FALSE(second.chosen.settings == first.chosen.settings);
  // Errors have a sign, so that parts of either do not look alike.
  Outcome standard = *memory.errors(first.standard.settings);
  standard.errors.values[1] = 0.75 * truth.figures[1];
  memory.put_errors(standard);
  EXPECT_DOUBLE_EQ(keep_budget(s, truth, memory, question(0.01)).standard.error, -0.25);
}

TEST_F(Budget, WhatCannotBeKeptIsSaid) {
  std::string text = kStudy;
  text.replace(text.find("[0.9, 0.3, 0.1]"), 15, "[0.9, 0.6, 0.4]");
  const Study s = study(text);
  const Truth& truth = truth_of(s);
  BudgetOptions options{"0.05%", "breath", dir_.string(), 2};
  testing::internal::CaptureStdout();
  EXPECT_EQ(run_budget(s, truth, options, {}), 1);
  const std::string out = testing::internal::GetCapturedStdout();
  EXPECT_NE(out.find("no settings of [search] keep 'breath' within 0.05%\nthe best: "), std::string::npos)
      << out;
  EXPECT_NE(out.find(" with dt_safety 0.4, arithmetic float64\n"), std::string::npos) << out;
  EXPECT_NE(out.find("\nwhat limits is dt_safety: the notch next to it still changes the error by "),
            std::string::npos)
      << out;
  EXPECT_FALSE(fs::exists(dir_ / "cheapest.toml"));
}

TEST_F(Budget, TheReport) {
  const Study s = study();
  const Truth& truth = truth_of(s);
  testing::internal::CaptureStdout();
  EXPECT_EQ(run_budget(s, truth, {"5%", "breath", dir_.string(), 2}, {}), 0);
  const std::string out = testing::internal::GetCapturedStdout();
  for (const char* part :
       {"figure 'breath': ", " Hz by the truth\n", "the cheapest settings within 5%\n\nsetting ",
        "\ndt_safety ", "\nindex_bits ", "\nfinest settings ", "\nsum ", "\nas measured: ", "\ncost: ",
        "\ntime step: ", " of that of the study's own settings (", "/cheapest.toml --arch "})
    EXPECT_NE(out.find(part), std::string::npos) << part << "\n" << out;
  const std::string scene = read_text(dir_ / "cheapest.toml");
  EXPECT_EQ(scene.find("# Chosen by `cuboct explore "), 0u);
  EXPECT_NE(scene.find("--error 5% --figure breath`: "), std::string::npos);
  EXPECT_NO_THROW(read_base((dir_ / "cheapest.toml").string(), (dir_ / "cheapest_arch.toml").string()));
}

TEST_F(Budget, WrongQuestions) {
  const auto error = [](const char* text) { return refused_with([&] { read_error_budget(text); }); };
  for (const char* text : {"", "%", "abc", "1 %", "1%%", "nan", "inf", "0x1", "1e"})
    EXPECT_EQ(error(text), "'" + std::string(text) +
                               "' is no error\n  hint: a percentage or a share: --error 1% or --error 0.01");
  EXPECT_EQ(error("1"),
            "an error of '1' is out of range: above 0 and below 100%\n  hint: did you mean '1%'?");
  for (const char* text : {"0", "-1%", "100%", "2"})
    EXPECT_EQ(error(text), "an error of '" + std::string(text) +
                               "' is out of range: above 0 and below 100%\n  hint: a percentage or a share: "
                               "--error 1% or --error 0.01");
  EXPECT_DOUBLE_EQ(read_error_budget("1%"), 0.01);
  EXPECT_DOUBLE_EQ(read_error_budget("0.5%"), 0.005);
  EXPECT_DOUBLE_EQ(read_error_budget("1e-3"), 0.001);

  const Study s = study();
  EXPECT_EQ(refused_with([&] { figure_named(s, ""); }),
            s.path + ": which figure?\n  hint: --figure last or breath");
  EXPECT_EQ(refused_with([&] { figure_named(s, "breat"); }),
            s.path + ": no figure 'breat'\n  hint: did you mean 'breath'?");
  EXPECT_EQ(figure_named(s, "breath"), 1u);

  Truth truth;
  truth.grid = s.grid;
  truth.figures = {0.0, 1.0};
  truth.rungs.resize(2);
  truth.rungs[0].figures = {0.0, 0.98};
  truth.rungs[1].figures = {0.0, 1.0};
  Store memory = store(s);
  EXPECT_EQ(refused_with([&] {
              keep_budget(s, truth, memory, {0, 0.01, 1, false});
            }),
            s.path + ": the figure 'last' of the truth is 0: no relative error can be told");
  EXPECT_EQ(refused_with([&] { keep_budget(s, truth, memory, question(0.01)); }),
            s.path +
                ": the truth of 'breath' is known to 0.02 only, worse than the budget of 0.01\n"
                "  hint: a smaller 'tolerance' or more 'rungs' in [truth]");
  Study plain = s;
  plain.search.clear();
  EXPECT_EQ(refused_with([&] { check_budget(plain, "1%", "breath"); }),
            s.path +
                ": no [search] to choose from\n"
                "  hint: list settings from cheap to dear, e.g. [search] dt_safety = [0.8, 0.4, 0.2]");
}

TEST_F(Budget, NotchesOutOfOrder) {
  std::string text = kStudy;
  text.replace(text.find("[3, 6, 9]"), 9, "[3, 9, 6]");
  const Study s = study(text);
  const Truth& truth = truth_of(s);
  Store memory = store(s);
  EXPECT_EQ(refused_with([&] { keep_budget(s, truth, memory, question(0.05)); }),
            s.path +
                ":22:14: '9' of index_bits costs more than '6' after it\n"
                "  hint: notches go from cheap to dear");
}

}  // namespace
}  // namespace cuboct::study
