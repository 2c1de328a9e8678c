// SPDX-License-Identifier: MIT
// Programs on the lattice engine: the pair law as a program beside golden, on every case.
#include <gtest/gtest.h>

#include "model/contract/golden.h"
#include "model/contract/pair_program.h"
#include "model/program/integer_program.h"
#include "model/run/integer_engine.h"
#include "tests/backend/against_golden.h"
#include "tests/support/block.h"

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

std::string fault_told_by(const std::function<void()>& step) {
  try {
    step();
  } catch (const RunError& e) {
    return std::to_string(static_cast<int>(e.fault)) + " particle " + std::to_string(e.particle) +
           " number " + std::to_string(e.number);
  }
  return "none";
}

// The first step, interpreted and compiled, beside golden's.
void compare_first_fault(const Case& c, bool faults) {
  const Plan& plan = c.setup.plan;
  const auto& start = c.setup.initial.particles;
  GoldenIntegers golden(plan.program->program, plan.lattice, plan.arch.capacity, c.setup.initial, nullptr);
  const std::string expected = fault_told_by([&] { golden.advance(1, nullptr); });
  EXPECT_EQ(expected != "none", faults);
  for (const emu::RuleCode code : {emu::RuleCode::interpreted, emu::RuleCode::compiled}) {
    emu::LatticeOptions options{.threads = 1, .quiescence = false, .simd = {}};
    options.rule_code = code, options.code_directory = CUBOCT_RULE_CODE;
    emu::LatticeEngine engine(
        plan, 0, static_cast<uint32_t>(start.size()), [&](uint32_t k) { return start[k]; }, options);
    EXPECT_EQ(fault_told_by([&] { engine.step(); }), expected) << static_cast<int>(code);
  }
}

// The least number of a width fits, and its negative does not: a pair that is made once for both ends is
// looked at from either.
TEST(LatticeProgramFaults, AtAWidthsEndAreSeenFromBothEnds) {
  Case c = as_program(fault_case(Fault::relative_velocity));
  const FixedRule& rule = c.setup.plan.rule;
  const int64_t half = int64_t{1} << (rule.widths.relative_velocity_bits - 2 + rule.w_shift);
  for (const int64_t v : {half, -half, half / 2}) {
    c.setup.initial.particles[0].v = {v, 0, 0}, c.setup.initial.particles[1].v = {-v, 0, 0};
    compare_first_fault(c, std::abs(v) == half);
  }
}

// A term that is neither odd nor even is checked from either end, each with its own difference.
TEST(LatticeProgramFaults, AreSeenFromTheOtherEndAcrossASeam) {
  for (const bool seam : {false, true}) {
    Scene scene = block_scene({.size = {4, 4, 4}, .cutoff = 1.4, .dt = 0.1, .jitter = 0, .speed = 0});
    scene.periodic.origin = Vec3::Constant(-0.3);
    scene.periodic.extent = Vec3::Constant(4 * std::sqrt(2.0));
    scene.body = {};
    scene.body.x = {{0.1, 1, 1}, {seam ? 5.2 : 0.7, 1, 1}};
    scene.body.v = {{0.8, 0, 0}, {0, 0, 0}};
    scene.body.type.assign(2, 0);
    Arch arch;
    arch.capacity = 60;
    Case c{"seam", make_setup(scene, arch), 1};
    Plan& plan = c.setup.plan;
    auto made = std::make_shared<IntegerProgram>();
    made->program = pair_program(plan.rule, plan.arch.capacity);
    graph::FixedProgram& program = made->program;
    graph::Builder b;
    std::vector<int> d, terms;
    for (int a = 0; a < 3; ++a) d.push_back(read_apart(b, program, a));
    const auto reach = static_cast<int64_t>(std::ldexp(1.4 / plan.rule.cell_edge, program.position_frac));
    b.counts(b.lt(b.dot(d, d), b.constant(reach * reach)));
    for (int a = 0; a < 3; ++a) {
      const int v = read_velocity(b, program, graph::Source::other_v, a);
      terms.push_back(b.clamp(b.check(v, 10, Fault::relative_velocity), {-1, 1}));
    }
    graph::Round& round = program.rounds.at(0);
    round.when = b.when();
    round.pair = b.take();
    round.sums.at(0).terms = terms;
    plan.program = made;
    compare_first_fault(c, true);
  }
}

}  // namespace
}  // namespace cuboct::test
