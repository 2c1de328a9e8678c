// SPDX-License-Identifier: MIT
// `cuboct energy` as a user meets it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/cli/refusal.h"

namespace cuboct::test {
namespace {

using Json = nlohmann::json;
using Strings = std::vector<std::string>;

Strings of(const Strings& more) {
  Strings words{"energy", "scenes/undamped_block.toml", "--steps", "20"};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

Json found(const Strings& more) {
  Strings words = of(more);
  words.emplace_back("--json");
  const Answer answer = Bench(false).cuboct(words);
  EXPECT_EQ(answer.code, 0) << answer.err;
  return Json::parse(answer.out);
}

TEST(EnergyCommand, TermsSumToTheTotal) {
  const Json out = found({"--technology", "cmos45,osu018", "--clock", "50 MHz"});
  ASSERT_EQ(out["machines"].size(), 1U);
  const Json& machine = out["machines"][0];
  EXPECT_EQ(machine["steps"], 20);
  const double updates = machine["events"]["updates"], cycles = machine["cycles"];
  EXPECT_EQ(updates, 20 * 256);
  ASSERT_EQ(machine["technologies"].size(), 2U);
  for (const Json& t : machine["technologies"]) {
    double low = 0, high = 0;
    for (const Json& term : t["terms"]) {
      low += term["picojoules"][0].get<double>(), high += term["picojoules"][1].get<double>();
      EXPECT_FALSE(term["source"].get<std::string>().empty());
    }
    EXPECT_NEAR(t["picojoules"][0], low, 1e-9 * low);
    EXPECT_NEAR(t["picojoules"][1], high, 1e-9 * high);
    EXPECT_NEAR(t["joules_per_particle_step"][0], 1e-12 * low / updates, 1e-9 * low);
    EXPECT_NEAR(t["watts"][1], 1e-12 * high / (cycles / 50e6), 1e-9 * high);
    EXPECT_TRUE(std::ranges::count(t["missing"], Json("host link")));
    EXPECT_LT(t["area_mm2"][0], t["area_mm2"][1]);
    EXPECT_FALSE(t["sensitivity"].empty());
  }
}

// 864 atoms, which have two rounds in each step.
TEST(EnergyCommand, ParticlesOfARuleOfTextStepOnceForAllRounds) {
  const Answer answer = Bench(false).cuboct(
      {"energy", "scenes/rules/copper.toml", "--steps", "2", "--technology", "cmos45", "--json"});
  ASSERT_EQ(answer.code, 0) << answer.err;
  const Json out = Json::parse(answer.out);
  const Json& machine = out["machines"][0];
  EXPECT_EQ(machine["events"]["updates"], 2 * 2 * 864);
  const Json& t = machine["technologies"][0];
  for (const int end : {0, 1})
    EXPECT_DOUBLE_EQ(t["joules_per_particle_step"][end].get<double>(),
                     1e-12 * t["picojoules"][end].get<double>() / (2 * 864));
}

// Neither joules nor devices of what no node runs; a stage is chosen.
TEST(EnergyCommand, RefusesRulesOfTextThatHaveNoMachine) {
  const Bench bench(false);
  const std::string arch = bench.path("narrow.toml");
  std::ofstream(arch) << "name = \"narrow\"\n[node]\nmultipliers = \"serial\"\n";
  for (const Strings& command : {Strings{"energy"}, Strings{"boards", "--nodes", "8"}}) {
    Strings words = command;
    words.insert(words.end(), {"scenes/rules/copper.toml", "--arch", arch});
    const Answer answer = bench.cuboct(words);
    EXPECT_EQ(answer.code, 2);
    EXPECT_NE(answer.err.find("the scene has no machine: shared and serial multipliers"), std::string::npos)
        << answer.err;
  }
  EXPECT_EQ(bench.cuboct({"energy", "scenes/rules/plastic.toml", "--stage", "pull", "--steps", "1"}).code, 0);
}

TEST(EnergyCommand, LinesForPeopleHaveBandsSourcesOfDoubtAndNoOrderWithinThem) {
  const Answer answer = Bench(false).cuboct(of({}));
  ASSERT_EQ(answer.code, 0) << answer.err;
  for (const char* line :
       {"clock  100 MHz\n", "links  wires on chip\n", "events of default, 20 steps, ",
        "default in cmos45: 45 nm", "  energy per particle-step ", "  power at 100 MHz ",
        "  area, without what is missing ", "  the sum moves most with, others in the middle\n",
        "  missing: host link\n", "  default in cmos45, default in cmos7: within the band: no order\n"})
    EXPECT_NE(answer.out.find(line), std::string::npos) << line << "\n" << answer.out;
  EXPECT_EQ(answer.out, Bench(false).cuboct(of({})).out);
}

// 0.18 um takes more than 7 nm by more than both bands: the one order that may be told.
TEST(EnergyCommand, BandsApartHaveAnOrder) {
  const Answer answer = Bench(false).cuboct(of({"--technology", "cmos7,osu018"}));
  EXPECT_NE(answer.out.find("  default in cmos7, default in osu018: the first takes less\n"),
            std::string::npos)
      << answer.out;
}

// An FPGA's file lacks memories and has devices: its sum is of other terms.
TEST(EnergyCommand, SumsOfOtherTermsHaveNone) {
  const Json out = found({"--technology", "ice40,osu018"});
  ASSERT_EQ(out["comparisons"].size(), 1U);
  EXPECT_EQ(out["comparisons"][0]["order"], "not the same terms: no order");
}

TEST(EnergyCommand, TwoMachinesSideBySide) {
  const Json out = found({"--technology", "cmos45", "--beside", "scenes/archs/solid.toml"});
  ASSERT_EQ(out["machines"].size(), 2U);
  EXPECT_EQ(out["machines"][1]["arch"], "solid");
  // The same particles, steps and pairs by fewer cycles and candidates.
  const Json &a = out["machines"][0], &b = out["machines"][1];
  EXPECT_EQ(a["events"]["updates"], b["events"]["updates"]);
  EXPECT_EQ(a["events"]["pairs_issued"], b["events"]["pairs_issued"]);
  EXPECT_GT(a["cycles"], b["cycles"]);
  EXPECT_GT(a["events"]["candidates"], b["events"]["candidates"]);
  ASSERT_EQ(out["comparisons"].size(), 1U);
  EXPECT_EQ(out["comparisons"][0]["order"], "within the band: no order");
}

TEST(EnergyCommand, WhatHasNoFigureIsMissingAndNotZero) {
  const Json out = found({"--technology", "ecp5"});
  const Json& t = out["machines"][0]["technologies"][0];
  EXPECT_TRUE(t["terms"].empty());
  EXPECT_TRUE(t["picojoules"].is_null() && t["watts"].is_null() && t["area_mm2"].is_null());
  EXPECT_TRUE(std::ranges::count(t["missing"], Json("pairs: products: no 'multiply_bit2' in ecp5")));
  const Answer answer = Bench(false).cuboct(of({"--technology", "ecp5"}));
  EXPECT_NE(answer.out.find("not known: every term is missing\n"), std::string::npos) << answer.out;
}

TEST(EnergyCommand, LinksBetweenChips) {
  const Json out = found({"--technology", "cmos7", "--link", "lvcmos"});
  const Json& terms = out["machines"][0]["technologies"][0]["terms"];
  const auto link = std::ranges::find_if(terms, [](const Json& t) { return t["term"] == "links"; });
  ASSERT_NE(link, terms.end());
  EXPECT_EQ((*link)["events"], out["machines"][0]["events"]["link_beats"]);
  EXPECT_TRUE(std::ranges::none_of(terms, [](const Json& t) { return t["term"] == "links: wires"; }));
}

// Names of a file reach a terminal as text alone.
TEST(EnergyCommand, NamesOfFilesAreEscaped) {
  const Bench bench(false);
  const std::string technology = bench.path("t.toml");
  std::ofstream(technology) << "name = \"x\\u001b[31m\"\ntitle = \"y\\nz\"\n"
                            << "[add_bit]\nlow = 1\nhigh = 2\nunit = \"pJ/bit\"\nsource = \"s\"\n";
  const Strings words = of({"--technology", technology + ",cmos45"});
  const Answer answer = bench.cuboct(words);
  ASSERT_EQ(answer.code, 0) << answer.err;
  EXPECT_EQ(answer.out.find('\x1b'), std::string::npos);
  EXPECT_EQ(answer.out.find("y\nz"), std::string::npos);
  Strings json = words;
  json.emplace_back("--json");
  EXPECT_EQ(Json::parse(bench.cuboct(json).out)["machines"][0]["technologies"][0]["technology"], "x\x1b[31m");
}

TEST(EnergyCommand, RefusesWrongInput) {
  expect_refusal(of({"--technology", "cmos54"}),
                 "unknown technology 'cmos54'\n  hint: did you mean 'cmos45'?\n");
  expect_refusal(of({"--link", "carrier-pigeon"}),
                 "unknown link 'carrier-pigeon'\n  hint: one of lvcmos, ucie, nvlink or pcie\n");
  expect_refusal(of({"--clock", "3 m"}), "--clock: '3 m' is not a frequency\n  hint: --clock '100 MHz'\n");
  expect_refusal(of({"--clock", "0 Hz"}),
                 "--clock: '0 Hz' is not in [1 Hz, 1 THz]\n  hint: --clock '100 MHz'\n");
  expect_refusal({"energy", "scenes/undamped_block.toml", "--steps", "0"},
                 "--steps: no step, no energy\n  hint: --steps 200\n");
  const Bench bench(false);
  const std::string path = bench.path("t.toml");
  std::ofstream(path) << "name = \"t\"\n[add_bit]\nlow = 1\nhigh = 2\nunit = \"pJ/bit\"\n";
  const Answer answer = bench.cuboct(of({"--technology", path}));
  EXPECT_EQ(answer.code, 2);
  EXPECT_EQ(answer.out, "");
  EXPECT_EQ(without_excerpt(answer.err),
            path +
                ":2:1: 'add_bit' has no source\n"
                "  hint: where low and high are published, or \"measured by\" which script\n");
}

}  // namespace
}  // namespace cuboct::test
