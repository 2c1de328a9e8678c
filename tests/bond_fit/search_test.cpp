// SPDX-License-Identifier: MIT
#include "study/potential_fit/search.h"

#include "study/potential_fit/granular_search.h"
#include "tests/bond_fit/silicon_problem.h"

namespace cuboct::bond_fit::test {
namespace {

class Search : public SiliconFit {};

// From a start whose loss falls to nothing: 1e-10 is L-BFGS's own end. A quarter of the evaluations suffices
// where slopes are known.
TEST_F(Search, AllMethodsDescendAndSlopesSaveEvaluations) {
  const Problem problem = read_bond_study(study("starts = 1\n")).problem;
  const Point start = random_start(problem, 1, 122);
  const double before = loss_of(problem, parameters_at(problem, start));
  std::array<Found, 3> found;
  for (const Method method : {Method::lbfgs, Method::nelder_mead, Method::granular}) {
    Descent descent;
    Found& one = found[static_cast<size_t>(method)];
    one = descend(problem, method, start, 2000, 5, &descent);
    EXPECT_EQ(one.loss, loss_of(problem, parameters_at(problem, one.point))) << name_of(method);
    EXPECT_LE(one.evaluations, 2000);
    EXPECT_EQ(descent.loss.front(), before);
    EXPECT_EQ(descent.loss.back(), one.loss);
    EXPECT_TRUE(std::ranges::is_sorted(descent.loss, std::greater()));
    EXPECT_TRUE(std::ranges::is_sorted(descent.evaluation));
    EXPECT_LT(one.loss, 0.2 * before) << name_of(method);
    for (const double x : one.point) EXPECT_TRUE(x >= 0 && x <= 1);
  }
  EXPECT_LT(found[0].loss, 1e-6);
  EXPECT_LT(found[0].evaluations, 1000);
  EXPECT_GT(found[2].loss, 1e-4);
}

TEST_F(Search, StartsAreDrawnWithinTheBoundsAndHoldTogether) {
  const Problem problem = read_bond_study(study("starts = 1\n", "[bounds]\nB = [100, 100]\n")).problem;
  const Point a = random_start(problem, 3, 1);
  EXPECT_EQ(a, random_start(problem, 3, 1));
  EXPECT_NE(a, random_start(problem, 3, 2));
  EXPECT_NE(a, random_start(problem, 4, 1));
  EXPECT_LT(loss_of(problem, parameters_at(problem, a)), kNoLattice);
  EXPECT_EQ(parameters_at(problem, a)[1], 100);
}

// A bowl with its lowest point inside: within the finest grain, which is 2^-26.
TEST(GranularSearch, FindsTheLowestPointOfABowl) {
  const Point middle = {0.3, 0.9, 0.05};
  int calls = 0;
  double least = 1;
  granular_search(
      [&](const Point& point) {
        ++calls;
        double sum = 0;
        for (size_t k = 0; k < 3; ++k) sum += (1 + 9.0 * k) * (point[k] - middle[k]) * (point[k] - middle[k]);
        least = std::min(least, sum);
        return sum;
      },
      {0.5, 0.5, 0.5}, 100000, 1);
  EXPECT_LT(least, 1e-12);
  EXPECT_LT(calls, 5000);
}

TEST(GranularSearch, EndsAfterItsEvaluations) {
  int calls = 0;
  granular_search([&](const Point&) { return static_cast<double>(-(++calls)); }, {0.5, 0.5}, 50, 1);
  EXPECT_EQ(calls, 50);
}

}  // namespace
}  // namespace cuboct::bond_fit::test
