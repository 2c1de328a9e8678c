// SPDX-License-Identifier: MIT
// `cuboct new`: each template is a scene that is read, runs, and shows what its comment says.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
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
                                             "sheet", "release"}));
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
  EXPECT_EQ(refusal({"new", bench.path("b"), "--like", "x"}),
            "unknown template 'x'\n  hint: one of tension, impact, drop, beam, gas, metal, crack, sheet or "
            "release\n");
  EXPECT_EQ(refusal({"new", bench.path("none/b")}),
            "cannot write " + bench.path("none/b.toml") + ": No such file or directory\n");
  EXPECT_FALSE(fs::exists(bench.path("b.toml")));
}

// What the comments promise, of those that run for a second or two.
class Template : public testing::Test {
 protected:
  void run(const std::string& name) {
    const Answer ran = bench_.cuboct({"run", kTemplates + name + ".toml", "--frame-every", "0", "--no-states",
                                      "--out", bench_.path("results")});
    ASSERT_EQ(ran.code, 0) << ran.err;
    trace_ = read_trace(bench_.path("results/trace.h5"));
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
  Bench bench_{false};
  Trace trace_;
};

TEST_F(Template, TensionHasTheModulusThatIsGiven) {
  run("tension");
  const std::vector<double>&strain = curve("tension.strain"), &stress = curve("tension.stress");
  double products = 0, squares = 0;
  for (size_t k = 0; k < strain.size(); ++k)
    if (strain[k] < 0.02) products += strain[k] * stress[k], squares += strain[k] * strain[k];
  EXPECT_NEAR(products / squares, 3e9, 0.03 * 3e9);
  EXPECT_NEAR(stress.back(), 192e6, 3e6);
}

TEST_F(Template, DropRebounds) {
  run("drop");
  const std::vector<double>& speed = curve("block_speed.velocity");
  const double strikes = -*std::min_element(speed.begin(), speed.end());
  EXPECT_NEAR(strikes, 0.527, 0.005);
  EXPECT_NEAR(*std::max_element(speed.begin(), speed.end()), 0.406, 0.005);
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
  EXPECT_NEAR(*std::max_element(tip.begin(), tip.end()), 2 * rest, 0.05 * rest);
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
}

}  // namespace
}  // namespace cuboct::test
