// SPDX-License-Identifier: MIT
#include "study/potential_fit/bond_fit.h"

#include <cmath>

#include "model/base/error.h"
#include "tests/bond_fit/silicon_problem.h"
#include "tests/cli/shell.h"

namespace cuboct::bond_fit::test {
namespace {

class BondFits : public SiliconFit {
 protected:
  BondFit run(const std::string& study, const std::string& out, int jobs) const {
    return run_bond_fit(read_bond_study(study), directory(out), {.jobs = jobs, .progress = false});
  }
};

void expect_equal(const BondFit& a, const BondFit& b) {
  ASSERT_EQ(a.starts.size(), b.starts.size());
  for (size_t k = 0; k < a.starts.size(); ++k) {
    EXPECT_EQ(a.starts[k].point, b.starts[k].point) << k;
    EXPECT_EQ(a.starts[k].loss, b.starts[k].loss) << k;
  }
  ASSERT_EQ(a.tried.size(), b.tried.size());
  for (size_t k = 0; k < a.tried.size(); ++k) {
    EXPECT_EQ(a.tried[k].start, b.tried[k].start);
    EXPECT_EQ(a.tried[k].endurance.hottest(), b.tried[k].endurance.hottest());
  }
  EXPECT_EQ(a.best, b.best);
}

// Threads, a file half of which is there, a file that is whole.
TEST_F(BondFits, AreTheSameHoweverTheyAreComputed) {
  const std::string study = this->study("from = \"si_erhart_albe\"\nstarts = 5\ntried = 2\nenough = 0.05\n");
  const BondFit whole = run(study, "whole", 1);
  ASSERT_EQ(whole.starts.size(), 6U);
  ASSERT_EQ(whole.tried.size(), 2U);
  expect_equal(whole, run(study, "threads", 3));
  const std::string kept = cuboct::test::contents(path("whole/starts.jsonl"));
  std::filesystem::create_directory(path("cut"));
  size_t end = 0;
  for (int line = 0; line < 4; ++line) end = kept.find('\n', end) + 1;
  std::ofstream(path("cut/starts.jsonl")) << kept.substr(0, end);
  expect_equal(whole, run(study, "cut", 2));
  EXPECT_EQ(cuboct::test::contents(path("cut/starts.jsonl")), kept);
  expect_equal(whole, run(study, "whole", 2));
  EXPECT_EQ(cuboct::test::contents(path("whole/starts.jsonl")), kept);
}

TEST_F(BondFits, KeepNoOtherStudysStarts) {
  run(study("from = \"si_erhart_albe\"\nstarts = 0\ntried = 1\n"), "one", 1);
  EXPECT_THROW(
      run(study("from = \"si_erhart_albe\"\nstarts = 0\ntried = 1\n", "[weights]\nB = 2\n"), "one", 1),
      InputError);
}

// A start near the truth of a target that is made by known parameters: all properties come back.
TEST_F(BondFits, FindParametersThatMadeTheTarget) {
  const TersoffTerm<double> made = tersoff_set("si_erhart_albe").terms[0];
  Problem problem = read_bond_study(study("starts = 1\n")).problem;
  problem.goal.value = diamond_properties(made, 5.429, false).value;
  TersoffFree off = free_of(made);
  for (size_t k = 0; k < kTersoffFree; ++k) off[k] *= k % 2 == 0 ? 1.04 : 0.97;
  const Point start = point_of(problem, off);
  ASSERT_GT(std::sqrt(squared_loss(problem, start, nullptr)), 0.1);
  const Found found = descend(problem, Method::lbfgs, start, 2000);
  EXPECT_LT(found.loss, 1e-4);
}

}  // namespace
}  // namespace cuboct::bond_fit::test
