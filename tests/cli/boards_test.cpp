// SPDX-License-Identifier: MIT
// `cuboct boards` as a user meets it.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "model/config/config.h"
#include "tests/cli/refusal.h"

namespace cuboct::test {
namespace {

using Json = nlohmann::json;
using Strings = std::vector<std::string>;

Strings boards(const Strings& more) {
  Strings words{"boards", "scenes/undamped_block.toml", "--arch", "scenes/archs/solid.toml"};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

TEST(BoardsCommand, CountsEachPartitionAsTheEnginesDo) {
  Bench bench(false);
  const std::string arch = testing::TempDir() + "boards_arch.toml";
  const Answer answer = bench.cuboct(boards({"--nodes", "32", "--steps", "10", "--write", arch, "--json"}));
  ASSERT_EQ(answer.code, 0) << answer.err;
  const Json out = Json::parse(answer.out);
  const double whole = out["one_device_cycles_per_step"];
  ASSERT_GE(out["partitions"].size(), 2u);
  double least = 1e9;
  for (const Json& row : out["partitions"]) {
    EXPECT_GT(row["devices"], 1);
    EXPECT_LE(row["nodes"][0].get<int>() * row["nodes"][1].get<int>() * row["nodes"][2].get<int>(), 32);
    EXPECT_GT(row["by_latency"], 0.0);
    EXPECT_GE(row["by_interval"], 0.0);
    EXPECT_NEAR(row["cycles_per_step"],
                whole + row["by_latency"].get<double>() + row["by_interval"].get<double>(), 1e-6);
    EXPECT_LE(row["lanes"], 80);
    least = std::min(least, row["cycles_per_step"].get<double>());
  }
  for (const Json& figure : out["link"]["figures"]) EXPECT_FALSE(figure["source"].get<std::string>().empty());
  // The arch that was written takes the fastest one's cycles, and leaves golden's bits.
  const Answer run = bench.cuboct(
      {"run", "scenes/undamped_block.toml", "--arch", arch, "--cycles", "--steps", "10", "--json"});
  ASSERT_EQ(run.code, 0) << run.err;
  // With DUMP and a cycle of IDLE, which are no part of a step.
  EXPECT_NEAR(Json::parse(run.out)["cycles"]["value"], 10 * least, 8);
  const Answer check = bench.cuboct({"crosscheck", "scenes/undamped_block.toml", "--arch", arch, "--steps",
                                     "3", "--engines", "golden,lattice"});
  EXPECT_EQ(check.code, 0) << check.out << check.err;
}

// Two rounds in each step, with the same count as the lattice engine's on the arch that was written.
TEST(BoardsCommand, CountsRulesOfText) {
  Bench bench(false);
  const std::string arch = testing::TempDir() + "boards_rule_arch.toml", scene = "scenes/rules/copper.toml";
  const Answer answer =
      bench.cuboct({"boards", scene, "--box", "4,4,2", "--steps", "2", "--write", arch, "--json"});
  ASSERT_EQ(answer.code, 0) << answer.err;
  const Json row = Json::parse(answer.out)["partitions"][0];
  EXPECT_GT(row["by_latency"], 0.0);
  const Answer run = bench.cuboct(
      {"run", scene, "--engine", "lattice", "--arch", arch, "--cycles", "--steps", "2", "--json"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_NEAR(Json::parse(run.out)["cycles"]["value"], 2 * row["cycles_per_step"].get<double>(), 50);
  EXPECT_EQ(
      bench.cuboct({"boards", "scenes/rules/glass.toml", "--device", "ecp5-85"}).err,
      "--device ecp5-85: nodes of a rule with bonds are not built here\n  hint: --nodes N: 'cuboct synth' of "
      "an emitted project tells how many a device holds\n");
}

TEST(BoardsCommand, LinesForPeopleNameAssumptions) {
  const Answer answer = Bench(false).cuboct(boards({"--nodes", "32", "--steps", "2"}));
  ASSERT_EQ(answer.code, 0) << answer.err;
  for (const char* part :
       {"assumed: ", "GDDRX2", "one device with all nodes: ", "cycles/step", "ecp5-lvds: 8 bits"})
    EXPECT_NE(answer.out.find(part), std::string::npos) << part << "\n" << answer.out;
}

TEST(BoardsCommand, RefusesWhatCannotBe) {
  expect_refusal(boards({}),
                 "what a device holds is told 0 times\n  hint: give one of --device NAME, --nodes N, "
                 "--box X,Y,Z\n");
  expect_refusal(boards({"--nodes", "9", "--box", "2,2,2"}),
                 "what a device holds is told 2 times\n  hint: give one of --device NAME, --nodes N, "
                 "--box X,Y,Z\n");
  expect_refusal(boards({"--nodes", "0"}), "--nodes: a device without nodes\n  hint: --nodes 64\n");
  expect_refusal(boards({"--box", "4,0,4"}), "--box: 0 is not in [1, 1048576]\n  hint: --box 4,4,4\n");
  expect_refusal(boards({"--nodes", "9", "--link", "ecp5-lvd"}),
                 "--link: unknown kind 'ecp5-lvd'\n  hint: did you mean 'ecp5-lvds'?\n");
  // A device with a single lane each way: not even a row of devices can be wired.
  std::string text = read_config_text(CUBOCT_SOURCE_DIR "/technologies/boards.toml");
  const std::string lanes = "[serdes.lanes]\nvalue = 32";
  text.replace(text.find(lanes), lanes.size(), "[serdes.lanes]\nvalue = 2");
  const std::string links = testing::TempDir() + "few_lanes.toml";
  std::ofstream(links) << text;
  const Answer few =
      Bench(false).cuboct(boards({"--nodes", "8", "--links", links, "--link", "serdes", "--steps", "2"}));
  EXPECT_EQ(few.code, 2);
  EXPECT_NE(few.err.find("serdes has 2 lanes on a device, which are not enough: the nearest, "),
            std::string::npos)
      << few.err;
}

#ifdef CUBOCT_HAS_SYNTH
TEST(BoardsCommand, RefusesDevicesWithoutLimits) {
  expect_refusal(
      boards({"--device", "ecp5-86"}),
      "unknown target 'ecp5-86'\n  hint: did you mean 'ecp5-85'? there are up5k, hx8k, ecp5-25, ecp5-85, "
      "xc7 and asic\n");
  expect_refusal(boards({"--device", "asic"}),
                 "--device asic: standard cells have no limit\n  hint: an FPGA, such as --device ecp5-85; or "
                 "--nodes N\n");
}
#endif

}  // namespace
}  // namespace cuboct::test
