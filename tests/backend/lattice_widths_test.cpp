// SPDX-License-Identifier: MIT
// The lattice engine against golden over the widths and tables that an arch file may ask for, inside and
// beyond what the vector kernels hold, and over lattices that span far.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "emu/lattice/kernel_rule.h"
#include "tests/backend/against_golden.h"
#include "tests/support/block.h"
#include "tests/support/dice.h"
#include "tests/support/refused_with.h"

namespace cuboct::test {
namespace {

bool fits(const Plan& plan) { return emu::kernel_rule(plan.rule, plan.arch.capacity).fits; }

// The widest unit that the rule allows, which must be the one expected, and plain integers.
void compare_both(const Case& c, Dice& dice, Count& count) {
  const auto all = variants(c.setup.plan);
  const bool vectors =
      fits(c.setup.plan) &&
      std::any_of(all.begin(), all.end(), [](const emu::LatticeOptions& v) { return v.simd != "portable"; });
  ASSERT_EQ(all.front().simd != "portable", vectors);
  for (const std::string& simd : {std::string(), std::string("portable")}) {
    compare(c, {dice.draw(1, 3), dice.chance(50), simd}, count);
    if (testing::Test::HasFatalFailure()) return;
  }
}

struct Drawn {
  Features features;
  Arch arch;
};

Drawn random_widths(Dice& dice) {
  Drawn d;
  d.features.size = {dice.draw(1, 2), 2, dice.draw(1, 2)};
  d.features.cutoff = dice.chance(50) ? 1.6 : 1.2;
  d.features.dt = 0.01 * dice.draw(1, 15);
  d.features.jitter = 0.1;
  d.features.speed = 0.01 * dice.draw(0, 60);
  d.features.damping = dice.chance(50) ? 0.02 * dice.draw(1, 10) : 0;
  d.features.two_materials = dice.chance(30);
  d.features.force_held = dice.chance(20);
  d.features.seed = static_cast<uint64_t>(dice.draw(1, 1 << 30));
  Widths& w = d.arch.widths;
  w.position_frac = dice.draw(8, 30);
  w.guard = dice.draw(1, 20);
  w.difference_frac = dice.draw(6, std::min(w.position_frac, 24));
  const bool wide = dice.chance(50);  // about where the vectors end
  if (wide) {
    w.position_frac = dice.draw(27, 30);
    w.guard = dice.draw(17, 20);
    w.difference_frac = dice.draw(20, 24);
    d.features.dt = 0.02 * dice.draw(1, 15);
  }
  w.velocity_bits = std::max(8, w.velocity_frac() + 1 - (dice.chance(30) ? dice.draw(1, 3) : 0));
  w.relative_velocity_frac = dice.draw(4, std::min(50, w.velocity_frac()));
  w.relative_velocity_bits = std::clamp(w.relative_velocity_frac - dice.draw(-1, 2), 4, 27);
  w.strength_bits = dice.chance(30) ? 0 : dice.draw(wide ? 23 : 8, 27);
  w.sum_bits = std::clamp(w.velocity_bits - dice.draw(-1, 5), 8, 48);
  w.displacement_bits = std::min(40, w.velocity_frac() + 2);
  w.scale_frac = dice.draw(8, 16);
  d.arch.table.shape = dice.chance(50) ? TableChoice::Shape::uniform : TableChoice::Shape::octaves;
  d.arch.table.degree = dice.draw(1, 2);
  d.arch.table.index_bits = std::min(dice.draw(4, 10), 2 * w.difference_frac - 1);
  d.arch.table.fraction_bits = dice.draw(1, 24);
  d.arch.capacity = dice.chance(50) ? 40 : 256;
  return d;
}

TEST(LatticeWidths, RandomOnesHoldGoldensBits) {
  Count inside, beyond;
  int refused = 0, held = 0, portable = 0;
  for (uint64_t seed = 1; seed <= 800; ++seed) {
    Dice dice(seed);
    const Drawn drawn = random_widths(dice);
    Case c{"widths " + std::to_string(seed), {}, 8};
    try {
      c.setup = block(drawn.features, drawn.arch);
    } catch (const InputError&) {
      ++refused;
      continue;
    }
    const bool fit = fits(c.setup.plan);
    ++(fit ? held : portable);
    compare_both(c, dice, fit ? inside : beyond);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(held, 250) << refused << " refused";
  EXPECT_GT(portable, 100) << refused << " refused";
  EXPECT_GT(inside.updates, 20000u);
  EXPECT_GT(inside.faults, 5u);
  EXPECT_GT(beyond.updates, 10000u);
  EXPECT_GT(beyond.faults, 10u);
}

// The widest formats of all, with steps so short that the kicks leave room for their sums.
Arch widest() {
  Arch arch;
  Widths& w = arch.widths;
  w.position_frac = 30;
  w.guard = 20;
  w.velocity_bits = 51;
  w.difference_frac = 24;
  w.strength_bits = 27;
  w.sum_bits = 48;
  w.displacement_bits = 40;
  w.relative_velocity_frac = 24;
  w.relative_velocity_bits = 24;
  arch.table.degree = 2;
  arch.table.index_bits = 10;
  arch.table.fraction_bits = 23;
  return arch;
}

TEST(LatticeWidths, TheWidestFormatsFitTheVectors) {
  Dice dice(1);
  for (const auto shape : {TableChoice::Shape::uniform, TableChoice::Shape::octaves})
    for (const double damping : {0.0, 0.1}) {
      Arch arch = widest();
      arch.table.shape = shape;
      Count count;
      const Case c{
          "widest",
          block({.size = {3, 2, 2}, .dt = 0.01, .jitter = 0.1, .speed = 2, .damping = damping, .margin = 3},
                arch),
          40};
      ASSERT_TRUE(fits(c.setup.plan));
      compare_both(c, dice, count);
      if (HasFatalFailure()) return;
      EXPECT_GT(count.updates, 1000u);
      EXPECT_GT(count.moves, 20u);
    }
}

// One more bit of a factor, or kicks larger by the steps' length, and they do not.
TEST(LatticeWidths, BeyondTheVectorsPlainIntegersAreChosen) {
  Dice dice(2);
  Arch arch = widest();
  arch.table.fraction_bits = 24;
  const Case wide{"a wider table", block({.size = {2, 2, 2}, .dt = 0.01, .jitter = 0.1, .speed = 2}, arch),
                  20};
  const Case strong{"stronger kicks",
                    block({.size = {2, 2, 2}, .dt = 0.3, .jitter = 0.1, .speed = 0.1}, widest()), 20};
  Arch fast = widest();
  fast.widths.relative_velocity_bits = 27;
  const Case damped{"wider velocities",
                    block({.size = {2, 2, 2}, .dt = 0.01, .jitter = 0.1, .speed = 2, .damping = 0.1}, fast),
                    20};
  for (const Case& c : {wide, strong, damped}) {
    ASSERT_FALSE(fits(c.setup.plan)) << c.name;
    Count count;
    compare_both(c, dice, count);
    if (HasFatalFailure()) return;
    EXPECT_EQ(count.vectors, 0u);
    EXPECT_GT(count.updates, 200u);
  }
}

// A free particle between held ones: the sums from either side pass 2^51, where doubles beside 1.5 * 2^52 are
// no longer whole, and cancel.
TEST(LatticeWidths, SumsBeyondDoublesStayExact) {
  Scene scene =
      block_scene({.size = {1, 1, 1}, .cutoff = 0.95, .dt = 0.6, .jitter = 0, .speed = 0, .margin = 1});
  scene.rule.types = {{.name = "free"}, {.name = "held"}};
  scene.rule.types[1].imposed = {true, true, true};
  scene.body = {};
  Dice dice(6);
  std::vector<Vec3> side;
  for (int k = 0; k < 8; ++k)
    side.emplace_back(0.5, 1e-4 * dice.draw(-500, 500), 1e-4 * dice.draw(-500, 500));
  const auto put = [&](const Vec3& x, uint8_t type) {
    scene.body.x.push_back(x);
    scene.body.v.push_back(Vec3::Zero());
    scene.body.type.push_back(type);
  };
  for (const Vec3& x : side) put(-x, 1);
  put(Vec3::Zero(), 0);
  for (const Vec3& x : side) put(x, 1);
  Arch arch = widest();
  arch.capacity = 40;
  Count count;
  const Case c{"squeezed", make_setup(scene, arch), 6};
  ASSERT_FALSE(fits(c.setup.plan));
  const FixedRule& rule = c.setup.plan.rule;
  const Int3 middle = visible(rule, c.setup.initial.particles[8].x);
  const auto kick =
      pair_kick(rule, middle, {}, 0, {middle[0] - (int64_t{1} << 29), middle[1], middle[2]}, {}, 1);
  ASSERT_GT(8 * kick.kick[0], int64_t{1} << 51);
  compare_both(c, dice, count);
  EXPECT_EQ(count.faults, 0u);
  EXPECT_GT(count.updates, 100u);
}

// Tables of random words, steeper than any law's: each value that they can give shows in the kicks.
TEST(LatticeWidths, RandomTablesGiveTheirValues) {
  Count count;
  int wide = 0;
  for (int bits = 8; bits <= 27; ++bits)
    for (const auto shape : {TableChoice::Shape::uniform, TableChoice::Shape::octaves})
      for (const int degree : {1, 2})
        for (const double damping : {0.0, 0.1}) {
          Dice dice(static_cast<uint64_t>(bits) * 8 + static_cast<uint64_t>(degree) * 2 + (damping > 0));
          Arch arch;
          arch.capacity = 60;
          arch.widths.strength_bits = bits;
          arch.widths.guard = 1;
          arch.widths.velocity_bits = 22;
          arch.widths.sum_bits = 30;
          arch.table = {.shape = shape, .degree = degree, .index_bits = 8, .fraction_bits = dice.draw(8, 20)};
          Case c{"table of " + std::to_string(bits) + " bits",
                 block({.size = {2, 2, 2},
                        .jitter = 0.5,
                        .speed = 0.1,
                        .damping = damping,
                        .seed = static_cast<uint64_t>(bits)},
                       arch),
                 2};
          for (FixedTable* table : {&c.setup.plan.rule.force, &c.setup.plan.rule.damp}) {
            const int most = (1 << (bits - 1 - (damping > 0))) - 1;
            for (size_t k = 0; k < table->c0.size(); ++k)
              for (;;) {  // as the quantiser makes them: ends and slopes fit
                const int left = dice.draw(-most, most), right = dice.draw(-most, most);
                const int curve = degree == 2 ? dice.draw(-most / 4, most / 4) : 0;
                if (std::abs(right - left - curve) > most || std::abs(left) > most - most / 4) continue;
                table->c0[k] = left;
                table->c1[k] = right - left - curve;
                if (degree == 2) table->c2[k] = curve;
                break;
              }
          }
          ASSERT_TRUE(fits(c.setup.plan));
          wide += bits > 20;
          compare_both(c, dice, count);
          if (HasFatalFailure()) return;
        }
  EXPECT_EQ(wide, 7 * 8);
  EXPECT_GT(count.updates, 5000u);
}

// Two warm bodies at either end of a lattice that spans `cells` cells of one pitch.
Setup far_apart(double cells, const Arch& arch, int axis) {
  Scene scene = block_scene({.size = {2, 2, 2}, .cutoff = 1.2, .jitter = 0.05, .speed = 0.4, .margin = 2});
  const size_t n = scene.body.size();
  for (size_t k = 0; k < n; ++k) {
    scene.body.x.push_back(scene.body.x[k] + Vec3::Unit(axis) * cells * 1.2);
    scene.body.v.push_back(scene.body.v[k] * -0.5);
    scene.body.type.push_back(scene.body.type[k]);
  }
  return make_setup(scene, arch);
}

TEST(LatticeSpan, BodiesFarApartHoldGoldensBits) {
  Dice dice(3);
  for (int axis = 0; axis < 3; ++axis)
    for (const double cells : {40000.0, 70000.0, 4.0e6}) {
      for (const int frac : {20, 30}) {
        Arch arch;
        arch.capacity = 40;
        arch.widths.position_frac = frac;
        arch.widths.guard = 8;
        arch.widths.velocity_bits = arch.widths.sum_bits = frac + arch.widths.guard + 1;
        Count count;
        compare_both({"far apart", far_apart(cells, arch, axis), 30}, dice, count);
        if (HasFatalFailure()) return;
        EXPECT_GT(count.moves, 20u);
      }
    }
}

TEST(LatticeSpan, ALongRingHoldsGoldensBits) {
  Dice dice(4);
  for (int axis = 0; axis < 3; ++axis) {
    Scene scene = block_scene({.size = {2, 2, 2}, .cutoff = 1.2, .jitter = 0.05, .speed = 0.4, .margin = 2});
    scene.periodic.origin[axis] = 1.0;  // the seam goes through the body
    scene.periodic.extent[axis] = 1.2 * 100000;
    for (size_t k = 0; k < scene.body.size(); ++k)
      if (scene.body.x[k][axis] < 1.0) scene.body.x[k][axis] += scene.periodic.extent[axis];
    Arch arch;
    arch.capacity = 40;
    Count count;
    const Case c{"long ring", make_setup(scene, arch), 30};
    ASSERT_EQ(c.setup.plan.lattice.period()[axis], 100000);
    compare_both(c, dice, count);
    if (HasFatalFailure()) return;
    EXPECT_GT(count.moves, 20u);
  }
}

std::string refusal(const Plan& plan, uint32_t count) {
  return refused_with([&] { emu::LatticeEngine(plan, 0, count, {}, {}); });
}

TEST(LatticeSpan, RefusesWhatADoubleOrAnIndexDoesNotHold) {
  Arch arch;
  arch.capacity = 40;
  arch.widths.position_frac = 30;
  arch.widths.velocity_bits = 39;
  const Plan plan = far_apart(5.0e6, arch, 1).plan;
  int32_t last = 0;
  for (uint32_t n = 0; n < plan.lattice.size(); ++n) last = std::max(last, plan.lattice.cell(n)[1]);
  EXPECT_EQ(refusal(plan, 0), "the lattice reaches " + std::to_string(last) +
                                  " cells along y: with position_frac = 30 the lattice engine holds up to "
                                  "4194300\n"
                                  "  hint: use another engine, or fewer fractional bits in the arch file");
  EXPECT_EQ(refusal(far_apart(10, arch, 0).plan, 0xfffffff0u),
            "4294967280 particles in one process: the lattice engine holds up to 2147483631\n"
            "  hint: share the scene between more ranks");
}

}  // namespace
}  // namespace cuboct::test
