// SPDX-License-Identifier: MIT
// Every value lies in its proven interval, 64 bits lose nothing, and single operations reach their ends.
#include <gtest/gtest.h>

#include <functional>

#include "tests/graph/random_graph.h"
#include "tests/support/refused_with.h"

namespace cuboct::graph {
namespace {

using test::Dice;

constexpr size_t kLanes = 48;

TEST(RandomGraph, SixtyFourBitsAreEnoughAndEachValueIsInItsInterval) {
  std::map<Op, int> seen;
  for (uint64_t seed = 1; seed <= 400; ++seed) {
    const Graph graph = test::random_graph(seed, 40).graph;
    Block<int64_t> narrow(graph, kLanes);
    Block<Wide> wide(graph, kLanes);
    test::run_all(narrow, graph, seed, kLanes);
    test::run_all(wide, graph, seed, kLanes);
    for (int n = 0; n < static_cast<int>(graph.nodes.size()); ++n) {
      const Node& node = graph.nodes[static_cast<size_t>(n)];
      ++seen[node.op];
      for (size_t k = 0; k < kLanes; ++k) {
        const int64_t v = narrow.values(n)[k];
        ASSERT_TRUE(wide.values(n)[k] == v) << "seed " << seed << ", " << label(graph, n) << ", lane " << k;
        ASSERT_TRUE(node.range.holds(v)) << "seed " << seed << ", " << label(graph, n) << ": " << v
                                         << " beside [" << node.range.low << ", " << node.range.high << "]";
      }
    }
    ASSERT_EQ(narrow.faults().size(), wide.faults().size());
  }
  for (int op = 0; op <= static_cast<int>(Op::noise); ++op)
    EXPECT_GE(seen[static_cast<Op>(op)], 20) << to_string(static_cast<Op>(op));
}

constexpr int kAny = 1 << 20;

// Runs a graph of two inputs over all of their values, and compares the values of a node with its interval.
void expect_tight(const std::string& what, const std::function<int(Builder&, int, int)>& make, Interval a,
                  Interval b, int beyond = 0) {
  Builder builder;
  const int x = builder.input(Source::own_field, 0, 0, a), y = builder.input(Source::own_field, 1, 0, b);
  const int node = make(builder, x, y);
  const Graph graph = builder.take();
  const auto lanes = static_cast<size_t>((a.high - a.low + 1) * (b.high - b.low + 1));
  Block<int64_t> block(graph, lanes);
  size_t k = 0;
  for (int64_t p = a.low; p <= a.high; ++p)
    for (int64_t q = b.low; q <= b.high; ++q, ++k) block.values(x)[k] = p, block.values(y)[k] = q;
  block.run(needed_by(graph, {node}), lanes);
  const auto [low, high] = std::minmax_element(block.values(node), block.values(node) + lanes);
  const Interval range = graph.nodes[static_cast<size_t>(node)].range;
  EXPECT_LE(range.low, *low) << what;
  EXPECT_GE(range.high, *high) << what;
  EXPECT_GE(range.low + beyond, *low) << what << " of [" << a.low << ", " << a.high << "]";
  EXPECT_LE(range.high - beyond, *high) << what << " of [" << a.low << ", " << a.high << "]";
}

TEST(Interval, OfOneOperationIsReached) {
  const std::vector<std::pair<std::string, std::function<int(Builder&, int, int)>>> operations = {
      {"add", [](Builder& b, int x, int y) { return b.add(x, y); }},
      {"sub", [](Builder& b, int x, int y) { return b.sub(x, y); }},
      {"neg", [](Builder& b, int x, int) { return b.neg(x); }},
      {"shl", [](Builder& b, int x, int) { return b.shl(x, 3); }},
      {"round", [](Builder& b, int x, int) { return b.round(x, 2); }},
      {"floor", [](Builder& b, int x, int) { return b.floor(x, 2); }},
      {"mul", [](Builder& b, int x, int y) { return b.mul(x, y, 3); }},
      {"square", [](Builder& b, int x, int) { return b.mul(x, x); }},
      {"mac", [](Builder& b, int x, int y) { return b.mac(x, y, y, 1); }},
      {"dot",
       [](Builder& b, int x, int y) {
         return b.dot({x, y}, {x, y}, 1);
       }},
      {"lt", [](Builder& b, int x, int y) { return b.lt(x, y); }},
      {"le", [](Builder& b, int x, int y) { return b.le(x, y); }},
      {"eq", [](Builder& b, int x, int y) { return b.eq(x, y); }},
      {"min", [](Builder& b, int x, int y) { return b.min(x, y); }},
      {"max", [](Builder& b, int x, int y) { return b.max(x, y); }},
      {"abs", [](Builder& b, int x, int) { return b.abs(x); }},
      {"clamp",
       [](Builder& b, int x, int) {
         return b.clamp(x, {-3, 2});
       }},
      {"msb", [](Builder& b, int x, int) { return b.msb(x); }},
      {"shift", [](Builder& b, int x, int y) { return b.shift(x, y); }},
      {"check", [](Builder& b, int x, int) { return b.check(x, 4, Fault::strength); }},
      {"select", [](Builder& b, int x, int y) { return b.select(b.lt(x, y), x, y); }}};
  const std::vector<Interval> ranges = {{-16, 15}, {-7, 31}, {0, 20}, {3, 12}, {-12, -3}, {-1, 0}};
  for (const auto& [name, make] : operations)
    for (const Interval a : ranges)
      for (const Interval b : ranges)
        // Of x < y ? x : y the ends follow from both together; the hull knows each alone.
        expect_tight(name, make, a, b, name == "select" ? kAny : 0);
}

TEST(Interval, OfTablesIsReached) {
  for (uint64_t seed = 1; seed <= 200; ++seed) {
    Dice dice(seed);
    // The vertex of a parabola may lie between two of few arguments.
    const FixedTable table = test::random_table(dice);
    const int64_t most = std::min<int64_t>(domain_of(table).high, (1 << 14) - 1);
    const int64_t p = dice.draw(0, static_cast<int>(most)), q = dice.draw(0, static_cast<int>(most));
    expect_tight(
        "table of seed " + std::to_string(seed),
        [&](Builder& b, int x, int law) { return b.lookup(b.table(table), x, law); },
        {std::min(p, q), std::max(p, q)}, {0, laws_of(table) - 1}, table.degree == 2 ? kAny : 0);
  }
}

TEST(Interval, BeyondItsRoomIsRefusedWithBothEnds) {
  Builder b;
  const int x = b.named(b.input(Source::own_v, 0, 0, {-(int64_t{1} << 31), int64_t{1} << 31}), "v.x");
  const int y = b.mul(x, x, 2);
  EXPECT_EQ(refused_with([&] { b.mul(x, y); }),
            "mul of 'v.x', 'mul 1' reaches from -2475880078570760549798248448 to "
            "2475880078570760549798248448: before its rounding a product has 64 bits");
  EXPECT_EQ(refused_with([&] { b.shl(b.mul(x, x, 1), 10); }),
            "shl of 'mul 2' reaches from 0 to 2361183241434822606848: a value has 63 bits");
}

TEST(Builder, HasEachValueOnce) {
  Builder b;
  const int x = b.input(Source::own_v, 0, 0, {-9, 9}), y = b.input(Source::own_v, 0, 1, {-9, 9});
  EXPECT_EQ(b.add(x, y), b.add(y, x));
  EXPECT_EQ(b.dot({x, y}, {y, y}), b.dot({y, y}, {y, x}));
  EXPECT_EQ(b.mac(x, x, y, 1), b.mac(x, y, x, 1));
  EXPECT_EQ(b.mul(x, b.constant(8), 3), x);
  EXPECT_EQ(b.add(x, b.constant(0)), x);
  EXPECT_EQ(b.sub(x, x), b.constant(0));
  EXPECT_EQ(b.neg(b.neg(x)), x);
  EXPECT_EQ(b.check(x, 5, Fault::strength), x);
  EXPECT_NE(b.sub(x, y), b.sub(y, x));
  EXPECT_EQ(b.add(b.constant(2), b.constant(3)), b.constant(5));
}

TEST(Builder, KnowsWhatFollowsFromAPairThatCounts) {
  Builder b;
  std::vector<int> d, w;
  for (int a = 0; a < 3; ++a) {
    d.push_back(b.input(Source::apart, 0, a, {-1000, 1000}));
    w.push_back(b.input(Source::own_v, 0, a, {-100, 99}));
  }
  const int r2 = b.dot(d, d), wd = b.dot(w, d, 2);
  EXPECT_EQ(b.range(r2), (Interval{0, 3000000}));
  EXPECT_EQ(b.within(r2), r2);
  b.counts(b.lt(r2, b.constant(90001)));
  EXPECT_EQ(b.range(b.within(r2)), (Interval{0, 90000}));
  EXPECT_EQ(b.range(b.within(d[1])), (Interval{-300, 300}));
  EXPECT_EQ(b.range(b.within(wd)), (Interval{-12990, 12990}));  // sqrt(3) 100 300 / 4
  EXPECT_EQ(b.within(w[0]), w[0]);
  // Not a product with all of d.
  EXPECT_EQ(b.within(b.dot({w[0], w[1], w[2]}, {d[0], d[0], d[1]})),
            b.dot({w[0], w[1], w[2]}, {d[0], d[0], d[1]}));
}

TEST(Exactness, IsThatOfProductsAndValues) {
  Builder b;
  const int x = b.input(Source::own_v, 0, 0, {0, (1 << 26) - 1});
  b.mul(x, x, 20);
  EXPECT_TRUE(exactness_of(b.graph()).doubles);
  b.mul(b.add(x, x), b.add(x, x), 20);
  EXPECT_FALSE(exactness_of(b.graph()).doubles);
  EXPECT_EQ(exactness_of(b.graph()).worst, 3);
}

// Two products that cancel: their sum is small, but a double on the way does not hold the first.
TEST(Intervals, TellWhetherSumsOfProductsAreExactOnTheirWay) {
  constexpr int64_t kWide = int64_t{1} << 28;
  for (const int64_t wide : {kWide, kWide / 16}) {
    Builder b;
    const auto near = [&](int index, int64_t at) {
      return b.input(Source::own_field, index, 0, {at - 1, at + 1});
    };
    b.dot({near(0, wide), near(1, -wide)}, {near(2, wide), near(3, wide)}, 1);
    EXPECT_EQ(exactness_of(b.graph()).doubles, wide < kWide);
  }
}

}  // namespace
}  // namespace cuboct::graph
