// SPDX-License-Identifier: MIT
#include "tests/gpu/beside_golden.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "model/contract/golden.h"
#include "model/trace/compare.h"
#include "tests/support/block.h"
#include "tests/support/dice.h"

namespace cuboct::test {
namespace {

std::string text_of(const RunError& e) {
  return fmt::format("{} step {} cell {} particle {} number {}: {}", to_string(e.fault), e.step, e.cell,
                     e.particle, e.number, e.what());
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

void compare(const Case& c, const GoldenPath& golden, const gpu::Options& options, Cut cut, uint64_t seed,
             Met& met) {
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
      const uint64_t steps = cut == Cut::whole ? left
                             : cut == Cut::single
                                 ? 1
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
  ASSERT_TRUE(found == golden.last) << (mismatch ? mismatch->text("golden", "gpu", plan.lattice)
                                                 : "steps differ");
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
    met.crossed += found.particles[k].cell != c.setup.initial.particles[k].cell;
  met.lists += counters.list_builds;
  met.golden_steps += counters.golden_steps;
  met.halo += counters.halo_particles;
}

Case random_bar(uint64_t seed) {
  Dice dice(seed);
  Features f;
  const int along = dice.draw(0, 2);
  for (int a = 0; a < 3; ++a) f.size[a] = dice.draw(1, 2);
  f.size[along] = dice.draw(8, 15);
  f.cutoff = 1.2;
  f.dt = 0.01 * dice.draw(2, 15);
  f.jitter = 0.01 * dice.draw(0, 12);
  f.speed = 0.01 * dice.draw(0, 90);
  f.damping = dice.chance(40) ? 0.05 * dice.draw(1, 4) : 0;
  f.two_materials = dice.chance(40);
  // Drawn apart, so that the other bars stay what they were.
  f.contact = Dice(seed * 0x9e3779b97f4a7c15u + 7).chance(40);
  f.masses = Dice(seed * 0x9e3779b97f4a7c15u + 9).chance(40);
  f.laws = Dice(seed * 0x9e3779b97f4a7c15u + 13).chance(40);
  f.held = dice.chance(20);
  f.force_held = !f.held && dice.chance(40);
  f.gravity = dice.chance(30);
  f.margin = 0.5 * dice.draw(0, 4);
  f.seed = seed;
  Arch arch;
  Widths& w = arch.widths;
  w.position_frac = dice.draw(8, 30);
  w.guard = dice.draw(1, std::min(30, 50 - w.position_frac));
  w.difference_frac = dice.draw(6, std::min(w.position_frac, 24));
  w.velocity_bits = std::max(8, w.velocity_frac() + 1 - (dice.chance(30) ? dice.draw(1, 2) : 0));
  w.relative_velocity_frac = dice.draw(4, std::min(50, w.velocity_frac()));
  w.relative_velocity_bits = std::clamp(w.relative_velocity_frac - dice.draw(-1, 1), 4, 27);
  w.strength_bits = dice.chance(30) ? 0 : dice.draw(16, 27);
  w.sum_bits = std::clamp(w.velocity_bits - dice.draw(-1, 3), 8, 48);
  w.displacement_bits = std::min(40, w.velocity_frac() + 2);
  w.scale_frac = dice.draw(8, 16);
  arch.table.shape = dice.chance(50) ? TableChoice::Shape::uniform : TableChoice::Shape::octaves;
  arch.table.degree = dice.draw(1, 2);
  arch.table.index_bits = std::min(dice.draw(6, 10), 2 * w.difference_frac - 1);
  arch.table.fraction_bits = dice.draw(4, 17);
  arch.capacity = dice.chance(30) ? 40 : dice.draw(4, 7);
  Case c{"bar " + std::to_string(seed), {}, static_cast<uint64_t>(dice.draw(5, 60)), {}};
  std::array<bool, 3> ring{};
  for (int a = 0; a < 3; ++a)
    if (dice.chance(30)) ring[static_cast<size_t>(a)] = true, f.size[a] = std::max(f.size[a], 3);
  c.scene = block_scene(f);
  for (int a = 0; a < 3; ++a)
    if (ring[static_cast<size_t>(a)]) {
      c.scene.periodic.origin[a] = -0.3;
      c.scene.periodic.extent[a] = f.size[a] * std::sqrt(2.0);
    }
  c.setup = make_setup(c.scene, arch);
  return c;
}

}  // namespace cuboct::test
