// SPDX-License-Identifier: MIT
#include "study/search/search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <set>

#include "tests/support/dice.h"

namespace cuboct::study {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

using Landscape = std::function<double(const Notches&)>;

// Counts what is asked for; a point that is asked for twice is a failure.
struct Asked {
  std::set<Notches> points;

  SearchSpace space(std::vector<int> sizes, Landscape error, Landscape cost) {
    const auto all = [this, error = std::move(error)](const std::vector<Notches>& wanted) {
      std::vector<double> errors;
      for (const Notches& p : wanted) {
        EXPECT_TRUE(points.insert(p).second);
        errors.push_back(error(p));
      }
      return errors;
    };
    return {std::move(sizes), all, std::move(cost), {}};
  }
};

// What each notch adds, summed over the axes.
Landscape sum_of(std::vector<std::vector<double>> terms) {
  return [terms = std::move(terms)](const Notches& p) {
    double sum = 0;
    for (size_t a = 0; a < p.size(); ++a) sum += terms[a].at(static_cast<size_t>(p[a]));
    return sum;
  };
}

// The definition of search.h, word by word.
double sum_at(const Landscape& error, const Notches& reference, const Notches& p) {
  double sum = std::abs(error(reference));
  Notches at = reference;
  for (size_t a = 0; a < p.size(); ++a) {
    double part = 0;
    for (int n = at[a]; n >= p[a]; --n) {
      Notches q = at;
      q[a] = n;
      const double change = std::abs(error(q) - error(at));
      part = std::isnan(change) ? kInfinity : std::max(part, change);
      if (std::isnan(change)) break;
    }
    sum += part;
    at[a] = p[a];
  }
  return sum;
}

void for_each_point(const std::vector<int>& sizes, const std::function<void(const Notches&)>& visit) {
  Notches p(sizes.size(), 0);
  while (true) {
    visit(p);
    size_t a = 0;
    while (a < p.size() && ++p[a] == sizes[a]) p[a++] = 0;
    if (a == p.size()) return;
  }
}

TEST(Search, TwoAxesByHand) {
  // Errors in per cent. (1,1): 0.1 + 0.4 + 0.2 = 0.7; (0,1) has 1.2, (1,0) has 1.1, both break 1.
  Asked asked;
  const auto space =
      asked.space({3, 3}, sum_of({{1.0, 0.5, 0.1}, {0.6, 0.2, 0.0}}), sum_of({{1, 2, 4}, {0.5, 2, 4}}));
  const SearchResult result = search(space, 1.0);
  ASSERT_TRUE(result.met);
  EXPECT_EQ(result.reference, (Notches{2, 2}));
  EXPECT_DOUBLE_EQ(result.reference_error, 0.1);
  EXPECT_EQ(result.best.at, (Notches{1, 1}));
  EXPECT_DOUBLE_EQ(result.best.error, 0.7);
  ASSERT_EQ(result.best.parts.size(), 2u);
  EXPECT_DOUBLE_EQ(result.best.parts[0], 0.4);
  EXPECT_DOUBLE_EQ(result.best.parts[1], 0.2);
  EXPECT_DOUBLE_EQ(result.best.sum, 0.7);
  EXPECT_DOUBLE_EQ(result.cost, 4);
  ASSERT_EQ(result.cheaper.size(), 2u);
  EXPECT_EQ(result.cheaper[0].axis, 0u);
  EXPECT_EQ(result.cheaper[0].spending.at, (Notches{0, 1}));
  EXPECT_DOUBLE_EQ(result.cheaper[0].spending.error, 1.2);
  EXPECT_EQ(result.cheaper[1].axis, 1u);
  EXPECT_DOUBLE_EQ(result.cheaper[1].spending.error, 1.1);
  EXPECT_EQ(result.measured, asked.points.size());
}

TEST(Search, ErrorsThatCancelDoNotCount) {
  // (0,0) is wrong by 0.1 in all, made of +2 and -1.9.
  Asked asked;
  const auto space = asked.space({2, 2}, sum_of({{2.0, 0}, {-1.9, 0}}), sum_of({{1, 2}, {1, 2}}));
  const SearchResult result = search(space, 1.0);
  ASSERT_TRUE(result.met);
  EXPECT_EQ(result.best.at, (Notches{1, 1}));
  // Nor do three of which any two leave more than the budget only together.
  Asked more;
  const auto three =
      more.space({2, 2, 2}, sum_of({{0.8, 0}, {-0.7, 0}, {0.6, 0}}), sum_of({{1, 9}, {1, 3}, {1, 2}}));
  const SearchResult one = search(three, 1.0);
  EXPECT_EQ(one.best.at, (Notches{0, 1, 1}));
  EXPECT_DOUBLE_EQ(one.best.error, 0.8);
  // The next cheaper ones are below the budget as measured, and told by their sum.
  ASSERT_EQ(one.cheaper.size(), 2u);
  EXPECT_NEAR(one.cheaper[0].spending.error, 0.1, 1e-12);
  EXPECT_NEAR(one.cheaper[0].spending.sum, 1.5, 1e-12);
}

TEST(Search, ANotchBelowABadOneIsAnAccident) {
  // The second notch from the left is a zero between +3 and -1.5.
  Asked asked;
  const auto space = asked.space({5}, sum_of({{3, 0.02, -1.5, -0.4, 0}}), sum_of({{1, 2, 3, 4, 5}}));
  const SearchResult result = search(space, 1.0);
  ASSERT_TRUE(result.met);
  EXPECT_EQ(result.best.at, (Notches{3}));
  ASSERT_EQ(result.cheaper.size(), 1u);
  EXPECT_DOUBLE_EQ(result.cheaper[0].spending.error, -1.5);
}

TEST(Search, LaterAxesAreJudgedWhereTheyRun) {
  // Few bits are bad with small steps only: at the finest step none but the widest format would do.
  const Landscape error = [](const Notches& p) {
    const double dt = std::pow(2.0, -p[0]), bits = 4.0 + 2 * p[1];
    return 0.5 * dt * dt + std::pow(2.0, -bits) / dt;
  };
  const auto cost = sum_of({{1, 2, 4, 8, 16, 32}, {0.1, 0.2, 0.3, 0.4, 0.5}});
  Asked asked;
  const SearchResult result = search(asked.space({6, 5}, error, cost), 0.2);
  ASSERT_TRUE(result.met);
  EXPECT_EQ(result.best.at[0], 1);
  // At dt = 1/2: 0.125 + 2^-bits * 2, which is 0.125 at 4 bits, too much, and 0.03 at 6.
  EXPECT_EQ(result.best.at[1], 1);
}

TEST(Search, AReferenceThatIsNotTheFinestPoint) {
  // U-shaped: the finest step alone misses the budget, the next one is well within, and so is that after it.
  Asked asked;
  const auto u = asked.space({5}, sum_of({{2, 0.8, 0.1, 0.3, 0.9}}), sum_of({{1, 2, 3, 4, 5}}));
  const SearchResult result = search(u, 1.0);
  ASSERT_TRUE(result.met);
  EXPECT_EQ(result.reference, (Notches{2}));
  EXPECT_EQ(result.best.at, (Notches{1}));
  EXPECT_DOUBLE_EQ(result.best.sum, 0.8);
  // A lone zero beside a finer notch that misses the budget is none.
  Asked zero;
  const SearchResult none =
      search(zero.space({4}, sum_of({{2, 1.7, 0.01, -1.6}}), sum_of({{1, 2, 3, 4}})), 1.0);
  EXPECT_FALSE(none.met);
  EXPECT_TRUE(none.accident);
  EXPECT_EQ(none.limit, 0);
  EXPECT_NEAR(none.limit_change, 1.69, 1e-12);
}

TEST(Search, AnImpossibleBudgetNamesWhatLimits) {
  Asked asked;
  const auto space =
      asked.space({3, 3}, sum_of({{9, 5, 3}, {1.2, 1.1, 1.0}}), sum_of({{1, 2, 3}, {1, 2, 3}}));
  const SearchResult result = search(space, 1.0);
  EXPECT_FALSE(result.met);
  EXPECT_FALSE(result.accident);
  EXPECT_EQ(result.best.at, (Notches{2, 2}));
  EXPECT_DOUBLE_EQ(result.best.error, 4);
  EXPECT_EQ(result.limit, 0);
  EXPECT_DOUBLE_EQ(result.limit_change, 2);
  EXPECT_TRUE(result.cheaper.empty());
  // The finest point and its neighbours, and nothing more.
  EXPECT_EQ(asked.points.size(), 3u);
}

TEST(Search, SettingsThatCannotRun) {
  // The cheapest of the second axis runs nowhere; with it goes its cost.
  Asked asked;
  const Landscape error = [](const Notches& p) { return p[1] == 0 ? kNan : 0.1 * (4 - p[0] - p[1]); };
  const Landscape cost = [](const Notches& p) { return p[1] == 0 ? kNan : 1.0 + p[0] + p[1]; };
  const SearchResult result = search(asked.space({3, 3}, error, cost), 1.0);
  ASSERT_TRUE(result.met);
  EXPECT_EQ(result.best.at, (Notches{0, 1}));
  ASSERT_EQ(result.cheaper.size(), 1u);
  EXPECT_TRUE(std::isnan(result.cheaper[0].spending.error));
  EXPECT_EQ(result.cheaper[0].spending.sum, kInfinity);
  // What has no cost is not chosen, whatever its error.
  Asked priceless;
  const SearchResult free =
      search(priceless.space({2}, sum_of({{0.2, 0.1}}), [](const Notches&) { return kNan; }), 1.0);
  EXPECT_FALSE(free.met);
  // Nothing runs at all.
  Asked nothing;
  const SearchResult none = search(nothing.space(
                                       {2, 2}, [](const Notches&) { return kNan; }, sum_of({{1, 2}, {1, 2}})),
                                   1.0);
  EXPECT_FALSE(none.met);
  EXPECT_EQ(none.limit, -1);
}

TEST(Search, OfEqualCostsTheLowerNotches) {
  Asked asked;
  const auto flat =
      asked.space({4, 4}, sum_of({{0.3, 0.2, 0.1, 0}, {9, 0.2, 0.1, 0}}), [](const Notches&) { return 1.0; });
  const SearchResult result = search(flat, 1.0);
  EXPECT_EQ(result.best.at, (Notches{0, 1}));
  ASSERT_EQ(result.cheaper.size(), 1u);
  // More nodes of one bound than are looked at together; the lowest notches, (10, 0, 0), come last.
  Asked wide;
  std::vector<double> most(12, 0.9), last(12, 0.5);
  most[10] = 0.1, most[11] = last[11] = 0;
  const SearchResult late = search(
      wide.space({12, 12, 2}, sum_of({most, last, {0.2, 0}}), [](const Notches&) { return 1.0; }), 1.0);
  EXPECT_EQ(late.best.at, (Notches{10, 0, 0}));
  // No axis, and axes of one notch.
  Asked none, one;
  EXPECT_TRUE(search(none.space({}, sum_of({}), [](const Notches&) { return 1.0; }), 1.0).met);
  const SearchResult lone = search(one.space({1, 1}, sum_of({{0.5}, {0.2}}), sum_of({{1}, {1}})), 1.0);
  EXPECT_TRUE(lone.met);
  EXPECT_TRUE(lone.cheaper.empty());
}

TEST(Search, AxesThatDoNotMatter) {
  // Bits (axis 1) matter to integers (axis 0 at 0) only, which miss the budget with any.
  Asked asked;
  const Landscape error = [](const Notches& p) { return p[0] == 1 ? 0.0 : 2.0 - 0.1 * p[1]; };
  auto space = asked.space({2, 3}, error, [](const Notches& p) { return p[0] == 1 ? 10.0 : 1.0 + p[1]; });
  space.finest_alike = [](const Notches& p) { return p[0] == 1 ? Notches{1, 2} : p; };
  const SearchResult result = search(space, 1.0);
  ASSERT_TRUE(result.met);
  EXPECT_EQ(result.best.at, (Notches{1, 2}));
  // Integers are told with their finest bits, not with those that happen to stand there.
  ASSERT_EQ(result.cheaper.size(), 1u);
  EXPECT_EQ(result.cheaper[0].spending.at, (Notches{0, 2}));
  EXPECT_DOUBLE_EQ(result.cheaper[0].spending.error, 1.8);
}

TEST(Search, NotchesOutOfOrder) {
  Asked asked;
  const auto space = asked.space({2, 3}, sum_of({{0.1, 0}, {0.2, 0.1, 0}}), sum_of({{1, 2}, {1, 3, 2}}));
  try {
    search(space, 1.0);
    FAIL();
  } catch (const NotchOrder& wrong) {
    EXPECT_EQ(wrong.axis, 1u);
    EXPECT_EQ(wrong.notch, 1);
    EXPECT_STREQ(wrong.what(), "notch 1 of axis 1 costs more than the one after it");
  }
}

// Against every point of random landscapes: interactions, accidents, holes, costs with ties.
TEST(Search, IsExactOnRandomLandscapes) {
  test::Dice dice(20);
  const auto real = [&dice](double low, double high) {
    return low + (high - low) * static_cast<double>(dice.bits(53)) * 0x1p-53;
  };
  int met = 0, unmet = 0, cancelled = 0, holes = 0, islands = 0, ties = 0, moved = 0;
  size_t asked_for = 0, points = 0;
  for (int round = 0; round < 400; ++round) {
    std::vector<int> sizes;
    const auto axes = static_cast<size_t>(dice.draw(1, 4));
    for (size_t a = 0; a < axes; ++a) sizes.push_back(dice.draw(1, 5));
    std::map<Notches, double> errors, costs;
    std::vector<std::vector<double>> terms(axes), prices(axes);
    for (size_t a = 0; a < axes; ++a) {
      double price = 1;
      for (int n = 0; n < sizes[a]; ++n) {
        terms[a].push_back(real(-1, 1) * std::pow(2.0, sizes[a] - n - 1) * 0.1);
        prices[a].push_back(price);
        price *= dice.draw(0, 3) == 0 ? 1.0 : real(1, 2.5);
      }
    }
    for_each_point(sizes, [&](const Notches& p) {
      double cost = 1;
      for (size_t a = 0; a < axes; ++a) cost *= prices[a][static_cast<size_t>(p[a])];
      costs[p] = cost;
      const bool hole = dice.draw(0, 19) == 0;
      errors[p] = hole ? kNan : sum_of(terms)(p) + real(-0.05, 0.05);
    });
    const Landscape error = [&](const Notches& p) { return errors.at(p); };
    const double budget = real(0.03, 0.4);
    Asked asked;
    const SearchResult result =
        search(asked.space(sizes, error, [&](const Notches& p) { return costs.at(p); }), budget);
    points += errors.size();
    asked_for += asked.points.size();
    if (!result.met) {
      ++unmet;
      EXPECT_TRUE(result.accident || !(std::abs(error(result.reference)) <= budget));
      continue;
    }
    ++met;
    Notches finest;
    for (const int size : sizes) finest.push_back(size - 1);
    moved += result.reference != finest;
    double least = kInfinity;
    for_each_point(sizes, [&](const Notches& p) {
      for (size_t a = 0; a < axes; ++a)
        if (p[a] > result.reference[a]) return;
      const double sum = sum_at(error, result.reference, p);
      if (sum <= budget) least = std::min(least, costs[p]);
      if (std::isnan(errors[p])) ++holes;
      if (std::abs(errors[p]) <= budget && sum > budget) ++cancelled;
      if (std::isfinite(sum)) {
        EXPECT_LE(std::abs(errors[p]), sum + 1e-12);
      }
    });
    EXPECT_DOUBLE_EQ(result.cost, least);
    EXPECT_DOUBLE_EQ(costs[result.best.at], least);
    EXPECT_NEAR(sum_at(error, result.reference, result.best.at), result.best.sum, 1e-12);
    EXPECT_LE(result.best.sum, budget);
    size_t cheaper = 0;
    for (size_t a = 0; a < axes; ++a) {
      if (result.best.at[a] == 0) continue;
      ASSERT_LT(cheaper, result.cheaper.size());
      const auto& c = result.cheaper[cheaper++];
      Notches p = result.best.at;
      --p[a];
      EXPECT_EQ(c.spending.at, p);
      EXPECT_GT(c.spending.sum, budget);
      EXPECT_GT(sum_at(error, result.reference, p), budget);
      if (std::abs(errors[p]) <= budget) ++islands;
      if (costs[p] == least) ++ties;
    }
    EXPECT_EQ(cheaper, result.cheaper.size());
  }
  EXPECT_GT(met, 100);
  EXPECT_GT(unmet, 50);
  EXPECT_GT(cancelled, 500);
  EXPECT_GT(holes, 100);
  EXPECT_GT(islands, 50);
  EXPECT_GT(ties, 30);
  EXPECT_GT(moved, 20);
  EXPECT_LT(asked_for, points);  // not by trying all
}

}  // namespace
}  // namespace cuboct::study
