// SPDX-License-Identifier: MIT
// The search behind `cuboct emit --fit`: against all plans of small spaces, and its bound against the cycles.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <limits>
#include <map>
#include <optional>
#include <tuple>

#include "hw/cost/room_search.h"
#include "hw/plan/setup.h"
#include "tests/backend/bond_cases.h"
#include "tests/backend/rule_cases.h"
#include "tests/support/dice.h"

namespace cuboct {
namespace {

using test::Dice;

// A space of a few shapes with costs that know no order at all.
struct Drawn {
  struct Cost {
    FitAmounts uses{};
    uint64_t least = 0;
    std::optional<uint64_t> cycles;
  };

  explicit Drawn(uint64_t seed) {
    Dice dice(seed);
    space.most_lanes = dice.draw(1, 4);
    space.most_pipes = dice.draw(1, 4);
    for (int s = dice.draw(0, 5); s > 0; --s)
      space.shapes.push_back({{s, dice.draw(1, 3), 1}, static_cast<uint32_t>(dice.draw(1, 9))});
    for (uint64_t& r : room) r = static_cast<uint64_t>(dice.draw(0, 12) == 0 ? 0 : dice.draw(40, 100));
    for (const FitShape& s : space.shapes)
      for (int lanes = 1; lanes <= 4; ++lanes)
        for (int pipes = 1; pipes <= 4; ++pipes) {
          Cost c;
          for (uint64_t& u : c.uses) u = static_cast<uint64_t>(dice.chance(20) ? 0 : dice.draw(1, 110));
          c.least = static_cast<uint64_t>(dice.draw(1, 30));  // ties are common
          if (!dice.chance(15)) c.cycles = c.least + static_cast<uint64_t>(dice.draw(0, 12));
          costs[{s.brick, lanes, pipes}] = c;
        }
  }

  FitCosts callbacks() {
    const auto of = [this](const FitShape& s, int lanes, int pipes) -> const Cost& {
      EXPECT_TRUE(pipes <= lanes && lanes <= space.most_lanes && pipes <= space.most_pipes);
      return costs.at({s.brick, lanes, pipes});
    };
    return {[of](const FitShape& s, int l, int p) { return of(s, l, p).uses; },
            [of](const FitShape& s, int l, int p) { return of(s, l, p).least; },
            [of, this](const FitShape& s, int l, int p) {
              ++asked;
              return of(s, l, p).cycles;
            }};
  }

  // As the words say it: all plans, one after the other.
  std::optional<FitPoint> best(bool must_fit) const {
    using Rank = std::tuple<double, double, FitPoint>;
    std::optional<Rank> best;
    for (const FitShape& s : space.shapes)
      for (int lanes = 1; lanes <= space.most_lanes; ++lanes)
        for (int pipes = 1; pipes <= std::min(lanes, space.most_pipes); ++pipes) {
          const FitPoint at{s.brick, lanes, pipes};
          const Cost& c = costs.at(at);
          double share = 0;
          for (size_t r = 0; r < room.size(); ++r)
            if (c.uses[r] > 0)
              share =
                  std::max(share, room[r] > 0 ? static_cast<double>(c.uses[r]) / static_cast<double>(room[r])
                                              : std::numeric_limits<double>::infinity());
          if (!c.cycles || (must_fit && share > 1)) continue;
          const auto cycles = static_cast<double>(*c.cycles);
          const Rank rank = must_fit ? Rank{cycles, share, at} : Rank{share, cycles, at};
          if (!best || rank < *best) best = rank;
        }
    if (!best) return std::nullopt;
    return std::get<FitPoint>(*best);
  }

