// SPDX-License-Identifier: MIT
#include "tests/gpu/beside_golden.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "model/compare.h"
#include "model/golden.h"
#include "tests/support/dice.h"

namespace cuboct::test {
namespace {

std::string text_of(const RunError& e) {
  return fmt::format("{} step {} node {} particle {} number {}: {}", to_string(e.fault), e.step, e.node, e.particle,
                     e.number, e.what());
}

std::string text_of(const std::optional<RunError>& e) { return e ? text_of(*e) : "no fault"; }

// What must leave no mark in the bits.
void look(gpu::Engine& engine, Dice& dice, uint32_t particles) {
  if (dice.chance(50)) {
    std::vector<uint32_t> ids;
    for (uint32_t id = 0; id < particles; ++id)
      if (dice.chance(20)) ids.push_back(id);
    engine.probe(ids);
    ASSERT_EQ(engine.read(dice.chance(50)).force.size(), ids.size());
  }
  if (dice.chance(30)) engine.body();
}

}  // namespace

GoldenPath golden_path(const Case& c) {
  GoldenPath path;
  const Plan& plan = c.setup.plan;
  Golden golden(plan.rule, plan.lattice, plan.arch.capacity, c.setup.initial);
  path.last = c.setup.initial;
  try {
    for (uint64_t s = 0; s < c.steps; ++s) {
      golden.step();
      path.last = golden.state();
      path.hashes.push_back(hash_of(plan.lattice, path.last));
    }
  } catch (const RunError& e) {
    path.fault = e;
  }
  return path;
}

int most_slabs(const Plan& plan) {
  int longest = 0;
  for (int a = 0; a < 3; ++a) {
    int low = plan.lattice.cell(0)[a], high = low;
    for (uint32_t n = 0; n < plan.lattice.size(); ++n) {
      low = std::min(low, plan.lattice.cell(n)[a]);
      high = std::max(high, plan.lattice.cell(n)[a]);
    }
    const int period = plan.lattice.period()[a];
    longest = std::max(longest, period > 0 ? period : high - low + 1);
  }
  return std::clamp(longest / 4, 1, 4);
}

void compare(const Case& c, const GoldenPath& golden, const gpu::Options& options, Cut cut, uint64_t seed, Met& met) {
  SCOPED_TRACE(fmt::format("{}, {} slabs, blocks of {}, cut {}, seed {}", c.name, options.devices.size(),
                           options.block, static_cast<int>(cut), seed));
  Dice dice(seed);
  const Plan& plan = c.setup.plan;
  const auto engine = gpu::make_fixed_engine(c.scene, plan, c.setup.initial, options);
  ASSERT_EQ(engine->hash(), hash_of(plan.lattice, c.setup.initial));
  std::vector<uint64_t> hashes;
  std::optional<RunError> fault;
  const uint64_t first = c.setup.initial.step;
  try {
    while (engine->step_count() < first + c.steps) {
      const uint64_t left = first + c.steps - engine->step_count();
      const uint64_t steps = cut == Cut::whole    ? left
                             : cut == Cut::single ? 1
                                                  : std::min<uint64_t>(left, static_cast<uint64_t>(dice.draw(1, 9)));
      if (cut == Cut::random) look(*engine, dice, plan.particles);
      // Hashes are asked for or not: the kernels differ.
      if (cut == Cut::random && dice.chance(30)) {
        engine->advance(steps);
        while (hashes.size() < engine->step_count() - first && hashes.size() < golden.hashes.size())
          hashes.push_back(golden.hashes[hashes.size()]);
        ASSERT_EQ(engine->hash(), hashes.back()) << "step " << engine->step_count();
      } else {
        engine->advance(steps, &hashes);
      }
      ASSERT_EQ(hashes.size(), engine->step_count() - first);
    }
  } catch (const RunError& e) {
    fault = e;
    while (hashes.size() < engine->step_count() - first && hashes.size() < golden.hashes.size())
      hashes.push_back(golden.hashes[hashes.size()]);  // of the call that threw, where it kept none
  }
  for (size_t k = 0; k < std::min(hashes.size(), golden.hashes.size()); ++k)
    ASSERT_EQ(hashes[k], golden.hashes[k]) << "first after step " << first + k + 1;
  ASSERT_EQ(text_of(fault), text_of(golden.fault));
  ASSERT_EQ(hashes.size(), golden.hashes.size());
  const State found = engine->state();
  const auto mismatch = cuboct::compare(golden.last, found);
  ASSERT_TRUE(found == golden.last) << (mismatch ? mismatch->text("golden", "gpu", plan.lattice) : "steps differ");
  ASSERT_EQ(engine->hash(), hash_of(plan.lattice, golden.last));
  if (fault) {
    // It stands where it stood, and says so again.
    std::string again = "nothing";
    try {
      engine->advance(1);
    } catch (const RunError& e) {
      again = text_of(e);
    }
    ASSERT_EQ(again, text_of(*fault));
    ASSERT_TRUE(engine->state() == golden.last);
  }
  const gpu::Counters& counters = engine->counters();
  ++met.runs;
  met.updates += hashes.size() * plan.particles;
  met.faults += fault.has_value();
  for (size_t k = 0; k < found.particles.size(); ++k)
    met.crossed += found.particles[k].node != c.setup.initial.particles[k].node;
  met.lists += counters.list_builds;
  met.golden_steps += counters.golden_steps;
  met.halo += counters.halo_particles;
}

}  // namespace cuboct::test
