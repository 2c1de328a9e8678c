// SPDX-License-Identifier: MIT
// `cuboct new`: each template is a scene that is read, runs, and shows what its comment says.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "model/trace/trace.h"
#include "tests/cli/shell.h"

namespace cuboct::test {
namespace {

namespace fs = std::filesystem;

const std::string kTemplates = CUBOCT_SOURCE_DIR "/scenes/templates/";

// The first words of the lines of --list.
std::vector<std::string> listed() {
  std::istringstream lines(Bench(false).cuboct({"new", "--list"}).out);
  std::vector<std::string> names;
  for (std::string line; std::getline(lines, line);) names.push_back(line.substr(0, line.find(' ')));
  return names;
}

TEST(New, ListsEveryTemplate) {
  const std::vector<std::string> names = listed();
  EXPECT_EQ(names, (std::vector<std::string>{"tension", "impact", "drop", "beam", "gas", "metal", "crack",
                                             "sheet", "release", "rule"}));
  size_t files = 0;
  for (const auto& entry : fs::directory_iterator(kTemplates)) files += entry.path().extension() == ".toml";
  EXPECT_EQ(files, names.size());
}

TEST(New, WritesScenesThatRun) {
  const Bench bench(false);
  for (const std::string& name : listed()) {
    const Answer made = bench.cuboct({"new", bench.path(name), "--like", name});
    EXPECT_EQ(made.code, 0) << made.err;
    const std::string path = bench.path(name + ".toml");
    EXPECT_EQ(contents(path), contents(kTemplates + name + ".toml"));
    const Answer checked = bench.cuboct({"check", path});
    EXPECT_EQ(checked.code, 0) << checked.err;
    EXPECT_EQ(checked.out.find("warning"), std::string::npos) << checked.out;
    std::vector<std::string> run{"run", path, "--steps", "40"};
    if (name == "release") run.insert(run.end(), {"--stage", "relax", "--out", bench.path("stages")});
    const Answer ran = bench.cuboct(run);
    EXPECT_EQ(ran.code, 0) << name << ran.out << ran.err;
  }
}

TEST(New, ReplacesNothingUnasked) {
  const Bench bench(false);
  const std::string path = bench.path("bar.toml");
  EXPECT_EQ(
      bench.cuboct({"new", path}).out,
      path + ": A tensile test: a square bar is held at one end and pulled at the other.\n  cuboct check " +
          path + "\n  cuboct run " + path + " --out out/bar\n");
  const auto refusal = [&](const std::vector<std::string>& arguments) {
    const Answer answer = bench.cuboct(arguments);
    EXPECT_EQ(answer.code, 2);
    EXPECT_EQ(answer.out, "");
    return answer.err;
  };
  EXPECT_EQ(refusal({"new", bench.path("bar"), "--like", "gas"}),
            path + " is there already\n  hint: --force replaces it\n");
  EXPECT_EQ(contents(path), contents(kTemplates + "tension.toml"));
  EXPECT_EQ(bench.cuboct({"new", bench.path("bar"), "--like", "gas", "--force"}).code, 0);
  EXPECT_EQ(contents(path), contents(kTemplates + "gas.toml"));
  EXPECT_EQ(refusal({"new"}), "no NAME for the scene\n  hint: cuboct new --list tells what there is\n");
  EXPECT_EQ(refusal({"new", bench.path("b"), "--like", "tensoin"}),
            "unknown template 'tensoin'\n  hint: did you mean 'tension'?\n");
  EXPECT_EQ(
      refusal({"new", bench.path("b"), "--like", "x"}),
      "unknown template 'x'\n  hint: one of tension, impact, drop, beam, gas, metal, crack, sheet, release "
      "or rule\n");
  EXPECT_EQ(refusal({"new", bench.path("none/b")}),
            "cannot write " + bench.path("none/b.toml") + ": No such file or directory\n");
  EXPECT_FALSE(fs::exists(bench.path("b.toml")));
}

// What the comments promise, read off what a run of theirs tells: its summary, and its curves where a promise
// is of a time.
class Template : public testing::Test {
 protected:
  void run(const std::string& name) {
    const std::string out = bench_.path("results");
    const Answer ran = bench_.cuboct(
        {"run", kTemplates + name + ".toml", "--frame-every", "0", "--no-states", "--out", out});
    ASSERT_EQ(ran.code, 0) << ran.err;
    summary_ = nlohmann::json::parse(contents(out + "/summary.json"));
    trace_ = read_trace(out + "/trace.h5");
  }
  // Of the summary: `member` is "value", "smallest" or "largest".
  double told(const std::string& name, const std::string& member = "value") const {
    return summary_.at(name).at(member).get<double>();
  }
  const std::vector<double>& curve(const std::string& name) const {
    for (const Curve& one : trace_.curves)
      if (one.name == name) return one.value;
    throw std::runtime_error("no curve " + name);
  }
  // Of the last three quarters.
  double mean(const std::string& name) const {
    const std::vector<double>& values = curve(name);
    double sum = 0;
    for (size_t k = values.size() / 4; k < values.size(); ++k) sum += values[k];
    return sum / static_cast<double>(values.size() - values.size() / 4);
  }
  // s, of the first reading at which the curve is `value` or more.
  double time_of(const std::string& name, double value) const {
    const std::vector<double>& values = curve(name);
    const auto at = std::ranges::find_if(values, [&](double one) { return one >= value; });
    if (at == values.end()) throw std::runtime_error(name + " stays below it");
    return told("simulated_time") * static_cast<double>(at - values.begin()) /
           static_cast<double>(values.size() - 1);
  }
  Bench bench_{false};
  nlohmann::json summary_;
  Trace trace_;
};

// The means of both halves of a bar of length L by the heat equation, t s after they begin 50 K above and
// below: 50 K 8/pi^2 sum over odd n of exp(-(n pi/L)^2 t k/(c density))/n^2 away from the mean. 41 layers
// less one stand pitch/sqrt(2) apart.
TEST_F(Template, ARuleOfTextConductsHeat) {
  run("rule");
  const double length = 40e-3 / std::sqrt(2), rate = 50 / (500 * 7800.0), time = told("simulated_time");
  double away = 0;
  for (int n = 1; n < 20; n += 2) {
    const double wave = n * std::numbers::pi / length;
    away += std::exp(-wave * wave * rate * time) / (n * n);
  }
  away *= 50 * 8 / (std::numbers::pi * std::numbers::pi);
  // Layers are 1/40 of the bar: their waves lag by (pi/40)^2/12 of a rate of 0.95.
  EXPECT_NEAR(told("left.T"), 350 - away, 0.02);
  EXPECT_NEAR(told("right.T"), 350 + away, 0.02);
  EXPECT_NEAR(told("left.T"), 334.3, 0.05);
}

TEST_F(Template, TensionHasTheModulusThatIsGiven) {
  run("tension");
  EXPECT_NEAR(told("tension.modulus"), 3.0e9, 0.03 * 3.0e9);
  double error = 0, from = 0, to = 0;
  const std::string note = summary_["tension.modulus"]["note"];
  ASSERT_EQ(std::sscanf(note.c_str(), "+- %lf; slope from %lf to %lf of strain", &error, &from, &to), 3)
      << note;
  EXPECT_LT(error, 0.02 * 3.0e9);
  EXPECT_GT(from, 0.003);  // behind the start-up
  EXPECT_GT(to, 0.02);     // as far as the comment says
  EXPECT_LT(to, 0.04);
  EXPECT_NEAR(told("tension.strength"), 192e6, 3e6);
  EXPECT_NEAR(told("tension.strain"), 0.09, 0.001);
  // The stress is level from a strain of 0.087 on: it rises by less than 0.2 % up to the end.
  EXPECT_GT(told("tension.yield_strain"), 0.085);
  EXPECT_TRUE(summary_["tension.strain_at_break"]["value"].is_null());
}

TEST_F(Template, DropRebounds) {
  run("drop");
  const double strikes = -told("block_speed.velocity", "smallest");
  EXPECT_NEAR(strikes, 0.527, 0.005);
  EXPECT_NEAR(told("block_speed.velocity", "largest"), 0.406, 0.005);
  EXPECT_NEAR(told("floor.force", "largest"), 0.67, 0.01);
  // A rod that meets a rigid wall: a plane wave of stress density c v runs up and down, and the rod is off.
  const double c = std::sqrt(1e6 / 1000), area = std::pow(6e-3, 2);
  const std::vector<double>& force = curve("floor.force");
  const auto pushes = [](double f) { return f > 1e-3; };
  const auto first = std::find_if(force.begin(), force.end(), pushes);
  const auto last = std::find_if(force.rbegin(), force.rend(), pushes).base();
  const double sample = 16e-3 / static_cast<double>(force.size() - 1);
  // Samples are 0.03 ms apart, and the end is soft: a contact of few particles lets go one by one.
  EXPECT_NEAR(static_cast<double>(last - first) * sample, 2 * 6e-3 / c, 3 * sample);
  double sum = 0;
  for (auto at = first + 1; at != first + 10; ++at) sum += *at;
  EXPECT_NEAR(sum / 9, 1000 * c * strikes * area, 0.05 * 1000 * c * strikes * area);
  EXPECT_GE(*std::min_element(force.begin(), force.end()), 0);  // nothing holds it back
}

// Euler and Bernoulli's deflection at rest, and twice it in a swing.
TEST_F(Template, BeamSwingsAboutItsDeflection) {
  run("beam");
  const std::vector<double>& tip = curve("tip.along");
  const double layer = 1.25e-3 / std::sqrt(2.0), square = layer * layer * 10;  // of -5 ... 5 layers: 110/11
  const double rest = 1000 * 9.81 * std::pow(0.1, 4) / (8 * 10e6 * square);
  EXPECT_NEAR(rest, 1.57e-3, 0.01e-3);
  EXPECT_NEAR(told("tip.along", "largest"), 3.2e-3, 0.05e-3);
  EXPECT_NEAR(told("tip.along", "smallest"), 0, 0.05e-3);
  const auto back = std::min_element(tip.begin() + static_cast<ptrdiff_t>(tip.size() / 2), tip.end());
  double sum = 0;
  for (auto at = tip.begin(); at != back; ++at) sum += *at;
  EXPECT_NEAR(sum / static_cast<double>(back - tip.begin()), rest, 0.02 * rest);
}

TEST_F(Template, GasIsNearlyIdeal) {
  run("gas");
  EXPECT_NEAR(mean("gas.temperature"), 318, 3);
  const double volume = std::pow(8 * std::sqrt(2.0) * 11.2e-10, 3);
  EXPECT_NEAR(mean("pressure"), 2048 * 1.380649e-23 * mean("gas.temperature") / volume, 0.1e6);
}

TEST_F(Template, MetalHasItsTemperature) {
  run("metal");
  EXPECT_NEAR(mean("crystal.temperature"), 302, 4);
  EXPECT_NEAR(curve("crystal.temperature").front(), 600, 25);
  EXPECT_NEAR(told("crystal.temperature"), 302, 7);
  EXPECT_NEAR(told("pressure"), 3.1e9, 0.1e9);
}

TEST_F(Template, CrackRunsThroughThePlate) {
  run("crack");
  EXPECT_NEAR(told("grip.force", "largest"), 187, 3);
  EXPECT_NEAR(time_of("grip.force", 0.999 * told("grip.force", "largest")), 62e-6, 2e-6);
  EXPECT_NEAR(time_of("crack.length", 6.5e-3), 80e-6, 4e-6);  // of the 7 mm that are whole
}

TEST_F(Template, SheetTears) {
  run("sheet");
  EXPECT_NEAR(told("pull.force", "largest"), 813, 10);
  EXPECT_NEAR(time_of("pull.force", 0.999 * told("pull.force", "largest")), 91e-6, 2e-6);
}

TEST_F(Template, ImpactBreaksThrough) {
  run("impact");
  const std::vector<double>& speed = curve("ball.velocity");
  EXPECT_NEAR(speed.front(), 600, 1);
  EXPECT_NEAR(speed[static_cast<size_t>(
                  std::lround(static_cast<double>(speed.size() - 1) * 3e-6 / told("simulated_time")))],
              455, 5);
  EXPECT_NEAR(told("ball.velocity"), 444, 3);
}

}  // namespace
}  // namespace cuboct::test
