// SPDX-License-Identifier: MIT
// Curves that are read, and those that are refused, word for word.
#include "study/law_fit/target.h"

#include "model/base/error.h"
#include "tests/fit/small_fit.h"

namespace cuboct::fit::test {
namespace {

class Target : public SmallFit {
 protected:
  // Without the directory.
  std::string refusal(const std::string& target) {
    try {
      read_fit(study(target, ""));
    } catch (const InputError& error) {
      std::string text = error.what();
      for (size_t at; (at = text.find(path(""))) != std::string::npos;) text.erase(at, path("").size());
      return text;
    }
    return "accepted";
  }
  std::string of_csv(const std::string& csv, const std::string& keys = "") {
    std::ofstream(path("t.csv")) << csv;
    return refusal("file = \"t.csv\"\n" + keys);
  }
};

TEST_F(Target, ReadsUnitsFromHeaderOrKeys) {
  for (const auto& [csv, keys] :
       {std::pair{"strain (%),stress (MPa)\n0,0\n# half way\n0.5,15\n1,20\n", ""},
        {"Stress;eps\n0;0\n15;0.005\n20;0.01\n",
         "strain_column = \"eps\"\nstress_column = \"Stress\"\nstress_unit = \"MPa\"\n"},
        {"strain,stress/kPa\n0,0\n0.005,15000\n0.01,2e4\n", ""},
        {"strain [%]\tstress [Pa]\n0\t0\n0.5\t15e6\n1\t20e6\n", ""}}) {
    std::ofstream(path("t.csv")) << csv;
    const auto read = read_fit(study(std::string("file = \"t.csv\"\n") + keys, "")).target;
    EXPECT_EQ(read.stress, (std::vector<double>{0, 15e6, 20e6})) << csv;
    EXPECT_DOUBLE_EQ(read.strain[1], 0.005);
    EXPECT_DOUBLE_EQ(read.modulus, 3e9);
    EXPECT_DOUBLE_EQ(read.strength, 20e6);
    EXPECT_DOUBLE_EQ(read.yield_strain, 0.01);
    EXPECT_EQ(read.even_stress.size(), read.even_strain.size());
    EXPECT_NEAR(read.even_stress[50], 7.5e6, 1);
  }
}

// A unit in the header and another in the study: one of them is wrong.
TEST_F(Target, AUnitThatTheHeaderContradictsIsRefused) {
  const std::string rows = "0,0\n0.5,15\n1,20\n";
  EXPECT_EQ(of_csv("strain (%),stress (MPa)\n" + rows, "stress_unit = \"N/mm^2\"\nstrain_unit = \"%\"\n"),
            "accepted");
  EXPECT_EQ(of_csv("strain (mm/mm),stress (psi)\n" + rows, "stress_unit = \"kPa\"\nstrain_unit = \"1\"\n"),
            "accepted");  // words that are not known say nothing
  const std::string stress = of_csv("strain,stress (MPa)\n" + rows, "stress_unit = \"kPa\"\n");
  EXPECT_NE(stress.find("'kPa' is not the unit that line 1 of t.csv states for 'stress', 'MPa'\n"
                        "  hint: without 'stress_unit' the file's unit holds"),
            std::string::npos)
      << stress;
  const std::string strain = of_csv("# x\nstrain [%],stress (MPa)\n" + rows, "strain_unit = \"1\"\n");
  EXPECT_NE(strain.find("'1' is not the unit that line 2 of t.csv states for 'strain', '%'"),
            std::string::npos)
      << strain;
}

TEST_F(Target, RefusesWhatIsNoCurve) {
  const std::string head = "strain,stress (MPa)\n";
  EXPECT_EQ(
      of_csv("strain,stress\n0,0\n1,2\n2,3\n"),
      "t.csv:1:8: the unit of 'stress' is missing\n  hint: write 'stress (MPa)', or stress_unit = \"MPa\" in "
      "[target]");
  EXPECT_EQ(of_csv("strain,stress (mm)\n0,0\n1,2\n2,3\n"),
            "t.csv:1:8: 'mm' is no unit of a pressure\n  hint: e.g. MPa");
  EXPECT_EQ(
      of_csv(head + "0,0\n0.1,10\n0.1,12\n0.2,14\n"),
      "t.csv:4:1: strains must ascend, but 0.1 follows 0.1\n  hint: a curve that goes back is no function of "
      "strain: leave the unloading out");
  EXPECT_EQ(of_csv(head + "0,0\n0.1,nan\n0.2,3\n"), "t.csv:3:5: 'nan' is no finite number");
  EXPECT_EQ(of_csv(head + "0,0\n0.1,1e13\n0.2,3\n"),
            "t.csv:3:1: a stress of 1e+19 Pa at a strain of 0.1: at most 1e+18 Pa and 100 are taken\n"
            "  hint: the right units of the columns");
  EXPECT_EQ(of_csv(head + "0,0\n0.1,\n0.2,3\n"), "t.csv:3:5: '' is no finite number");
  EXPECT_EQ(of_csv(head + "0,0\n0.1\n0.2,3\n"), "t.csv:3:1: 1 fields, but the header has 2");
  EXPECT_EQ(of_csv(head + "0,0\n0.1,3\n"), "t.csv:2:1: 2 points, but at least 3 are needed");
  EXPECT_EQ(of_csv(head + "-0.1,0\n0.1,3\n0.2,3\n"), "t.csv:2:1: the first strain is -0.1, below 0");
  EXPECT_EQ(of_csv(head + "0,5\n0.1,8\n0.2,9\n"),
            "t.csv:2:1: the stress at strain 0 is 5e+06 Pa: a body at rest has none\n  hint: take the stress "
            "of the "
            "start off, or let strains count from where it is 0");
  EXPECT_EQ(
      of_csv(head + "0,0\n0.1,-8\n0.2,9\n"),
      "t.csv:2:1: the curve begins with a slope of -8e+07 Pa: no law has a modulus that is not above 0");
  EXPECT_EQ(of_csv(head + "0,0\n0.1,-8\n0.2,-9\n"),
            "t.csv:2:1: the largest stress is 0 Pa: this is no curve of tension");
  EXPECT_EQ(
      of_csv("eps,stress (MPa)\n0,0\n1,2\n2,3\n"),
      "t.csv:1:1: no column 'strain'\n  hint: known: eps or stress; strain_column in [target] names another");
  EXPECT_EQ(of_csv("# nothing\n"), "study.toml:7:8: t.csv holds no curve");
}

TEST_F(Target, RefusesListsThatAreNone) {
  EXPECT_EQ(refusal("strain = [0, 0.1]\nstress = \"[0, 1, 2] MPa\"\n"),
            "study.toml:8:10: 'strain' has 2 points, 'stress' has 3");
  EXPECT_EQ(refusal("strain = [0, 0.2, 0.1]\nstress = \"[0, 1, 2] MPa\"\n"),
            "study.toml:7:10: strains must ascend, but 0.1 follows 0.2\n  hint: a curve that goes back is no "
            "function "
            "of strain: leave the unloading out");
  EXPECT_EQ(refusal("strain = [0, 0.1, 0.2]\nstress = [0, 1, 2]\n").substr(0, 34),
            "study.toml:8:10: 'stress' needs a ");
  EXPECT_EQ(refusal("strain = [0, 0.1, 0.2]\nstress = \"[0, 1, 2] MPa\"\nto = 0.15\n"),
            "study.toml:9:6: 2 points lie up to there, but at least 3 are needed");
}

}  // namespace
}  // namespace cuboct::fit::test
