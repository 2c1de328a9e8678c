// SPDX-License-Identifier: MIT
// `cuboct explore STUDY` of machines, as a user meets it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "model/base/output.h"
#include "tests/cli/shell.h"

namespace cuboct::test {
namespace {

using Json = nlohmann::json;

constexpr const char* kGrid = R"(steps = 10
constraints = ["power <= 60 W", "steps/s >= 1e5"]
minimise = ["time", "energy"]

[[machines]]
technology = ["cmos45", "osu018"]
clock = "50 MHz"
filter_lanes = [2, 8]
force_pipes = [1, 2]
brick = [[1, 1, 1], [9, 9, 9]]
)";

constexpr const char* kBlock = CUBOCT_SOURCE_DIR "/scenes/undamped_block.toml";

// A rule of two rounds.
constexpr const char* kRounds = R"toml(density = "7.8 g/cm^3"
packing = { pitch = "1 mm" }
run = { dt = "0.2 us", steps = 9 }
[box]
periodic = "xyz"
cells = [4, 3, 3]
[[velocity]]
thermal_speed = "300 m/s"
seed = 3
[rule]
reach = "1.3 * pitch"
[rule.particle.crowd]
range = [-40, 40]
[[rule.round]]
sum.n = "1 - r / (1.3 * pitch)"
finish.crowd = "max(min(n, 30), -30)"
[[rule.round]]
sum.force = "(1 kN/m + 0.1 kN/m * (crowd_i + crowd_j)) * (r - pitch) * d / r"
)toml";

struct Machines {
  explicit Machines(const std::string& text, const std::string& scene = kBlock) : bench(false) {
    write_text(bench.path("study.toml"), "scene = \"" + scene + "\"\n" + text);
  }
  Answer explore(const std::vector<std::string>& more = {}, const std::string& jobs = "2") const {
    std::vector<std::string> words{
        "explore", bench.path("study.toml"), "--out", bench.path("results"), "--jobs", jobs};
    words.insert(words.end(), more.begin(), more.end());
    return bench.cuboct(words);
  }
  std::string result(const std::string& name) const { return contents(bench.path("results") + "/" + name); }
  // By the head's names; machines in their order.
  std::vector<std::map<std::string, std::string>> table() const {
    std::istringstream text(result("machines.tsv"));
    std::string line;
    std::vector<std::string> head;
    std::vector<std::map<std::string, std::string>> rows;
    const auto cells = [](const std::string& of) {
      std::vector<std::string> parts{""};
      for (const char c : of)
        if (c == '\t')
          parts.emplace_back();
        else
          parts.back() += c;
      return parts;
    };
    std::getline(text, line);
    head = cells(line);
    std::string last;
    for (std::string& name : head) {  // "high" and "known" are of the column before
      if (name == "high" || name == "known")
        name = last + " " + name;
      else
        last = name.substr(0, name.find(','));
    }
    while (std::getline(text, line)) {
      const auto row = cells(line);
      EXPECT_EQ(row.size(), head.size());
      auto& named = rows.emplace_back();
      for (size_t k = 0; k < row.size(); ++k) named[head[k]] = row[k];
    }
    return rows;
  }
  Bench bench;
};

// Each machine of the grid has the numbers that `cuboct energy` has of its arch.
void expect_numbers_of_energy(const Machines& m, const std::string& scene) {
  const Answer answer = m.explore();
  ASSERT_EQ(answer.code, 0) << answer.err;
  const auto rows = m.table();
  ASSERT_EQ(rows.size(), 16U);
  size_t compared = 0, refused = 0;
  for (const auto& row : rows) {
    refused += !row.at("no machine, because").empty();
    if (row.at("arch.node.brick") != "[1, 1, 1]") continue;
    write_text(m.bench.path("arch.toml"),
               "name = \"a\"\n[node]\nfilter_lanes = " + row.at("arch.node.filter_lanes") +
                   "\nforce_pipes = " + row.at("arch.node.force_pipes") + "\n");
    const Answer energy =
        m.bench.cuboct({"energy", scene, "--arch", m.bench.path("arch.toml"), "--technology",
                        row.at("technology"), "--clock", "50 MHz", "--steps", "10", "--json"});
    ASSERT_EQ(energy.code, 0) << energy.err;
    const Json machine = Json::parse(energy.out)["machines"][0], tech = machine["technologies"][0];
    const auto near = [&](const std::string& column, double expected) {
      EXPECT_NEAR(std::stod(row.at(column)), expected, 1e-5 * expected) << column;
    };
    near("cycles, low", machine["cycles"].get<double>() / 10);
    near("energy, J, low", tech["joules_per_particle_step"][0]);
    near("power, W, low", tech["watts"][0]);
    near("area, m^2, low", 1e-6 * tech["area_mm2"][0].get<double>());
    near("energy high", tech["joules_per_particle_step"][1]);
    near("power high", tech["watts"][1]);
    EXPECT_EQ(row.at("cycles known"), "exact");
    EXPECT_EQ(row.at("energy known"), "estimated");
    ++compared;
  }
  EXPECT_EQ(compared, 8U);
  EXPECT_EQ(refused, 8U);
  EXPECT_NE(answer.out.find("16 machines, 8 refused; cycles are means of 10 steps\n  no machine, 8x: "),
            std::string::npos)
      << answer.out;
}