  FitSpace space;
  FitAmounts room{};
  std::map<FitPoint, Cost> costs;
  int asked = 0;
};

TEST(Fit, IsTheBestOfAllPlansThatFit) {
  int found = 0, none = 0, spared = 0;
  for (uint64_t seed = 0; seed < 3000; ++seed) {
    Drawn drawn(seed);
    const auto choice = fastest_that_fits(drawn.space, drawn.room, drawn.callbacks());
    const auto best = drawn.best(true);
    ASSERT_EQ(choice.has_value(), best.has_value()) << "seed " << seed;
    none += !choice;
    if (!choice) continue;
    ++found;
    ASSERT_EQ(choice->point, *best) << "seed " << seed;
    const Drawn::Cost& cost = drawn.costs.at(choice->point);
    EXPECT_EQ(choice->cycles, *cost.cycles);
    EXPECT_EQ(choice->uses, cost.uses);
    EXPECT_TRUE(has_room(choice->uses, drawn.room));
    const auto shape = std::ranges::find(drawn.space.shapes, choice->point.brick, &FitShape::brick);
    EXPECT_EQ(choice->nodes, shape->nodes);
    // Cycles are counted only where the bound leaves hope.
    int fit = 0;
    for (const auto& [at, c] : drawn.costs)
      fit += at.lanes <= drawn.space.most_lanes && at.pipes <= std::min(at.lanes, drawn.space.most_pipes) &&
             has_room(c.uses, drawn.room);
    spared += drawn.asked < fit;
  }
  EXPECT_GT(found, 300);
  EXPECT_GT(none, 300);
  EXPECT_GT(spared, 50);
}

TEST(Fit, NearestIsTheLeastWorstShare) {
  int found = 0;
  for (uint64_t seed = 0; seed < 1000; ++seed) {
    Drawn drawn(seed);
    const auto choice = nearest_to_fit(drawn.space, drawn.room, drawn.callbacks());
    const auto best = drawn.best(false);
    ASSERT_EQ(choice.has_value(), best.has_value()) << "seed " << seed;
    if (!choice) continue;
    ++found;
    ASSERT_EQ(choice->point, *best) << "seed " << seed;
  }
  EXPECT_GT(found, 500);
}

TEST(Fit, SharesOfWhatIsNotThere) {
  const FitAmounts room{100, 50, 0, 10, 200};
  EXPECT_EQ(worst_share({50, 25, 0, 6, 0}, room).share, 0.6);
  EXPECT_EQ(worst_share({50, 25, 0, 6, 0}, room).resource, 3u);
  EXPECT_EQ(worst_share({0, 0, 1, 0, 0}, room).share, std::numeric_limits<double>::infinity());
  EXPECT_TRUE(has_room({100, 50, 0, 10, 200}, room));
  EXPECT_FALSE(has_room({100, 50, 0, 11, 200}, room));
  EXPECT_FALSE(has_room({0, 0, 1, 0, 0}, room));
}

Lattice box_to_fit(const Cell& size, const Cell& period = {}) {
  std::vector<Cell> cells;
  for (int32_t z = 0; z < size[2]; ++z)
    for (int32_t y = 0; y < size[1]; ++y)
      for (int32_t x = 0; x < size[0]; ++x) cells.push_back({x, y, z});
  return Lattice(cells, period);
}

TEST(Fit, BricksOfABox) {
  const Lattice lattice = box_to_fit({3, 2, 1});
  const std::vector<Cell> bricks = possible_bricks(lattice);
  const std::vector<Cell> all{{1, 1, 1}, {2, 1, 1}, {1, 2, 1}, {3, 1, 1}, {2, 2, 1}, {3, 2, 1}};
  EXPECT_EQ(bricks, all);
  std::vector<uint32_t> counts;
  for (const Cell& b : bricks) counts.push_back(count_bricks(lattice, b));
  EXPECT_EQ(counts, (std::vector<uint32_t>{6, 4, 3, 2, 2, 1}));
  // No brick has more cells than a node serves.
  for (const Cell& b : possible_bricks(box_to_fit({20, 10, 10}))) EXPECT_LE(cells_of(b), 512u);
}

// The count that is cheap is that of the bricks themselves, for lattices with holes and rings too.
TEST(Fit, CountsBricksAsTheyAreCut) {
  Dice dice(1);
  int compared = 0;
  for (int k = 0; k < 40; ++k) {
    std::vector<Cell> cells;
    for (int n = dice.draw(1, 12); n > 0; --n)
      cells.push_back({dice.draw(-3, 4), dice.draw(-2, 3), dice.draw(0, 3)});
    const Lattice lattice = k % 4 == 0 ? box_to_fit({6, 4, 3}, {6, 0, 3}) : Lattice(cells, {});
    for (const Cell& brick : possible_bricks(lattice)) {
      if (cells_of(brick) == 1) continue;
      EXPECT_EQ(count_bricks(lattice, brick), Bricks(lattice, brick).size());
      ++compared;
    }
  }
  EXPECT_GT(compared, 500);
}

// Each pair of particles, one after the other.
TEST(Fit, TheCensusCountsAllPairs) {
  const cuboct::Setup setup = make_setup(read_scene(CUBOCT_SOURCE_DIR "/scenes/undamped_block.toml"), Arch());
  const Plan& plan = setup.plan;
  const PairCensus census(plan, setup.initial);
  std::map<std::pair<uint32_t, std::array<int8_t, 3>>, uint64_t> pairs;
  uint64_t all = 0, counted = 0, particles = 0;
  for (const Particle& i : setup.initial.particles)
    for (const Particle& j : setup.initial.particles) {
      std::array<int8_t, 3> offset{};
      Int3 x_j = visible(plan.rule, j.x);
      bool near = &i != &j;
      for (int a = 0; a < 3; ++a) {
        const int32_t apart = plan.lattice.cell(j.cell)[static_cast<size_t>(a)] -
                              plan.lattice.cell(i.cell)[static_cast<size_t>(a)];
        near = near && std::abs(apart) <= 1;
        offset[static_cast<size_t>(a)] = static_cast<int8_t>(apart);
        x_j[a] += int64_t{apart} << plan.rule.widths.position_frac;
      }
      if (!near || !may_interact(plan.rule, visible(plan.rule, i.x), x_j)) continue;
      ++pairs[{i.cell, offset}];
      ++all;
    }
  for (const auto& [where, count] : pairs) EXPECT_EQ(census.pairs(where.first, where.second), count);
  for (uint32_t n = 0; n < plan.lattice.size(); ++n)
    counted += census.pairs(n), particles += census.particles(n);
  EXPECT_EQ(counted, all);
  EXPECT_EQ(particles, plan.particles);
  EXPECT_GT(all, 2000u);
}

// A bound and the cycles of lanes and pipes, of the machine of one cell a node that `base` is.
struct Bounded {
  double tightest = 0;
  int compared = 0;

