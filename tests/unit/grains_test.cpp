// SPDX-License-Identifier: MIT
// Packings of grains: centres and turns by hand and in the mean, cells by brute force, what a boundary
// leaves out.
#include "model/body/grains.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "model/analysis/scene_cell.h"
#include "model/analysis/strained_cell.h"
#include "model/base/error.h"
#include "model/base/mat3.h"
#include "model/contract/neighbours.h"
#include "model/scene/scene.h"
#include "model/solid/moduli.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

constexpr std::array<bool, 3> kAll{true, true, true};

Periodic cube(double edge) { return {.origin = Vec3(1, 2, 3), .extent = Vec3::Constant(edge)}; }

bool before(const Vec3& a, const Vec3& b) {
  return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
}

// Pairs by how many pitches they are apart, in a box that repeats where `repeats` says.
struct Pairs {
  double least = 1e9;
  std::vector<int> nearest;  // [site]: others at the pitch, to 1e-6

  Pairs(const std::vector<Vec3>& x, const Periodic& repeats) : nearest(x.size(), 0) {
    CellList cells(1.1, repeats);
    cells.build(x);
    cells.for_each_pair(x, [&](uint32_t i, uint32_t j, const Vec3&, double r) {
      least = std::min(least, r);
      if (std::abs(r - 1) < 1e-6) ++nearest[i], ++nearest[j];
    });
  }
  double perfect() const {
    return static_cast<double>(std::ranges::count(nearest, 12)) / static_cast<double>(nearest.size());
  }
};

// mt19937_64(5489) begins with 14514284786278117030 and 4620546740167642908, as the C++ standard has it.
TEST(Grains, CentresAreTheGeneratorsNumbers) {
  const GrainDomain domain{Vec3(1, 2, 3), Vec3(10, 20, 30), kAll};
  const std::vector<Grain> grains = draw_grains({.size = 10, .seed = 5489}, domain);
  ASSERT_EQ(grains.size(), 6U);
  const auto uniform = [](uint64_t bits) { return (static_cast<double>(bits >> 11) + 0.5) * 0x1p-53; };
  EXPECT_EQ(grains[0].centre.x(), 1 + uniform(14514284786278117030ULL) * 10);
  EXPECT_EQ(grains[0].centre.y(), 2 + uniform(4620546740167642908ULL) * 20);
  for (size_t i = 0; i < grains.size(); ++i)
    for (size_t j = 0; j < i; ++j)
      EXPECT_GE(domain.between(grains[i].centre, grains[j].centre).norm(), 5) << i << " " << j;
}

// A rotation that is uniform has entries of mean 0, square 1/3 and fourth power 1/5; about an axis the square
// of the cosine is 1/2 and its fourth power 3/8 in the mean. Within five standard errors.
TEST(Grains, TurnsAreUniform) {
  const double edge = 20;
  const auto means = [&](int axis, int row, int column) {
    const GrainDomain domain{Vec3::Zero(), Vec3::Constant(axis < 0 ? edge : edge * std::sqrt(edge)), kAll};
    std::array<double, 3> sum{};
    const std::vector<Grain> grains = draw_grains({.size = 1, .seed = 7, .column_axis = axis}, domain);
    for (const Grain& grain : grains) {
      EXPECT_LT((grain.turn * grain.turn.transpose() - Mat3::Identity()).norm(), 1e-12);
      EXPECT_NEAR(grain.turn.determinant(), 1, 1e-12);
      const double entry = grain.turn(row, column);
      sum[0] += entry, sum[1] += entry * entry, sum[2] += std::pow(entry, 4);
    }
    for (double& of : sum) of /= static_cast<double>(grains.size());
    EXPECT_EQ(grains.size(), 8000U);
    return sum;
  };
  const double error = 5 / std::sqrt(8000);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) {
      const auto [first, second, fourth] = means(-1, row, column);
      EXPECT_NEAR(first, 0, error * std::sqrt(1.0 / 3));
      EXPECT_NEAR(second, 1.0 / 3, error * std::sqrt(1.0 / 5 - 1.0 / 9));
      EXPECT_NEAR(fourth, 1.0 / 5, error * std::sqrt(1.0 / 9 - 1.0 / 25));
    }
  const auto [first, second, fourth] = means(1, 0, 2);
  EXPECT_NEAR(first, 0, error * std::sqrt(0.5));
  EXPECT_NEAR(second, 0.5, error * std::sqrt(3.0 / 8 - 1.0 / 4));
  EXPECT_NEAR(fourth, 3.0 / 8, error * std::sqrt(35.0 / 128 - 9.0 / 64));
  EXPECT_EQ(means(1, 1, 1)[2], 1);
}

