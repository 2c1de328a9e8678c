// SPDX-License-Identifier: MIT
#include "model/graph/parity.h"

#include <gtest/gtest.h>

#include <array>

#include "tests/graph/random_graph.h"

namespace cuboct::graph {
namespace {

using test::Dice;

struct Pair {
  Builder b;
  int p = b.input(Source::own_field, 0, 0, {-99, 99}), q = b.input(Source::other_field, 0, 0, {-99, 99});
  int d = b.input(Source::apart, 0, 0, {-99, 99});
  int even = b.add(p, q), odd = b.sub(q, p), any = b.add(b.shl(p, 1), q);

  Parity of(int node) const { return parities_of(b.graph())[static_cast<size_t>(node)]; }
};

TEST(Parity, OfOneOperation) {
  Pair pair;
  Builder& b = pair.b;
  const int even = pair.even, odd = pair.odd, any = pair.any, d = pair.d, one = b.constant(1);
  const FixedTable table{.difference_frac = 2,
                         .index_bits = 2,
                         .fraction_bits = 2,
                         .c0 = {1, 5, 2, 7},
                         .c1 = {4, -3, 5, 0},
                         .c2 = {}};
  const int t = b.table(table), positive = b.clamp(odd, {0, 15});
  using P = Parity;
  const std::vector<std::tuple<std::string, int, Parity>> cases = {
      {"own", pair.p, P::none},
      {"even", even, P::even},
      {"odd", odd, P::odd},
      {"apart", d, P::odd},
      {"1", one, P::even},
      {"0", b.sub(b.sub(pair.p, pair.q), b.neg(odd)), P::zero},
      {"neg", b.neg(d), P::odd},
      {"shl", b.shl(odd, 3), P::odd},
      {"round", b.round(odd, 3), P::odd},
      {"floor of odd", b.floor(odd, 3), P::none},
      {"floor of even", b.floor(even, 3), P::even},
      {"odd odd", b.mul(odd, d, 2), P::even},
      {"even odd", b.mul(even, d, 2), P::odd},
      {"any odd", b.mul(any, d), P::none},
      {"square", b.mul(odd, odd), P::even},
      {"p q", b.mul(pair.p, pair.q, 4), P::even},
      {"mac odd", b.mac(d, even, odd, 2), P::odd},
      {"mac", b.mac(even, even, odd, 2), P::none},
      {"dot even", b.dot({pair.p, d}, {pair.q, odd}, 3), P::even},
      {"dot of each", b.dot({pair.p, pair.q}, {pair.p, pair.q}, 3), P::even},
      {"dot odd", b.dot({pair.p, pair.q}, {d, d}, 3), P::odd},
      {"lookup of even", b.lookup(t, b.clamp(even, {0, 3})), P::even},
      {"lookup of odd", b.lookup(t, positive), P::none},
      {"own < other", b.lt(pair.p, pair.q), P::none},
      {"even < 1", b.lt(even, one), P::even},
      {"odd < 1", b.lt(odd, one), P::none},
      {"p == q", b.eq(pair.p, pair.q), P::even},
      {"odd == even", b.eq(odd, even), P::none},
      {"p < q or q < p", b.either(b.lt(pair.p, pair.q), b.lt(pair.q, pair.p)), P::even},
      {"not p < q or not q < p", b.both(b.negate(b.lt(pair.p, pair.q)), b.le(pair.p, pair.q)), P::even},
      {"select even", b.select(b.lt(even, one), odd, d), P::odd},
      {"select own", b.select(b.lt(pair.p, pair.q), odd, d), P::none},
      {"min", b.min(pair.p, pair.q), P::even},
      {"min of odd", b.min(odd, b.neg(odd)), P::even},
      {"min of odds", b.min(odd, d), P::none},
      {"abs", b.abs(odd), P::even},
      {"symmetric clamp", b.clamp(odd, {-4, 4}), P::odd},
      {"clamp", b.clamp(odd, {-4, 5}), P::none},
      {"msb", b.msb(odd), P::none},
      {"msb of even", b.msb(even), P::even},
      {"align", b.align(odd, 4), P::none},
      {"shift", b.shift(odd, b.clamp(even, {-3, 3})), P::odd},
      {"shift by odd", b.shift(even, b.clamp(odd, {-3, 3})), P::none},
      {"check", b.check(odd, 4, Fault::strength), P::odd},
      {"check when own", b.check(odd, 4, Fault::strength, b.lt(pair.p, pair.q)), P::none},
      {"noise of both", b.noise(pair.p, pair.q, one, 5, 8), P::even},
      {"noise of own", b.noise(pair.p, one, one, 5, 8), P::none},
      {"symmetric types", b.input(Source::pair_constant, 0, 0, {1, 9}, 0, true), P::even},
      {"types", b.input(Source::pair_constant, 1, 0, {1, 9}), P::none},
      {"bond", b.input(Source::bond_field, 0, 0, {0, 1}), P::even}};
  for (const auto& [what, node, parity] : cases)
    EXPECT_STREQ(to_string(pair.of(node)), to_string(parity)) << what;
}

TEST(Parity, OfSumsInAnyOrder) {
  Pair pair;
  Builder& b = pair.b;
  const int x = b.mul(pair.p, pair.even, 1), y = b.mul(pair.q, pair.even, 1), z = b.constant(7);
  EXPECT_EQ(pair.of(b.add(b.add(z, x), y)), Parity::even);
  EXPECT_EQ(pair.of(b.mul(b.add(b.add(z, y), x), pair.d, 3)), Parity::odd);
  EXPECT_EQ(pair.of(b.add(b.add(z, x), x)), Parity::none);
  EXPECT_EQ(pair.of(b.sub(b.round(pair.p, 2), b.round(pair.q, 2))), Parity::odd);
}

// Evaluates a graph of fields p, q and apart with own and other swapped.
TEST(Parity, IsWhatSwappingShows) {
  size_t even = 0, odd = 0;
  for (uint64_t seed = 1; seed <= 300; ++seed) {
    const Graph graph = test::random_pair_graph(seed, 25);
    constexpr size_t kLanes = 32;
    Block<int64_t> as_is(graph, kLanes), swapped(graph, kLanes);
    std::vector<int> all;
    Dice dice(seed);
    std::map<std::pair<Source, int>, std::array<int64_t, kLanes>> values;
    for (int n = 0; n < static_cast<int>(graph.nodes.size()); ++n) {
      all.push_back(n);
      const Node& node = graph.nodes[static_cast<size_t>(n)];
      if (node.op != Op::input) continue;
      auto& drawn = values[{node.source, node.index}];
      for (size_t k = 0; k < kLanes; ++k)
        as_is.values(n)[k] = drawn[k] = test::random_value(dice, node.range);
    }
    for (int n : all) {
      const Node& node = graph.nodes[static_cast<size_t>(n)];
      if (node.op != Op::input) continue;
      const bool apart = node.source == Source::apart;
      const Source other = apart                              ? Source::apart
                           : node.source == Source::own_field ? Source::other_field
                                                              : Source::own_field;
      for (size_t k = 0; k < kLanes; ++k)
        swapped.values(n)[k] = (apart ? -1 : 1) * values.at({other, node.index})[k];
    }
    as_is.run(all, kLanes), swapped.run(all, kLanes);
    const std::vector<Parity> parities = parities_of(graph);
    for (int n : all) {
      const Parity parity = parities[static_cast<size_t>(n)];
      even += parity == Parity::even, odd += parity == Parity::odd;
      for (size_t k = 0; k < kLanes; ++k) {
        const int64_t here = as_is.values(n)[k], there = swapped.values(n)[k];
        ASSERT_TRUE(!is_even(parity) || here == there) << "seed " << seed << ", " << label(graph, n);
        ASSERT_TRUE(!is_odd(parity) || here == -there) << "seed " << seed << ", " << label(graph, n);
      }
    }
  }
  EXPECT_GT(even, 500u);
  EXPECT_GT(odd, 500u);
}

}  // namespace
}  // namespace cuboct::graph
