// SPDX-License-Identifier: MIT
// The pair law as a program, on the gpu engine with loops for kernels, beside golden.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "emu/gpu/cells.h"
#include "emu/gpu/rounds/rounds_engine.h"
#include "hw/arch/cell_box.h"
#include "model/contract/golden.h"
#include "model/contract/pair_program.h"
#include "model/program/integer_program.h"
#include "model/trace/compare.h"
#include "tests/support/cases.h"
#include "tests/support/dice.h"

namespace cuboct::test {

struct Compared {
  uint64_t runs = 0, updates = 0, faults = 0, golden_steps = 0, builds = 0, ghosts = 0;
  uint64_t crossed = 0;  // from one slab into another
};

inline double counter(const IntegerEngine& engine, const std::string& name) {
  for (const auto& [key, value] : engine.counters())
    if (key == name) return value;
  return -1;
}

// Which slab owns a particle, by the planes of cells across the longest axis.
class Owners {
 public:
  Owners(const Plan& plan, const State& initial, int slabs) : plan_(plan) {
    const CellBox box = box_of(plan.lattice, true);
    for (size_t a = 1; a < 3; ++a)
      if (box.extent(a) > box.extent(axis_)) axis_ = a;
    low_ = box.low[axis_];
    std::vector<uint64_t> particles(static_cast<size_t>(box.extent(axis_)));
    for (const Particle& p : initial.particles) ++particles[plane_of(p)];
    ends_ = gpu::slab_ends(particles, slabs, 1);
  }
  size_t planes() const { return static_cast<size_t>(ends_.back()); }
  long of(const Particle& p) const {
    return std::upper_bound(ends_.begin(), ends_.end(), static_cast<int>(plane_of(p))) - ends_.begin();
  }

 private:
  size_t plane_of(const Particle& p) const {
    return static_cast<size_t>(plan_.lattice.cell(p.cell)[axis_] - low_);
  }
  const Plan& plan_;
  size_t axis_ = 0;
  int low_ = 0;
  std::vector<int> ends_;
};

// In batches of any length: hashes of all steps, the state after each batch, and the fault that ends the run.
inline void compare_rounds(Case c, uint64_t seed, Compared& compared, const gpu::Options& options = {},
                           int longest = 9) {
  SCOPED_TRACE(fmt::format("{}, {} slabs, seed {}", c.name, options.devices.size(), seed));
  Plan& plan = c.setup.plan;
  auto made = std::make_shared<IntegerProgram>();
  FixedRule rule = plan.rule;
  rule.axes = 3;
  made->program = pair_program(rule, plan.arch.capacity);
  plan.program = made;
  Golden golden(plan.rule, plan.lattice, plan.arch.capacity, c.setup.initial);
  const auto engine = gpu::make_rounds_engine(plan, c.setup.initial, options);
  Dice dice(seed);
  for (uint64_t step = 0; step < c.steps;) {
    const uint64_t batch = std::min<uint64_t>(c.steps - step, static_cast<uint64_t>(dice.draw(1, longest)));
    std::vector<uint64_t> expected, found;
    std::string golden_stop, engine_stop;
    const auto text = [](const RunError& e) {
      return std::to_string(static_cast<int>(e.fault)) + " step " + std::to_string(e.step) + ": " + e.what();
    };
    try {
      for (uint64_t k = 0; k < batch; ++k) {
        golden.step();
        expected.push_back(hash_of(plan.lattice, golden.state()));
      }
    } catch (const RunError& e) {
      golden_stop = text(e);
    }
    try {
      engine->advance(batch, &found);
    } catch (const RunError& e) {
      engine_stop = text(e);
    }
    ASSERT_EQ(found, expected) << "from step " << step;
    ASSERT_EQ(engine_stop, golden_stop);
    compared.updates += expected.size() * plan.particles;
    if (!golden_stop.empty()) {
      ++compared.faults;
      break;
    }
    step += batch;
    const State here = engine->state(), there = golden.state();
    const auto mismatch = compare(there, here);
    ASSERT_FALSE(mismatch) << mismatch->text("golden", "gpu", plan.lattice);
    ASSERT_EQ(engine->hash(), hash_of(plan.lattice, there));
    ASSERT_EQ(engine->next_velocities(), golden.next_velocities());
    ASSERT_EQ(engine->hash(), hash_of(plan.lattice, there));
  }
  const State last = engine->state();
  const Owners owners(plan, c.setup.initial, static_cast<int>(options.devices.size()));
  for (size_t k = 0; k < last.particles.size(); ++k)
    compared.crossed += owners.of(last.particles[k]) != owners.of(c.setup.initial.particles[k]);
  ++compared.runs;
  compared.ghosts += static_cast<uint64_t>(counter(*engine, "halo_particles"));
  compared.golden_steps += static_cast<uint64_t>(counter(*engine, "golden_steps"));
  compared.builds += static_cast<uint64_t>(counter(*engine, "list_builds"));
}

}  // namespace cuboct::test