// Oracle: all sites of all images of all crystals, each held against all images of all centres.
TEST(Grains, SitesAreThoseOfTheNearestCentre) {
  const Fcc fcc{.pitch = 1, .offset = {0.3, 0.1, 0.2}};
  for (const std::array<bool, 3>& repeats : {kAll, {true, false, true}}) {
    const Grains grains{.size = 4, .seed = 3, .closest = 1e-9};
    const Periodic box = cube(9);
    const GrainDomain domain = grain_domain(nullptr, box, repeats);
    std::vector<Vec3> centres;
    std::vector<Mat3> turns;
    for (const Grain& grain : draw_grains(grains, domain))
      for (int image = 0; image < 27; ++image) {
        const Vec3 shift(image % 3 - 1, image / 3 % 3 - 1, image / 9 - 1);
        if (!repeats[1] && shift.y() != 0) continue;
        centres.push_back(grain.centre + 9 * shift);
        turns.push_back(grain.turn);
      }
    std::vector<Vec3> expected;
    for (size_t g = 0; g < centres.size(); ++g) {
      const Fcc crystal{1, turns[g], centres[g] + fcc.offset};
      for (const Vec3& x : pack(crystal, sphere(centres[g], 12).get(), {})) {
        const Vec3 in = x - box.origin;
        if (in.minCoeff() < 0 || in.maxCoeff() >= 9) continue;
        size_t nearest = 0;
        for (size_t other = 1; other < centres.size(); ++other)
          if ((x - centres[other]).norm() < (x - centres[nearest]).norm()) nearest = other;
        if (nearest == g) expected.push_back(x);
      }
    }
    std::vector<Vec3> sites = pack_grains(fcc, grains, nullptr, box, repeats);
    EXPECT_GT(sites.size(), 900U);
    std::ranges::sort(sites, before);
    std::ranges::sort(expected, before);
    ASSERT_EQ(sites.size(), expected.size());
    double farthest = 0;
    for (size_t i = 0; i < sites.size(); ++i) farthest = std::max(farthest, (sites[i] - expected[i]).norm());
    EXPECT_LT(farthest, 1e-9);
  }
}

TEST(Grains, OneOfTwoSitesThatAreTooCloseIsLeftOut) {
  const Fcc fcc{.pitch = 1};
  const Periodic box = cube(21);
  const std::vector<Vec3> all = pack_grains(fcc, {.size = 7, .seed = 1, .closest = 1e-9}, nullptr, box, kAll);
  // Cells hold the crystal's density but for the noise of their faces.
  EXPECT_NEAR(static_cast<double>(all.size()), std::sqrt(2) * 9261, 0.01 * 13097);
  const Pairs whole(all, box);
  for (const double closest : {0.6, 0.8}) {
    const std::vector<Vec3> kept =
        pack_grains(fcc, {.size = 7, .seed = 1, .closest = closest}, nullptr, box, kAll);
    const Pairs pairs(kept, box);
    EXPECT_LT(whole.least, 0.3);
    EXPECT_GE(pairs.least, closest);
    // None is left out needlessly: each that went stands too close to one that stayed.
    CellList cells(closest, box);
    std::vector<Vec3> both = kept, sorted = kept;
    std::ranges::sort(sorted, before);
    for (const Vec3& x : all)
      if (!std::ranges::binary_search(sorted, x, before)) both.push_back(x);
    ASSERT_EQ(both.size(), all.size());
    std::vector<char> near(both.size(), 0);
    cells.build(both);
    cells.for_each_pair(both, [&](uint32_t i, uint32_t j, const Vec3&, double) {
      if (i < kept.size()) near[j] = 1;
    });
    EXPECT_EQ(
        static_cast<size_t>(std::count(near.begin() + static_cast<ptrdiff_t>(kept.size()), near.end(), 1)),
        both.size() - kept.size());
    EXPECT_EQ(std::count(near.begin(), near.begin() + static_cast<ptrdiff_t>(kept.size()), 1), 0);
  }
}

TEST(Grains, SameSeedSameBits) {
  const Fcc fcc{.pitch = 0.5};
  const auto packed = [&](uint64_t seed) {
    return pack_grains(fcc, {.size = 3, .seed = seed}, nullptr, cube(9), kAll);
  };
  EXPECT_EQ(packed(1), packed(1));
  EXPECT_NE(packed(1), packed(2));
}

