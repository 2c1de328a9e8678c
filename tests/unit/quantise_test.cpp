// SPDX-License-Identifier: MIT
#include "model/contract/quantise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "model/base/fixed_math.h"
#include "tests/support/block.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

Rule bond_rule(double damping = 0) { return test::block_scene({.damping = damping}).rule; }

FixedRule quantised(const Rule& rule, TableChoice::Shape shape, int degree, int index_bits,
                    double edge = 1.6) {
  return quantise(rule, edge, {}, {.shape = shape, .degree = degree, .index_bits = index_bits});
}

double real_of(const FixedRule& fixed, const Rule& rule, uint64_t r2) {
  return std::ldexp(static_cast<double>(fixed.force.at(r2)), -fixed.force.value_frac) * rule.mass /
         (rule.dt * rule.dt);
}

// The error that the quantiser reports is one that random distances do not exceed, and nearly reach.
TEST(Quantise, ReportedErrorIsTheWorstThatRandomDistancesFind) {
  const Rule rule = bond_rule();
  for (const auto shape : {TableChoice::Shape::uniform, TableChoice::Shape::octaves})
    for (const int degree : {1, 2}) {
      const FixedRule fixed = quantised(rule, shape, degree, 7);
      std::mt19937_64 random(3);
      double worst = 0;
      int inside = 0;
      for (int k = 0; k < 400000; ++k) {
        const uint64_t r2 = random() % fixed.cutoff2;
        const double r = std::sqrt(std::ldexp(static_cast<double>(r2), -32)) * 1.6;
        if (r < rule.law->core()) continue;
        worst = std::max(worst, std::abs(real_of(fixed, rule, r2) * r - rule.law->force(r)));
        ++inside;
      }
      ASSERT_GT(inside, 300000);
      // The report samples each bin at 64 points: what lies between is the rounding of an entry, half a unit
      // times r, and at the core's kink a 64th of the bin.
      const double rounding =
          std::ldexp(0.5, -fixed.force.value_frac) * rule.mass / (rule.dt * rule.dt) * 1.6;
      EXPECT_LE(worst, 1.05 * fixed.error().worst_force + rounding) << degree;
      EXPECT_GE(worst, 0.95 * fixed.error().worst_force - rounding) << degree;
      EXPECT_GT(worst, 2 * rounding) << degree;
    }
}

// A piecewise polynomial of degree n over bins of width h errs by O(h^(n+1)): 4 and 8 times less for half the
// width, as long as the entries' own rounding is smaller.
TEST(Quantise, ErrorFallsWithTheOrderOfTheTable) {
  const Rule rule = bond_rule();
  Widths wide;
  wide.strength_bits = 26;
  for (const int degree : {1, 2}) {
    const auto error = [&](int bits) {
      return quantise(rule, 2.0, wide,
                      {.shape = TableChoice::Shape::uniform,
                       .degree = degree,
                       .index_bits = bits,
                       .fraction_bits = 22})
          .error()
          .worst_force;
    };
    const double order = std::log2(error(6) / error(7));
    EXPECT_NEAR(order, degree + 1, 0.35) << "degree " << degree;
  }
}

TEST(Quantise, TablesHaveNoSeams) {
  const Rule rule = bond_rule(0.1);
  for (const auto shape : {TableChoice::Shape::uniform, TableChoice::Shape::octaves})
    for (const int degree : {1, 2}) {
      const FixedRule fixed = quantised(rule, shape, degree, 6);
      for (const FixedTable* table : {&fixed.force, &fixed.damp}) {
        int seams = 0;
        uint32_t last = table->address(fixed.cutoff2 >> 4).index;
        for (uint64_t r2 = (fixed.cutoff2 >> 4) + 1; r2 < fixed.cutoff2; r2 += 1 << 10) {
          const uint32_t k = table->address(r2).index;
          if (k != last) {
            ASSERT_EQ(k, last + 1);
            const int64_t end =
                int64_t{table->c0[last]} + table->c1[last] + (degree == 2 ? table->c2[last] : 0);
            ASSERT_EQ(end, table->c0[k]) << k;
            ++seams;
          }
          last = k;
        }
        EXPECT_GT(seams, 20);
      }
    }
}

// Every entry and the interpolation between them fits the width, with the bit of headroom that damping needs.
TEST(Quantise, TablesUseTheirWidthAndNoMore) {
  for (const double damping : {0.0, 0.1}) {
    const FixedRule fixed = quantised(bond_rule(damping), TableChoice::Shape::uniform, 2, 6);
    const int bits = fixed.widths.strength_bits - (damping > 0 ? 1 : 0);
    int64_t largest = 0;
    for (uint64_t r2 = 0; r2 < fixed.cutoff2; r2 += 9973)
      largest = std::max(largest, std::abs(fixed.force.at(r2)));
    EXPECT_TRUE(fits(largest, bits));
    EXPECT_FALSE(fits(4 * largest, bits)) << "more than a bit is wasted";
  }
}