  void look(const cuboct::Setup& base, FitLoads& loads, const PairCensus& census, const Cell& brick,
            int lanes, int pipes) {
    Arch changed = base.plan.arch;
    changed.brick = brick;
    changed.filter_lanes = lanes;
    changed.force_pipes = pipes;
    const Plan plan = on_machine(base.plan, changed);
    const ExpectedCycles counted = expected_cycles(plan, base.initial);
    const ExpectedCycles same = expected_cycles(plan, census);
    EXPECT_EQ(same.step, counted.step);
    EXPECT_EQ(same.ideal, counted.ideal);
    const uint64_t least = loads.least_cycles(brick, lanes, pipes);
    EXPECT_LE(least, counted.step);
    EXPECT_GT(least, counted.ideal);
    tightest = std::max(tightest, static_cast<double>(least) / static_cast<double>(counted.step));
    ++compared;
  }
};

constexpr std::array kLanesAndPipes = {std::pair{1, 1}, std::pair{3, 1}, std::pair{8, 2}, std::pair{16, 8}};

TEST(Fit, TheBoundIsBelowTheCycles) {
  Bounded bounded;
  for (const char* name : {"undamped_block", "lj_block", "two_types"}) {
    const Scene scene = read_scene(CUBOCT_SOURCE_DIR "/scenes/" + std::string(name) + ".toml");
    for (const bool overlap : {true, false}) {
      Arch arch;
      arch.overlap = overlap;
      arch.filter_lanes = 1;
      const cuboct::Setup base = make_setup(scene, arch);
      const PairCensus census(base.plan, base.initial);
      FitLoads loads(base.plan, census);
      for (const Cell& brick : {Cell{1, 1, 1}, Cell{2, 1, 1}, Cell{2, 2, 2}, Cell{3, 3, 3}})
        for (const auto& [lanes, pipes] : kLanesAndPipes)
          bounded.look(base, loads, census, brick, lanes, pipes);
    }
  }
  EXPECT_EQ(bounded.compared, 96);
  EXPECT_GT(bounded.tightest, 0.95);
}

// Of a round, of four, of bonds.
TEST(Fit, TheBoundIsBelowTheCyclesOfRulesOfText) {
  Bounded bounded;
  for (const bool overlap : {true, false}) {
    Arch arch;
    arch.overlap = overlap;
    arch.filter_lanes = 1;
    for (const cuboct::Setup& base : {test::case_of("one", test::hot(test::kOneRound), arch, 1).setup,
                                      test::case_of("four", test::hot(test::kFourRounds), arch, 1).setup,
                                      test::BondedCase(test::kSprings, {}, arch).c.setup}) {
      const PairCensus census(base.plan, base.initial);
      FitLoads loads(base.plan, census);
      for (const auto& [lanes, pipes] : kLanesAndPipes)
        bounded.look(base, loads, census, {1, 1, 1}, lanes, pipes);
    }
  }
  EXPECT_EQ(bounded.compared, 24);
  EXPECT_GT(bounded.tightest, 0.8);
}

// Pairs of a bonded rule are its bonds, each from both ends.
TEST(Fit, TheCensusOfABondedRuleCountsBonds) {
  const cuboct::Setup setup = test::BondedCase(test::kSprings, {}, {}).c.setup;
  const PairCensus census(setup.plan, setup.initial);
  uint64_t pairs = 0;
  for (uint32_t n = 0; n < setup.plan.lattice.size(); ++n) pairs += census.pairs(n);
  EXPECT_EQ(pairs, setup.plan.program->rows->other.size());
  EXPECT_GT(pairs, 100U);
}

}  // namespace
}  // namespace cuboct
