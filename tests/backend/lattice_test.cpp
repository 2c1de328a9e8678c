// SPDX-License-Identifier: MIT
// The lattice engine against golden: state, order of slots and faults at every step, on every vector unit of the
// machine, any number of threads, with and without quiescence.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include "emu/lattice/engine.h"
#include "model/golden.h"
#include "tests/support/cases.h"

namespace cuboct::test {
namespace {

struct Variant {
  std::string simd;
  int threads;
  bool quiescence;
};

// Those of this machine: "portable" everywhere.
std::vector<Variant> variants(const Plan& plan) {
  std::vector<Variant> all;
  for (const char* simd : {"avx512", "avx2", "128-bit", "portable"})
    for (const int threads : {1, 2, 3, 5})
      for (const bool quiescence : {false, true}) all.push_back({simd, threads, quiescence});
  std::erase_if(all, [&](const Variant& v) {
    try {
      emu::LatticeEngine(plan, 0, 0, {}, {v.threads, v.quiescence, v.simd});
      return false;
    } catch (const InputError&) {
      return true;
    }
  });
  return all;
}

std::string name(const Variant& v) {
  return v.simd + ", " + std::to_string(v.threads) + " threads, quiescence " + (v.quiescence ? "on" : "off");
}

struct Count {
  uint64_t updates = 0, moves = 0, faults = 0, quiet = 0, builds = 0, vectors = 0;
};

std::string where(const RunError& e) {
  return fmt::format("{} step {} node {} particle {} number {}: {}", static_cast<int>(e.fault), e.step, e.node,
                     e.particle, e.number, e.what());
}

// Runs both, compares everything at each step.
void compare(const Case& c, const Variant& variant, Count& count) {
  SCOPED_TRACE(c.name + ", " + name(variant));
  const Plan& plan = c.setup.plan;
  const auto& start = c.setup.initial.particles;
  Golden golden(plan.rule, plan.lattice, plan.arch.capacity, c.setup.initial);
  emu::LatticeEngine engine(
      plan, c.setup.initial.step, static_cast<uint32_t>(start.size()), [&](uint32_t k) { return start[k]; },
      {variant.threads, variant.quiescence, variant.simd});
  count.vectors += engine.simd() != "portable";
  State before = golden.state();
  for (uint64_t s = 0; s < c.steps; ++s) {
    std::string expected, found;
    try {
      golden.step();
    } catch (const RunError& e) {
      expected = where(e);
    }
    try {
      engine.step();
    } catch (const RunError& e) {
      found = where(e);
    }
    ASSERT_EQ(found, expected) << "step " << s;
    if (!expected.empty()) {
      ++count.faults;
      break;
    }
    const State state = golden.state();
    ASSERT_TRUE(engine.state() == state) << "step " << s;
    ASSERT_EQ(engine.hash(), hash_of(plan.lattice, state));
    ASSERT_EQ(engine.momentum(), momentum(state));
    std::vector<Particle> slots, golden_slots;
    engine.for_each_slot([&](const Particle& p) { slots.push_back(p); });
    for (const auto& node : golden.nodes()) golden_slots.insert(golden_slots.end(), node.begin(), node.end());
    ASSERT_TRUE(slots == golden_slots) << "step " << s;
    uint64_t moved = 0;
    for (size_t k = 0; k < state.particles.size(); ++k)
      moved += state.particles[k].node != before.particles[k].node;
    ASSERT_EQ(engine.leaving().size(), moved);
    count.moves += moved;
    count.updates += state.particles.size();
    before = state;
  }
  count.quiet += engine.counters().quiet_node_steps;
  count.builds += engine.counters().list_builds;
}

class Lattice : public testing::TestWithParam<std::string> {};

TEST_P(Lattice, EqualsGoldenAtEachStep) {
  const Case c = make_case(GetParam());
  Count count;
  for (const Variant& v : variants(c.setup.plan)) compare(c, v, count);
  EXPECT_GT(count.updates, 0u);
}

INSTANTIATE_TEST_SUITE_P(Cases, Lattice, testing::ValuesIn(case_names()), [](const auto& p) { return p.param; });

TEST(LatticeRandom, EqualsGolden) {
  Count count;
  for (uint64_t seed = 1; seed <= 300; ++seed) {
    const Case c = random_case(seed);
    const auto all = variants(c.setup.plan);
    // Each seed meets the widest unit and one other variant.
    compare(c, all[seed % 8], count);
    compare(c, all[seed % all.size()], count);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(count.updates, 100000u);
  EXPECT_GT(count.moves, 500u);
  EXPECT_GT(count.faults, 0u);
  RecordProperty("updates", static_cast<int>(count.updates));
}

TEST(LatticeFaults, EachArisesAsInGolden) {
  Count count;
  size_t expected = 0;
  for (const Fault fault : all_faults()) {
    const Case c = fault_case(fault);
    for (const Variant& v : variants(c.setup.plan)) {
      compare(c, v, count);
      ++expected;
    }
  }
  EXPECT_EQ(count.faults, expected);
}

}  // namespace
}  // namespace cuboct::test