TEST(ExploreMachines, NumbersAreThoseOfCuboctEnergy) { expect_numbers_of_energy(Machines(kGrid), kBlock); }

TEST(ExploreMachines, NumbersOfARuleOfTextAreThoseOfCuboctEnergy) {
  const Bench scene(false);
  write_text(scene.path("rounds.toml"), kRounds);
  expect_numbers_of_energy(Machines(kGrid, scene.path("rounds.toml")), scene.path("rounds.toml"));
}

// A rule's file counts as the scene's own text does, and the scene that is chosen finds it.
TEST(ExploreMachines, KnowARulesFile) {
  const Bench scene(false);
  const std::string text = kRounds, scene_part = text.substr(0, text.find("reach = "));
  // The tables of a rule's own file have no [rule] before them.
  const std::string rule = std::regex_replace(text.substr(scene_part.size()), std::regex("rule\\."), "");
  write_text(scene.path("rounds.toml"), scene_part + "file = \"rule.toml\"\n");
  write_text(scene.path("rule.toml"), rule);
  const Machines m(std::regex_replace(kGrid, std::regex("constraints.*\n"), ""), scene.path("rounds.toml"));
  ASSERT_EQ(m.explore({"--best"}).code, 0);
  const Answer check = m.bench.cuboct({"check", m.bench.path("results") + "/best_scene.toml"});
  EXPECT_EQ(check.code, 0) << check.err;
  const double before = std::stod(m.table()[0].at("cycles, low"));
  // A round more, before the last.
  write_text(scene.path("rule.toml"),
             std::string(rule).insert(rule.rfind("[[round]]"),
                                      "[[round]]\nsum.again = \"crowd_j\"\nfinish.crowd = "
                                      "\"max(min(again, 30), -30)\"\n"));
  ASSERT_EQ(m.explore().code, 0);
  EXPECT_GT(std::stod(m.table()[0].at("cycles, low")), 1.2 * before);
}

// Nothing in a build without the page.
std::string page_of(const Machines& m) {
#ifdef CUBOCT_HAS_PAGE
  return m.result("page.html");
#else
  return std::to_string(m.table().size());
#endif
}

// Half of the counts lost: the same tables and page to the byte, whatever the threads.
TEST(ExploreMachines, ResumesToTheSameBytes) {
  const Machines m(kGrid);
  ASSERT_EQ(m.explore().code, 0);
  const std::string table = m.result("machines.tsv"), kept = m.result("machines.jsonl"), page = page_of(m);
  std::istringstream lines(kept);
  std::string part, line;
  for (int k = 0; k < 3 && std::getline(lines, line); ++k) part += line + "\n";
  ASSERT_LT(part.size(), kept.size());
  write_text(m.bench.path("results") + "/machines.jsonl", part);
  ASSERT_EQ(m.explore({}, "1").code, 0);
  EXPECT_EQ(m.result("machines.tsv"), table);
  EXPECT_EQ(page_of(m), page);
  // Counts that are there are not counted again: a false one stays.
  std::string wrong = m.result("machines.jsonl");
  const size_t at = wrong.find("\"cycles\":") + 9;
  wrong.replace(at, wrong.find(',', at) - at, "123456");
  write_text(m.bench.path("results") + "/machines.jsonl", wrong);
  ASSERT_EQ(m.explore().code, 0);
  EXPECT_NE(m.result("machines.tsv"), table);
}

