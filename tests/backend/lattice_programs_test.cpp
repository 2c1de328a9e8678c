// SPDX-License-Identifier: MIT
// Programs on the lattice engine: the pair law as a program beside golden, on every case.
#include <gtest/gtest.h>

#include "tests/backend/against_golden.h"

namespace cuboct::test {
namespace {

// Threads and quiescence; there is one vector unit, the widest.
std::vector<emu::LatticeOptions> program_variants(emu::RuleCode code = emu::RuleCode::interpreted) {
  std::vector<emu::LatticeOptions> all;
  for (const int threads : {1, 2, 3, 5})
    for (const bool quiescence : {false, true})
      all.push_back({.threads = threads,
                     .quiescence = quiescence,
                     .simd = {},
                     .rule_code = code,
                     .code_directory = CUBOCT_RULE_CODE});
  return all;
}

// Formats wider than doubles are for other engines.
bool vectors_hold(const Case& c, Count& count) {
  try {
    const emu::LatticeEngine engine(c.setup.plan, 0, 0, {}, {});
    return true;
  } catch (const InputError&) {
    ++count.vectors;
    return false;
  }
}

class LatticeProgram : public testing::TestWithParam<std::string> {};

TEST_P(LatticeProgram, EqualsGoldenAtEachStep) {
  const Case c = as_program(make_case(GetParam()));
  Count count;
  if (!vectors_hold(c, count)) GTEST_SKIP() << "formats wider than doubles";
  for (const emu::LatticeOptions& v : {program_variants()[0], program_variants()[5]}) compare(c, v, count);
  EXPECT_GT(count.updates, 0u);
}

INSTANTIATE_TEST_SUITE_P(Cases, LatticeProgram, testing::ValuesIn(case_names()),
                         [](const auto& p) { return p.param; });

void compare_random(emu::RuleCode code) {
  Count count, wide;
  const std::vector<emu::LatticeOptions> all = program_variants(code);
  for (uint64_t seed = 1; seed <= 150; ++seed) {
    const Case c = as_program(random_case(seed));
    if (!vectors_hold(c, wide)) continue;
    compare(c, all[seed % all.size()], count);
    if (testing::Test::HasFatalFailure()) return;
  }
  EXPECT_LT(wide.vectors, 50u);
  EXPECT_GT(count.updates, 20000u);
  EXPECT_GT(count.ahead, count.updates / 4);
  EXPECT_GT(count.moves, 100u);
  EXPECT_GT(count.lists.quiet_node_steps, 0u);
}

TEST(LatticeProgramRandom, EqualsGolden) { compare_random(emu::RuleCode::interpreted); }

// Of the full tier: a compiler takes a second for each shape of a rule.
TEST(LatticeProgramCompiled, EqualsGoldenOnEachCase) {
  for (const std::string& name : case_names()) {
    const Case c = as_program(make_case(name));
    Count count;
    if (!vectors_hold(c, count)) continue;
    compare(c, program_variants(emu::RuleCode::compiled)[5], count);
    EXPECT_GT(count.updates, 0u);
  }
}
TEST(LatticeProgramCompiled, EqualsGoldenAtRandom) { compare_random(emu::RuleCode::compiled); }

TEST(LatticeProgramCompiled, EqualsGoldenOnEachVectorUnit) {
  const Case c = as_program(make_case("two_materials"));
  for (const char* simd : {"avx512", "avx2", "128-bit", "portable"}) {
    Count count;
    try {
      compare(c,
              {.threads = 2,
               .quiescence = true,
               .simd = simd,
               .rule_code = emu::RuleCode::compiled,
               .code_directory = CUBOCT_RULE_CODE},
              count);
    } catch (const InputError&) {
      continue;  // not on this machine
    }
    EXPECT_GT(count.updates, 0u) << simd;
  }
}

TEST(LatticeProgramFaults, EachArisesAsInGolden) {
  Count count, wide;
  size_t expected = 0;
  for (const Fault fault : all_faults()) {
    const Case c = as_program(fault_case(fault));
    if (!vectors_hold(c, wide)) continue;
    for (const emu::LatticeOptions& v : program_variants()) compare(c, v, count), ++expected;
    if (fault == Fault::sum || fault == Fault::velocity)
      compare(c, program_variants(emu::RuleCode::compiled)[3], count), ++expected;
  }
  EXPECT_GT(expected, 8 * all_faults().size() / 2);
  EXPECT_EQ(count.faults, expected);
}

}  // namespace
}  // namespace cuboct::test
