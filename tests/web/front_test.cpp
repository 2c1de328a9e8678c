// SPDX-License-Identifier: MIT
// The Pareto front and the table by decades: cases to check by hand, and brute force.
#include "study/search/front.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/dice.h"

namespace cuboct::test {
namespace {

using study::Cheapest, study::Outcome, study::Status;

constexpr double kNan = study::kNotMeasured;

Outcome point(double speed, double error, Status status = Status::done) {
  Outcome outcome;
  outcome.status = status;
  outcome.speed.simulated_seconds = speed;
  outcome.errors.trajectory = error;
  return outcome;
}

double trajectory(const Outcome& outcome) { return outcome.errors.trajectory; }

using Points = std::vector<size_t>;

TEST(ParetoFront, FromFastToExact) {
  const std::vector<Outcome> outcomes{
      point(1, 1e-6),    // 0: the most exact
      point(10, 1e-3),   // 1: the fastest
      point(5, 1e-2),    // 2: slower and worse than 1
      point(4, 1e-4),    // 3: between
      point(0.5, 1e-6),  // 4: as exact as 0, slower
      point(4, 2e-4),    // 5: as fast as 3, worse
  };
  EXPECT_EQ(study::pareto_front(outcomes, trajectory), (Points{1, 3, 0}));
}

TEST(ParetoFront, EqualPointsStandThereOnce) {
  EXPECT_EQ(study::pareto_front({point(2, 1e-3), point(3, 1e-2), point(2, 1e-3), point(3, 1e-2)}, trajectory),
            (Points{1, 0}));
}

TEST(ParetoFront, OnlyPointsThatAreDoneAndHaveBothNumbers) {
  EXPECT_EQ(study::pareto_front({point(9, 1e-9, Status::unstable), point(8, 1e-8, Status::refused),
                                 point(7, kNan), point(kNan, 1e-7), point(INFINITY, 1e-6), point(1, 1e-3)},
                                trajectory),
            (Points{5}));
  EXPECT_EQ(study::pareto_front({point(7, kNan)}, trajectory), Points{});
  EXPECT_EQ(study::pareto_front({}, trajectory), Points{});
}

TEST(ParetoFront, AnErrorOfNothingIsTheMostExact) {
  EXPECT_EQ(study::pareto_front({point(1, 0), point(2, 0), point(3, 1e-3)}, trajectory), (Points{2, 1}));
}

TEST(ParetoFront, ACostCountsWithAMinus) {
  std::vector<Outcome> outcomes{point(1, 1e-3), point(1, 1e-4), point(1, 1e-5)};
  outcomes[0].cost = 100, outcomes[1].cost = 50, outcomes[2].cost = 200;
  EXPECT_EQ(study::pareto_front(outcomes, trajectory, [](const Outcome& o) { return -o.cost; }),
            (Points{1, 2}));
}

// On a coarse grid of values, so that ties of one and of both numbers are common.
TEST(ParetoFront, IsWhatBruteForceFinds) {
  Dice dice(7);
  size_t ties = 0, sizes = 0;
  for (int trial = 0; trial < 300; ++trial) {
    std::vector<Outcome> outcomes;
    for (int n = dice.draw(1, 40); n > 0; --n)
      outcomes.push_back(point(dice.chance(5) ? kNan : dice.draw(1, 12),
                               dice.chance(5) ? kNan : std::pow(10.0, dice.draw(-9, 0)),
                               static_cast<Status>(dice.chance(80) ? 0 : dice.draw(1, 2))));
    const auto usable = [](const Outcome& o) {
      return o.status == Status::done && !std::isnan(trajectory(o)) && !std::isnan(o.speed.simulated_seconds);
    };
    Points expected;
    for (size_t n = 0; n < outcomes.size(); ++n) {
      if (!usable(outcomes[n])) continue;
      const double s = outcomes[n].speed.simulated_seconds, e = trajectory(outcomes[n]);
      bool beaten = false;
      for (size_t k = 0; k < outcomes.size(); ++k) {
        if (k == n || !usable(outcomes[k])) continue;
        const double t = outcomes[k].speed.simulated_seconds, f = trajectory(outcomes[k]);
        if (t == s && f == e) ++ties;
        beaten = beaten || (t >= s && f <= e && (t > s || f < e || k < n));
      }
      if (!beaten) expected.push_back(n);
    }
    Points front = study::pareto_front(outcomes, trajectory);
    for (size_t k = 1; k < front.size(); ++k) {
      EXPECT_LT(outcomes[front[k]].speed.simulated_seconds, outcomes[front[k - 1]].speed.simulated_seconds);
      EXPECT_LT(trajectory(outcomes[front[k]]), trajectory(outcomes[front[k - 1]]));
    }
    std::sort(front.begin(), front.end());
    EXPECT_EQ(front, expected) << "trial " << trial;
    sizes += front.size();
  }
  EXPECT_GT(ties, 500U);
  EXPECT_GT(sizes, 600U);
}

TEST(CheapestByDecade, FastestWithinEachDecade) {
  const std::vector<Outcome> outcomes{point(100, 3e-2),  // at most 10^-1
                                      point(80, 2e-3),   // at most 10^-2
                                      point(60, 1.5e-3),
                                      point(40, 1e-4),  // at most 10^-3 and, just, 10^-4
                                      point(20, 9e-7),  // at most 10^-5 and 10^-6
                                      point(90, kNan),
                                      point(95, 1e-7, Status::unstable),
                                      point(99, 1e-8, Status::refused)};
  EXPECT_EQ(study::cheapest_by_decade(outcomes, trajectory),
            (std::vector<Cheapest>{{-1, 0}, {-2, 1}, {-3, 3}, {-4, 3}, {-5, 4}, {-6, 4}}));
}

TEST(CheapestByDecade, WholePowersOfTenBelongToThemselves) {
  for (int e = -300; e <= 300; ++e) {
    const double error = std::pow(10.0, e);
    EXPECT_EQ(study::cheapest_by_decade({point(1, error)}, trajectory), (std::vector<Cheapest>{{e, 0}}));
    EXPECT_EQ(study::cheapest_by_decade({point(1, std::nextafter(error, INFINITY))}, trajectory),
              (std::vector<Cheapest>{{e + 1, 0}}));
  }
}

TEST(CheapestByDecade, AnErrorOfNothingHasItsOwnRow) {
  EXPECT_EQ(study::cheapest_by_decade({point(1, 0), point(2, 5e-3)}, trajectory),
            (std::vector<Cheapest>{{-2, 1}, {Cheapest::kExact, 0}}));
  EXPECT_EQ(study::cheapest_by_decade({point(2, 0), point(1, 5e-3)}, trajectory),
            (std::vector<Cheapest>{{Cheapest::kExact, 0}}));
  EXPECT_TRUE(study::cheapest_by_decade({point(1, kNan)}, trajectory).empty());
}

// Of equally fast points the more exact one, of equal ones the first.
TEST(CheapestByDecade, Ties) {
  EXPECT_EQ(study::cheapest_by_decade({point(2, 5e-3), point(2, 4e-3), point(2, 4e-3)}, trajectory),
            (std::vector<Cheapest>{{-2, 1}}));
}

}  // namespace
}  // namespace cuboct::test
