// SPDX-License-Identifier: MIT
#include "hw/cost/pair_work.h"

#include <gtest/gtest.h>

#include <string>

#include "hw/cost/node_area.h"
#include "hw/plan/setup.h"

namespace cuboct {
namespace {

Plan plan(const std::string& scene) {
  return plan_of(read_scene(CUBOCT_SOURCE_DIR "/scenes/" + scene + ".toml"), Arch{});
}

// P, D, entries and t of the plan, against cuboct_pipe: three squares, slope times t, three kicks.
TEST(PairWork, OfAnUndampedPairIsThatOfThePipe) {
  const Plan p = plan("undamped_block");
  const Widths& w = p.rule.widths;
  ASSERT_FALSE(p.rule.damped);
  ASSERT_EQ(p.rule.force.degree, 1);
  const int d = w.difference_frac + 1, force = value_bits(p.rule.force);
  const Work pair = datapath_work(p).pair;
  const std::vector<Product> products{
      {d, d, 3}, {w.strength_bits, p.rule.force.fraction_bits + 1, 1}, {force, d, 3}};
  EXPECT_EQ(pair.products, products);
  EXPECT_EQ(pair.bit_products(),
            3.0 * d * d + w.strength_bits * (p.rule.force.fraction_bits + 1) + 3.0 * force * d);
  ASSERT_EQ(pair.tables.size(), 1U);
  EXPECT_EQ(pair.tables[0], (TableWords{p.rule.force.c0.size(), 2 * w.strength_bits, 1}));
}

// A lane of B leading bits: three differences of B + 2, seven tests.
TEST(PairWork, ALaneTestsLeadingBits) {
  const Plan p = plan("undamped_block");
  const int B = p.rule.widths.filter_frac;
  ASSERT_LT(B, p.rule.widths.position_frac);
  EXPECT_EQ(datapath_work(p).lane.adder_bits, 3 * (B + 2) + 9 * (B + 3) + 3 * (B + 4));
  EXPECT_LT(datapath_work(p).lane.adder_bits, datapath_work(p, WorkOf::cost).lane.adder_bits);
}

TEST(PairWork, AFlatPlanHasNoThirdAxis) {
  const Plan flat = plan("sheet");
  ASSERT_EQ(flat.rule.axes, 2);
  const DatapathWork built = datapath_work(flat), cost = datapath_work(flat, WorkOf::cost);
  const int d = flat.rule.widths.difference_frac + 1;
  EXPECT_EQ(built.pair.products.front(), (Product{d, d, 2}));
  EXPECT_EQ(cost.pair.products.front(), (Product{d, d, 3}));
  EXPECT_LT(built.update.adder_bits, cost.update.adder_bits);
}

TEST(PairWork, DampingAndTypesAddTheirProducts) {
  const Work damped = datapath_work(plan("coupon")).pair, plain = datapath_work(plan("undamped_block")).pair;
  EXPECT_GT(damped.products.size(), plain.products.size());
  EXPECT_GT(damped.tables.size(), plain.tables.size());
  EXPECT_GT(damped.register_bits, plain.register_bits);
}

// Three registers hold a record of a halo while its distances and tests are made; operands of products wait
// in registers of their own.
TEST(PairWork, HalosOnArrivalAreCulled) {
  const Plan phases = plan("undamped_block");
  const Plan arrival = plan_of(read_scene(CUBOCT_SOURCE_DIR "/scenes/undamped_block.toml"),
                               read_arch(CUBOCT_SOURCE_DIR "/scenes/archs/solid.toml"));
  EXPECT_EQ(datapath_work(phases).cull.adder_bits, 0);
  const DatapathWork work = datapath_work(arrival);
  EXPECT_GE(work.cull.register_bits, 3 * arrival.words.halo_bits);
  double operands = 0;
  for (const Product& p : work.pair.products) operands += p.count * (p.a + p.b);
  EXPECT_EQ(work.pair.register_bits, datapath_work(phases).pair.register_bits + operands);
}

// Area by the same list: 34 transistors a bit product, 28 an adder's bit, 6 a bit of memory.
TEST(PairWork, AreaIsThatOfTheWork) {
  for (const char* scene : {"undamped_block", "coupon", "sheet", "two_types"}) {
    const Plan p = plan(scene);
    const DatapathWork w = datapath_work(p, WorkOf::cost);
    const NodeArea area = area_of(p);
    const int pipes = p.arch.force_pipes, lanes = p.arch.filter_lanes;
    EXPECT_EQ(area.multipliers, 34 * (pipes * w.pair.bit_products() + w.update.bit_products())) << scene;
    EXPECT_EQ(area.tables, 6 * pipes * w.pair.table_bits()) << scene;
    EXPECT_EQ(area.adders, 28 * (pipes * w.pair.adder_bits + lanes * w.lane.adder_bits + w.update.adder_bits))
        << scene;
  }
}

}  // namespace
}  // namespace cuboct
