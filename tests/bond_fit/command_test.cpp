// SPDX-License-Identifier: MIT
// `cuboct fit` of a potential as users meet it.
#include <nlohmann/json.hpp>
#include <regex>

#include "model/atoms/bond_order/tersoff_parameters.h"
#include "model/config/config.h"
#include "tests/bond_fit/silicon_problem.h"
#include "tests/cli/shell.h"

namespace cuboct::bond_fit::test {
namespace {

using cuboct::test::Answer;
using cuboct::test::Bench;
using cuboct::test::contents;

class BondFitCommand : public SiliconFit {
 protected:
  // Its error without the excerpt and the directory.
  std::string refused(const std::string& study) const {
    const Answer answer = bench_.cuboct({"fit", study, "--out", path("none")});
    EXPECT_EQ(answer.code, 2) << answer.out;
    EXPECT_FALSE(std::filesystem::exists(path("none")));
    std::string text = cuboct::test::without_excerpt(answer.err);
    for (size_t at; (at = text.find(path(""))) != std::string::npos;) text.erase(at, path("").size());
    return text;
  }
  const Bench bench_{false};
};

TEST_F(BondFitCommand, WritesParametersThatOthersTake) {
  const std::string study =
      this->study("starts = 9\ntried = 1\nbeside = [\"si_multiscale\"]\n",
                  "[compare]\nevaluations = 100\n[bounds]\nc = [1, 1e6]\nbeta = [1e-7, 1]\n");
  const Answer answer = bench_.cuboct({"fit", study, "--out", path("out"), "--json"});
  ASSERT_EQ(answer.code, 0) << answer.err;
  const nlohmann::json told = nlohmann::json::parse(answer.out);
  EXPECT_EQ(contents(path("out/summary.json")), answer.out);
  EXPECT_LT(told["loss"]["value"].get<double>(), 1e-5);
  EXPECT_NEAR(told["loss_of_si_multiscale"]["value"].get<double>(), 0.0308, 1e-4);
  const Tersoff fitted = read_tersoff(path("out/fitted.tersoff"), {"Si"});
  EXPECT_DOUBLE_EQ(fitted.terms[0].A, told["parameter_A"]["value"].get<double>());
  EXPECT_NEAR(told["B"]["value"].get<double>(), 99, 1e-2);
  EXPECT_DOUBLE_EQ(fitted.terms[0].B, told["parameter_B"]["value"].get<double>());
  const double c44_told = told["C44"]["value"];
  EXPECT_NEAR(diamond_properties(fitted.terms[0], 5.429, false).value[c44] * 160.2176634, c44_told, 1e-3);
  EXPECT_EQ(contents(path("out/trials.tsv")).find("set\tperiodic"), 0U);
  EXPECT_EQ(contents(path("out/convergence.tsv")).find("method\tstart"), 0U);
  EXPECT_NE(contents(path("out/convergence.tsv")).find("granular search\t1\t"), std::string::npos);
}

TEST_F(BondFitCommand, SaysWhereNoSetIsStable) {
  // Ten thousand kelvin: no silicon holds.
  const Answer answer = bench_.cuboct(
      {"fit", study("from = \"si_erhart_albe\"\nstarts = 0\ntried = 1\n", "temperature = \"10000 K\"\n"),
       "--out", path("out")});
  EXPECT_EQ(answer.code, 1);
  EXPECT_EQ(answer.err,
            "none of the 1 sets that were tried is stable\n  hint: trials.tsv says how each failed; try "
            "more sets (fit.tried), or more starts\n");
  EXPECT_FALSE(std::filesystem::exists(path("out/fitted.tersoff")));
  EXPECT_NE(answer.out.find("trial: set 0, loss "), std::string::npos) << answer.out;
}

TEST_F(BondFitCommand, RefusesBeforeItBegins) {
  const std::string head = "[fit]\nkind = \"tersoff\"\nfrom = \"si_erhart_albe\"\nstarts = 0\n";
  const auto with = [&](const std::string& target, const std::string& more = {}) {
    return file(head + target + kPotential + kStability + more);
  };
  std::string less = kTarget;
  less.erase(less.find("C44 ="));
  EXPECT_EQ(refused(file("[fit]\n")), "study.toml:1:1: missing key 'kind' in 'fit'\n");
  EXPECT_EQ(refused(with(less)), "study.toml:5:1: missing key 'C44' in 'target'\n");
  EXPECT_EQ(refused(with(kTarget, "[weights]\nC44 = -1\n")),
            "study.toml:23:7: 'C44' must be at least 0, not -1\n");
  EXPECT_EQ(refused(with(kTarget, "[weights]\nC45 = 1\n")),
            "study.toml:23:1: unknown key 'C45'\n  hint: did you mean 'C44'?\n");
  EXPECT_EQ(refused(with(kTarget, "[bounds]\nlambda1 = [3, 2]\n")),
            "study.toml:23:11: 'lambda1' takes [lowest, highest]\n");
  EXPECT_EQ(
      refused(with(kTarget, "[bounds]\nlambda1 = [3, 4]\n")),
      "study.toml:3:8: lambda1 of si_erhart_albe is 2.83319, outside of its bounds, 3 to 4\n  hint: set "
      "bounds.lambda1\n");
  EXPECT_EQ(refused(file("[fit]\nkind = \"tersof\"\n" + kTarget + kPotential + kStability)),
            "study.toml:2:8: unknown kind 'tersof'\n  hint: did you mean 'tersoff'?\n");
  EXPECT_EQ(refused(file("[fit]\nkind = \"tersoff\"\nstarts = 0\n" + kTarget + kPotential + kStability)),
            "study.toml:3:10: a fit without a start\n  hint: give 'from' or some 'starts'\n");
  EXPECT_EQ(refused(with(kTarget,
                         "[weights]\nenergy = 0\nslope = 0\nB = 0\nCprime = 0\nC11 = 0\nC12 = 0\n"
                         "C44_clamped = 0\nC44 = 0\n")),
            "study.toml:22:1: all weights are 0: every set of parameters has the loss 0/0\n");
}

TEST_F(BondFitCommand, RefusesACutoffAndAStartThatHoldNoLattice) {
  const std::string head = "[fit]\nkind = \"tersoff\"\nfrom = \"si_erhart_albe\"\nstarts = 0\n";
  std::string far = kPotential, wide = kTarget;
  far.replace(far.find("2.85"), 4, "3.75");
  EXPECT_EQ(
      refused(file(head + kTarget + far + kStability)),
      "study.toml:15:5: the cutoff falls from 3.6 to 3.9 angstrom: it must do so between the bond, 2.351, "
      "and the second neighbours, 3.839\n  hint: R - D and R + D; silicon takes 2.85 and 0.15 angstrom\n");
  // Bonds of 3.03 angstrom, drawn far beyond where their force is largest.
  wide.replace(wide.find("5.429"), 5, "7");
  far.replace(far.find("3.75"), 4, "3.5");
  EXPECT_EQ(
      refused(file(head + wide + far + kStability)),
      "study.toml:3:8: with the parameters of si_erhart_albe the lattice of edge 7 angstrom is unstable: B "
      "is -15.7 GPa\n  hint: take another start, or none\n");
}

// Keys that docs/user/potential-fit.md names, "table.key".
std::set<std::string> documented() {
  std::set<std::string> named;
  std::string section, line;
  static const std::regex heading(R"(## `\[([a-z]+)\]`)"), name("`([A-Za-z_0-9]+)`");
  for (std::ifstream in(CUBOCT_SOURCE_DIR "/docs/user/potential-fit.md"); std::getline(in, line);) {
    std::smatch found;
    if (line.starts_with("## ")) section.clear();
    if (line.starts_with("## Top level")) section = "top";
    if (std::regex_search(line, found, heading)) section = found[1];
    if (section.empty() || !line.starts_with("| `")) continue;
    const std::string cell = line.substr(0, line.find(" |", 2));
    for (std::sregex_iterator at(cell.begin(), cell.end(), name), end; at != end; ++at)
      named.insert(section == "top" ? (*at)[1].str() : section + "." + (*at)[1].str());
  }
  return named;
}

TEST_F(BondFitCommand, PageNamesEveryKeyAndNoOther) {
  std::set<std::string> asked;
  record_config_keys(&asked);
  read_bond_study(study("", "[weights]\n[bounds]\n[compare]\n"));
  record_config_keys(nullptr);
  const std::set<std::string> named = documented();
  EXPECT_GT(named.size(), 40U);
  for (const std::string& key : asked)
    if (key.find('.') != std::string::npos) {
      EXPECT_TRUE(named.contains(key)) << key << " is not on the page";
    }
  for (const std::string& key : named) EXPECT_TRUE(asked.contains(key)) << key << " is not read";
}

}  // namespace
}  // namespace cuboct::bond_fit::test
