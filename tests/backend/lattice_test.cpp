// SPDX-License-Identifier: MIT
// The lattice engine against golden: state, order of slots and faults at every step, on every vector unit of
// the machine, any number of threads, with and without quiescence.
#include <gtest/gtest.h>

#include "tests/backend/against_golden.h"

namespace cuboct::test {
namespace {

class Lattice : public testing::TestWithParam<std::string> {};

TEST_P(Lattice, EqualsGoldenAtEachStep) {
  const Case c = make_case(GetParam());
  Count count;
  for (const emu::LatticeOptions& v : variants(c.setup.plan)) compare(c, v, count);
  EXPECT_GT(count.updates, 0u);
}

INSTANTIATE_TEST_SUITE_P(Cases, Lattice, testing::ValuesIn(case_names()),
                         [](const auto& p) { return p.param; });

TEST(LatticeRandom, EqualsGolden) {
  Count count;
  int weighted = 0;
  for (uint64_t seed = 1; seed <= 300; ++seed) {
    const Case c = random_case(seed);
    weighted += c.setup.plan.rule.weighted;
    const auto all = variants(c.setup.plan);
    // Each seed meets the widest unit and one other variant.
    compare(c, all[seed % 8], count);
    compare(c, all[seed % all.size()], count);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(count.updates, 100000u);
  EXPECT_GT(count.kicks, 20000u);
  EXPECT_GT(count.moves, 500u);
  EXPECT_GT(count.faults, 0u);
  EXPECT_GT(weighted, 20);
  RecordProperty("updates", static_cast<int>(count.updates));
}

TEST(LatticeFaults, EachArisesAsInGolden) {
  Count count;
  size_t expected = 0;
  for (const Fault fault : all_faults()) {
    const Case c = fault_case(fault);
    for (const emu::LatticeOptions& v : variants(c.setup.plan)) {
      compare(c, v, count);
      ++expected;
    }
  }
  EXPECT_EQ(count.faults, expected);
}

}  // namespace
}  // namespace cuboct::test
