// SPDX-License-Identifier: MIT
// A learned solid that cracks: its forces and damage, its critical stretch from its own crack, and the
// command.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "model/base/error.h"
#include "study/learn/stretch_fit.h"
#include "tests/cli/shell.h"

namespace cuboct::learn {
namespace {

constexpr double kSlit = 25e-10;

Grid grid_of(int points) { return {points, Vec3(5e-10, 5.03e-10, 0), 3.35e-10, 1e-9}; }
Kernel kernel() { return {-0.2e12, 0.7e12, 1, {1.2, 0.9, 0.6}, 3}; }

std::vector<Vec3> strained(const Grid& grid, double xx, double yy, double xy) {
  std::vector<Vec3> u;
  for (const Vec3& x : grid.all()) u.emplace_back(xx * x[0] + xy * x[1], xy * x[0] + yy * x[1], 0);
  return u;
}

// Of equal strain no force is inside; of the quadratic field u_x = c x^2/2 it is (lambda + 2 mu) c, which
// weights that are exact for polynomials reproduce.
TEST(CrackBody, HasTheForcesOfElasticity) {
  const Grid grid = grid_of(14);
  CrackBody body(grid, kernel(), {10, 0.05}, 0);
  const std::vector<size_t> deep = inside(grid, 6);
  ASSERT_EQ(deep.size(), 4u);
  const double size = 0.7e12 * 1e-4 / grid.step();
  const std::vector<Vec3> still = body.force(strained(grid, 1e-4, -2e-4, 3e-4), true);
  for (const size_t i : deep) EXPECT_LT(still[i].norm(), 1e-9 * size);
  std::vector<Vec3> u;
  const double c = 1e5;  // 1/m
  for (const Vec3& x : grid.all()) u.emplace_back(c * x[0] * x[0] / 2, 0, 0);
  const std::vector<Vec3>& bent = body.force(u, true);
  for (const size_t i : deep) EXPECT_NEAR(bent[i][0] / ((-0.2e12 + 1.4e12) * c), 1, 0.02);
}

TEST(CrackBody, RefusesWeightsOfNoStableSolid) {
  const Kernel negative{-0.2e12, 0.7e12, 1, {-1}, 3};
  try {
    CrackBody(grid_of(10), negative, {0.2, 0.05}, kSlit);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("are of no stable solid"), std::string::npos) << error.what();
  }
}

// The slit's bonds are broken from the first; with a stretch far above the critical one all are.
TEST(CrackBody, CountsBrokenBonds) {
  const Grid grid = grid_of(10);
  CrackBody body(grid, kernel(), {0.2, 0.01}, kSlit);
  body.force(std::vector<Vec3>(grid.size(), Vec3::Zero()), true);
  std::vector<double> damage = body.damage();
  // Row 1, half a spacing left of the slit: of its bonds within three spacings those to x > 0 cross it.
  const size_t beside = 10 + 4;
  int crossing = 0, all = 0;
  for (size_t j = 0; j < grid.size(); ++j) {
    const Vec3 r = grid.at(j) - grid.at(beside);
    if (j == beside || r.norm() > 3 * grid.step() * (1 + 1e-6)) continue;
    ++all;
    const double y = grid.at(beside)[1] - r[1] * grid.at(beside)[0] / r[0];
    crossing += grid.at(j)[0] > 0 && y < 10 * grid.spacing[1] / -2 + kSlit;
  }
  EXPECT_GT(crossing, 4);
  EXPECT_NEAR(damage[beside], static_cast<double>(crossing) / all, 1e-6);
  EXPECT_NEAR(damage[99], 0, 1e-9);
  body.force(strained(grid, 0.5, 0.5, 0), true);
  for (const double one : body.damage()) EXPECT_NEAR(one, 1, 1e-6);
}

TEST(ErrorsOf, IsTheMeanOverFrames) {
  const std::vector<CrackState> seen{
      {{Vec3(9, 9, 9)}, {1}}, {{Vec3(2, 0, 0)}, {0.5}}, {{Vec3(0, 4, 0)}, {1}}};
  std::vector<CrackState> off = seen;
  off[0].u[0][0] = 5;
  off[1].u[0][1] = 1, off[2].damage[0] = 0.5;
  const CrackErrors errors = errors_of(off, seen, {0});
  EXPECT_DOUBLE_EQ(errors.displacement, 0.25);
  EXPECT_DOUBLE_EQ(errors.displacement_squares, 0.125);
  EXPECT_DOUBLE_EQ(errors.damage, 0.25);
}

// A sheet that is pulled apart at its lower edge.
std::vector<Frame> pulled(const Grid& grid, int frames, double speed) {
  std::vector<Frame> out;
  const double half = grid.points / 2.0;
  for (int k = 0; k <= frames; ++k) {
    Frame frame;
    for (const Vec3& x : grid.all())
      frame.u.emplace_back(
          k * speed * x[0] / (half * grid.spacing[0]) * (0.5 - x[1] / (2 * half * grid.spacing[1])), 0, 0);
    frame.acceleration.assign(grid.size(), Vec3::Zero());
    frame.b.assign(grid.size(), Vec3::Zero());
    out.push_back(frame);
  }
  return out;
}

// What a solid did gives its critical stretch back, and the prediction with it is the solid itself.
TEST(FitStretch, FindsWhatMadeTheCrack) {
  const Grid grid = grid_of(10);
  const std::vector<double> density(grid.size(), 2160);
  std::vector<Frame> frames = pulled(grid, 14, 1e-10);
  const std::vector<Vec3> velocity(grid.size(), Vec3::Zero());
  const double made = 0.21, interval = 5e-14;
  const PredictionInput input;
  const CrackData edges{grid, density, velocity, frames};
  const std::vector<CrackState> run = predict(edges, kernel(), {made, 0.05}, kSlit, interval, input);
  EXPECT_GT(run.back().damage[65], run.front().damage[65] + 0.1);  // ahead of the slit
  std::vector<Frame> atoms = frames;
  for (size_t k = 0; k < atoms.size(); ++k) atoms[k].u = run[k].u;
  StretchInput search;
  search.low = 0.05, search.high = 0.45, search.frames = {3, 14};
  const StretchFit fit =
      fit_stretch({grid, density, velocity, atoms}, kernel(), kSlit, interval, search, input);
  EXPECT_NEAR(fit.stretch, made, 0.003);
  double least = 1, most = 0;
  for (const StretchPoint& p : fit.tried)
    least = std::min(least, p.errors.displacement), most = std::max(most, p.errors.displacement);
  EXPECT_LT(least, 0.01);
  EXPECT_GT(most, 10 * least);
}

class CracksCommand : public testing::Test {
 protected:
  std::string study(const std::string& points, const std::string& slit = "12") const {
    const std::string path = bench_.path("small.toml");
    std::ofstream(path)
        << "[sheet]\npotential = \"c_1989\"\nmass = \"2e-26 kg\"\ncells = [16, 9]\n[grid]\npoints = "
        << points
        << "\nfine_points = 12\ncoarse_points = 8\n"
           "[static]\nwaves = 1\ndisc = [{ force = \"x\", centres = \"y\", radius = \"10 angstrom\" }]\n"
           "[kernel]\nhorizons = [3]\ndegrees = [5]\nseeds = 2\n"
           "[fracture]\nslit = \""
        << slit
        << " angstrom\"\nvelocity = \"2000 m/s\"\npush = \"3 nN\"\n"
           "duration = \"0.1 ps\"\nframes = 12\n"
           "[stretch]\nhorizon = 3\ndegree = 0\nframes = [3, 8]\n";
    return path;
  }
  const cuboct::test::Bench bench_{false};
};

// A sheet of 4 nm: what it predicts is nearer to the atoms than the edges' motion alone would be by chance,
// and a second command computes no atom anew.
TEST_F(CracksCommand, PredictsCracksAndGoesOn) {
  const std::string path = study("8"), out = bench_.path("cracks");
  const auto answer = bench_.cuboct({"learn", path, "--out", out, "--json"});
  ASSERT_EQ(answer.code, 0) << answer.err;
  const nlohmann::json told = nlohmann::json::parse(answer.out);
  EXPECT_GT(told["critical_stretch"]["value"].get<double>(), 0.04);
  EXPECT_LT(told["critical_stretch"]["value"].get<double>(), 0.44);
  for (const char* test : {"longer_time", "other_load", "finer_grid"}) {
    const double error = told[std::string(test) + ":_displacement"]["value"].get<double>();
    EXPECT_GT(error, 0) << test;
    EXPECT_LT(error, 40) << test;
  }
  const std::string kept = cuboct::test::contents(out + "/cracks.jsonl");
  const std::string cost = cuboct::test::contents(out + "/cost.tsv");
  EXPECT_EQ(std::ranges::count(cost, '\n'), 15);
  const auto again = bench_.cuboct({"learn", path, "--out", out, "--json"});
  EXPECT_EQ(again.out, answer.out);
  EXPECT_EQ(cuboct::test::contents(out + "/cracks.jsonl"), kept);
}

TEST_F(CracksCommand, RefusesAColumnOnTheSlit) {
  const auto answer = bench_.cuboct({"learn", study("9"), "--out", bench_.path("none")});
  EXPECT_EQ(answer.code, 2);
  EXPECT_NE(answer.err.find("small.toml:6:"), std::string::npos) << answer.err;
  EXPECT_NE(answer.err.find("an odd number of points has a column on the slit"), std::string::npos);
}

TEST_F(CracksCommand, RefusesASlitThatPartsTheSheet) {
  const auto answer = bench_.cuboct({"learn", study("8", "50"), "--out", bench_.path("none")});
  EXPECT_EQ(answer.code, 2);
  EXPECT_NE(answer.err.find("a slit of 50 angstrom parts the sheet"), std::string::npos) << answer.err;
}

}  // namespace
}  // namespace cuboct::learn