// Columns turn about their axis: planes of sites across it stay planes, and a layer of close-packed rows
// becomes patches of such rows.
TEST(Grains, ColumnsKeepTheirLayers) {
  Fcc fcc{.pitch = 1};
  fcc.orientation.row(0) = eigen(Vec3(1, -1, 0).normalized());
  fcc.orientation.row(1) = eigen(Vec3(1, 1, -2).normalized());
  fcc.orientation.row(2) = eigen(Vec3(1, 1, 1).normalized());
  const auto plate = box(Vec3(0, 0, -0.5), Vec3(60, 60, 0.5));
  const Grains grains{.size = 15, .seed = 2, .column_axis = 2};
  const std::vector<Vec3> sites = pack_grains(fcc, grains, plate.get(), {}, {});
  for (const Vec3& x : sites) ASSERT_NEAR(x.z(), 0, 1e-12);
  // A site of the layer stands for sqrt(3)/2 pitch^2.
  EXPECT_NEAR(static_cast<double>(sites.size()) * std::sqrt(3) / 2 / 3600, 0.98, 0.02);
  const Pairs pairs(sites, {});
  EXPECT_GE(pairs.least, grains.closest);
  EXPECT_GT(static_cast<double>(std::ranges::count(pairs.nearest, 6)),
            0.7 * static_cast<double>(sites.size()));
}

std::string scene_text(const std::string& packing, const std::string& box, const std::string& rest = "") {
  return "units = \"reduced\"\nmass = 1\n[packing]\npitch = 1\n" + packing + "\n[box]\n" + box +
         "\n[law]\nkind = \"elastic\"\n" + (rest.empty() ? "stiffness = 1\n" : rest) + "[run]\nsteps = 1\n";
}

std::string error(const std::string& packing, const std::string& box, const std::string& rest = "") {
  return refused_with([&] { parse_scene(scene_text(packing, box, rest), "a.toml"); });
}

TEST(Grains, WhatCannotBeIsRefusedAtItsKey) {
  const std::string box = "size = [20, 20, 20]\nperiodic = \"xyz\"", some = "grains = { size = 7, seed = 1 }";
  EXPECT_EQ(error(some, box), "accepted");
  EXPECT_EQ(error("grains = { size = 7 }", box), "a.toml:5:10: missing key 'seed' in 'packing.grains'");
  EXPECT_EQ(
      error("grains = { size = 2.5, seed = 1 }", box),
      "a.toml:5:19: grains of 2.5 pitches: they have at least 3\n  hint: a larger size, or a finer pitch");
  EXPECT_EQ(error("grains = { size = 19, seed = 1 }", box),
            "a.toml:5:19: the body holds one grain\n  hint: a smaller size, or no 'grains': 'axes' turn one "
            "crystal");
  EXPECT_EQ(error("grains = { size = 7, seed = 1, closest = 1 }", box),
            "a.toml:5:42: 'closest' must be between 0.3 and 0.95, not 1");
  EXPECT_EQ(error("grains = { size = 7, seed = 1, texture = \"w\" }", box),
            "a.toml:5:42: unknown texture 'w'\n  hint: known: random, x, y or z");
  EXPECT_EQ(error("grains = { size = 7, seed = 1, sed = 1 }", box), "a.toml:5:32: unknown key 'sed'");
  EXPECT_EQ(error("grains = 7", box), "a.toml:5:10: 'grains' must be a table\n  hint: write [grains]");
  const std::string plane = "stiffness = 1\n[[symmetry]]\nnormal = \"x\"\n";
  EXPECT_EQ(
      error(some, "size = [20, 20, 20]\nperiodic = \"yz\"", plane),
      "a.toml:13:10: grains are not their own mirror image along x\n  hint: grains that are columns along "
      "it: texture = \"x\"");
  EXPECT_EQ(error("axes = [[1, 1, 0], [-1, 1, 0]]\n" + some, box),
            "a.toml:5:8: 'axes' serves one crystal, and grains that are columns: others turn any way\n"
            "  hint: give 'grains' a texture = \"x\", \"y\" or \"z\"");
  EXPECT_EQ(error(some, "size = [20, 20, 2.9]\nperiodic = \"z\""),
            "a.toml:5:10: the body has 2.9 pitches along z: grains that turn any way need 3\n"
            "  hint: texture = \"z\" makes columns along it");
  const std::string columns = "grains = { size = 7, seed = 1, texture = \"z\" }";
  EXPECT_EQ(error(columns, "size = [20, 20, 2.9]\nperiodic = \"z\""),
            "a.toml:7:8: the packing does not repeat after 2.9 m along z\n  hint: give 'cells' instead");
  EXPECT_EQ(error(columns, "cells = [14, 14, 2]\nperiodic = \"xyz\""), "accepted");
  EXPECT_EQ(
      error("axes = [[1, 1, -2], [1, 1, 1]]\n" + columns, "size = [20, 20, 1]\nperiodic = \"z\""),
      "a.toml:6:10: the box repeats after 1 pitches along z, grains need 1.3: a site would be near its own "
      "image");
  EXPECT_EQ(
      error(some, box, "youngs_modulus = 1\ndirection = \"x\"\n"),
      "a.toml:12:13: each grain has another crystal direction along x\n  hint: give the crystal direction: "
      "three numbers");
  EXPECT_EQ(error(some, box, "youngs_modulus = 1\ndirection = [1, 1, 0]\n"), "accepted");
  EXPECT_EQ(error(columns, "cells = [14, 14, 2]", "youngs_modulus = 1\ndirection = \"z\"\n"), "accepted");
}

