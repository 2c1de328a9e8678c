// SPDX-License-Identifier: MIT
// `cuboct stability` as a user meets it.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>

#include "tests/cli/refusal.h"

namespace cuboct::test {
namespace {

// A free block of 32 particles.
std::string block(const Bench& bench, const std::string& more = "") {
  const std::string path = bench.path("block.toml");
  std::ofstream(path) << "title = \"Block\"\nunits = \"reduced\"\nmass = 1.0\n"
                         "[packing]\npitch = 1.0\n[box]\ncells = [2, 2, 2]\n"
                         "[law]\nkind = \"elastic\"\nstiffness = 2.0\n"
                      << more << "[run]\nsteps = 1\n";
  return path;
}

TEST(Stability, PrintsTheoryBesideWhatItMeasures) {
  const Bench bench(false);
  const Answer answer = bench.cuboct(
      {"stability", block(bench, "[damping]\nratio = 0.3\n"), "--strain", "0", "--resolution", "0.01"});
  EXPECT_EQ(answer.code, 0) << answer.err;
  EXPECT_EQ(answer.err, "");
  // 2/sqrt(8 k/m)
  static const std::regex packing(R"(perfect packing +0\.5\n)");
  EXPECT_TRUE(std::regex_search(answer.out, packing)) << answer.out;
  static const std::regex row(R"((body with its surface|damped) +0\.\d+( +0\.\d+ +(0\.99|1\.00)\d\d){4}\n)");
  const auto begin = std::sregex_iterator(answer.out.begin(), answer.out.end(), row);
  EXPECT_EQ(std::distance(begin, std::sregex_iterator()), 2) << answer.out;
}

TEST(Stability, JsonAndStrain) {
  const Bench bench(false);
  const Answer answer =
      bench.cuboct({"stability", block(bench), "--json", "--resolution", "0.01", "--axis", "y"});
  EXPECT_EQ(answer.code, 0) << answer.err;
  for (const char* part :
       {"\"particles\": 32,", "{\"name\": \"perfect packing\", \"note\": \"\", \"predicted\": 0.5,",
        "\"name\": \"stretched by 10 % along y\"",
        "\"name\": \"pressed by 10 % along y\", \"note\": \"the body itself is unstable: no dt cures that\"",
        "\"euler_fixed\": {\"stable\": 0."})
    EXPECT_NE(answer.out.find(part), std::string::npos) << part << "\n" << answer.out;
}

// Control characters have no place in JSON's strings.
TEST(Stability, JsonIsEscaped) {
  const Bench bench(false);
  const std::string odd = bench.path("a\tb.toml");
  std::filesystem::rename(block(bench), odd);
  const Answer answer = bench.cuboct({"stability", odd, "--json", "--strain", "0", "--resolution", "0.1"});
  EXPECT_EQ(answer.code, 0) << answer.err;
  EXPECT_EQ(answer.out.find('\t'), std::string::npos);
  EXPECT_NE(answer.out.find("/a\\u0009b.toml\", \"particles\": 32,"), std::string::npos) << answer.out;
}

TEST(Stability, RefusesWrongInput) {
  expect_refusal({"stability", "scenes/none.toml"}, "scenes/none.toml: cannot read this file\n");
  expect_refusal({"stability", "scenes/lj_block.toml", "--strian", "0.1"},
                 "unknown option '--strian' of 'cuboct stability'\n  hint: did you mean '--strain'?\n");
  expect_refusal(
      {"stability", "scenes/lj_block.toml", "--strain", "0.7"},
      "--strain: 0.7 is not in [0, 0.5]: the part of its length that the body is stretched and pressed by\n");
  expect_refusal({"stability", "scenes/lj_block.toml", "--resolution", "0"},
                 "--resolution: 0 is not in [0.0001, 0.1]\n");
  expect_refusal({"stability", "scenes/lj_block.toml", "--axis", "w"}, "--axis: 'w' is not x, y or z\n");
  expect_refusal({"stability", "scenes/bench/block_256k.toml", "--maps", "/nowhere"},
                 "--maps runs a scene thousands of times: 256000 particles are more than 5000\n"
                 "  hint: draw them of a smaller piece\n");
}

TEST(Stability, CtrlCPrintsWhatIsThere) {
  const Bench bench(false);
  const Answer answer =
      bench.cuboct({"stability", "scenes/two_types.toml", "--resolution", "0.0001"}, catches_interrupts);
  EXPECT_EQ(answer.code, 1);
  EXPECT_NE(answer.out.find("perfect packing"), std::string::npos) << answer.out;
  EXPECT_EQ(answer.out.find("pressed by"), std::string::npos) << answer.out;
  EXPECT_EQ(answer.err, "interrupted\n");
}

}  // namespace
}  // namespace cuboct::test
