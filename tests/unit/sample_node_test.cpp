// SPDX-License-Identifier: MIT
// A node for each element: its arithmetic is Tersoff's, its operations are those of its formulas by hand, and
// its energy is their number times the technology's figures.
#include "study/sample_node/sample_node.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "model/atoms/bond_order/tersoff_parameters.h"
#include "model/atoms/multiscale/tersoff_law.h"
#include "model/base/error.h"

namespace cuboct {
namespace {

constexpr double kMass = 28.0855 * 1.66053906660e-27;  // kg

SampleMaterial silicon(const std::string& set, int cells) {
  return crystal_material(Crystal::diamond, tersoff_law(tersoff_set(set)), 5.43, cells, kMass, 1e-6);
}
TersoffTerm<double> term(const std::string& set) { return tersoff_set(set).terms[0]; }

Technology technology(const std::string& name) {
  return read_technology(CUBOCT_SOURCE_DIR "/technologies/" + name + ".toml");
}

// All pairs within the cutoff of eight atoms, pressed and shaken so that some of them are where it falls.
TEST(TersoffDatapath, IsTersoffsPotential) {
  for (const char* set : {"si_1989", "si_erhart_albe", "si_multiscale", "si_1988"}) {
    const TersoffTerm<double> t = term(set);
    DatapathSample<double> sample;
    std::vector<Vec3> x;
    for (const Vec3& place : crystal_lattice(Crystal::diamond, 5.43, 1, kMass).place) {
      const double n = static_cast<double>(x.size());
      x.push_back(4.7 * place + 0.3 * Vec3(std::sin(5 * n), std::sin(7 * n + 1), std::sin(11 * n + 2)));
      sample.x.push_back({x.back()[0], x.back()[1], x.back()[2]});
    }
    sample.first = {0};
    size_t falling = 0;
    for (uint32_t i = 0; i < 8; ++i) {
      for (uint32_t j = 0; j < 8; ++j)
        if (const double r = (x[i] - x[j]).norm(); i != j && r < t.R + t.D) {
          sample.bonds.push_back({j, {0, 0, 0}});
          if (r > t.R - t.D) ++falling;
        }
      sample.first.push_back(static_cast<uint32_t>(sample.bonds.size()));
    }
    ASSERT_GT(sample.bonds.size(), 12U);
    ASSERT_GE(falling, 2U) << set;
    const TersoffExact tables(t);
    DatapathForces<double> found;
    TersoffDatapath<double, TersoffExact>(tables).evaluate(sample, found);
    // Far from its images.
    std::vector<Vec3> f(8);
    Mat3 virial;
    const double energy =
        tersoff_law(tersoff_set(set))->forces()->evaluate(50 * Mat3::Identity(), x, f, virial);
    EXPECT_NEAR(found.energy, energy, 1e-12 * std::abs(energy)) << set;
    for (size_t i = 0; i < 8; ++i)
      for (size_t a = 0; a < 3; ++a) EXPECT_NEAR(found.f[i][a], f[i][static_cast<int>(a)], 1e-11) << set;
    EXPECT_NEAR(found.virial[0], virial(0, 0), 1e-10) << set;
    EXPECT_NEAR(found.virial[3], virial(1, 2), 1e-10) << set;
  }
}

// Products and sums of each stage, from the formulas: a look-up has two of each, a scalar product of vectors
// three and two. An atom of diamond has 4 bonds and 6 pairs of them.
TEST(SampleNode, OperationsAreThoseOfTheFormulas) {
  const SampleNode node = count_sample_node(silicon("si_multiscale", 1), term("si_multiscale"));
  const auto stage = [&](DatapathStage s) { return node.stages[static_cast<size_t>(s)]; };
  const auto expect = [&](DatapathStage s, uint64_t products, uint64_t adds, uint64_t lookups) {
    EXPECT_EQ(stage(s).products, 8 * products) << static_cast<int>(s);
    EXPECT_EQ(stage(s).adds, 8 * adds) << static_cast<int>(s);
    EXPECT_EQ(stage(s).lookups, 8 * lookups) << static_cast<int>(s);
  };
  expect(DatapathStage::meet, 4 * (3 + 2 * 7 + 1 + 3), 4 * (6 + 2 + 2 * 7), 4 * 7);
  expect(DatapathStage::angles, 6 * (3 + 2 * 2 + 2 + 2 * 4 + 2), 6 * (2 + 2 * 2 + 2 + 2 * 4 + 2), 6 * 6);
  expect(DatapathStage::orders, 4 * (2 * 2 + 3), 4 * (2 * 2 + 3), 4 * 2);
  expect(DatapathStage::turns, 6 * (2 + 2 + 1 + 2 + 2 + 2 + 4 + 6), 6 * (1 + 1 + 2 + 4 + 6), 0);
  expect(DatapathStage::add, 4 * (3 + 6), 4 * (3 + 6 + 6), 0);
  // Without stretches the pairs have less to do.
  const SampleNode plain = count_sample_node(silicon("si_erhart_albe", 1), term("si_erhart_albe"));
  EXPECT_EQ(plain.stages[1].products, 8U * 6 * (3 + 2 * 2 + 2));
  EXPECT_EQ(plain.stretch_words, 0U);
  // Atoms follow one another, six cycles each; then they are moved, and a quotient is made.
  EXPECT_EQ(node.cycles_of_evaluation(), 8 * 6 + node.depth + 8 + node.width);
}

// With more bits behind the point the node nears doubles, until its tables are what is left.
TEST(SampleNode, NearsDoublesWithItsBits) {
  const SampleMaterial material = silicon("si_multiscale", 1);
  const auto with = [&](int fraction) {
    return count_sample_node(material, term("si_multiscale"), {.fraction = fraction, .table_words = 1024});
  };
  const SampleNode coarse = with(16), middle = with(22), fine = with(30);
  EXPECT_EQ(fine.width - coarse.width, 14);
  EXPECT_LT(middle.force_error, coarse.force_error / 16);
  EXPECT_LT(fine.force_error, middle.force_error / 4);
  EXPECT_LT(middle.stress_error, 2e-3);
  EXPECT_LT(fine.stress_error, 1e-4);
  EXPECT_GT(coarse.force_error, 0);
}

TEST(SampleNode, EnergyIsOperationsTimesFigures) {
  const SampleNode node = count_sample_node(silicon("si_multiscale", 1), term("si_multiscale"));
  const Technology cmos = technology("cmos45");
  const Energy energy = energy_of(node, 1e9, cmos), slower = energy_of(node, 5e8, cmos);
  const auto row = [](const Energy& of, const std::string& name) {
    const auto at = std::ranges::find(of.rows, name, &EnergyRow::term);
    EXPECT_NE(at, of.rows.end()) << name;
    return at->picojoules;
  };
  const double bits = node.width * node.width * static_cast<double>(node.relaxation.products);
  EXPECT_DOUBLE_EQ(row(energy, "products").low, bits * cmos.at(Constant::multiply_bit2)->band.low);
  EXPECT_DOUBLE_EQ(row(energy, "products").high, bits * cmos.at(Constant::multiply_bit2)->band.high);
  EXPECT_DOUBLE_EQ(row(slower, "leakage of logic").high, 2 * row(energy, "leakage of logic").high);
  Band sum;
  for (const EnergyRow& one : energy.rows) sum += one.picojoules;
  EXPECT_EQ(energy.sum, sum);
  // A relaxation's operations are its evaluations and a little more.
  EXPECT_GE(node.relaxation.products, node.evaluations * node.evaluation().products);
  EXPECT_LT(node.relaxation.products, 1.05 * node.evaluations * node.evaluation().products);
}

// No figure, no zero.
TEST(SampleNode, NamesWhatIsMissing) {
  const SampleNode node = count_sample_node(silicon("si_erhart_albe", 1), term("si_erhart_albe"));
  const Energy none = energy_of(node, 1e9, technology("ecp5")),
               some = energy_of(node, 1e9, technology("cmos45"));
  EXPECT_TRUE(none.rows.empty());
  EXPECT_EQ(none.missing.size(), some.rows.size() + some.missing.size());
  EXPECT_EQ(area_of(node, technology("ecp5")), Band{});
  EXPECT_THROW(energy_of(node, 0, technology("cmos45")), std::invalid_argument);
}

TEST(SampleNode, SaysWhereItsBitsDoNotDo) {
  EXPECT_THROW(count_sample_node(silicon("si_multiscale", 1), term("si_multiscale"), {.strain = -0.3}),
               InputError);
}

}  // namespace
}  // namespace cuboct