// The density of what is packed, over the crystal's.
double filled(const Scene& scene) {
  return static_cast<double>(scene.body.size()) / (std::sqrt(2) * scene.periodic.extent.prod());
}

TEST(Grains, ASceneIsPackedToItsDensity) {
  struct Of {
    double size, closest, least;
  };
  // Boundaries take some 2.9/size of area per volume, and by default a sixth of a pitch off each.
  for (const auto& [size, closest, least] : {Of{10, 0.65, 0.945}, Of{10, 0.55, 0.97}, Of{18, 0.65, 0.97}}) {
    const double edge = 3 * size;
    const Scene scene =
        parse_scene(scene_text(fmt::format("grains = {{ size = {}, seed = 1, closest = {} }}", size, closest),
                               fmt::format("size = [{}, {}, {}]\nperiodic = \"xyz\"", edge, edge, edge)),
                    "a");
    EXPECT_EQ(scene.grains, 27U);
    EXPECT_GT(filled(scene), least) << size;
    EXPECT_LT(filled(scene), least + 0.02) << size;
    const Pairs pairs(scene.body.x, scene.periodic);
    EXPECT_GE(pairs.least, closest);
    EXPECT_GT(pairs.perfect(), size < 18 ? 0.5 : 0.7);
  }
}

// The means of Voigt and Reuss bound a body whose grains fill it. Here boundaries have fewer pairs: of the
// crystal's pairs per volume a share is left, and Reuss's modulus times that share is the lower bound. The
// bulk modulus has no such bound: boundaries are loose, and give way to pressure.
TEST(Grains, ARelaxedCubeIsAsStiffAsItsCrystalInTheMean) {
  const Scene scene = parse_scene(
      scene_text("grains = { size = 8, seed = 1 }", "size = [13, 13, 13]\nperiodic = \"xyz\""), "a");
  const Scene crystal = parse_scene(scene_text("", "cells = [4, 4, 4]"), "b");
  const Matrix6 perfect = elastic_tensor(crystal.rule, cell_of(crystal, "").cell).c;
  StrainedCell cell(scene.rule, cell_of(scene, "").cell);
  cell.relax();
  const Matrix6 found = elastic_tensor(scene.rule, cell.cell()).c;
  double pairs = 0;
  CellList cells(1.2, scene.periodic);  // the law pulls back that far
  cells.build(cell.cell().x);
  cells.for_each_pair(cell.cell().x, [&](uint32_t, uint32_t, const Vec3&, double) { ++pairs; });
  const double share = pairs / (6 * std::sqrt(2) * scene.periodic.extent.prod());
  EXPECT_LT(share, 0.95);
  EXPECT_GT(share, 0.8);
  const double most = voigt_mean(perfect).youngs(), least = reuss_mean(perfect).youngs();
  EXPECT_LT(voigt_mean(found).youngs(), most);
  EXPECT_GT(reuss_mean(found).youngs(), share * least);
  EXPECT_GT(voigt_mean(found).bulk, 0.7 * voigt_mean(perfect).bulk);
  EXPECT_LT(voigt_mean(found).bulk, voigt_mean(perfect).bulk);
  // Of one crystal it is 0.6.
  EXPECT_NEAR(universal_anisotropy(perfect), 0.6, 1e-6);
  EXPECT_LT(universal_anisotropy(found), 0.2);
}

}  // namespace
}  // namespace cuboct
