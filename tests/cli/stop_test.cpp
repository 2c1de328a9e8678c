// SPDX-License-Identifier: MIT
// Runs that have to stop, and scenes too large to start, as a user meets them.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/cli/shell.h"

namespace cuboct::test {
namespace {

// Two particles, 1.12 apart; the first flies off along -y at 0.0036 cells per step, in a lattice of a cell's
// margin.
std::string stray(const Bench& bench, const std::string& reach = "") {
  const std::string path = bench.path("stray.toml");
  std::ofstream(path) << "title = \"Stray\"\nunits = \"reduced\"\nmass = 1.0\n"
                         "[law]\nkind = \"lj\"\nepsilon = 1.0\nsigma = 1.0\ncutoff = 2.5\n"
                         "[[particle]]\nposition = [0.0, 0.0, 0.0]\nvelocity = [0.0, -9.0, 0.0]\n"
                         "[[particle]]\nposition = [1.12, 0.0, 0.0]\n"
                         "[run]\ndt = 0.001\nsteps = 2000\n"
                      << reach;
  return path;
}

constexpr const char* kLeft = "step 350, cell 1 at (0, -1, 0), particle 0: left the lattice along y (0)";

TEST(Stop, NamesStepNodeAndParticle) {
  const Bench bench(false);
  const Answer answer = bench.cuboct({"run", stray(bench), "--out", bench.path("kept")});
  EXPECT_EQ(answer.code, 1);
  EXPECT_NE(answer.out.find(std::string(" ") + kLeft + "\nended "), std::string::npos)
      << answer.out << answer.err;
  EXPECT_NE(answer.out.find("\nstopped  "), std::string::npos) << answer.out;
  EXPECT_TRUE(std::filesystem::exists(bench.path("kept/trace.h5")));  // what was done is kept
}

TEST(Stop, OfAllEnginesAlikeIsNoSuccess) {
  const Bench bench(true);
  const Answer answer = bench.cuboct({"crosscheck", stray(bench), "--engines", "golden,systemc"});
  EXPECT_EQ(answer.code, 1);
  EXPECT_NE(answer.out.find(std::string("all stopped: ") + kLeft), std::string::npos)
      << answer.out << answer.err;
}

TEST(Stop, AReachOfMoreCellsThanCanBeBuiltIsRefused) {
  const Bench bench(false);
  const Answer answer = bench.cuboct({"check", stray(bench, "[reach]\nmargin = 1e4\n")});
  EXPECT_EQ(answer.code, 2);
  EXPECT_EQ(answer.out, "");
  EXPECT_NE(without_excerpt(answer.err)
                .find(": the reach of a particle spans 6.4e+07 cells of 2.5 m: at most 3e+07 can be built\n"
                      "  hint: a smaller reach.margin\n"),
            std::string::npos)
      << answer.err;
}

TEST(Stop, AGeometryOfMoreSitesThanCanBeTestedIsRefused) {
  const Bench bench(false);
  const std::string path = bench.path("huge.toml");
  std::ofstream(path) << "title = \"Huge\"\nunits = \"reduced\"\nmass = 1.0\n[packing]\npitch = 1.0\n"
                         "[geometry]\nshape = \"sphere\"\nradius = 1e5\n"
                         "[law]\nkind = \"elastic\"\nstiffness = 1.0\n[run]\ndt = \"auto\"\nsteps = 1\n";
  const Answer answer = bench.cuboct({"check", path});
  EXPECT_EQ(answer.code, 2);
  EXPECT_NE(answer.err.find("3.11e+12 sites of the packing, held against 1 parts of the geometry: at most "
                            "4e+09 tests are made"),
            std::string::npos)
      << answer.err;
}

}  // namespace
}  // namespace cuboct::test
