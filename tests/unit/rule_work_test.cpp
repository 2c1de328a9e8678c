// SPDX-License-Identifier: MIT
// What nodes of rules of text are made of, and what their memories read and write.
#include "hw/cost/rule_work.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "hw/cost/energy.h"
#include "tests/backend/rule_cases.h"

namespace cuboct::test {
namespace {

Plan plan_with(const std::string& rule, int pipes = 1) {
  Arch arch;
  arch.force_pipes = pipes;
  return case_of("rule", hot(rule), arch, 1).setup.plan;
}

const MemoryTraffic& memory(const std::vector<MemoryTraffic>& all, const std::string& holds) {
  const auto found = std::ranges::find(all, holds, &MemoryTraffic::holds);
  if (found == all.end()) throw std::logic_error("no memory of " + holds);
  return *found;
}

// Factors have 25 bits and a sign, and so two limbs of 17 bits; each meets each.
TEST(RuleWork, AProductIsThatOfItsLimbs) {
  const auto rule = [](const char* is) {
    return std::string(
               "reach = \"1.3 * pitch\"\nstill = true\n[rule.particle.a]\nrange = [-1, 1]\n"
               "start = \"x.x / pitch / 100\"\n[[rule.round]]\nsum.n = \"") +
           is + "\"\nfinish.a = \"max(min(a + n / 1e6, 0.9), -0.9)\"\n";
  };
  const Plan plain = plan_with(rule("a_j")), product = plan_with(rule("a_j * a_i"));
  const Work before = rule_work(plain).pair, after = rule_work(product).pair;
  EXPECT_EQ(after.products.size() - before.products.size(), 4u);
  EXPECT_GT(after.adder_bits, before.adder_bits);
  EXPECT_GT(after.register_bits, before.register_bits);
}

// What one round does in a run is that of all over their number.
TEST(RuleWork, EachRoundMeetsItsPairsOnce) {
  const Plan plan = plan_with(kFourRounds, 2);
  MachineEvents e;
  e.steps = plan.nodes(), e.pairs = 4000, e.updates = 400, e.candidates = 10000;
  const Technology technology = read_technology(CUBOCT_SOURCE_DIR "/technologies/cmos45.toml");
  const Energy energy = energy_of(plan, e, rule_traffic(plan, e), 10000, 1e8, technology);
  const auto row = std::ranges::find(energy.rows, "pairs: adders", &EnergyRow::term);
  ASSERT_NE(row, energy.rows.end());
  EXPECT_EQ(row->events, 1000);
  const auto finish = std::ranges::find(energy.rows, "update: adders", &EnergyRow::term);
  ASSERT_NE(finish, energy.rows.end());
  EXPECT_EQ(finish->events, 100);
  // Its pipes add to its sums, each of which is read for each particle.
  const auto traffic = rule_traffic(plan, e);
  for (const char* sum : {"sum 1 of round 1", "sum 1 of round 4"}) {
    EXPECT_EQ(memory(traffic, sum).writes, 1000u) << sum;
    EXPECT_EQ(memory(traffic, sum).reads, 1000u + 2 * 100) << sum;
    EXPECT_EQ(memory(traffic, sum).copies, 2) << sum;
  }
}

// kFourRounds sends nothing in its third round. Later numbers count in their round and behind it.
TEST(RuleWork, FacesHoldWhatEachRoundSends) {
  const Plan plan = plan_with(kFourRounds);
  ASSERT_EQ(plan.rounds[2].beats, 0);
  MachineEvents e;
  e.candidates = 6000, e.candidates_y = 4000, e.halos_y = 300;
  const auto all = rule_traffic(plan, e);
  const auto along_y = [&](const std::string& holds) {
    std::vector<MemoryTraffic> found;
    for (const MemoryTraffic& m : all)
      if (m.holds == holds) found.push_back(m);
    return found.at(1);
  };
  EXPECT_EQ(along_y("halos from a face").reads, 4000u);
  EXPECT_EQ(along_y("halos from a face").writes, 100u);
  EXPECT_EQ(along_y("halos, for the relay").reads, 100u);  // along z
  EXPECT_EQ(along_y("numbers of round 2 from a face").reads, 3000u);
  EXPECT_EQ(along_y("numbers of round 4 from a face").reads, 1000u);
  EXPECT_EQ(along_y("numbers of round 4 from a face").writes, 100u);
  EXPECT_EQ(along_y("numbers of round 2 from a face").bits, bits_of(plan.rounds[1].record));
  EXPECT_THROW(along_y("numbers of round 3 from a face"), std::out_of_range);
}

// Flip-flops of nodes as synthesised for ECP5 (docs/measured/data/synth-rules.tsv).
TEST(RuleWork, RegistersAreThoseOfSynthesisedNodes) {
  std::ifstream file(CUBOCT_SOURCE_DIR "/docs/measured/data/synth-rules.tsv");
  int nodes = 0;
  for (std::string line; std::getline(file, line);) {
    std::istringstream cells(line);
    std::string scene, cell;
    std::getline(cells, scene, '\t');
    if (line[0] == '#' || scene == "node of") continue;
    for (int k = 0; k < 4; ++k) std::getline(cells, cell, '\t');  // rounds, cycles, LUT, FF
    std::erase(cell, ',');
    const Band band = register_bits(program_plan_of(
        read_scene(CUBOCT_SOURCE_DIR "/scenes/rules/" + scene + ".toml"), Arch{}, CellForm::cubes));
    EXPECT_LE(band.low, std::stod(cell)) << line;
    EXPECT_GE(band.high, std::stod(cell)) << line;
    ++nodes;
  }
  EXPECT_GE(nodes, 4);
}

}  // namespace
}  // namespace cuboct::test
