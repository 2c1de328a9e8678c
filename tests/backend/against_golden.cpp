// SPDX-License-Identifier: MIT
#include "tests/backend/against_golden.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "model/analysis/measure.h"
#include "model/contract/golden.h"
#include "model/contract/pair_program.h"
#include "model/program/integer_program.h"
#include "model/trace/compare.h"
#include "tests/support/block.h"

namespace cuboct::test {
namespace {

std::string where(const RunError& e) {
  return fmt::format("{} step {} cell {} particle {} number {}: {}", static_cast<int>(e.fault), e.step,
                     e.cell, e.particle, e.number, e.what());
}

std::string name(const emu::LatticeOptions& options) {
  const emu::Ranks* ranks = options.ranks;
  return fmt::format(
      "{}, {} threads, quiescence {}{}", options.simd.empty() ? "widest" : options.simd, options.threads,
      options.quiescence ? "on" : "off",
      ranks ? fmt::format(", rank {} of {}, cut in {}", ranks->rank(), ranks->size(), options.cut) : "");
}

// The particle, the field and both values.
std::string first_difference(const Lattice& lattice, const State& golden, const State& found) {
  const auto mismatch = cuboct::compare(golden, found);
  return mismatch ? mismatch->text("golden", "lattice", lattice) : "the states' steps differ";
}

}  // namespace

std::vector<emu::LatticeOptions> variants(const Plan& plan) {
  std::vector<emu::LatticeOptions> all;
  for (const char* simd : {"avx512", "avx2", "128-bit", "portable"})
    for (const int threads : {1, 2, 3, 5})
      for (const bool quiescence : {false, true}) all.push_back({threads, quiescence, simd});
  std::erase_if(all, [&](const emu::LatticeOptions& options) {
    try {
      emu::LatticeEngine(plan, 0, 0, {}, options);
      return false;
    } catch (const InputError&) {
      return true;
    }
  });
  return all;
}

void compare(const Case& c, const emu::LatticeOptions& options, Count& count) {
  SCOPED_TRACE(c.name + ", " + name(options));
  const bool first = !options.ranks || options.ranks->rank() == 0;
  const Plan& plan = c.setup.plan;
  const auto& start = c.setup.initial.particles;
  Golden golden(plan.rule, plan.lattice, plan.arch.capacity, c.setup.initial);
  emu::LatticeEngine engine(
      plan, c.setup.initial.step, static_cast<uint32_t>(start.size()), [&](uint32_t k) { return start[k]; },
      options);
  count.vectors += engine.simd() != "portable";
  State before = golden.state();
  uint64_t at_rest = 0;
  bool was_at_rest = true;
  for (uint64_t s = 0; s < c.steps; ++s) {
    std::string expected, found;
    if (s % 4 == 0) {
      const std::vector<Int3> kicks = engine.kicks();
      if (first && !kicks.empty()) {
        ASSERT_EQ(kicks, summed_kicks(plan.rule, plan.lattice, before, 1)) << "step " << s;
      }
      count.kicks += kicks.size();
    }
    if (plan.program && s % 3 == 0) {
      const std::vector<Int3> ahead = engine.next_velocities();
      ASSERT_TRUE(!first || ahead == golden.next_velocities()) << "step " << s;
      count.ahead += ahead.size();
      // Within the step, too, the state is that of before.
      const State here = engine.state();
      ASSERT_TRUE(!first || here == before) << first_difference(plan.lattice, before, here);
      ASSERT_EQ(engine.hash(), hash_of(plan.lattice, before));
    }
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
    const State found_state = engine.state();
    ASSERT_TRUE(!first || found_state == state) << first_difference(plan.lattice, state, found_state);
    ASSERT_EQ(engine.hash(), hash_of(plan.lattice, state));
    ASSERT_EQ(engine.momentum(), momentum(plan.rule, state));
    std::vector<Particle> slots, golden_slots;
    engine.for_each_slot([&](const Particle& p) { slots.push_back(p); });
    for (const auto& cell : golden.cells()) golden_slots.insert(golden_slots.end(), cell.begin(), cell.end());
    ASSERT_TRUE(!first || slots == golden_slots) << "step " << s;
    uint64_t moved = 0;
    for (size_t k = 0; k < state.particles.size(); ++k)
      moved += state.particles[k].cell != before.particles[k].cell;
    ASSERT_EQ(engine.leaving().size(), moved);
    count.moves += moved;
    count.updates += state.particles.size();
    const bool now_at_rest = engine.counters().quiet_node_steps > at_rest;
    count.resumed += now_at_rest && !was_at_rest;
    was_at_rest = now_at_rest;
    at_rest = engine.counters().quiet_node_steps;
    before = state;
  }
  const emu::LatticeCounters& lists = engine.counters();
  count.lists.list_builds += lists.list_builds;
  count.lists.list_mends += lists.list_mends;
  count.lists.near_lists += lists.near_lists;
  count.lists.near_parts += lists.near_parts;
  count.lists.sorts += lists.sorts;
  count.lists.node_steps += lists.node_steps;
  count.lists.quiet_node_steps += lists.quiet_node_steps;
}

Case as_program(Case c) {
  Plan& plan = c.setup.plan;
  auto program = std::make_shared<IntegerProgram>();
  FixedRule rule = plan.rule;
  rule.axes = 3;  // golden moves along z in flat scenes too
  program->program = pair_program(rule, plan.arch.capacity);
  plan.program = std::move(program);
  return c;
}

Case faulty_gas(uint64_t seed) {
  Scene scene = block_scene({.size = {4, 4, 4},
                             .cutoff = 1.4,
                             .dt = 0.1,
                             .jitter = 0.1,
                             .speed = 0.8,
                             .damping = 0.02,
                             .seed = seed});
  for (int a = 0; a < 3; ++a) {
    scene.periodic.origin[a] = -0.3;
    scene.periodic.extent[a] = 4 * std::sqrt(2.0);
  }
  Arch arch;
  arch.capacity = 60;
  arch.widths.relative_velocity_bits = 18;  // 1/8 of a cell per step: less than some pairs have
  return {"faulty gas " + std::to_string(seed), make_setup(scene, arch), 100};
}

}  // namespace cuboct::test
