// SPDX-License-Identifier: MIT
// What a position has below the bits that pairs see is kept, wherever its particle is stored.
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <vector>

#include "emu/gpu/engine.h"
#include "emu/gpu/particle.h"
#include "model/base/error.h"
#include "tests/gpu/beside_golden.h"
#include "tests/support/block.h"
#include "tests/support/dice.h"

namespace cuboct::test {
namespace {

TEST(GpuResidues, KeepEveryBitBesideTheirNeighbours) {
  for (int bits = 1; bits <= gpu::kMostResidueBits; ++bits) {
    SCOPED_TRACE(std::to_string(bits) + " bits");
    using Residues = gpu::Residues<true>;
    Dice dice(static_cast<uint64_t>(bits));
    const auto draw = [&] {
      gpu::Three<uint32_t> value;
      for (uint32_t& part : value.at)
        part = static_cast<uint32_t>(dice.draw(0, 65535) << 16 | dice.draw(0, 65535)) >> (32 - bits);
      return value;
    };
    constexpr size_t kParticles = 40;
    std::vector<uint32_t> words(kParticles * Residues::words_for(bits));
    const Residues residues{words.data(), bits};
    std::vector<gpu::Three<uint32_t>> expected(kParticles);
    for (int k = 0; k < 400; ++k) {
      const auto i = static_cast<size_t>(dice.draw(0, kParticles - 1));
      expected[i] = k % 7 == 0 ? gpu::Three<uint32_t>{{~0u >> (32 - bits), 0, ~0u >> (32 - bits)}} : draw();
      residues.store(i, expected[i]);
      for (size_t j = 0; j < kParticles; ++j)
        for (int a = 0; a < 3; ++a)
          ASSERT_EQ(residues.load(j).at[a], expected[j].at[a]) << j << ", axis " << a;
    }
  }
}

// A row of particles out of each other's reach, one a cell, each within a few units of a face and slower than
// one unit of a visible position per step; and a fast one, for which lists are made anew all the time.
struct Row {
  Case of{"row", {}, 300, {}};
  std::vector<Int3> first;  // from the corner of cell (0, 0, 0), P+G fractional bits

  explicit Row(int guard) {
    constexpr int kLength = 16, kFast = 8;
    constexpr double kEdge = 4;  // three cutoffs and more
    of.scene =
        block_scene({.size = {1, 1, 1}, .cutoff = 1.2, .dt = 1e-3, .jitter = 0, .speed = 0, .margin = kEdge});
    of.scene.body = {};
    for (int k = 0; k < kLength; ++k) of.scene.body.x.push_back(Vec3(kEdge * k, 0, 0));
    of.scene.body.v.assign(kLength, Vec3::Zero());
    of.scene.body.type.assign(kLength, 0);
    Arch arch;
    arch.cell_edge = kEdge;
    Widths& w = arch.widths;
    w.position_frac = 18, w.guard = guard, w.velocity_bits = w.sum_bits = 18 + guard;
    w.difference_frac = w.relative_velocity_frac = 16;
    of.setup = make_setup(of.scene, arch);
    const int64_t edge = int64_t{1} << w.velocity_frac(), unit = int64_t{1} << guard;
    for (Particle& p : of.setup.initial.particles) {
      const int k = static_cast<int>(p.id);
      // Most of what such a speed is lies in its last bits.
      const int64_t slow = std::max<int64_t>(1, unit * (3 + 2 * k) / 40 | 1) * (k % 2 == 0 ? 1 : -1);
      p.v = {slow, -slow, slow};
      p.x = {slow > 0 ? edge - 20 * unit : 20 * unit, (k % 2 == 0 ? 1 : 3) * edge / 4, edge / 2};
      if (k == kFast) p.x = {edge / 2, 0, edge - 1}, p.v = {0, edge / 400, -edge / 400};
      Int3 from;
      for (int a = 0; a < 3; ++a) from[a] = of.setup.plan.lattice.cell(p.cell)[a] * edge + p.x[a];
      first.push_back(from);
    }
  }
};

// The expected place is a product, no engine's.
TEST(FixedDrift, IsTheSumOfItsVelocities) {
  for (const int guard : {1, 8, 10, 11, 14, 15, 21, 22, 30}) {
    const Row row(guard);
    const Plan& plan = row.of.setup.plan;
    const int frac = plan.rule.widths.velocity_frac();
    ASSERT_EQ(most_slabs(plan), 4);
    for (int slabs = 1; slabs <= 4; ++slabs) {
      SCOPED_TRACE(std::to_string(guard) + " guard bits, " + std::to_string(slabs) + " slabs");
      gpu::Options options;
      options.devices.assign(static_cast<size_t>(slabs), 0);
      const auto engine = gpu::make_fixed_engine(row.of.scene, plan, row.of.setup.initial, options);
      engine->advance(row.of.steps);
      const State state = engine->state();
      ASSERT_EQ(engine->hash(), hash_of(plan.lattice, state));
      int crossed = 0;
      for (const Particle& p : state.particles) {
        const Particle& before = row.of.setup.initial.particles[p.id];
        ASSERT_EQ(p.v, before.v);
        crossed += p.cell != before.cell;
        for (int a = 0; a < 3; ++a) {
          const int64_t whole = row.first[p.id][a] + static_cast<int64_t>(row.of.steps) * p.v[a];
          ASSERT_EQ(plan.lattice.cell(p.cell)[a], whole >> frac) << "particle " << p.id << ", axis " << a;
          ASSERT_EQ(p.x[a], whole & ((int64_t{1} << frac) - 1)) << "particle " << p.id << ", axis " << a;
        }
      }
      EXPECT_GT(crossed, 12);
      EXPECT_GT(engine->counters().list_builds, 20u);
    }
  }
}

TEST(FixedDrift, HoldsGoldensBits) {
  Met met;
  for (const int guard : {8, 21, 30}) {
    const Row row(guard);
    const GoldenPath golden = golden_path(row.of);
    for (int slabs = 1; slabs <= 4; ++slabs) {
      gpu::Options options;
      options.devices.assign(static_cast<size_t>(slabs), 0);
      compare(row.of, golden, options, slabs % 2 == 0 ? Cut::random : Cut::whole, 3, met);
      if (HasFatalFailure()) return;
    }
  }
  EXPECT_EQ(met.faults, 0u);
}

// The limits of emu/gpu/fixed/fixed_policy.h, which an arch does not reach.
TEST(FixedWidths, BeyondTheEnginesAreRefused) {
  Case c = make_case("damped");
  const auto refusal = [&](int position_frac, int guard) {
    Widths& w = c.setup.plan.rule.widths;
    w.position_frac = position_frac, w.guard = guard;
    try {
      gpu::make_fixed_engine(c.scene, c.setup.plan, c.setup.initial, {});
    } catch (const InputError& e) {
      return fmt::format("{}: {}", fmt::join(e.keys(), ", "), e.what());
    }
    return std::string("accepted");
  };
  EXPECT_EQ(
      refusal(31, 8),
      "widths.position_frac: position_frac = 31: the gpu engine's positions hold 30 bits of a cell at most");
  EXPECT_EQ(refusal(20, 33),
            "widths.guard: guard = 33: the gpu engine keeps 32 bits of a position beside those at most");
}

}  // namespace
}  // namespace cuboct::test
