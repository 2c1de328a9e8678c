// SPDX-License-Identifier: MIT
// Learning a peridynamic solid: its operator against the engine's forces, slopes by differences, moduli that
// are known, and the command.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "model/base/error.h"
#include "model/base/mat3.h"
#include "model/rules/lps.h"
#include "study/learn/kernel_fit.h"
#include "tests/cli/shell.h"
#include "tests/support/refused_with.h"

namespace cuboct::learn {
namespace {

Grid square_grid(int points) { return {points, Vec3(5e-10, 5.03e-10, 0), 3.35e-10, 1e-9}; }

// On waves S u is the force density of the engine's rule with the opposite sign. With P = 0 and alpha = 1 the
// kernel is the rule's influence of power 1. The rule divides by its integral of w r^2, whose quadrature is
// exact here: w r^2 = r^4/r^3.
TEST(WaveOperator, IsTheOperatorOfTheEngine) {
  const Grid grid = square_grid(12);
  const WaveOperator symbol(grid, 3);
  const Kernel kernel{-0.2e12, 0.7e12, 1, {1}, 3};
  LpsMaterial material;
  material.dimensions = 2, material.lambda = kernel.lambda, material.mu = kernel.mu;
  material.horizon = 3 * grid.step(), material.influence = 1, material.volume = grid.volume();
  material.spacing = grid.step(), material.quadrature = LpsQuadrature::fitted, material.finite = false;
  Body body;
  body.x = grid.all();
  const Vec3 extent(12 * grid.spacing[0], 12 * grid.spacing[1], 0);
  const auto terms = LpsRule(material, {}).bind({}, body, {-extent / 2, extent}, 1);
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal(0, 1e-12);
  std::vector<Vec3> u;
  std::vector<Vec3> x = body.x;
  for (Vec3& at : x) u.emplace_back(normal(random), normal(random), 0), at += u.back();
  terms->begin(x);
  run_rounds(*terms, 2, x.size(), true);
  const auto force = symbol.waves_of(terms->force()), moved = symbol.waves_of(u);
  const WaveOperator::Parts parts = symbol.parts(symbol.kappa(symbol.kernel_at(kernel.alpha, kernel.D)));
  double size = 0, off = 0;
  for (size_t k = 0; k < symbol.waves(); ++k) {
    const Eigen::Vector2cd expected =
        -WaveOperator::matrix(kernel.lambda, kernel.mu, parts, k) * moved[k] * grid.volume();
    size = std::max(size, force[k].norm()), off = std::max(off, (force[k] - expected).norm());
  }
  EXPECT_GT(size, 0);
  EXPECT_LT(off, 1e-9 * size);
}

// Samples that a solid of these moduli has: what local elasticity, k^2 exactly, says of each load.
std::vector<StaticSample> elastic(const Grid& grid, double lambda, double mu, int waves) {
  std::vector<StaticSample> out;
  for (int axis = 0; axis < 2; ++axis)
    for (int a = 0; a <= waves; ++a)
      for (int b = 0; b <= waves; ++b) {
        if (a + b == 0) continue;
        const double n = grid.points;
        const Eigen::Vector2d k(2 * M_PI * a / (n * grid.spacing[0]), 2 * M_PI * b / (n * grid.spacing[1]));
        StaticSample sample;
        for (const Vec3& x : grid.all()) {
          sample.u.emplace_back(Vec3::Zero()), sample.b.emplace_back(Vec3::Zero());
          // cos cos is the mean of two waves, of k and of its mirror image.
          for (const double sign : {1.0, -1.0}) {
            const Eigen::Vector2d q(k[0], sign * k[1]);
            const Eigen::Matrix2d stiffness =
                mu * q.squaredNorm() * Eigen::Matrix2d::Identity() + (lambda + mu) * q * q.transpose();
            const Eigen::Vector2d u = stiffness.ldlt().solve(Eigen::Vector2d::Unit(axis)) * 1e9;
            eigen(sample.u.back()).head<2>() += u * std::cos(q.dot(eigen(x).head<2>())) / 2;
            sample.b.back()[axis] += 1e9 * std::cos(q.dot(eigen(x).head<2>())) / 2;
          }
        }
        out.push_back(sample);
      }
  return out;
}

TEST(KernelProblem, HasTheSlopesOfItsDifferences) {
  const Grid grid = square_grid(12);
  const WaveOperator symbol(grid, 3);
  const auto samples = elastic(grid, -0.2e12, 0.7e12, 2);
  std::vector<const StaticSample*> all;
  for (const StaticSample& sample : samples) all.push_back(&sample);
  const KernelLoss loss(symbol, all, std::vector<double>(all.size(), 1));
  const KernelInput input;
  KernelProblem problem(symbol, loss, input);
  const Unknowns at{0.6, 0.7, 1.1, 2, 1.5, 1.2, -0.4};
  for (const double penalty : {0.0, 1.0}) {
    problem.penalty = penalty;
    problem.multiplier.assign(problem.constraints(at).size(), 0.1);
    std::vector<double> slope(at.size());
    problem.at(at, slope.data());
    for (size_t k = 0; k < at.size(); ++k) {
      Unknowns ahead = at, behind = at;
      ahead[k] += 1e-6, behind[k] -= 1e-6;
      const double difference = (problem.at(ahead, nullptr) - problem.at(behind, nullptr)) / 2e-6;
      EXPECT_NEAR(slope[k], difference, 1e-5 * (std::abs(difference) + 1))
          << "unknown " << k << ", penalty " << penalty;
    }
  }
}

// Of waves of four spacings and more: what a kernel of three spacings cannot follow is some percent.
TEST(FitKernel, FindsTheModuliOfAnElasticSolid) {
  const Grid grid = square_grid(12);
  const auto training = elastic(grid, -0.2e12, 0.7e12, 2);
  KernelInput input;
  input.evaluations = 1000;
  const KernelFit fit = fit_kernel(grid, training, training, input, {.horizon = 3, .degree = 5});
  EXPECT_NEAR(fit.kernel.mu / 0.7e12, 1, 0.02);
  EXPECT_NEAR(fit.kernel.lambda / -0.2e12, 1, 0.1);
  EXPECT_LT(fit.validation, 0.05);
  EXPECT_GT(fit.constraint, -1e-4);
  EXPECT_GT(fit.curve.front().training, 5 * fit.training);
}

TEST(FitKernel, RefusesWhatItCannotLearnFrom) {
  const Grid grid = square_grid(12);
  auto samples = elastic(grid, -0.2e12, 0.7e12, 1);
  samples[1].u[5][0] = std::nan("");
  EXPECT_EQ(refused_with([&] { fit_kernel(grid, samples, samples, {}, {.horizon = 3, .degree = 3}); }),
            "sample 1 has no load, or a number that is not finite");
  EXPECT_THROW(WaveOperator(grid, 1.1), InputError);
  EXPECT_THROW(WaveOperator(grid, 6), InputError);
}

class LearnCommand : public testing::Test {
 protected:
  std::string study(const std::string& kernel) const {
    const std::string path = bench_.path("small.toml");
    std::ofstream(path)
        << "[sheet]\npotential = \"c_1989\"\nmass = \"2e-26 kg\"\ncells = [16, 9]\n[grid]\npoints = 8\n"
           "[static]\nwaves = 1\ndisc = [{ force = \"x\", centres = \"y\", radius = \"10 angstrom\" }]\n"
        << kernel;
    return path;
  }
  const cuboct::test::Bench bench_{false};
};

// A sheet of 4 nm: its moduli are those of graphene, lambda -0.197 and mu 0.722 TPa (data of LAMMPS).
TEST_F(LearnCommand, LearnsGrapheneAndGoesOn) {
  const std::string path = study("[kernel]\nhorizons = [3]\ndegrees = [5]\nseeds = 2\n");
  const auto answer = bench_.cuboct({"learn", path, "--out", bench_.path("learned"), "--json"});
  ASSERT_EQ(answer.code, 0) << answer.err;
  const nlohmann::json told = nlohmann::json::parse(answer.out);
  EXPECT_EQ(told["samples"]["value"], 6);
  EXPECT_NEAR(told["mu"]["value"].get<double>(), 0.722, 0.0722);
  EXPECT_NEAR(told["lambda"]["value"].get<double>() + 2 * told["mu"]["value"].get<double>(), 1.247, 0.12);
  const std::string kept = cuboct::test::contents(bench_.path("learned/samples.jsonl"));
  const auto again = bench_.cuboct({"learn", path, "--out", bench_.path("learned"), "--json"});
  EXPECT_EQ(again.out, answer.out);
  EXPECT_EQ(cuboct::test::contents(bench_.path("learned/samples.jsonl")), kept);
}

// Their forces would undo one another, and leave samples without a load.
TEST_F(LearnCommand, RefusesDiscsThatOverlap) {
  const std::string path = study("");
  std::string text = cuboct::test::contents(path);
  text.replace(text.find("10 angstrom"), 11, "25 angstrom");
  std::ofstream(path) << text;
  const auto answer = bench_.cuboct({"learn", path, "--out", bench_.path("none")});
  EXPECT_EQ(answer.code, 2);
  EXPECT_EQ(cuboct::test::without_excerpt(answer.err),
            path + ":9:48: a disc of 25 angstrom is wider than half the sheet's edge, 39.42 angstrom\n");
}

// Nothing would move.
TEST_F(LearnCommand, RefusesARestThatLoadsDoNotDisturb) {
  const std::string path = study("[kernel]\nhorizons = [3]\n");
  std::string text = cuboct::test::contents(path);
  text.replace(text.find("waves = 1\n"), 10, "waves = 1\nforce = \"1 eV/angstrom\"\n");
  std::ofstream(path) << text;
  const auto answer = bench_.cuboct({"learn", path, "--out", bench_.path("none")});
  EXPECT_EQ(answer.code, 2);
  EXPECT_EQ(
      cuboct::test::without_excerpt(answer.err),
      path +
          ":9:9: a sheet whose forces are below 1 eV/angstrom is at rest, and 'wave x 1 0' loads an atom "
          "with 0.0324 eV/angstrom at most\n  hint: a smaller 'force'\n");
  EXPECT_FALSE(std::filesystem::exists(bench_.path("none")));
}

// The loads of a sheet that is thick are large: the waves along x pass, and one along y does not. What passed
// is not left behind.
TEST_F(LearnCommand, LeavesNoSamplesOfAStudyThatIsRefused) {
  const std::string path = study("[kernel]\nhorizons = [3]\n");
  std::string text = cuboct::test::contents(path);
  text.replace(text.find("cells"), 5, "thickness = \"5.4 angstrom\"\ncells");
  text.replace(text.find("waves = 1\n"), 10, "waves = 1\nstrain = 0.02\n");
  std::ofstream(path) << text;
  const auto answer = bench_.cuboct({"learn", path, "--out", bench_.path("none"), "--jobs", "1"});
  EXPECT_EQ(answer.code, 2);
  EXPECT_EQ(cuboct::test::without_excerpt(answer.err),
            path +
                ":10:10: wave y 0 1: a bond is strained by 2.24 %, more than 2 %\n  hint: a smaller "
                "'strain'\n");
  EXPECT_FALSE(std::filesystem::exists(bench_.path("none/samples.jsonl")));
  EXPECT_FALSE(std::filesystem::exists(bench_.path("none")));
}

// A kept line that holds no field of the study's grid, or a sheet that did not move.
TEST_F(LearnCommand, RefusesKeptSamplesOfAnotherGrid) {
  const std::string path = study("[kernel]\nhorizons = [3]\ndegrees = [5]\nseeds = 1\n");
  ASSERT_EQ(bench_.cuboct({"learn", path, "--out", bench_.path("learned")}).code, 0);
  const std::string kept = bench_.path("learned/samples.jsonl"), text = cuboct::test::contents(kept);
  const std::string head = text.substr(0, text.find('\n') + 1);
  for (const char* field : {"[1, 2]", "[]", "{\"a\": 1}"}) {
    std::ofstream(kept) << head << "{\"name\":\"wave x 0 1\",\"strain\":0,\"u\":" << field
                        << ",\"b\":" << field << "}\n";
    const auto answer = bench_.cuboct({"learn", path, "--out", bench_.path("learned")});
    EXPECT_EQ(answer.code, 2);
    EXPECT_EQ(answer.err,
              kept +
                  ": line 2 is none of its results\n  hint: it is damaged: take another --out DIR, or "
                  "remove the file and begin again\n");
  }
}

TEST_F(LearnCommand, RefusesAKernelWithoutPoints) {
  const std::string path = study("[kernel]\nhorizons = [5]\n");
  const auto answer = bench_.cuboct({"learn", path, "--out", bench_.path("none")});
  EXPECT_EQ(answer.code, 2);
  EXPECT_EQ(cuboct::test::without_excerpt(answer.err),
            path +
                ":11:12: a horizon of 5 spacings meets itself around 8 points\n  hint: more points, or a "
                "smaller horizon\n");
}

}  // namespace
}  // namespace cuboct::learn