TEST(ExploreMachines, ChoosesAndEmits) {
  const Machines m(kGrid);
  const Answer answer = m.explore({"--emit", m.bench.path("rtl")});
  ASSERT_EQ(answer.code, 0) << answer.err;
  for (const char* text :
       {"\nchosen: machine ", "constraints\n  power <= 60 W            holds ",
        "  steps/s >= 1e5           holds ", "/best_arch.toml\n", "/rtl: 216 nodes, 256 particles"})
    EXPECT_NE(answer.out.find(text), std::string::npos) << text << answer.out;
  const Json project = Json::parse(contents(m.bench.path("rtl") + "/project.json"));
  const Answer plan = m.bench.cuboct({"check", "scenes/undamped_block.toml", "--arch",
                                      m.bench.path("results") + "/best_arch.toml", "--json"});
  ASSERT_EQ(plan.code, 0) << plan.err;
  const std::string hash = project["plan"];
  EXPECT_NE(plan.out.find(hash), std::string::npos) << hash;
}

TEST(ExploreMachines, NamesTheNearestWhereNoneKeepsTheConstraints) {
  std::string text = kGrid;
  text.replace(text.find("60 W"), 4, "20 mW");
  const Machines m(text);
  const Answer answer = m.explore({"--best"});
  EXPECT_EQ(answer.code, 1) << answer.err;
  EXPECT_NE(answer.out.find("\nno machine keeps all constraints\nthe nearest: machine "), std::string::npos)
      << answer.out;
  EXPECT_NE(answer.out.find("  power <= 20 mW           fails "), std::string::npos) << answer.out;
}

// osu018's figures of memories and wires are there, ice40's are not: its sums are open.
TEST(ExploreMachines, WhatLacksFiguresIsUndecided) {
  std::string text = kGrid;
  text.replace(text.find("[\"cmos45\", \"osu018\"]"), 20, "\"ice40\"");
  text.replace(text.find("60 W"), 4, "1 MW");
  const Machines m(text);
  const Answer answer = m.explore({"--best"});
  EXPECT_EQ(answer.code, 1) << answer.err;
  EXPECT_NE(answer.out.find("  power <= 1 MW            undecided  at least "), std::string::npos)
      << answer.out;
}

TEST(ExploreMachines, WrongStudiesAreToldAtTheirPlace) {
  const auto expect = [&](const std::string& text, const std::string& error) {
    const Machines m(text);
    const Answer answer = m.explore();
    EXPECT_EQ(answer.code, 2);
    EXPECT_EQ(answer.out, "");
    EXPECT_EQ(without_excerpt(answer.err), m.bench.path("study.toml") + error);
  };
  expect("[[machines]]\nfilter_lane = 3\n",
         ":3:1: unknown key 'filter_lane'\n  hint: did you mean 'filter_lanes'?\n");
  expect("[[machines]]\nfilter_lanes = [1, 65]\n",
         ":3:20: 'filter_lanes' must be between 1 and 64, not 65\n");
  expect("[[machines]]\nclock = \"3 mm\"\n",
         ":3:9: '3 mm' is not a frequency\n  hint: such as \"100 MHz\"\n");
  expect("[[machines]]\ntechnology = [\"cmos46\"]\n",
         ":3:15: unknown technology 'cmos46'\n  hint: did you mean 'cmos45'?\n");
  expect("constraints = [\"power <= 3 m\"]\n[[machines]]\n",
         ":2:16: the limit '3 m' of 'power' is a length, not kg*m^2/s^3\n  hint: such as \"power <= 2 W\"\n");
  expect("constraints = [\"pover <= 3 W\"]\n[[machines]]\n",
         ":2:16: no quantity 'pover'\n  hint: did you mean 'power'?\n");
  expect("constraints = [\"power < 3 W\"]\n[[machines]]\n",
         ":2:16: 'power < 3 W' is no constraint\n  hint: a quantity, <= or >=, a limit, as \"power <= 10 "
         "W\"; or "
         "\"fits ecp5-85\"\n");
  expect("constraints = [\"steps/s >= 1e6\", \"steps/s <= 1e5\"]\n[[machines]]\n",
         ":2:34: no machine keeps both 'steps/s >= 1e6' and 'steps/s <= 1e5'\n");
  expect("constraints = [\"error <= 1%\"]\n[[machines]]\n",
         ":2:16: the study has no figure whose error could be held\n  hint: add a [[figure]]\n");
  expect("minimise = [\"steps/s\"]\n[[machines]]\n",
         ":2:13: less of 'steps/s' is no aim\n  hint: minimise \"time\"\n");
  expect("[[sweep]]\nguard = 4\n[[machines]]\n",
         ":2:1: a study of machines has no 'sweep'\n  hint: its grids are [[machines]]\n");
  expect("[evolve]\npopulation = 10\n", ":3:14: a population is a multiple of 4\n  hint: population = 12\n");
}

}  // namespace
}  // namespace cuboct::test