TEST(Quantise, PairTermIsOddAndMatchesTheRule) {
  Scene scene = test::block_scene({.damping = 0.15, .two_materials = true});
  const Rule& rule = scene.rule;
  const FixedRule fixed = quantise(rule, 1.7, {}, {});
  ASSERT_TRUE(fixed.damped && fixed.scaled);
  std::mt19937_64 random(11);
  const int64_t P = int64_t{1} << fixed.widths.position_frac;
  int inside = 0;
  for (int k = 0; k < 200000; ++k) {
    Int3 xi, xj, vi, vj, back_i, back_j;
    for (int a = 0; a < 3; ++a) {
      xi[a] = static_cast<int64_t>(random() % P);
      xj[a] = static_cast<int64_t>(random() % (3 * P)) - P;
      vi[a] = static_cast<int64_t>(random() % (1 << 23)) - (1 << 22);
      vj[a] = static_cast<int64_t>(random() % (1 << 23)) - (1 << 22);
      back_i[a] = xj[a] - P;  // the same pair seen from another frame
      back_j[a] = xi[a] - P;
    }
    const int ti = static_cast<int>(random() % 2), tj = static_cast<int>(random() % 2);
    const PairResult ij = pair_kick(fixed, xi, vi, ti, xj, vj, tj);
    const PairResult ji = pair_kick(fixed, back_i, vj, tj, back_j, vi, ti);
    ASSERT_EQ(ij.inside, ji.inside);
    for (int a = 0; a < 3; ++a) ASSERT_EQ(ij.kick[a], -ji.kick[a]);
    if (!ij.inside || ij.fault != Fault::none) continue;
    ASSERT_TRUE(may_interact(fixed, xi, xj));
    ++inside;
    const double length = fixed.cell_edge, unit = std::ldexp(length, -fixed.widths.velocity_frac());
    Vec3 d, w;
    for (int a = 0; a < 3; ++a) {
      d[a] = static_cast<double>(xj[a] - xi[a]) * length / static_cast<double>(P);
      w[a] = static_cast<double>(vj[a] - vi[a]) * unit / rule.dt;
    }
    const double r = d.norm(), strength = rule.strength_of(ti, tj);
    if (r < rule.law->core()) continue;
    const Vec3 expected =
        strength * (-rule.law->force(r) / r + rule.damping_over_r2(r) * w.dot(d)) * d * rule.dt / rule.mass;
    for (int a = 0; a < 3; ++a) {
      const double kick = static_cast<double>(ij.kick[a]) * unit / rule.dt;
      // Table error, d to half a unit of 2^-16 cells against slopes below 20, damping's terms to 2^-16 of
      // themselves.
      const double bound = rule.dt * (fixed.error().worst_force * 2 + 20 * length / 65536 +
                                      0.01 * std::abs(rule.damping_over_r2(r) * w.dot(d)) * r) +
                           2 * unit / rule.dt;
      ASSERT_NEAR(kick, expected[a], bound) << r;
    }
  }
  EXPECT_GT(inside, 10000);
}

TEST(Quantise, RefusesWithNumbers) {
  Rule rule = bond_rule();
  EXPECT_EQ(refused_with([&] { quantise(rule, 1.5, {}, {}); }),
            "the cutoff, 1.6 m, is longer than a cell edge, 1.5 m");
  EXPECT_EQ(refused_with([&] { quantise(rule, 1e6, {}, {}); }),
            "a cutoff of 1.6 m is less than a unit of a difference in cells of 1e+06 m\n"
            "  hint: a smaller cell_edge, or more bits of difference_frac");
  EXPECT_EQ(refused_with([&] { quantise(rule, 1.6, {.velocity_bits = 40}, {}); }),
            "velocity_bits = 40 is out of range: 8 to 29");
  EXPECT_EQ(refused_with([&] { quantise(rule, 1.6, {}, {.degree = 3}); }),
            "table degree = 3 is out of range: 1 to 2");
  EXPECT_EQ(
      refused_with([&] { quantise(rule, 1.6, {}, {.shape = TableChoice::Shape::octaves, .index_bits = 2}); }),
      "2 index bits are too few for the octaves between the law's core and its cutoff\n"
      "  hint: index_bits = 3, or shape = \"uniform\", in the arch file's [table]");
  rule.types[0].velocity = Vec3(12, 0, 0);
  EXPECT_EQ(refused_with([&] { quantise(rule, 1.6, {}, {}); }),
            "an imposed velocity is 1.125 in units of the lattice: 29 bits with 28 fractional bits hold less "
            "than 1\n"
            "  hint: a dt of at most 0.133 s holds it");
  rule.types[0].velocity = Vec3::Zero();
  rule.types[0].gravity = Vec3(0, 0, 1e-6);
  EXPECT_EQ(refused_with([&] { quantise(rule, 1.6, {}, {}); }),
            "gravity is 1.40625e-08 in units of the lattice: 28 fractional bits round it to 1.49012e-08\n"
            "  hint: guard = 12 in the arch file keeps it");
  rule.types[0].gravity = Vec3::Zero();
  rule.dt = 3000;
  EXPECT_NE(refused_with([&] { quantise(rule, 1.6, {}, {}); }).find("a dt of at most "), std::string::npos);
}

}  // namespace
}  // namespace cuboct
