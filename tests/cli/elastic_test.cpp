// SPDX-License-Identifier: MIT
// `cuboct elastic` as a user meets it, and runs with static loading.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/cli/refusal.h"

namespace cuboct::test {
namespace {

using Json = nlohmann::json;
using Strings = std::vector<std::string>;

const Strings kLj{"elastic", "--law",   "kind = \"lj\", epsilon = 1.0, sigma = 1.0, cutoff = 2.5",
                  "--pitch", "relaxed", "--reduced"};

Strings with(Strings words, const Strings& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

TEST(Elastic, OfALawIsThePublishedOneBothWays) {
  const Answer answer = Bench(false).cuboct(with(kLj, {"--json"}));
  ASSERT_EQ(answer.code, 0) << answer.err;
  const Json found = Json::parse(answer.out);
  for (const char* way : {"constants", "strained"}) {
    EXPECT_NEAR(found[way][0][0].get<double>(), 97.71, 0.1) << way;
    EXPECT_NEAR(found[way][0][1].get<double>(), 55.63, 0.06) << way;
    EXPECT_NEAR(found[way][3][3].get<double>(), 55.63, 0.06) << way;
  }
  EXPECT_LT(found["difference"].get<double>(), 1e-6);
  EXPECT_EQ(found["directions"].size(), 8U);
  EXPECT_EQ(found["directions"][7]["name"], "stiffest");
}

// C11 = sqrt(2) k/pitch, C12 = C44 = C11/2: E along [100] is 2/3 C11, and Zener's ratio is 2.
TEST(Elastic, OfAPresetPrintsItsClosedForms) {
  const Bench bench(false);
  const Answer answer = bench.cuboct(
      {"elastic", "--law", "kind = \"ductile\", youngs_modulus = \"3 GPa\", direction = \"x\"", "--pitch",
       "0.4 mm", "--density", "1.41 g/cm^3", "--layers", "3", "--polar", bench.path("polar.svg")});
  ASSERT_EQ(answer.code, 0) << answer.err;
  for (const char* line :
       {"cell                  the packing's, of matter: 1 particle\n",
        "C11, C12, C44         4.5 GPa, 2.25 GPa, 2.25 GPa\n", "Zener ratio           2.0000\n",
        "of many grains (Hill)", "     2 ", " 0.6000\n", "     3 ", " 0.7500\n"})
    EXPECT_NE(answer.out.find(line), std::string::npos) << line << "\n" << answer.out;
  const std::string picture = contents(bench.path("polar.svg"));
  EXPECT_NE(picture.find("</svg>"), std::string::npos);
  EXPECT_NE(picture.find("lattice sums"), std::string::npos);
}

TEST(Elastic, OfASceneTakesItsBox) {
  const Answer answer = Bench(false).cuboct({"elastic", "scenes/lj_block.toml"});
  EXPECT_EQ(answer.code, 0) << answer.err;
  EXPECT_NE(answer.out.find("cell                  the scene's box: 256 particles\n"), std::string::npos)
      << answer.out;
}

// K + 4G/3, K - 2G/3 and G of 72 GPa and 0.22, whatever cuts the scene begins with.
TEST(Elastic, OfARuleOfTextIsItsClosedForm) {
  const Answer answer = Bench(false).cuboct({"elastic", "scenes/rules/glass.toml"});
  ASSERT_EQ(answer.code, 0) << answer.err;
  for (const char* line : {"left out              the scene's start of whole, hard: it asks where it is\n",
                           "C11, C12, C44         82.2 GPa, 23.2 GPa, 29.5 GPa\n", "asymmetry over"})
    EXPECT_NE(answer.out.find(line), std::string::npos) << line << "\n" << answer.out;
  EXPECT_EQ(answer.out.find("lattice sums"), std::string::npos);
  // Of stages the first; the other fields of the JSON are null.
  const Answer yields = Bench(false).cuboct({"elastic", "scenes/rules/plastic.toml", "--json"});
  ASSERT_EQ(yields.code, 0) << yields.err;
  const Json found = Json::parse(yields.out);
  EXPECT_NEAR(found["constants"][0][0].get<double>(), std::sqrt(2.0) * 1e6, 1);  // sqrt(2) spring/pitch
  EXPECT_TRUE(found["born"].is_null() && found["difference"].is_null());
  expect_refusal(
      {"elastic", "scenes/rules/heat.toml"},
      "scenes/rules/heat.toml:6:8: a cell at rest leaves out time, and the rule moves no particle\n"
      "   6 | file = \"texts/heat.toml\"\n     |        ^\n");
}

TEST(Elastic, RefusesWrongInput) {
  expect_refusal({"elastic"},
                 "either a scene or --law\n  hint: cuboct elastic SCENE, or cuboct elastic --law 'kind = "
                 "...' --pitch P\n");
  expect_refusal({"elastic", "--law", "kind = \"ductile\""},
                 "--law needs --pitch, the distance of nearest particles\n");
  expect_refusal({"elastic", "scenes/lj_block.toml", "--reduced"},
                 "--pitch, --density and --reduced go with --law\n  hint: a scene has its own\n");
  expect_refusal({"elastic", "scenes/lj_block.toml", "--polar", "e.pdf"},
                 "--polar: 'e.pdf' ends with neither .svg nor .png\n");
  expect_refusal({"elastic", "scenes/lj_block.toml", "--strain", "1"},
                 "--strain: 1 is not in [1e-8, 0.01]\n");
  expect_refusal({"elastic", "scenes/lj_block.toml", "--material", "matter"},
                 "--material is for scenes whose box does not repeat along all axes\n"
                 "  hint: the cell is the box, with all its materials\n");
  const Bench bench(false);
  const std::string loose = bench.path("loose.toml");
  std::ofstream(loose)
      << "units = \"reduced\"\nmass = 1.0\n[law]\nkind = \"lj\"\nepsilon = 1.0\nsigma = 1.0\n"
         "cutoff = 2.5\n[[particle]]\nposition = [0, 0, 0]\n[run]\ndt = 0.01\nsteps = 1\n";
  expect_refusal({"elastic", loose}, loose +
                                         ":8:1: the scene has no cell that repeats\n"
                                         "   8 | [[particle]]\n     | ^\n"
                                         "  hint: give it a [box] with periodic = \"xyz\", or a [packing]\n");
}

// A bar, pulled in five load steps.
std::string bar(const Bench& bench, const std::string& run) {
  const std::string path = bench.path("bar.toml");
  std::ofstream(path)
      << "units = \"reduced\"\nmass = 1.0\n[packing]\npitch = 1.0\naxes = [[1, 1, 0], [-1, 1, 0]]\n"
         "[geometry]\nshape = \"box\"\nsize = [8, 2.1, 2.1]\n[law]\nkind = \"elastic\"\nstiffness = 1.0\n"
         "[damping]\nratio = 0.3\n[regions]\n"
         "left = { shape = \"half_space\", point = [-3.4, 0, 0], normal = \"x\" }\n"
         "right = { shape = \"half_space\", point = [3.4, 0, 0], normal = \"-x\" }\n"
         "[[constraint]]\nname = \"fixed\"\nkind = \"held\"\nregion = \"left\"\n"
         "[[constraint]]\nname = \"pulled\"\nkind = \"moved\"\nvelocity = [0.001, 0, 0]\nregion = \"right\"\n"
         "[[probe]]\nname = \"grip\"\nkind = \"force\"\naxis = \"x\"\nregion = \"right\"\n"
         "[run]\ndt = 0.1\nsteps = 500\n"
      << run;
  return path;
}

TEST(Static, RunWritesWhatARunWrites) {
  const Bench bench(false);
  const std::string scene = bar(bench, "static = { load_steps = 5 }\n"), out = bench.path("run");
  const Answer answer = bench.cuboct({"run", scene, "--out", out, "--json"});
  ASSERT_EQ(answer.code, 0) << answer.err;
  const Json summary = Json::parse(answer.out);
  EXPECT_EQ(summary["engine"]["value"], "reference");
  EXPECT_EQ(summary["steps"]["value"], 500);
  EXPECT_EQ(summary["load_steps"]["value"], 5);
  EXPECT_GT(summary["force_evaluations"]["value"].get<double>(), 10);
  EXPECT_LT(summary["grip.force"]["value"].get<double>(), -0.01);
  const double work = summary["force_evaluations"]["value"].get<double>() *
                      summary["particles"]["value"].get<double>() /
                      summary["host_time"]["value"].get<double>();
  EXPECT_NEAR(summary["speed"]["value"].get<double>(), work, 1e-3 * work);
  EXPECT_EQ(summary["speed"]["unit"], "particles/s");
  EXPECT_EQ(summary["loading"]["value"].get<std::string>().find("static: at each load step "), 0U);
  // While it goes: a row for each load step, and no speed of time steps that nothing makes.
  std::istringstream err(answer.err);
  std::vector<std::string> loads;
  for (std::string line; std::getline(err, line);) {
    std::istringstream words(line);
    std::string step, time, load;
    words >> step >> time >> load;
    loads.push_back(step + " " + load);
  }
  EXPECT_EQ(loads, (std::vector<std::string>{"step loads", "s J", "0 0/5", "100 1/5", "200 2/5", "300 3/5",
                                             "400 4/5", "500 5/5"}))
      << answer.err;
  for (const char* file : {"trace.h5", "frames.xyz", "summary.json"})
    EXPECT_FALSE(contents(out + "/" + file).empty()) << file;
  const Answer report = bench.cuboct({"report", out});
  EXPECT_EQ(report.code, 0) << report.err;
  const Answer check = bench.cuboct({"check", scene});
  EXPECT_NE(check.out.find("static: 5 load steps of 100 steps each, 0.001 of the load unbalanced at most"),
            std::string::npos)
      << check.out;
  EXPECT_NE(check.out.find("5 load steps, each as many evaluations of forces as bring the body to rest, of "),
            std::string::npos)
      << check.out;
  EXPECT_EQ(check.out.find("particle-steps"), std::string::npos) << check.out;
  const Json resolved = Json::parse(bench.cuboct({"check", scene, "--json"}).out);
  EXPECT_EQ(resolved["load_steps"]["value"], 5);
  EXPECT_FALSE(resolved.contains("particle-steps") || resolved.contains("particle_steps"));
}

// A static stage, then one of motion that begins with what it left.
TEST(Static, StagesLoadAndThenMove) {
  const Bench bench(false);
  const std::string scene = bar(bench,
                                "[[stage]]\nname = \"load\"\nstatic = { load_steps = 2 }\n"
                                "[[stage]]\nname = \"move\"\nsteps = 20\n");
  const Answer answer = bench.cuboct({"run", scene, "--out", bench.path("run"), "--json"});
  ASSERT_EQ(answer.code, 0) << answer.err;
  EXPECT_NE(contents(bench.path("run/1-load/summary.json")).find("\"reference\""), std::string::npos);
  EXPECT_NE(contents(bench.path("run/2-move/summary.json")).find("\"lattice\""), std::string::npos);
}

TEST(Static, OtherEnginesAndCommandsRefuse) {
  const Bench bench(false);
  const std::string scene = bar(bench, "static = true\n");
  const std::string hint = "\n  hint: the reference engine relaxes; 'static = false' lets the body move\n";
  const auto expect_refusal = [&](const Strings& arguments, const std::string& text) {
    const Answer answer = bench.cuboct(arguments);
    EXPECT_EQ(answer.code, 2) << answer.out;
    EXPECT_EQ(answer.err, text);
  };
  const std::string excerpt = "\n  34 | static = true\n     |          ^";
  expect_refusal({"run", scene, "--engine", "golden", "--quiet"},
                 scene + ":34:10: static loading is not for the golden engine" + excerpt + hint);
  expect_refusal({"emit", scene, "--out", bench.path("rtl")},
                 scene + ":34:10: static loading is not for hardware" + excerpt + hint);
  expect_refusal({"run", scene, "--precision", "float", "--quiet"},
                 "static loading is in doubles: --precision float is not for it\n");
}

}  // namespace
}  // namespace cuboct::test
