// SPDX-License-Identifier: MIT
// What --fit takes a node for: its memories against the RTL's, memories in blocks, lines through what was
// measured.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>

#include "hw/cost/node_memories.h"
#include "hw/plan/setup.h"
#include "hw/rtl/rtl_emit.h"
#include "model/base/process.h"
#include "synth/elaborate.h"
#include "synth/fit_model.h"
#include "synth/json_file.h"
#include "synth/project.h"
#include "synth/script.h"
#include "tests/backend/bond_cases.h"
#include "tests/backend/rule_cases.h"

namespace cuboct::synth {
namespace {

using Kind = NodeMemory::Kind;
using Shapes = std::map<std::pair<uint64_t, int>, int>;  // words, bits: how many

// The memories below the node as yosys reads the RTL, but for tables and delays.
Shapes elaborated(const Plan& plan) {
  const Scratch scratch;
  emit_node(plan, scratch.path("node"));
  std::vector<std::string> files;
  std::ifstream list(scratch.path("node/files.f"));
  for (std::string f; std::getline(list, f);) files.push_back(scratch.path("node/" + f));
  {
    std::ofstream script(scratch.path("read.ys"));
    script << elaborate_script(files, "cuboct_node", scratch.path(""));
  }
  EXPECT_EQ(Process("yosys", {scratch.path("read.ys")}, false, {"/dev/null", "/dev/null"}).wait(), 0);
  const nlohmann::json json = read_json(scratch.path("elaborated.json"));
  const Design design = read_design(scratch.path("elaborated.json"));
  Shapes shapes;
  const std::function<void(const std::string&)> walk = [&](const std::string& key) {
    const Module& module = design.modules.at(key);
    if (module.base.find("_rom") == std::string::npos && json.at("modules").at(key).contains("memories"))
      for (const auto& [name, m] : json.at("modules").at(key).at("memories").items())
        ++shapes[{m.at("size").get<uint64_t>(), m.at("width").get<int>()}];
    for (const auto& [name, child] : module.instances) walk(child);
  };
  walk(design.top);
  return shapes;
}

Shapes counted(const Plan& plan) {
  Shapes shapes;
  for (const NodeMemory& m : memories_of(plan))
    if (!m.holds.starts_with("table")) shapes[{m.words, m.bits}] += m.copies;
  return shapes;
}

std::string text_of(const Shapes& shapes) {
  std::string text;
  for (const auto& [shape, n] : shapes) text += fmt::format("{} x {} of {}\n", n, shape.first, shape.second);
  return text;
}

Plan plan_of_scene(const std::string& scene, const std::function<void(Arch&)>& change) {
  Arch arch;
  change(arch);
  return make_setup(read_scene(CUBOCT_SOURCE_DIR "/scenes/" + scene + ".toml"), arch).plan;
}

TEST(FitMemories, AreThoseOfTheRtl) {
  const Plan arrival = plan_of_scene(
      "undamped_block", [](Arch& a) { a.halos = Halos::arrival, a.streamers = 2, a.force_pipes = 4; });
  EXPECT_EQ(text_of(counted(arrival)), text_of(elaborated(arrival)));
  const Plan brick = plan_of_scene("sheet", [](Arch& a) {
    a.brick = {3, 1, 1}, a.filter_lanes = 3, a.force_pipes = 2;
  });
  EXPECT_EQ(text_of(counted(brick)), text_of(elaborated(brick)));
}

// Of the full tier.
TEST(FitMemories, OfOtherPlansAreThoseOfTheRtl) {
  const Plan flat = plan_of_scene("sheet", [](Arch& a) { a.filter_lanes = 3, a.force_pipes = 2; });
  EXPECT_EQ(text_of(counted(flat)), text_of(elaborated(flat)));
  const Plan held = plan_of_scene("two_types", [](Arch& a) { a.capacity = 11, a.queue_depth = 24; });
  EXPECT_EQ(text_of(counted(held)), text_of(elaborated(held)));
  const Plan plain = plan_of_scene("undamped_block", [](Arch& a) { a.link_bits = 40; });
  EXPECT_EQ(text_of(counted(plain)), text_of(elaborated(plain)));
  const Plan cube = plan_of_scene("two_types", [](Arch& a) { a.brick = {2, 2, 2}, a.capacity = 6; });
  EXPECT_EQ(text_of(counted(cube)), text_of(elaborated(cube)));
}

TEST(FitMemories, OfOtherPlansOfRulesOfTextAreThoseOfTheRtl) {
  Arch arch;
  arch.filter_lanes = 3, arch.force_pipes = 2, arch.capacity = 11;
  const Plan rounds = test::case_of("four", test::hot(test::kFourRounds), arch, 1).setup.plan;
  EXPECT_EQ(text_of(counted(rounds)), text_of(elaborated(rounds)));
  const Plan bonds = test::BondedCase(test::kSprings, {}, arch).c.setup.plan;
  EXPECT_EQ(text_of(counted(bonds)), text_of(elaborated(bonds)));
  const std::string file = CUBOCT_SOURCE_DIR "/scenes/rules/heat.toml";
  const Plan still = program_plan_of(read_scene(file), arch);
  EXPECT_FALSE(graph::moves(still.program->program));
  EXPECT_EQ(text_of(counted(still)), text_of(elaborated(still)));
  EXPECT_TRUE(graph::moves(rounds.program->program));
}

TEST(FitMemories, InBlocksOfTheDevice) {
  const auto bram = [](Family family, uint64_t words, int bits) {
    return memory_counts(family, {"", words, bits, 1, Kind::block})[Resource::bram];
  };
  EXPECT_EQ(bram(Family::ecp5, 512, 36), 1u);
  EXPECT_EQ(bram(Family::ecp5, 513, 36), 2u);
  EXPECT_EQ(bram(Family::ecp5, 160, 165), 5u);
  EXPECT_EQ(bram(Family::ecp5, 16384, 1), 1u);
  EXPECT_EQ(memory_counts(Family::ecp5, {"", 16, 165, 2, Kind::late})[Resource::lut], 2u * 4 * 42);
  // A block costs as much as 32 pieces of LUT memory.
  EXPECT_EQ(memory_counts(Family::ecp5, {"", 32, 30, 1, Kind::late})[Resource::bram], 0u);
  EXPECT_EQ(memory_counts(Family::ecp5, {"", 64, 30, 1, Kind::late})[Resource::bram], 1u);
  EXPECT_EQ(memory_counts(Family::ecp5, {"", 20, 5, 1, Kind::prompt, 3})[Resource::lut], 3u * 4 * 2 * 2);
  EXPECT_EQ(memory_counts(Family::ice40, {"", 3, 12, 1, Kind::late})[Resource::bram], 0u);
  EXPECT_EQ(bram(Family::ice40, 256, 16), 1u);
  EXPECT_EQ(bram(Family::ice40, 257, 16), 2u);
  EXPECT_EQ(bram(Family::ice40, 3, 17), 2u);
  EXPECT_EQ(memory_counts(Family::ice40, {"", 4, 10, 1, Kind::prompt})[Resource::ff], 40u);
  EXPECT_EQ(memory_counts(Family::ice40, {"", 4, 10, 1, Kind::prompt})[Resource::bram], 0u);
  EXPECT_EQ(memory_counts(Family::xc7, {"", 32, 12, 1, Kind::prompt})[Resource::lut], 8u);
}

TEST(FitModel, DrawsLinesAndKeepsWhatWasMeasured) {
  FitModel model;
  const FitAmounts none{};
  EXPECT_EQ(model.predict({{1, 1, 1}, 3, 2}, {5, 0, 0, 7, 0}), (FitAmounts{5, 0, 0, 7, 0}));
  model.add({{1, 1, 1}, 1, 1}, {10, 0, 0, 4, 0}, {110, 50, 7, 6, 0});
  model.add({{1, 1, 1}, 8, 1}, {10, 0, 0, 4, 0}, {180, 64, 7, 6, 0});
  model.add({{1, 1, 1}, 8, 2}, {10, 0, 0, 6, 0}, {230, 80, 14, 9, 0});
  // Ten LUTs and two flip-flops a lane, 50, 16, 7 and a table a pipe; memories are told.
  EXPECT_EQ(model.predict({{1, 1, 1}, 4, 1}, {20, 0, 0, 5, 0}), (FitAmounts{150, 56, 7, 7, 0}));
  EXPECT_EQ(model.predict({{1, 1, 1}, 4, 3}, none), (FitAmounts{230, 88, 21, 4, 0}));
  EXPECT_EQ(model.predict({{1, 1, 1}, 8, 2}, {10, 0, 0, 6, 0}), (FitAmounts{230, 80, 14, 9, 0}));
  // Bricks are other nodes, first taken for these.
  EXPECT_EQ(model.predict({{2, 1, 1}, 4, 1}, none), (FitAmounts{130, 56, 7, 2, 0}));
  model.add({{2, 2, 1}, 4, 1}, none, {1000, 500, 9, 3, 0});
  EXPECT_EQ(model.predict({{2, 2, 1}, 4, 1}, none), (FitAmounts{1000, 500, 9, 3, 0}));
  EXPECT_EQ(model.predict({{2, 1, 1}, 4, 1}, none), (FitAmounts{1000, 500, 9, 3, 0}));
  EXPECT_EQ(model.predict({{1, 1, 1}, 4, 1}, none), (FitAmounts{130, 56, 7, 2, 0}));
  // What is off the line moves its neighbours.
  model.add({{1, 1, 1}, 4, 1}, none, {139, 56, 7, 2, 0});
  EXPECT_EQ(model.predict({{1, 1, 1}, 4, 1}, none), (FitAmounts{139, 56, 7, 2, 0}));
  EXPECT_EQ(model.predict({{1, 1, 1}, 5, 1}, none), (FitAmounts{149, 58, 7, 2, 0}));
  EXPECT_EQ(model.predict({{1, 1, 1}, 8, 1}, none), (FitAmounts{170, 64, 7, 2, 0}));
}

TEST(FitModel, RoomIsWhatIsPlanned) {
  EXPECT_EQ(room_of(target_of("ecp5-85")), (FitAmounts{83640, 83640, 117, 208, UINT64_MAX}));
  EXPECT_EQ(room_of(target_of("up5k")), (FitAmounts{5280, 5280, 8, 30, 5280}));
  EXPECT_EQ(room_of(target_of("xc7"))[2], 240u);
}

}  // namespace
}  // namespace cuboct::synth
