// SPDX-License-Identifier: MIT
// Scenes with [rule] as a user meets them: `check`, `run` and `report`, and every command that knows pairs
// alone.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "model/base/output.h"
#include "model/trace/trace.h"
#include "tests/cli/shell.h"

namespace cuboct::test {
namespace {

std::string scene_with(const std::string& rule, const std::string& more = "") {
  return "density = \"2440 kg/m^3\"\npacking = { pitch = \"1 mm\" }\n"
         "geometry = { shape = \"box\", min = \"[0, 0, 0] mm\", max = \"[8, 8, 4] mm\" }\n[rule]\n" +
         rule + more + "[run]\ndt = \"auto\"\nsteps = 400\n";
}

const std::string kGlass = "kind = \"lps\"\nyoungs_modulus = \"72 GPa\"\npoissons_ratio = 0.22\n";
const std::string kBreaks = "fracture_energy = \"3.8 J/m^2\"\n";
const std::string kPulled =
    "[[velocity]]\nregion = { shape = \"half_space\", point = \"[0, 4.1, 0] mm\", normal = \"y\" }\n"
    "uniform = \"[0, 40, 0] m/s\"\n";

class RoundsTest : public testing::Test {
 protected:
  std::string scene(const std::string& text) const {
    std::ofstream(bench_.path("scene.toml")) << text;
    return bench_.path("scene.toml");
  }
  const Bench bench_{false};
};

TEST_F(RoundsTest, CheckTellsTheRule) {
  const Answer answer = bench_.cuboct({"check", scene(scene_with(kGlass + kBreaks))});
  ASSERT_EQ(answer.code, 0) << answer.err;
  for (const char* part : {"dilatation", "round", "critical stretch", "particle-steps"})
    EXPECT_NE(answer.out.find(part), std::string::npos) << part << "\n" << answer.out;
}

// Pulled apart at 40 m/s the block breaks; the reference engine is taken without being named.
TEST_F(RoundsTest, RunBreaksAndReports) {
  const std::string out = bench_.path("run");
  const Answer answer =
      bench_.cuboct({"run", scene(scene_with(kGlass + kBreaks, kPulled)), "--out", out, "--json"});
  ASSERT_EQ(answer.code, 0) << answer.err;
  const nlohmann::json summary = nlohmann::json::parse(answer.out);
  EXPECT_EQ(summary["engine"]["value"], "reference");
  EXPECT_GT(summary["largest_damage"]["value"].get<double>(), 0.5);
  EXPECT_LT(summary["mean_damage"]["value"].get<double>(), summary["largest_damage"]["value"].get<double>());
  const Answer report = bench_.cuboct({"report", out});
  EXPECT_EQ(report.code, 0) << report.err;
  const Answer whole = bench_.cuboct({"run", scene(scene_with(kGlass, kPulled)), "--json"});
  ASSERT_EQ(whole.code, 0) << whole.err;
  EXPECT_EQ(nlohmann::json::parse(whole.out)["largest_damage"]["value"], 0);
}

// No noise comes twice, and a run in parts is that in one, whichever engine makes a part.
TEST_F(RoundsTest, NoiseCountsOnFromRunToRun) {
  const auto hash = [&](const char* engine, const char* steps, const std::string& from, const char* out) {
    std::vector<std::string> words{"run",           "scenes/rules/langevin.toml",
                                   "--json",        "--engine",
                                   engine,          "--steps",
                                   steps,           "--out",
                                   bench_.path(out)};
    if (!from.empty()) words.insert(words.end(), {"--from", bench_.path(from)});
    const Answer answer = bench_.cuboct(words);
    EXPECT_EQ(answer.code, 0) << answer.err;
    return nlohmann::json::parse(answer.out)["state_hash"]["value"].get<std::string>();
  };
  const std::string check = bench_.cuboct({"check", "scenes/rules/dpd.toml"}).out;
  for (const char* part : {"drawn anew in each step", "exchanges position, velocity, id"})
    EXPECT_NE(check.find(part), std::string::npos) << check;
  hash("lattice", "6", "", "a"), hash("golden", "5", "a", "b");
  EXPECT_EQ(hash("lattice", "4", "b", "c"), hash("lattice", "15", "", "d"));
}

// No bit depends on how the rule's code runs; compiled code takes every step where it is asked for.
TEST_F(RoundsTest, TheRulesCodeRunsAsAsked) {
  std::vector<std::string> hashes;
  for (const char* code : {"interpreted", "compiled"}) {
    const Answer answer = bench_.cuboct({"run", "scenes/rules/heat.toml", "--engine", "lattice",
                                         "--rule-code", code, "--steps", "5", "--json"});
    ASSERT_EQ(answer.code, 0) << answer.err;
    const nlohmann::json summary = nlohmann::json::parse(answer.out);
    EXPECT_EQ(summary["compiled_steps"]["value"], std::string(code) == "compiled" ? 5 : 0);
    hashes.push_back(summary["state_hash"]["value"]);
    const Answer compared =
        bench_.cuboct({"crosscheck", "scenes/rules/heat.toml", "--rule-code", code, "--steps", "3"});
    EXPECT_EQ(compared.out, "matched 3840 updates over 3 steps in 2 engines\n") << compared.err;
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

// Stages and --from hand broken bonds on: what one stage broke the next one has.
TEST_F(RoundsTest, StagesKeepWhatBroke) {
  const std::string path = scene(scene_with(kGlass + kBreaks, kPulled) +
                                 "[[stage]]\nname = \"open\"\n[[stage]]\nname = \"rest\"\nsteps = 5\n");
  const std::string out = bench_.path("run");
  const Answer answer = bench_.cuboct({"run", path, "--out", out, "--frames", "none", "--json"});
  ASSERT_EQ(answer.code, 0) << answer.err;
  const nlohmann::json stages = nlohmann::json::parse(answer.out)["stages"];
  const auto damage = [](const nlohmann::json& summary) {
    return summary["mean_damage"]["value"].get<double>();
  };
  EXPECT_GT(damage(stages[0]["summary"]), 0.01);
  EXPECT_GE(damage(stages[1]["summary"]), damage(stages[0]["summary"]));
  const auto alone = [&](const std::string& text) {
    return bench_.cuboct({"run", scene(text), "--from", out + "/1-open", "--steps", "5", "--json"});
  };
  const Answer same = alone(scene_with(kGlass + kBreaks));
  ASSERT_EQ(same.code, 0) << same.err;
  EXPECT_EQ(damage(nlohmann::json::parse(same.out)), damage(stages[1]["summary"]));
  const Answer other = alone(scene_with(kGlass + "fracture_energy = \"4 J/m^2\"\n"));
  EXPECT_EQ(other.code, 2) << other.out;
  const nlohmann::json error = nlohmann::json::parse(other.err)["error"];
  EXPECT_TRUE(error["message"].get<std::string>().starts_with("the state was left by other bonds")) << error;
  EXPECT_EQ(error["line"], 4);
  // `check` refuses what a run would.
  const auto checked = [&](const std::string& text) {
    return bench_.cuboct({"check", scene(text), "--from", out + "/1-open", "--json"});
  };
  EXPECT_EQ(checked(scene_with(kGlass + kBreaks)).code, 0);
  const Answer refused = checked(scene_with(kGlass + "fracture_energy = \"4 J/m^2\"\n"));
  EXPECT_EQ(refused.code, 2) << refused.out;
  EXPECT_EQ(refused.err, other.err);
}

// Copper whose halves run into one another: the table of the embedding ends, and what was done is kept.
TEST_F(RoundsTest, ADensityBeyondItsTableKeepsTheTrace) {
  const std::string texts = CUBOCT_SOURCE_DIR "/scenes/rules/texts/";
  const std::string path = scene(
      "mass = \"63.546 u\"\npacking = { pitch = \"1.85 angstrom\" }\n"
      "geometry = { shape = \"box\", min = \"[0, 0, 0] angstrom\", max = \"[6, 6, 6] angstrom\" }\n"
      "velocity = [ { region = { shape = \"half_space\", point = \"[0, 3.1, 0] angstrom\", normal = \"y\" }, "
      "uniform = \"[0, 20, 0] km/s\" } ]\nrun = { dt = \"0.2 fs\", steps = 200 }\nrule = { file = \"" +
      texts + "eam.toml\", potential.file = \"" + texts +
      "copper.eam.alloy\" }\nprobe = [ { name = \"all\", kind = \"field\", field = \"E\", region = { shape = "
      "\"sphere\", radius = \"1 m\" } } ]\n");
  for (const char* engine : {"reference", "golden"}) {
    const std::string out = bench_.path(engine);
    const Answer answer = bench_.cuboct({"run", path, "--engine", engine, "--out", out});
    EXPECT_EQ(answer.code, 1) << answer.err;
    EXPECT_NE(answer.out.find("the embedding of Cu is asked for at 100."), std::string::npos) << answer.out;
    EXPECT_EQ(answer.out.find("advice"), std::string::npos) << answer.out;
    EXPECT_GE(read_trace(out + "/trace.h5").steps(), 9u);
  }
  const Answer report = bench_.cuboct({"report", bench_.path("golden")});
  EXPECT_EQ(report.code, 0) << report.err;
  EXPECT_NE(read_text(bench_.path("golden/report.html")).find("<h2>E: all"), std::string::npos);
}

TEST_F(RoundsTest, WrongInputHasItsPlace) {
  const auto refused = [&](const std::string& text, const std::string& place, const std::string& what) {
    const std::string path = scene(text);
    const Answer answer = bench_.cuboct({"check", path});
    EXPECT_EQ(answer.code, 2) << answer.out;
    EXPECT_TRUE(answer.err.starts_with(path + place)) << answer.err;
    EXPECT_NE(answer.err.find(what), std::string::npos) << answer.err;
  };
  refused(scene_with("kind = \"lps\"\nyoungs_modulus = \"72 GPa\"\n"), ":4:1:", "poissons_ratio");
  refused(scene_with(kGlass + "horizon = \"-1 mm\"\n"), ":8:", "horizon");
  refused(scene_with("kind = \"lsp\"\n"), ":5:", "lps");
  refused(scene_with(kGlass,
                     "[[probe]]\nname = \"tip\"\nkind = \"crack\"\naxis = \"x\"\nregion = { shape = "
                     "\"sphere\", radius = \"9 mm\" }\n"),
          ":10:", "counts the bonds of a pair law");
}

// No command takes the rule for a law without force.
TEST_F(RoundsTest, WhatKnowsPairsAloneRefuses) {
  const std::string path = scene(scene_with(kGlass));
  for (const std::vector<std::string>& command :
       std::vector<std::vector<std::string>>{{"run", path, "--engine", "lattice"},
                                             {"run", path, "--engine", "golden"},
                                             {"check", path, "--machine"},
                                             {"crosscheck", path},
                                             {"energy", path, "--technology", "cmos45"},
                                             {"elastic", path},
                                             {"stability", path},
                                             {"emit", path, "--out", bench_.path("rtl")}}) {
    const Answer answer = bench_.cuboct(command);
    EXPECT_EQ(answer.code, 2) << command[0] << answer.out << answer.err;
    EXPECT_EQ(answer.err.find(path + ":"), 0U) << command[0] << answer.err;
    EXPECT_NE(answer.err.find("knows the pair law alone"), std::string::npos) << command[0] << answer.err;
    EXPECT_NE(answer.err.find("reference engine runs it"), std::string::npos) << command[0] << answer.err;
  }
}

}  // namespace
}  // namespace cuboct::test
